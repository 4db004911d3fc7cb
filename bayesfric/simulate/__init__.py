"""Boards, effects and noise make a recording: the mirror of :mod:`bayesfric.likelihood`."""

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np

from bayesfric.paper import paper
from bayesfric.recording.tables import Gravity, Recording, RigConstants
from bayesfric.rigs.gravity_board.simulator import SENSORS, TRAVEL_M, draw_events, lay_trials
from bayesfric.rigs.motor_board.simulator import simulate_motor
from bayesfric.rigs.protocols import PROTOCOLS, Protocol
from bayesfric.rigs.truth import AppliedEffect, Truth, table1_coefficients
from bayesfric.simulate.strength import at_strength

__all__ = [
    "SENSORS",
    "AppliedEffect",
    "Truth",
    "simulate_recording",
    "table1_coefficients",
]

RIGS = ("gravity", "motor")
TORQUE_CONSTANT_N_M_PER_A = 0.0259  # an assumption: the paper does not name its motor's
CAPSTAN_RADIUS_M = 0.0065  # likewise


def simulate_recording(
    protocol: str | Protocol = "paper",
    *,
    seed: int = 0,
    truth: Truth | None = None,
    name: str = "simulated",
    created: str | None = None,
    rigs: Collection[str] = RIGS,
    effects: Mapping[str, float] | None = None,
) -> Recording:
    """Simulate the gravity board and the motor board.

    Parameters
    ----------
    protocol : str or Protocol
        A name in :data:`bayesfric.rigs.protocols.PROTOCOLS`, or a design.
    seed : int
        Seeds streams of their own (order, scatter, sensors, noise, the motor board's,
        and the phases of effects on each board), so that a change of one leaves the
        others as they were.
    truth : Truth or None
        Parameters; None is the paper's Table I with 1 % trial and 1.5 % setup
        scatter, 30 µm and 20 µs; on the motor board the specified torque constant,
        2 mA and 0.5 % of the load.
    name : str
        Name of the recording.
    created : str or None
        ISO 8601 date to write down; none is made up.
    rigs : collection of str
        ``gravity``, ``motor`` or both.
    effects : mapping of str to float, or None
        Strengths of effects by name, see :func:`bayesfric.simulate.strength.at_strength`;
        they come on top of those of `truth`.

    Returns
    -------
    Recording
        Trials in `order`, those of an assembly together. A trial that stalls
        before the fifth event of a sensor cannot be written in the recording
        format; it is left out and named in ``metadata["simulation"]["stalled"]``.

    Raises
    ------
    ValueError
        A rig is unknown, or there is none.
    InputError
        An effect is unknown.
    """
    if not rigs or set(rigs) - set(RIGS):
        raise ValueError(f"rigs is {rigs!r}; it holds 'gravity', 'motor' or both")
    truth = Truth() if truth is None else truth
    label = protocol if isinstance(protocol, str) else "custom"
    design = PROTOCOLS[protocol] if isinstance(protocol, str) else protocol
    order_rng, scatter_rng, sensor_rng, noise_rng, motor_rng, trial_rng, run_rng = (
        np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(7)
    )
    board = paper()["board"]
    rig = RigConstants(
        hall_spacing_m=board["hall_spacing_m"],
        magnets_per_revolution=board["magnets_per_revolution"],
        timer_resolution_s=board["timer_resolution_s"],
        motor_torque_constant_n_m_per_a=TORQUE_CONSTANT_N_M_PER_A,
        capstan_radius_m=CAPSTAN_RADIUS_M,
        limits={"travel_m": [0.0, TRAVEL_M]},
    )
    if effects:
        added = [at_strength(name, size, design, rig, truth) for name, size in effects.items()]
        truth = replace(truth, effects=(*truth.effects, *added))
    gravity, stalled = None, []
    if "gravity" in rigs:
        trials = lay_trials(design, order_rng)
        rngs = (scatter_rng, sensor_rng, noise_rng, trial_rng)
        events, moved = draw_events(trials, rig, truth, *rngs)
        stalled = trials.loc[~moved, "trial"].tolist()
        gravity = Gravity(trials=trials[moved].reset_index(drop=True), events=events)
    return Recording(
        name=name,
        title=f"Synthetic pulley-board recording, protocol {label}, seed {seed}",
        rig=rig,
        gravity=gravity,
        motor=simulate_motor(rig, truth, motor_rng, run_rng) if "motor" in rigs else None,
        created=created,
        metadata={
            "sources": [{"title": "Simulated by bayesfric; no board was measured"}],
            "licenses": [{"name": "CC0-1.0"}],
            "simulation": {
                "protocol": label,
                "seed": seed,
                "truth": truth.as_json(),
                "stalled": stalled,
            },
        },
    )
