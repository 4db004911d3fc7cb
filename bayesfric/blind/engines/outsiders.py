"""Outsiders: what a board may do that no effect of the package describes.

Each names the axes along which its force really varies. Where a design has few levels of
an axis, some effect of the package fits any curve through them. So an outsider that varies
with wrap angle or tension does not scale with the rest of friction as those effects do.
"""

from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.factors import Draw, Parameters, moving_share, scaled, share, uniform
from bayesfric.blind.engines.law import TABLE_I
from bayesfric.blind.engines.state import Array, BoardState, Form, Kind, Law, no_parameters

MEDIUM_N = float(TABLE_I[1, 0] * 15 + TABLE_I[1, 1])  # of one pulley at 15 N and 85°


def _either(rng: Generator, *choices: Any) -> Any:
    return choices[int(rng.integers(len(choices)))]


def _kind(
    name: str,
    axes: tuple[str, ...],
    law: Law,
    draw: Draw = no_parameters,
    *,
    affine: bool = True,
    signed: bool = True,
    needs: str = "",
    boards: tuple[str, ...] = ("gravity", "motor"),
) -> Kind:
    form = Form(name, False, law, draw=draw, affine=affine)
    return Kind(name, "amplitude", (form,), axes, signed, needs, boards)


def _bump(values: Array, middle: float, width: float) -> Array:
    return np.asarray(np.exp(-(((values - middle) / width) ** 2)))


def _step(values: Array, place: float, width: float) -> Array:
    return np.asarray(0.5 * (1 + np.tanh((values - place) / width)))


def _kinked(p: Parameters, s: BoardState, tension: Array) -> Array:
    # The same force for every size, as of a bearing that starts to rub on its shield.
    beyond = np.logaddexp(0.0, (tension - p["tension"]) / p["width"]) * p["width"]
    return np.asarray(p["amplitude"] * MEDIUM_N * beyond / 15.0)


def _crossed(p: Parameters, s: BoardState, tension: Array) -> Array:
    return np.asarray(p["amplitude"] * (s.speed_m_s - 0.6) * (tension / 15 - 1) * s.scale_n)


OUTSIDERS = (
    _kind(  # a worn place of the cable
        "dip-in-travel",
        ("displacement",),
        moving_share(lambda p, s: -_bump(s.travel_m, p["place"], p["width"])),
        uniform(place=(0.2, 0.45), width=(0.03, 0.07)),
        signed=False,
        boards=("gravity",),
    ),
    _kind(  # a regime of lubrication that ends
        "step-in-speed",
        ("velocity",),
        share(lambda p, s: _step(s.speed_m_s, p["speed"], 0.02)),
        uniform(speed=(0.4, 0.75)),
    ),
    _kind(
        "resonance-in-speed",
        ("velocity",),
        share(lambda p, s: _bump(s.speed_m_s, p["speed"], p["width"])),
        uniform(speed=(0.4, 0.75), width=(0.05, 0.12)),
        signed=False,
    ),
    _kind(
        "tension-threshold",
        ("tension",),
        _kinked,
        uniform(tension=(17.0, 22.0), width=(0.2, 0.6)),
        affine=False,
        signed=False,
    ),
    _kind(
        "bump-in-wrap",
        ("wrap_angle",),
        scaled(lambda p, s: _bump(s.wrap_angle_deg, p["angle"], p["width"])),
        uniform(angle=(75.0, 95.0), width=(15.0, 25.0)),
    ),
    _kind(  # one plate that is bent: its pulleys stand askew
        "one-pulley-count",
        ("n_pulleys",),
        share(lambda p, s: np.where(s.n_pulleys == p["count"], 1.0, 0.0)),
        lambda rng, trials: {"count": int(_either(rng, 9, 15))},
        signed=False,
    ),
    _kind(  # days and nights
        "wave-in-order",
        ("order",),
        share(lambda p, s: np.sin(2 * np.pi * p["cycles"] * s.order + p["phase"])),
        uniform(cycles=(1.5, 2.5), phase=(0, 2 * np.pi)),
        signed=False,
    ),
    _kind(  # a wave on the cable itself, not of any pulley
        "wave-in-travel",
        ("displacement",),
        moving_share(lambda p, s: np.cos(2 * np.pi * s.travel_m / p["length"] + p["phase"])),
        uniform(length=(0.2, 0.35), phase=(0, 2 * np.pi)),
        signed=False,
        boards=("gravity",),
    ),
    _kind(  # bearings that are loaded further as they are spun up
        "load-of-acceleration",
        ("acceleration",),
        share(lambda p, s: s.acceleration_m_s2 / 0.6),
        boards=("gravity",),
    ),
    _kind(  # the motor's plate is out of line
        "motor-board-askew",
        ("rig",),
        share(lambda p, s: 1.0 if s.steady else 0.0),
        signed=False,
        needs="motor",
        boards=("motor",),
    ),
    _kind(
        "speed-by-tension",
        ("velocity", "tension"),
        _crossed,
    ),
    _kind(  # grease that is pushed ahead, in one size
        "one-size-along-travel",
        ("displacement", "pulley_size"),
        moving_share(lambda p, s: np.where(s.size == p["size"], s.travel_m / 0.3 - 1, 0.0)),
        lambda rng, trials: {"size": int(_either(rng, 0, 1, 2))},
        boards=("gravity",),
    ),
    _kind(  # friction that waits for the travel to have settled, at one spot and speed
        "speed-late-in-travel",
        ("velocity", "displacement"),
        moving_share(lambda p, s: s.speed_m_s * _step(s.travel_m, p["place"], 0.02)),
        uniform(place=(0.25, 0.4)),
        boards=("gravity",),
    ),
)
"""Outsiders, in no particular order."""
