"""Verdicts of a diagnosis, made up: of the file, what scoring reads is told, the rest is empty."""

from bayesfric.analysis import HalfNormal
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause, EffectNumber, Remainder
from bayesfric.schemas.gap import Gap, GapRow

WHY = "made up"
PRACTICAL = 0.02


def interval(mean, sd):
    return Interval(mean=mean, sd=sd, q05=mean - 1.645 * sd, q50=mean, q95=mean + 1.645 * sd)


def cause(effect):
    """A cause of slope 0.123 ± 0.006."""
    slope = EffectNumber(
        **interval(0.123, 0.006).model_dump(),
        unit="s/m",
        prior="half-normal(scale=0.15)",
        prior_density=HalfNormal(scale=0.15),
    )
    return Cause(
        effect=effect,
        sentence=WHY,
        inclusion_probability=0.97,
        log10_bayes_factor=12.0,
        log10_bayes_factor_se=0.05,
        law="constant",
        parameters={"slope": slope},
        plausible=True,
        plausible_range=(0.0, 0.3),
        plausible_reference=WHY,
        strength=0.08,
        below_floor=False,
    )


def gap(above):
    """A gap whose shrink is 0.981 ± 0.004, practical with probability `above`."""
    row = GapRow(
        name="in sample",
        as_shipped=None,
        as_shipped_why=WHY,
        before=interval(0.05, 0.002),
        after=interval(0.02, 0.001),
        floor=interval(0.02, 0.001),
        shrink=interval(0.9, 0.01),
    )
    return Gap(
        **row.model_dump(exclude={"name", "below_floor", "shrink", "shrink_why"}),
        systematic=interval(0.05, 0.002),
        probability_above_practical=above,
        floor_agrees=True,
        shrink=interval(0.981, 0.004),
        shrink_of_model=interval(0.981, 0.004),
        friction_rms=0.7,
        held_out=(row,),
        in_sample=row,
        trajectory=None,
        trajectory_why=WHY,
    )


def diagnosed(verdict="named", causes=("viscous",), above=0.99, **changes):
    """A diagnosis with a verdict, its causes by name and the probability of a practical gap."""
    fields = {
        "seed": 5,
        "versions": {},
        "recording": {"name": "a-board", "title": "A board", "sha256": "a" * 64},
        "analysis_sha256": "b" * 64,
        "created": None,
        "rigs": ("gravity",),
        "baseline": "paper",
        "practical_share": PRACTICAL,
        "verdict": verdict,
        "verdict_probability": 0.97,
        "sentence": WHY,
        "probabilities": {"viscous": 0.97, "none": 0.03},
        "hypothesis_prior": {},
        "prior_sensitivity": {},
        "unvisited_probability": 0.0,
        "causes": tuple(cause(name) for name in causes),
        "unseparated": (),
        "absorbed": (),
        "remainder": Remainder(
            significant=False,
            log10_bayes_factor=-0.7,
            share_of_gap=None,
            share_of_gap_why=WHY,
            axis=None,
            axis_why=WHY,
        ),
        "where": (),
        "unexplained": interval(1.0, 0.0),
        "all_unexplained_because": WHY,
        "gap": gap(above),
        "effects": (),
        "next_experiment": (),
        "next_experiment_why": WHY,
    }
    return DiagnosisFile(**(fields | changes))
