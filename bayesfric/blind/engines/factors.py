"""Parts of which forms of friction are made: factors of a pulley's friction, and draws."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.state import Array, BoardState, Form, no_parameters

Parameters = Mapping[str, Any]
Draw = Callable[[Generator, int], dict[str, Any]]
Factor = Callable[[Parameters, BoardState], Any]


def uniform(**ranges: tuple[float, float]) -> Draw:
    """Return a draw: each number between its two limits."""

    def draw(rng: Generator, trials: int) -> dict[str, Any]:
        return {name: float(rng.uniform(*limits)) for name, limits in ranges.items()}

    return draw


def alike(
    law: Callable[[Any], Any],
    *forms: tuple[str, bool, Any],
    draw: Draw = no_parameters,
    affine: bool = True,
) -> tuple[Form, ...]:
    """Return forms of friction whose laws differ by one function each.

    Parameters
    ----------
    law : callable
        Such a function to the law.
    *forms : (str, bool, callable)
        Name of each form, whether the package's own effect has it, and its function.
    draw, affine
        As of :class:`.state.Form`.
    """
    return tuple(
        Form(name, own, law(change), draw=draw, affine=affine) for name, own, change in forms
    )


def share(factor: Factor) -> Any:
    """Return a law: a factor of the pulley's friction."""

    def law(p: Parameters, s: BoardState, tension: Array) -> Array:
        return np.asarray(p["amplitude"] * factor(p, s) * s.friction(tension))

    return law


def moving_share(factor: Factor) -> Any:
    """Return a law: such a share while the board runs; none in a steady run."""
    return share(lambda p, s: 0.0 if s.steady else factor(p, s))


def scaled(factor: Factor) -> Any:
    """Return a law: a factor of a pulley's friction at 15 N and 85°, whatever the tension."""

    def law(p: Parameters, s: BoardState, tension: Array) -> Array:
        return np.asarray(p["amplitude"] * factor(p, s) * s.scale_n + 0.0 * tension)

    return law


def with_tension(factor: Factor) -> Any:
    """Return a law: the same, in proportion to tension."""

    def law(p: Parameters, s: BoardState, tension: Array) -> Array:
        return np.asarray(p["amplitude"] * factor(p, s) * s.scale_n * tension / 15.0)

    return law
