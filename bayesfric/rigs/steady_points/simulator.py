"""Simulation of steady points, with the model of :mod:`bayesfric.observation.readings`.

Assemblies of medium pulleys, with several numbers and wrap angles, run in both directions at
several tensions and speeds. A reading is a sum of three terms. The first is friction, of the law
and of effects on it, times 1 + η + ε with the deviations of the assembly and of the reading. The
others are effects on the drive, and an error with a known standard error.
"""

from itertools import product

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.effects import NO_OFFSET, PULLEYS, Effect, State
from bayesfric.observation.linear import rank
from bayesfric.physics.friction import coulomb_friction
from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.acting import draw_phases, of_kind, total
from bayesfric.rigs.base import CONDITION
from bayesfric.rigs.changes import Change
from bayesfric.rigs.own_design import OwnDesign, Simulated
from bayesfric.rigs.truth import AppliedEffect, Truth, laws_of, table1_coefficients

CELLS = ((5, 85.0), (9, 50.0), (9, 85.0), (9, 85.0), (15, 85.0), (15, 135.0))
TENSIONS_N = (6.0, 15.0, 30.0)
SPEEDS_M_S = (-1.2, -0.6, -0.1, 0.1, 0.3, 0.6, 1.2)
ERROR_N = 0.005
SIZE = "medium"


def points_in_random_order(rng: np.random.Generator) -> pd.DataFrame:
    """Return a table of points, with assemblies, and the points of each, in random order."""
    rows = []
    for setup in rng.permutation(len(CELLS)):
        n, wrap = CELLS[setup]
        points = list(product(TENSIONS_N, SPEEDS_M_S))
        for place in rng.permutation(len(points)):
            tension, speed = points[place]
            rows.append((f"a{setup + 1}", SIZE, n, wrap, tension, speed))
    names = "setup pulley_size n_pulleys wrap_angle_deg tension_n velocity_m_s".split()
    table = pd.DataFrame(rows, columns=names)
    table.insert(0, "run", [f"p{place + 1:03d}" for place in range(len(table))])
    table.insert(1, "order", np.arange(1, len(table) + 1))
    return table


def _state(table: pd.DataFrame, truth: Truth) -> State:
    n, wrap, tension = (table[name].to_numpy(float) for name in CONDITION)
    speed = table["velocity_m_s"].to_numpy(float)
    law = laws_of(truth, table["pulley_size"])
    around = {"order": rank(table), "direction": np.sign(speed)}
    return State.of(law, n, wrap, tension, np.abs(speed), **around, steady=True)


def _friction(table: pd.DataFrame, truth: Truth) -> Array:
    law = laws_of(truth, table["pulley_size"])
    return coulomb_friction(law, *(table[name].to_numpy(float) for name in CONDITION))


def change(effect: Effect, constants: RigConstants, truth: Truth) -> Change | None:
    """Return a function that computes the relative change of each point's friction by an effect.

    The result is None for effects that points cannot show.
    """
    del constants
    if effect.acts_on not in ("friction", "drive") or effect.components:
        return None
    table = points_in_random_order(np.random.default_rng(0))
    state, friction = _state(table, truth), _friction(table, truth)

    def changed(applied: AppliedEffect) -> Array:
        return np.broadcast_to(np.asarray(applied(state)) / friction, friction.shape)[:, None]

    return changed


def simulate(constants: RigConstants, truth: Truth, seed: int) -> Simulated:
    """Return a simulated table of points."""
    del constants
    streams = np.random.SeedSequence(seed).spawn(4)
    lay, scatter, noise, phases = (np.random.default_rng(child) for child in streams)
    table = points_in_random_order(lay)
    state = _state(table, truth)
    acting = draw_phases(truth, len(table), 1, phases)
    setup = pd.factorize(table["setup"])[0]
    eta = truth.omega * scatter.standard_normal(len(CELLS))[setup]
    deviation = eta + truth.tau * scatter.standard_normal(len(table))
    friction = _friction(table, truth) + total(of_kind(acting, "friction"), state)
    read = friction * (1 + deviation) + total(of_kind(acting, "drive"), state)
    read = read + ERROR_N * noise.standard_normal(len(table))
    steady = table.assign(friction_n=read.round(6), friction_sd_n=ERROR_N)
    return Simulated({"steady": steady}, len(steady))


DESIGN = OwnDesign(
    name="points",
    title="steady friction points of medium pulleys by Table I of Miyasaka et al. (2015)",
    constants=RigConstants(),
    coefficients={SIZE: table1_coefficients()[SIZE]},
    offers=PULLEYS | {"direction", NO_OFFSET},
    change=change,
    simulate=simulate,
)
