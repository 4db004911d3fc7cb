"""``analysis.toml``: every choice of an analysis that is the user's to make.

The models validate and document; they compute nothing. Unknown keys are refused.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, model_validator

from bayesfric.errors import InputError
from bayesfric.families import (
    Family,
    Finite,
    Positive,
    Section,
)
from bayesfric.families import HalfCauchy as HalfCauchy
from bayesfric.families import HalfNormal as HalfNormal
from bayesfric.families import LogNormal as LogNormal
from bayesfric.families import Normal as Normal
from bayesfric.families import Prior as Prior
from bayesfric.families import Uniform as Uniform
from bayesfric.files import key_faults, read_toml
from bayesfric.priors import PriorOverrides as PriorOverrides
from bayesfric.priors import Priors as Priors


class Scatter(Section):
    """How friction scatters from trial to trial and from assembly to assembly."""

    by_size: bool = Field(False, description="A tau and an omega for each size, instead of one.")
    trial: Literal["normal", "student-t"] = Field(
        "normal",
        description="Distribution of a trial's scatter; student-t forgives outliers. It is that of "
        "the gravity board: other rigs have normal scatter, and results say so.",
    )
    assembly: Literal["normal", "student-t"] = Field(
        "normal",
        description="Likewise of an assembly's; not both are student-t.",
    )
    degrees_of_freedom: Annotated[float, Field(gt=2, le=100)] = Field(
        4.0, description="Of the student-t; tau, or omega and omega_intercept, are its scales."
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> "Scatter":
        if self.trial == self.assembly == "student-t":
            raise ValueError("student-t scatter of trials or of assemblies, not of both")
        return self


class Sampler(Section):
    """Settings of the ensemble sampler."""

    ensembles: Annotated[int, Field(ge=4, le=64)] = Field(
        4, description="Independent ensembles; at least 4, so that R-hat means something."
    )
    walkers: Annotated[int, Field(ge=8, le=1024)] | None = Field(
        None, description="Walkers an ensemble; even. Absent: the larger of 40 and 2 a parameter."
    )
    burn: Annotated[int, Field(ge=10, le=100_000)] = Field(
        40,
        description="Steps of an ensemble that are thrown away. Where no importance sample gives a "
        "proposal, also of the first of three pilots; each further pilot is twice as long.",
    )
    steps: Annotated[int, Field(ge=50, le=1_000_000)] = Field(
        240, description="Steps of an ensemble that are kept, before thinning."
    )
    thin: Annotated[int, Field(ge=1, le=1000)] = Field(2, description="Keep each thin-th step.")
    extensions: Annotated[int, Field(ge=0, le=100)] = Field(
        4,
        description="While draws have not converged, they serve as a pilot for a better proposal "
        "and the ensembles go on for as many steps as before, thinned to as many draws; at most "
        "so often.",
    )
    independence_share: Annotated[float, Field(ge=0, le=1)] = Field(
        0.9,
        description="Share of independence proposals; the rest are differential evolution.",
    )

    @model_validator(mode="after")
    def _even(self) -> "Sampler":
        if self.walkers is not None and self.walkers % 2:
            raise ValueError("an even number of walkers")
        if self.steps // self.thin < 20:
            raise ValueError("at least 20 steps left after thinning")
        return self


Share = Annotated[float, Field(gt=0, lt=1)]


class ClaimRules(Section):
    """When a claim is supported, refuted, or neither.

    A claim may have rivals: effects that it says are absent. It is refuted where the Bayes
    factor favours a rival, the rival's effect is large enough to matter, and it improves
    prediction. It is supported where the Bayes factor favours the claim and the rival's effect
    is too small to matter. Otherwise it stays undecided. To refute, the Bayes factor must hold
    over a tenfold change of the width of the rivals' priors; to support, a weaker one must. A
    claim without rivals rests on a probability.
    """

    support_log10_bayes_factor: Finite = Field(
        1.0, description="At least, in favour of the claim, to support it."
    )
    support_over_width_log10_bayes_factor: Finite = Field(
        0.5,
        description="At least, in favour of the claim, wherever the width of the rivals' priors "
        "lies within a tenfold range, to support it.",
    )
    refute_log10_bayes_factor: Finite = Field(-1.0, description="At most, to refute it.")
    region_of_equivalence: Share = Field(
        0.05, description="Share of friction below which an effect does not matter [-]."
    )
    refute_effect_probability: Share = Field(
        0.95, description="Of an effect beyond the region of equivalence, at least, to refute."
    )
    refute_elpd_errors: Positive = Field(
        2.0, description="Standard errors by which a rival predicts better, to refute."
    )
    support_probability: Share = Field(0.95, description="Of a claim without rivals, at least.")
    refute_probability: Share = Field(0.05, description="Of a claim without rivals, at most.")
    refute_tail_probability: Share = Field(
        0.01, description="Joint tail probability of Table I below which `coefficients` may fall."
    )
    table1_tolerance: Share = Field(
        0.05,
        description="Largest relative difference of friction by Table I, over the tested range of "
        "Table II, with which `coefficients` holds.",
    )
    stiffness_tolerance: Share = Field(
        0.01, description="Largest relative change of friction by a stretching cable."
    )
    rig_tolerance: Share = Field(
        0.10, description="Largest relative difference of friction between the rigs."
    )
    rig_usual_tolerance: Share = Field(
        0.05, description="Relative difference that most conditions of two rigs are within."
    )
    tension_tolerance_n: Positive = Field(
        0.15, description="Largest difference from a quoted nominal tension [N]."
    )


class HypothesisPriors(Section):
    """Prior probabilities of hypotheses by number of effects, shared equally within a number."""

    none: Share = Field(0.5, description="That nothing acts beside the baseline.")
    one: Share = Field(0.3, description="That one effect acts; an alias class counts once.")
    two: Share = Field(0.08, description="That two act.")
    more: Share = Field(0.02, description="That three or more act.")
    unknown: Share = Field(0.1, description="That a force acts which nobody described.")

    @model_validator(mode="after")
    def _whole(self) -> "HypothesisPriors":
        total = self.none + self.one + self.two + self.more + self.unknown
        if abs(total - 1) > 1e-9:
            raise ValueError(f"probabilities that add up to 1, not {total:g}")
        return self


class DiagnosisRules(Section):
    """What counts as a gap between simulation and reality, and what is expected beforehand."""

    practical_share: Share = Field(
        0.02,
        description="Share of rms friction below which a systematic gap, or an effect, is of no "
        "concern; a quarter of it (at least 0.0025) is the rms of the discrepancy of every "
        "hypothesis.",
    )
    unknown_scale: Share = Field(
        0.1, description="Scale of the half-normal rms of an unknown force, of rms friction."
    )
    hypotheses: HypothesisPriors = Field(
        default_factory=HypothesisPriors, description="Prior probabilities of hypotheses."
    )
    widths: dict[str, Positive] = Field(
        default_factory=dict,
        description="By effect, what the width of its amplitude's prior is multiplied by.",
    )


class CalibrationRules(Section):
    """What simulation-based calibration draws its recordings from, and fits them with.

    Coefficients lie around Table I, scatter and noise around the values here: within `spread`,
    equally likely. Narrow enough that boards move: the protocols leave a reserve of 40 % of
    friction. The sampler is short, since only 99 draws of each posterior are ranked.
    """

    protocol: Literal["quick", "paper"] = Field("quick", description="Of each recording.")
    spread: Share = Field(0.3, description="Half width of each prior, over its centre.")
    tau: Positive = Field(0.01, description="Centre of the scatter of a trial [-].")
    omega: Positive = Field(0.015, description="Centre of the scatter of an assembly [-].")
    omega_intercept: Positive = Field(
        0.03, description="Centre of the scatter of c2 an assembly, beside that of all friction."
    )
    wander: Positive = Field(0.002, description="Centre of the rms of friction that wanders [-].")
    wander_length: Positive = Field(0.1, description="Centre of its correlation length [m].")
    sigma_x: Positive = Field(3e-5, description="Centre of the position error of an event [m].")
    sigma_t: Positive = Field(2e-5, description="Centre of the clock error of an event [s].")
    sampler: Sampler = Field(
        Sampler(burn=30, steps=60, thin=3, extensions=0),
        description="Ensemble sampler of each fit; keys as in [sampler], whose defaults hold "
        "for those that a file leaves out.",
    )


class Analysis(Section):
    """The whole of ``analysis.toml``; every key has a default."""

    seed: Annotated[int, Field(ge=0, lt=2**63)] = Field(
        2015, description="Seed of everything random; --seed overrides it."
    )
    priors: Priors = Field(default_factory=Priors, description="Prior densities.")
    scatter: Scatter = Field(default_factory=Scatter, description="Scatter of friction.")
    sampler: Sampler = Field(default_factory=Sampler, description="Ensemble sampler.")
    claims: ClaimRules = Field(default_factory=ClaimRules, description="Verdicts on claims.")
    diagnosis: DiagnosisRules = Field(
        default_factory=DiagnosisRules, description="Diagnosis of the sim-to-real gap."
    )
    calibration: CalibrationRules = Field(
        default_factory=CalibrationRules, description="Simulation-based calibration."
    )


def read_analysis(path: Path | None, *, seed: int | None = None) -> Analysis:
    """Read and validate an ``analysis.toml``.

    Parameters
    ----------
    path : Path or None
        The file; None gives the defaults.
    seed : int or None
        Replaces the file's seed.

    Returns
    -------
    Analysis
        Validated settings.

    Raises
    ------
    InputError
        With every fault of the file: where, what was found, what was expected.
    """
    name = "analysis.toml" if path is None else path.name
    values = {} if path is None else read_toml(path)
    if seed is not None:
        values = {**values, "seed": seed}
    return checked_analysis(values, name, strict=True)


def checked_analysis(values: Mapping[str, Any], name: str, *, strict: bool = False) -> Analysis:
    """Validate settings.

    Parameters
    ----------
    values : mapping
        Keys of an ``analysis.toml``; what is absent has its default.
    name : str
        Of the file that they are from.
    strict : bool
        Whether a text or a truth value is no number, as in a file.

    Raises
    ------
    InputError
        With every fault: where, what was found, what was expected.
    """
    try:
        return Analysis.model_validate(values, strict=strict)
    except ValidationError as error:
        tags = {family.model_fields["family"].default for family in Family.__subclasses__()}
        raise InputError(key_faults(name, error, "docs/analysis.md", Analysis, tags)) from error


def analysis_sha256(analysis: Analysis) -> str:
    """Return the SHA-256 of the settings in full, defaults filled in."""
    return hashlib.sha256(analysis.model_dump_json().encode()).hexdigest()
