"""Thirty-one kinds of recording, each odd in one way and drawn at random in all others."""

from dataclasses import replace

from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

from drawn.plans import BOARD_PLANS, DRIVE_PLANS, NAMES, POINT_PLANS

__all__ = ["KINDS", "drawn_of", "small"]

LARGEST = {"trials": 6, "points": 30, "samples": 300, "runs": 2}
ONE = settings(
    max_examples=2,  # the first of a search is the simplest of all
    deadline=None,
    database=None,
    suppress_health_check=list(HealthCheck),
    phases=[Phase.generate],
)
EVERY_COLUMN = (
    "order",
    "setup",
    "pulley_size",
    "n_pulleys",
    "wrap_angle_deg",
    "tension_n",
    "velocity_m_s",
    "friction_sd_n",
    "role",
)


def small(plan):
    """Return a plan of no more than takes a second or two."""
    counts = {name: most for name, most in LARGEST.items() if hasattr(plan, name)}
    return replace(plan, **{name: min(most, getattr(plan, name)) for name, most in counts.items()})


def odd(plans, **fields):
    """Return plans that have these values, and are drawn otherwise."""
    return st.tuples(plans.map(lambda plan: replace(plan, **fields)))


KINDS = {
    "board": st.tuples(BOARD_PLANS),
    "board of one trial": odd(BOARD_PLANS, trials=1, runs=0),
    "board of one assembly": odd(BOARD_PLANS, trials=6, setups=1),
    "motor runs alone": odd(BOARD_PLANS, trials=0, runs=3),
    "board and motor runs": odd(BOARD_PLANS, trials=5, runs=3),
    "board without further columns": odd(
        BOARD_PLANS, trials=6, dropped=("setup", "order", "drive_end", "role")
    ),
    "board in slow motion": odd(BOARD_PLANS, trials=6, slower=3.0),
    "board whose clock jumps": odd(BOARD_PLANS, trials=6, jitter_s=1e-3),
    "board of accelerations that no masses have": odd(BOARD_PLANS, trials=6, by_acceleration=True),
    "board with the role test alone": odd(BOARD_PLANS, trials=6, tested=1.0),
    "points": st.tuples(POINT_PLANS),
    "one point": odd(POINT_PLANS, points=1),
    "points without columns": odd(POINT_PLANS, points=30, columns=(), covariates=()),
    "points with every column": odd(POINT_PLANS, points=30, columns=EVERY_COLUMN),
    "points without friction": odd(POINT_PLANS, points=30, size=0.0),
    "points of a million newtons": odd(POINT_PLANS, points=30, size=1e6),
    "points that are all alike": odd(POINT_PLANS, points=30, same=True, scatter=0.0),
    "points that run both ways": odd(POINT_PLANS, points=30, both_ways=True),
    "drive": st.tuples(DRIVE_PLANS),
    "drive of constant force": odd(DRIVE_PLANS, force="constant"),
    "drive without force": odd(DRIVE_PLANS, force="none"),
    "drive that stands still": odd(DRIVE_PLANS, motion="still"),
    "drive of noise": odd(DRIVE_PLANS, motion="noise"),
    "drive that runs one way": odd(DRIVE_PLANS, motion="one way"),
    "drive of ten samples": odd(DRIVE_PLANS, samples=10),
    "drive at ten kilohertz": odd(DRIVE_PLANS, sampled_hz=10000.0),
    "drive far from zero on a tiny stroke": odd(DRIVE_PLANS, offset=1e4, stroke=1e-6),
    "drive of ten tonnes": odd(DRIVE_PLANS, constants={"moving_mass_kg": 1e4}),
    "drive with names of any text": st.tuples(
        st.builds(lambda plan, names: replace(plan, names=names), DRIVE_PLANS, NAMES)
    ),
    "drive beside points": st.tuples(DRIVE_PLANS, POINT_PLANS),
    "drive spun up by one force a run": odd(DRIVE_PLANS, motion="spins up", runs=5),
}
"""Plans by what is odd about them."""


def drawn_of(kind):
    """Return small plans of a kind, always the same."""
    drawn = []

    @ONE
    @seed(list(KINDS).index(kind))
    @given(plans=KINDS[kind])
    def draw(plans):
        drawn.append(plans)

    draw()
    return tuple(map(small, drawn[-1]))
