"""A diagnosis as the verb stores it: made up, with numbers that are easy to find again."""

import numpy as np
import xarray as xr
from report.told import plain as words

from bayesfric.analysis import HalfNormal
from bayesfric.report.chapters.diagnosis import diagnosis as chapter
from bayesfric.report.chapters.diagnosis_details import appendix
from bayesfric.report.content import BulletList, Figure, Notice, Paragraph, Table
from bayesfric.report.stored import StoredDiagnosis
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import (
    Absorbed,
    Cause,
    EffectNumber,
    Inclusion,
    Remainder,
    Shape,
    Unseparated,
)
from bayesfric.schemas.diagnosis import ExaminedEffect, NextExperiment
from bayesfric.schemas.gap import Axis, Gap, GapRow

PROVENANCE = {
    "seed": 5,
    "versions": {"python": "3.11.0"},
    "recording": {"name": "a-board", "title": "A board", "sha256": "a" * 64},
    "analysis_sha256": "b" * 64,
    "created": None,
}


def interval(mean: float, sd: float | None = None) -> Interval:
    sd = abs(mean) / 20 if sd is None else sd
    return Interval(mean=mean, sd=sd, q05=mean - 1.645 * sd, q50=mean, q95=mean + 1.645 * sd)


def axis(
    name: str,
    unit: str,
    share: float | None,
    low: float = 0.0,
    high: float = 1.0,
    *,
    leads: bool = False,
) -> Axis:
    grid = np.linspace(low, high, 25)
    if share is None:
        why = "the covariate did not vary"
        return Axis(
            axis=name, unit=unit, blind=True, leads=False,
            share=None, share_why=why, alone=None, alone_why=why,
            confounded_with=(), p_value=None, p_value_why=why, shape=None, shape_why=why,
        )  # fmt: skip
    gap = 0.05 * share * np.sin(3 * (grid - low) / (high - low))
    return Axis(
        axis=name, unit=unit, blind=False, leads=leads,
        share=interval(share), alone=interval(1.2 * share),
        confounded_with=("tension",) if name == "displacement" else (),
        p_value=0.0005 if share > 0.3 else 0.43,
        shape=Shape(
            grid=tuple(grid), gap_n=tuple(gap), low_n=tuple(gap - 0.004), high_n=tuple(gap + 0.004)
        ),
    )  # fmt: skip


def cause(effect: str, **changes: object) -> Cause:
    slope = interval(0.123)
    fields: dict[str, object] = {
        "effect": effect,
        "sentence": "friction grows in proportion to speed",
        "inclusion_probability": 0.987,
        "log10_bayes_factor": 12.34,
        "log10_bayes_factor_se": 0.056,
        "law": "constant",
        "parameters": {
            "slope": EffectNumber(
                **slope.model_dump(),
                unit="s/m",
                prior="half-normal(scale=0.15)",
                prior_density=HalfNormal(scale=0.15),
            )
        },
        "plausible": True,
        "plausible_range": (0.0, 0.3),
        "plausible_reference": "Harris and Kotzalas (2006)",
        "strength": 0.0789,
        "below_floor": False,
    }
    return Cause(**(fields | changes))  # type: ignore[arg-type]


def acts(effect: str, probability: float, strength: Interval | None = None) -> Inclusion:
    return Inclusion(
        effect=effect,
        probability=probability,
        strength=strength,
        strength_why="it is too improbable to be drawn" if strength is None else None,
        probability_above_practical=0.0 if strength is None else probability,
        makes_a_gap=strength is not None,
    )


def row(name: str, scale: float = 1.0, shipped: bool = True) -> GapRow:
    return GapRow(
        name=name,
        as_shipped=interval(0.0951 * scale) if shipped else None,
        as_shipped_why=None if shipped else "no published values for this size",
        before=interval(0.0523 * scale),
        after=interval(0.0187 * scale),
        floor=interval(0.0174 * scale),
        shrink=interval(0.981, 0.004),
    )


def diagnosis(**changes: object) -> DiagnosisFile:
    gap = row("all")
    fields: dict[str, object] = PROVENANCE | {
        "rigs": ("gravity", "motor"),
        "baseline": "paper",
        "practical_share": 0.005,
        "verdict": "named",
        "verdict_probability": 0.987,
        "sentence": "Friction grows in proportion to the speed of the cable (viscous), with "
        "probability 0.971; adding it closes 98 % of the systematic gap on held-out assemblies.",
        "probabilities": {
            "viscous": 0.971, "viscous+stribeck": 0.0091, "viscous+air-drag": 0.0069,
            "air-drag": 0.0054, "stribeck": 0.004, "unknown": 0.002, "presliding": 0.001,
            "none": 0.0001, "fixed-drag": 0.0003, "runout": 0.0002,
        },
        "hypothesis_prior": {
            "none": 0.5, "one": 0.3, "two": 0.08, "three or more": 0.02, "unknown": 0.1,
        },
        "prior_sensitivity": {
            "0.1": {"viscous": 0.975, "none": 0.00002},
            "0.9": {"viscous": 0.961, "none": 0.001},
        },
        "unvisited_probability": 0.0021,
        "inclusion": (
            acts("viscous", 0.987, interval(0.0789)), acts("air-drag", 0.0123, interval(0.011)),
            acts("stribeck", 0.0131), acts("presliding", 0.001),
        ),
        "causes": (cause("viscous"),),
        "unseparated": (
            Unseparated(effects=("viscous", "cable-weight"), reason="identical-on-this-rig"),
            Unseparated(effects=("air-drag", "stribeck"), reason="these-data"),
        ),
        "absorbed": (
            Absorbed(effect="mass-error", by="c2[medium]", bias=0.00134, unit="N"),
        ),
        "remainder": Remainder(
            significant=False,
            log10_bayes_factor=-0.71,
            share_of_gap=interval(0.0135),
            axis="tension",
        ),
        "where": (
            axis("velocity", "m/s", 0.62, 0.2, 1.4, leads=True),
            axis("displacement", "m", 0.21, 0.0, 0.8),
            axis("tension", "N", 0.093, 6.0, 28.0), axis("n_pulleys", "1", 0.021, 5.0, 19.0),
            axis("order", "1", 0.0032), axis("setup", "1", 0.0, 0.0, 30.0),
            axis("pulley_size", "1", None), axis("wrap_angle", "deg", None),
        ),
        "unexplained": interval(0.0528),
        "gap": Gap(
            **gap.model_dump(exclude={"name", "below_floor"}),
            shrink_of_model=interval(0.981, 0.004),
            systematic=interval(0.0493),
            probability_above_practical=1.0,
            floor_agrees=True,
            friction_rms=0.731,
            held_out=(
                row("folds over assemblies"), row("top tension", 1.3),
                row("largest number of pulleys", 1.2, shipped=False),
            ),
            in_sample=row("in sample", 0.9),
            trajectory=row("trajectory", 0.2),
        ),
        "effects": (
            ExaminedEffect(effect="viscous", log10_bayes_factor=14.56),
            ExaminedEffect(effect="air-drag", log10_bayes_factor=11.2),
            ExaminedEffect(
                effect="torque-constant",
                log10_bayes_factor=None,
                log10_bayes_factor_why="absent from these data",
            ),
        ),
        "next_experiment": (
            NextExperiment(
                condition={"size": "medium", "n_pulleys": 9.0, "mass_drive_kg": 1.85},
                separates=("viscous", "air-drag"),
                log10_bayes_factor=3.21,
            ),
        ),
    }  # fmt: skip
    return DiagnosisFile(**(fields | changes))  # type: ignore[arg-type]


def curves(causes: tuple[str, ...] = ("viscous",), trajectories: bool = True) -> xr.DataTree:
    rng = np.random.default_rng(1)
    count = 800
    tension = rng.choice([6.0, 15.0, 28.0], count)
    speed = rng.uniform(0.2, 1.4, count)
    groups = {
        "residuals": xr.Dataset(
            {
                "rig": ("row", ["gravity"] * count),
                "trial": ("row", [f"g{k // 8:04d}" for k in range(count)]),
                "friction_n": ("row", np.full(count, 0.7)),
                "residual_n": ("row", 0.03 * np.sin(3 * (speed - 0.2) / 1.2)
                               + 0.012 * rng.standard_normal(count)),
                "noise_sd_n": ("row", np.full(count, 0.004)),
                "velocity": ("row", speed),
                "tension": ("row", tension),
                "wrap_angle": ("row", np.full(count, 85.0)),
                "n_pulleys": ("row", rng.choice([5.0, 9.0, 15.0, 19.0], count)),
                "displacement": ("row", rng.uniform(0, 0.8, count)),
                "order": ("row", rng.uniform(0, 1, count)),
            }
        )
    }  # fmt: skip
    if causes:
        groups["amplitudes"] = xr.Dataset(
            {"amplitude": (("cause", "draw"), rng.normal(0.123, 0.006, (len(causes), 400)))},
            coords={"cause": list(causes)},
        )
    if trajectories:
        time = np.linspace(0.05, 1.2, 60)[None] * np.array([[1.0], [1.3], [1.7]])
        path = 0.35 * time**2
        time[1, 55:] = np.nan  # a trial with fewer events
        path[1, 55:] = np.nan
        wave = 1e-3 * np.sin(40 * path)
        groups["trajectories"] = xr.Dataset(
            {
                "time_s": (("example", "event"), time),
                "measured_m": (("example", "event"), path),
                "before_m": (("example", "event"), path + 0.012 * time**2),
                "after_m": (("example", "event"), path + 0.2 * wave),
            },
            coords={"trial": ("example", ["g0011", "g0042", "g0107"])},
        )
    return xr.DataTree.from_dict(groups)


def stored_diagnosis(**changes: object) -> StoredDiagnosis:
    record = diagnosis(**changes)
    names = tuple(named.effect for named in record.causes)
    return StoredDiagnosis(record, curves(names, record.gap.trajectory is not None))


def without_gap() -> StoredDiagnosis:
    """No gap: nothing named, after as before, no shrink; nothing shipped, no trajectory."""
    record = diagnosis()
    same = {
        "as_shipped": None,
        "as_shipped_why": "the user's simulator has no published values",
        "before": interval(0.0176),
        "after": interval(0.0176),
        "floor": interval(0.0174),
        "shrink": None,
        "shrink_why": "P(before > floor) is 0.61, below 0.95",
    }
    rows = tuple(gap_row.model_copy(update=same) for gap_row in record.gap.held_out)
    gap = record.gap.model_copy(
        update=same
        | {
            "shrink_of_model": None,
            "shrink_of_model_why": "no cause is named",
            "systematic": interval(0.0006),
            "probability_above_practical": 0.066,
            "held_out": rows,
            "in_sample": record.gap.in_sample.model_copy(update=same),
            "trajectory": None,
            "trajectory_why": "no trial of the gravity board was held out",
        }
    )
    return stored_diagnosis(
        verdict="no-gap",
        verdict_probability=0.934,
        sentence="No gap: the recalibrated baseline leaves no more than trial scatter.",
        probabilities={"none": 0.934, "viscous": 0.018, "air-drag": 0.011, "unknown": 0.037},
        inclusion=(acts("viscous", 0.018), acts("air-drag", 0.011)),
        causes=(),
        unseparated=(),
        absorbed=(),
        remainder=Remainder(
            significant=False,
            log10_bayes_factor=-0.9,
            share_of_gap=None,
            share_of_gap_why="there is no gap",
            axis=None,
            axis_why="there is no gap",
        ),
        gap=gap,
        next_experiment=(),
        next_experiment_why="no two plausible hypotheses are left to separate",
    )


def blocks_of(stored):
    """Return the chapter and its long tables."""
    return [*chapter(stored, alone=False), *appendix(stored.record)]


def tables(stored):
    return {b.label: b for b in blocks_of(stored) if isinstance(b, Table)}


def rows(stored, label):
    return {words(row[0]): [words(cell) for cell in row[1:]] for row in tables(stored)[label].rows}


def paragraphs(stored):
    blocks = blocks_of(stored)
    said = [words(b.text) for b in blocks if isinstance(b, Paragraph | Notice)]
    said += [words(item) for b in blocks if isinstance(b, BulletList) for item in b.items]
    return " ".join(said)


def figures(stored):
    return {b.label: b for b in chapter(stored, alone=False) if isinstance(b, Figure)}


def two_causes():
    """Much of everything: a long sentence, two causes of long names, many axes."""
    further = tuple(axis(f"covariate_{k}", "m", 0.02) for k in range(8))
    return stored_diagnosis(
        sentence="Friction grows with the speed of the cable (viscous) and more than in proportion "
        "to the number of pulleys (pulley-count-curvature), with probability 0.93; adding both "
        "closes 98 % of the systematic gap on assemblies held out of the fit.",
        verdict_probability=0.93,
        probabilities={"viscous+pulley-count-curvature": 0.93, "viscous": 0.06, "none": 0.01},
        inclusion=(acts("viscous", 0.99), acts("pulley-count-curvature", 0.93)),
        causes=(
            cause("viscous"),
            cause("pulley-count-curvature", plausible=False, below_floor=True),
        ),
        where=diagnosis().where + further,
    )


def glance(stored):
    return {question: " ".join(answer) for question, answer in rows(stored, "glance").items()}
