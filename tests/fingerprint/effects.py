"""Every law of every effect, at fixed places, by the functions of ``effects/``."""

from typing import Any

import numpy as np
from fingerprint.numbers import Number, closed

from bayesfric.effects import Effect, Reading, State, all_effects
from bayesfric.inference.priors import from_normal
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.loads import behind

LAW = Coefficients(0.0131, 0.0255, 2.9e-5)
PATH = 0.02 * np.sin(2.0 + 9 * 2e-3 * np.arange(200))


def _load(held: str, heavy: float, length: Any) -> tuple[Any, Any]:
    """Return how a load follows a path, at five samples."""
    lengths = np.atleast_1d(np.asarray(length, dtype=float)).ravel()[:1]
    ahead, rubs = behind(held, PATH, 2e-3, 0.8, np.array([heavy]), lengths, 0.06)
    return ahead[20::40, 0] * 1e3, rubs[20::40, 0] - 1


def _state() -> State:
    return State.of(
        LAW,
        np.array([5.0, 9.0, 15.0, 19.0, 9.0]),
        np.array([50.0, 85.0, 135.0, 110.0, 70.0]),
        np.array([6.0, 12.0, 18.0, 28.0, 33.0]),
        np.array([0.02, 0.15, 0.4, 0.8, 1.3]),
        np.array([1.1, 2.2, 3.3, 4.4, 5.5]),
        travel_m=np.array([0.001, 0.01, 0.1, 0.3, 0.6]),
        passes_m=(np.full(5, 0.02), np.linspace(0.001, 0.1, 5)),
        acceleration_m_s2=np.array([0.1, 0.5, -0.3, 1.2, 2.0]),
        order=np.array([0.0, 0.2, 0.5, 0.7, 1.0]),
        drive_end=np.array([-0.5, 0.5, 0.0, 0.5, -0.5]),
        trial_in_setup=np.array([0.0, 1.0, 2.0, 3.0, 5.0]),
        position_m=np.array([-0.1, 0.0, 0.05, 0.1, 0.15]),
        direction=np.array([-1.0, 1.0, 1.0, -1.0, 1.0]),
        drive_force_n=np.array([-3.0, 2.0, 4.0, -1.0, 5.0]),
        mass_kg=2.0,
        force_rate_n_s=np.array([10.0, -5.0, 3.0, 8.0, -2.0]),
        force_curvature_n_s2=np.array([100.0, 50.0, -30.0, 20.0, 5.0]),
        lagging_rate_n_s=np.array([9.0, -4.0, 2.0, 7.0, -1.0]),
        wave_from_m=0.01,
        tested=np.array([0.0, 1.0, 0.0, 1.0, 0.0]),
        load=_load,
        wrap_spread_deg=np.array([0.0, 5.0, 10.0, 20.0, 30.0]),
    )


def _reading() -> Reading:
    return Reading(
        np.array([0.0, 0.0098, 0.049, 0.196, 0.49]),
        np.array([0, 1, 5, 20, 50]),
        np.array([0, 1, 0, 1, 1]),
        np.array([0.0, 0.1, 0.25, 0.6, 1.0]),
        np.array([0.02, 0.15, 0.4, 0.8, 1.3]),
        np.array([0.8, 0.8, 0.8, 0.8, 0.8]),
        np.array([1.75, 1.75, 2.9, 2.9, 3.4]),
        np.array([1.41, 1.41, 2.1, 2.1, 1.9]),
        5,
    )


def numbers() -> dict[str, Number]:
    """Return what each effect does at two strengths."""
    rows = {}
    for name, effect in all_effects(None).items():
        place = _reading() if effect.acts_on == "reading" else _state()
        for kind, laws in (("", effect.laws), (" that turns", effect.turning)):
            for law_name, law in laws.items():
                done = [law(values, place) for values in _strengths(effect)]
                flat = np.concatenate([np.broadcast_to(force, (5,)).ravel() if np.ndim(force) == 0
                                       else np.ravel(force) for force in done])  # fmt: skip
                rows[f"{name}, {law_name}{kind}"] = closed(flat)
    return rows


def _strengths(effect: Effect) -> list[dict[str, np.ndarray]]:
    """Return parameters at two quantiles of their priors, of two digits."""
    return [
        {
            parameter.name: np.float64(f"{float(from_normal(parameter.prior, normal)):.2g}")
            for parameter in effect.parameters
        }
        for normal in (0.4, 1.3)
    ]
