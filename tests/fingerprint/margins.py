"""Every metric of the four bundled loops at fixed draws, and how two draws of them swing."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from fingerprint import access_margins as access
from fingerprint.numbers import Number, closed, integrated, text

LOOPS = ("raven-elbow", "raven-grasp", "raven-insertion", "raven-tool-rotation")


def numbers() -> dict[str, Number]:
    """Return the metrics of each loop, draw by draw."""
    rows = dict(item for loop in LOOPS for item in _of_a_loop(loop))
    as_one = access.swing(access.loop_at_shaft("raven-insertion", stiff=True))
    return rows | dict(_of_a_swing("raven-insertion on a stiff cable", as_one))


def _of_a_loop(name: str) -> Iterator[tuple[str, Number]]:
    loop = access.loop_at_shaft(name)
    for (metric, direction), values in access.closed_metrics(loop).items():
        label = f"{name}: {metric}" + (f", {direction}" if direction else "")
        values = np.asarray(values)
        yield f"{label}: how many are finite", closed(np.isfinite(values).sum())
        if np.isfinite(values).any():
            # Margins are read off at crossings, which are looked for.
            yield label, integrated(values[np.isfinite(values)])
    yield f"{name}: gamma_hunting by formula", closed(access.hunting_formula(loop))
    yield from _of_a_swing(name, access.swing(loop))


def _of_a_swing(name: str, swing: Any) -> Iterator[tuple[str, Number]]:
    yield f"{name}: hunts", text(" ".join(str(bool(hunts)) for hunts in swing.hunts))
    for figure in ("amplitude", "final_error", "rms_error"):
        values = np.asarray(getattr(swing, figure))
        if np.isfinite(values).all():
            yield f"{name}: {figure}", integrated(values)
