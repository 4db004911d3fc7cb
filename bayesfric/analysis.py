"""``analysis.toml``: the settings of an analysis.

The models validate and document the settings; they compute nothing. Unknown keys are refused.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, Field, ValidationError, model_validator

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
    """How friction scatters from trial to trial and from assembly to assembly.

    Fields
    ------
    by_size: A tau and an omega for each size, instead of one.
    trial: Distribution of a trial's scatter on the gravity board; student-t is robust against
        outliers. Other rigs have normal scatter, and results state this.
    assembly: Distribution of an assembly's scatter. Trial and assembly cannot both be student-t.
    degrees_of_freedom: Degrees of freedom of the student-t. Its scale is tau, or omega and
        omega_intercept.
    """

    by_size: bool = False
    trial: Literal["normal", "student-t"] = "normal"
    assembly: Literal["normal", "student-t"] = "normal"
    degrees_of_freedom: Annotated[float, Field(gt=2, le=100)] = 4.0

    @model_validator(mode="after")
    def _one_of_them(self) -> "Scatter":
        if self.trial == self.assembly == "student-t":
            raise ValueError("student-t scatter of trials or of assemblies, not of both")
        return self


class Sampler(Section):
    """Settings of the ensemble sampler.

    Fields
    ------
    ensembles: Number of independent ensembles. R-hat needs 4 or more.
    walkers: Number of walkers in an ensemble, even. Absent: 40, or 2 for each parameter if that is
        more.
    burn: Steps of an ensemble that are discarded. If the importance samples are unreliable, three
        pilot runs give the proposal. The first has this many steps, and each further one twice as
        many as the one before.
    steps: Steps of an ensemble that are kept, before thinning.
    thin: Every `thin`-th step is kept.
    extensions: Largest number of extensions of the ensembles, while the draws have not converged.
        Each extension runs as many steps as before, with a better proposal, and thins to as many
        draws.
    independence_share: Share of independence proposals; the rest are differential evolution.
    """

    ensembles: Annotated[int, Field(ge=4, le=64)] = 4
    walkers: Annotated[int, Field(ge=8, le=1024)] | None = None
    burn: Annotated[int, Field(ge=10, le=100_000)] = 20
    steps: Annotated[int, Field(ge=50, le=1_000_000)] = 140
    thin: Annotated[int, Field(ge=1, le=1000)] = 1
    extensions: Annotated[int, Field(ge=0, le=100)] = 4
    independence_share: Annotated[float, Field(ge=0, le=1)] = 0.9

    @model_validator(mode="after")
    def _even(self) -> "Sampler":
        if self.walkers is not None and self.walkers % 2:
            raise ValueError("an even number of walkers")
        if self.steps // self.thin < 20:
            raise ValueError("at least 20 steps left after thinning")
        return self


Share = Annotated[float, Field(gt=0, lt=1)]


class ClaimRules(Section):
    """Rules for the verdict on a claim.

    A claim may have rivals: effects that the claim denies. It is refuted where the Bayes
    factor favours a rival, the rival's effect is large enough to matter, and it improves
    prediction. It is supported where the Bayes factor favours the claim and the rival's effect
    is too small to matter. Otherwise it stays undecided.

    The Bayes factor depends on the width of the rivals' priors, so it is computed for a tenfold
    range of widths around the width of the analysis. A claim is refuted only if the Bayes factor
    reaches the threshold for refuting at every width of this range. A claim is supported only if
    the Bayes factor reaches the threshold for supporting at the width of the analysis, and a lower
    threshold at every width of the range. A claim without rivals is judged by a probability.

    Fields
    ------
    support_log10_bayes_factor: A claim is supported only if the log10 Bayes factor in its favour is
        this or more.
    support_over_width_log10_bayes_factor: A claim is supported only if the log10 Bayes factor in
        its favour is this or more for every width of the rivals' priors within a tenfold range.
    refute_log10_bayes_factor: A claim is refuted only if the log10 Bayes factor in its favour is
        this or less.
    region_of_equivalence: Share of friction below which an effect does not matter [-].
    refute_effect_probability: A claim is refuted only if a rival's effect is beyond the region of
        equivalence with this probability or more.
    refute_elpd_errors: A claim is refuted only if a rival predicts better by more than this many
        standard errors.
    support_probability: A claim without rivals is supported from this probability on.
    refute_probability: A claim without rivals is refuted up to this probability.
    refute_tail_probability: The claim `coefficients` may be refuted if the joint tail probability
        of the paper's Table I is below this.
    table1_tolerance: The claim `coefficients` holds if friction by the paper's Table I differs by
        this share or less, over the range of its Table II.
    stiffness_tolerance: Largest relative change of friction by a stretching cable.
    rig_tolerance: Largest relative difference of friction between the rigs.
    rig_usual_tolerance: Relative difference of the rigs that most conditions must not exceed.
    tension_tolerance_n: Largest difference from a quoted nominal tension [N].
    """

    support_log10_bayes_factor: Finite = 1.0
    support_over_width_log10_bayes_factor: Finite = 0.5
    refute_log10_bayes_factor: Finite = -1.0
    region_of_equivalence: Share = 0.05
    refute_effect_probability: Share = 0.95
    refute_elpd_errors: Positive = 2.0
    support_probability: Share = 0.95
    refute_probability: Share = 0.05
    refute_tail_probability: Share = 0.01
    table1_tolerance: Share = 0.05
    stiffness_tolerance: Share = 0.01
    rig_tolerance: Share = 0.10
    rig_usual_tolerance: Share = 0.05
    tension_tolerance_n: Positive = 0.15


class HypothesisPriors(Section):
    """Prior probabilities of hypotheses by number of effects, shared equally within a number.

    Fields
    ------
    none: Probability that no effect acts.
    one: Probability that one effect acts. Effects that the rig cannot tell apart count once.
    two: Probability that two effects act.
    more: Probability that three or more effects act.
    unknown: Probability that an unknown force acts.
    """

    none: Share = 0.5
    one: Share = 0.3
    two: Share = 0.08
    more: Share = 0.02
    unknown: Share = 0.1

    @model_validator(mode="after")
    def _whole(self) -> "HypothesisPriors":
        total = self.none + self.one + self.two + self.more + self.unknown
        if abs(total - 1) > 1e-9:
            raise ValueError(f"probabilities that add up to 1, not {total:g}")
        return self


class DiagnosisRules(Section):
    """The size from which a gap matters, and the prior probabilities of the hypotheses.

    Fields
    ------
    practical_share: Share of rms friction below which a systematic gap, or an effect, does not
        matter. The rms of the discrepancy in every hypothesis is a quarter of this share, at
        least 0.0025.
    unknown_scale: Scale of the half-normal prior of an unknown force's rms, as a share of rms
        friction.
    hypotheses: Prior probabilities of hypotheses.
    widths: Factor on the width of the amplitude's prior, by name of the effect. The diagnosis does
        not widen the prior of a listed effect, even if it is too tight for the data.
    """

    practical_share: Share = 0.02
    unknown_scale: Share = 0.1
    hypotheses: HypothesisPriors = Field(default_factory=HypothesisPriors)
    widths: dict[str, Positive] = Field(default_factory=dict)


class CalibrationRules(Section):
    """Priors of simulation-based calibration: recordings are drawn from them and fitted with them.

    Each prior is uniform: coefficients around the paper's Table I, scatter and noise around the
    values here, each within `spread`. The priors are so narrow that the masses move: the driving
    force of the protocols exceeds friction by at least 40 %. The sampler is short, since only 99
    draws of each posterior are ranked.

    Fields
    ------
    protocol: Protocol of each recording.
    spread: Half width of each prior, as a share of its centre.
    tau: Centre of the scatter from trial to trial [-].
    omega: Centre of the scatter from assembly to assembly [-].
    omega_intercept: Centre of the scatter of c2 alone from assembly to assembly.
    wander: Centre of the rms by which friction varies along a trial [-].
    wander_length: Centre of the correlation length of that variation [m].
    sigma_x: Centre of the position error of an event [m].
    sigma_t: Centre of the clock error of an event [s].
    sampler: Sampler of each fit, with the keys of [sampler].
    """

    protocol: Literal["quick", "paper"] = "quick"
    spread: Share = 0.3
    tau: Positive = 0.01
    omega: Positive = 0.015
    omega_intercept: Positive = 0.03
    wander: Positive = 0.002
    wander_length: Positive = 0.1
    sigma_x: Positive = 3e-5
    sigma_t: Positive = 2e-5
    sampler: Sampler = Sampler(burn=30, steps=60, thin=3, extensions=0)


class Analysis(Section):
    """The whole of ``analysis.toml``; every key has a default.

    Fields
    ------
    seed: Seed of all random numbers. --seed overrides it.
    priors: Prior densities.
    scatter: Scatter of friction.
    sampler: Ensemble sampler.
    claims: Verdicts on claims.
    diagnosis: Diagnosis of the sim-to-real gap.
    calibration: Simulation-based calibration.
    """

    seed: Annotated[int, Field(ge=0, lt=2**63)] = 2015
    priors: Priors = Field(default_factory=Priors)
    scatter: Scatter = Field(default_factory=Scatter)
    sampler: Sampler = Field(default_factory=Sampler)
    claims: ClaimRules = Field(default_factory=ClaimRules)
    diagnosis: DiagnosisRules = Field(default_factory=DiagnosisRules)
    calibration: CalibrationRules = Field(default_factory=CalibrationRules)


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
        Keys of an ``analysis.toml``; absent keys have their defaults.
    name : str
        Name of the file that they are from.
    strict : bool
        Whether a text or a truth value is refused as a number, as in a file.

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


def settings_sha256(settings: BaseModel) -> str:
    """Return the SHA-256 of all settings of a file, with their defaults."""
    return hashlib.sha256(settings.model_dump_json().encode()).hexdigest()
