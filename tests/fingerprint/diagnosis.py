"""Of a diagnosis: evidences at fixed noise, information, climbs, and a small search.

The noise is fixed by name, so that evidences are closed forms.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from fingerprint import access_diagnosis as access
from fingerprint.numbers import Number, closed, drawn, integrated
from fingerprint.points import NOISE

STRENGTHS = {"quiet": 0.3, "as it is": 1.0, "loud": 3.0}
SEARCHED = {
    "gravity": ("viscous", "tension-curvature"),
    "motor": ("viscous", "tension-curvature"),
    "points": ("viscous", "air-drag"),
    "axis": ("air-drag", "presliding"),
}

AWAY = ("motor", "points")


def numbers(rig: str) -> dict[str, Number]:
    """Return the numbers of a rig."""
    return dict((*_at_fixed_noise(rig), *_of_a_search(rig)))


def _at_fixed_noise(rig: str) -> Iterator[tuple[str, Number]]:
    model, noise = access.linear(rig), NOISE[rig]
    slopes = rig != "axis"  # small ones are differences of much larger numbers there
    for name, factor in STRENGTHS.items():
        louder = {key: factor * value for key, value in noise.items()}
        yield from _of_hypothesis(
            f"nothing acts, noise {name}", access.at_noise(model, louder), slopes=slopes
        )
    for effect, law in access.laws_of(model):
        hypothesis = access.at_noise(model, noise, [(effect, law, 0.4)])
        yield f"{effect}, {law}: log evidence", closed(hypothesis.log_evidence)
        yield f"{effect}, {law}: strength", closed(hypothesis.strengths)
    pair = [(effect, law, -0.3) for effect, law in access.laws_of(model, SEARCHED[rig])]
    yield from _of_hypothesis("several act", access.at_noise(model, noise, pair[:3]), slopes=slopes)
    for axis in access.axes(model):
        wide = access.at_noise(model, noise, wide=(0.05, axis))
        yield f"unknown force along {axis}: log evidence", closed(wide.log_evidence)
    yield from _of_hypothesis(
        "half of the trials", access.at_noise(model, noise, half=True), slopes=slopes
    )
    bare = access.linear(rig, discrepancy=False)
    yield from _of_hypothesis("without discrepancy", access.at_noise(bare, noise), slopes=slopes)
    acting = [(*access.laws_of(model, SEARCHED[rig][:1])[0], 0.2)]
    formed = access.linear(rig, acting=acting)
    yield from _of_hypothesis(
        "around an effect", access.at_noise(formed, noise, acting), slopes=slopes
    )
    wrong = access.at_noise(formed, noise, acting, form=0.3)
    yield "around an effect whose law is wrong: log evidence", closed(wrong.log_evidence)
    shown = access.windows(model, noise)
    yield "windows: rms of residual force", closed(shown.residual_rms)
    yield "windows: rms friction", closed(shown.friction_rms)
    yield "windows: measurement error", closed(shown.error_rms)
    yield "windows: scatter", closed(shown.scatter)


def _of_hypothesis(
    name: str, hypothesis: Any, *, slopes: bool = True
) -> Iterator[tuple[str, Number]]:
    yield f"{name}: log evidence", closed(hypothesis.log_evidence)
    yield f"{name}: log determinant of the information", closed(hypothesis.log_determinant)
    yield f"{name}: slope by the noise", integrated(np.linalg.norm(hypothesis.slopes))
    if slopes:
        yield f"{name}: slopes by the noise", integrated(hypothesis.slopes)
    yield f"{name}: strengths of effects", closed(hypothesis.strengths)


def _of_a_search(rig: str) -> Iterator[tuple[str, Number]]:
    if rig in AWAY:
        around = access.searched(rig, SEARCHED[rig], seed=477, away=True)
        for name, value in around.log_evidence.items():
            yield f"search, priors away from 0, {name}: log evidence", integrated(value)
    search = access.searched(rig, SEARCHED[rig], seed=477)
    # The volume of an axis's noise is one of differences that are as small as rounding; it is
    # nearly the same for all hypotheses.
    whole = rig != "axis"
    for name, value in search.log_evidence.items():
        if whole:
            yield f"search, {name}: log evidence", integrated(value)
        gain = value - search.log_evidence["none"]
        if name != "none":
            yield f"search, {name}: gain over nothing", drawn(gain, 1e-3 if whole else 0.02)
    for name, chance in search.probabilities.items():
        yield f"search, {name}: probability", drawn(chance, 0.002)
    if whole:
        yield "search: log volume of the noise", integrated(search.volume)
    yield "search: systematic gap", drawn(*search.gap)
    for name, strength in search.strengths.items():
        yield f"search, {name}: strength", drawn(*strength)
