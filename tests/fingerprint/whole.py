"""One small fit and one whole diagnosis of each rig, at a fixed seed."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from fingerprint import access, access_diagnosis
from fingerprint.numbers import Number, drawn, integrated, text


def of_fit(rig: str) -> dict[str, Number]:
    """Return mean and standard deviation of each parameter, with their Monte Carlo errors."""
    rows: dict[str, Number] = {}
    for name, (draws, count) in access.small_fit(rig).items():
        sd = float(draws.std())
        rows[f"{name}: mean"] = drawn(float(draws.mean()), sd / np.sqrt(count))
        excess = float((((draws - draws.mean()) / sd) ** 4).mean()) - 1
        rows[f"{name}: sd"] = drawn(sd, sd * np.sqrt(max(excess, 1.0) / (4 * count)))
    return rows


def of_diagnosis(rig: str) -> dict[str, Number]:
    """Return probabilities, verdict, gap, causes and strengths."""
    rows = dict(_of_diagnosis(access_diagnosis.diagnosis(rig)))
    if rig == "points":
        for name, recorded in access_diagnosis.with_more_friction().items():
            numbers = _of_diagnosis(access_diagnosis.diagnosis(rig, recorded))
            rows |= {f"{name}: {number}": value for number, value in numbers}
    return rows


def _of_diagnosis(diagnosis: Any) -> Iterator[tuple[str, Number]]:
    yield "verdict", text(diagnosis.verdict)
    yield "verdict: probability", drawn(diagnosis.verdict_probability, 0.005)
    for name, chance in diagnosis.probabilities.items():
        if chance > 0.02:
            yield f"probability of {name}", drawn(chance, 0.002)
    for effect in diagnosis.effects:
        if effect.log10_bayes_factor is not None:
            yield f"{effect.effect}: log10 Bayes factor", drawn(effect.log10_bayes_factor, 0.002)
    for name, value in diagnosis.scatter.items():
        yield f"scatter {name}", drawn(value, 0.002 * value)
    for name, number in diagnosis.law.items():
        yield f"law alone: {name}", drawn(number.before.mean, 0.05 * number.before.sd)
        yield f"law: {name}", drawn(number.after.mean, _error(number.after))
    gap = diagnosis.gap
    yield "gap: friction", integrated(gap.friction_rms)
    for name in ("as_shipped", "before", "after", "floor", "systematic", "shrink"):
        interval = getattr(gap, name)
        if interval is not None:
            yield f"gap: {name}", drawn(interval.q50, _error(interval))
    for cause in (*diagnosis.causes, *diagnosis.present, *diagnosis.possible):
        yield f"{cause.effect}: law", text(cause.law)
        yield f"{cause.effect}: strength", drawn(cause.strength, 0.02 * cause.strength)
        for name, number in cause.parameters.items():
            yield f"{cause.effect}: {name}", drawn(number.mean, _error(number))
    yield "causes", text(", ".join(cause.effect for cause in diagnosis.causes))
    yield "present", text(", ".join(cause.effect for cause in diagnosis.present))
    yield "absorbed", text(", ".join(sorted(absorbed.effect for absorbed in diagnosis.absorbed)))
    for axis in diagnosis.where:
        if axis.share is not None:
            yield f"where: share along {axis.axis}", drawn(axis.share.mean, _error(axis.share))
        if axis.p_value is not None:
            yield f"where: p_value along {axis.axis}", drawn(axis.p_value, 0.003)
    if diagnosis.where and diagnosis.where[0].shape is not None:
        shape = diagnosis.where[0].shape
        for name in ("gap_n", "high_n"):
            spread = float(np.mean(np.subtract(shape.high_n, shape.low_n)))
            largest = float(np.max(np.abs(getattr(shape, name))))
            yield f"where: largest {name}", drawn(largest, 0.01 * spread)
    yield "gap: floor agrees", text(str(gap.floor_agrees))
    for row in gap.held_out:
        yield f"gap, {row.name}: before", drawn(row.before.q50, _error(row.before))
        yield f"gap, {row.name}: after", drawn(row.after.q50, _error(row.after))
    yield "remainder", drawn(diagnosis.remainder.log10_bayes_factor, 0.01)


def _error(interval: Any) -> float:
    """Return the Monte Carlo error of a median or mean of the hundreds of draws that there are."""
    return max(1.25 * interval.sd / np.sqrt(400), 1e-9)
