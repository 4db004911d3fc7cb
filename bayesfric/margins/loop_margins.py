"""The margins of one loop over the draws of a fit, in the form of ``margins.json``."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from bayesfric.analysis import settings_sha256
from bayesfric.arrays import Array
from bayesfric.margins.answer import (
    SafeGain,
    against_the_spec,
    largest_safe_gain,
    limit_cycle_curve,
    what_to_measure,
    which_gain,
)
from bayesfric.margins.assembly import Assembly, draw_assembly
from bayesfric.margins.at_safe_gain import at_safe_gain
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.certificate import certify
from bayesfric.margins.diagnosed import Diagnosed, reflected
from bayesfric.margins.following import follow_all
from bayesfric.margins.frequency_figures import bode_bands, nyquist_fans
from bayesfric.margins.inputs import beyond_the_draws
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Loop, Spec
from bayesfric.margins.metric_definitions import missed_specs
from bayesfric.margins.metrics import Key, Linear, closed_forms, linear_of
from bayesfric.margins.plant import plant_of
from bayesfric.margins.posterior import Posterior, RigDiscrepancy
from bayesfric.margins.rows import metric_rows
from bayesfric.margins.thresholds import Hunting, find_hunting
from bayesfric.margins.tuning import meets_all_now, tune
from bayesfric.margins.variance import variance_shares
from bayesfric.margins.verification import verify
from bayesfric.margins.warnings import loop_warnings
from bayesfric.probabilities import stated_of_draws
from bayesfric.schemas.loop_runs import HuntingMap
from bayesfric.schemas.margins import LoopMargins, Metric, WithEffects

SHARED = 1000  # number of draws for the shares of variance


class Asked(NamedTuple):
    """Settings of the computation for each loop.

    Parameters
    ----------
    seed : int
        Seed of the draws for the machine.
    verify : int
        Number of draws that are compared with an elastic cable.
    tune, moves : bool
        Whether to search for gains, and whether to simulate moving references.
    simulated : int
        Number of draws in which motion is simulated, and hunting if it has no closed form.
    """

    seed: int
    verify: int
    tune: bool
    moves: bool
    simulated: int


@dataclass(frozen=True)
class Judged:
    """A loop's draws judged by its spec.

    Parameters
    ----------
    linear : mapping of Direction to Linear
        Linear margins by direction, with the peaks of S and T.
    hunting : Hunting
        Thresholds of hunting.
    safe : SafeGain
        The largest compensation gain that is safe.
    rows : tuple of Metric
        Metrics as they are reported.
    missed : tuple of str
        Specs that it misses.
    """

    linear: Mapping[Direction | None, Linear]
    hunting: Hunting
    safe: SafeGain
    rows: tuple[Metric, ...]
    missed: tuple[str, ...]

    @classmethod
    def of(cls, shaft: LoopAtShaft, spec: Spec, simulated: int, draws: float) -> "Judged":
        """Judge a loop by its spec; `draws` is the effective number of draws of the fit."""
        linear = linear_of(shaft, with_peaks=True)
        hunting = find_hunting(shaft, simulated, spec.limit_cycle_probability_max)
        safe = largest_safe_gain(hunting, spec.limit_cycle_probability_max, draws)
        rows = metric_rows(shaft, linear, hunting, draws)
        missed = missed_specs(rows, float(hunting.now.mean()), spec)
        return cls(linear, hunting, safe, rows, missed)


def loop_margins(
    loop: Loop,
    posterior: Posterior,
    discrepancy: RigDiscrepancy,
    diagnosed: Diagnosed | None,
    asked: Asked,
) -> tuple[LoopAtShaft, LoopMargins]:
    """Return a loop at the motor's shaft, and its entry in ``margins.json``.

    Parameters
    ----------
    loop : Loop
        The joint and its controller.
    posterior : Posterior
        Draws of the friction law, and of effects beside it.
    discrepancy : RigDiscrepancy
        Difference between rigs.
    diagnosed : Diagnosed or None
        The law and the effects of a diagnosis.
    asked : Asked
        Settings of the computation.
    """
    given = draw_assembly(loop, posterior, discrepancy, asked.seed)
    shaft = reflected(loop, given)
    draws = posterior.effective_draws
    judged = Judged.of(shaft, loop.spec, asked.simulated, draws)
    hunting = judged.hunting
    shares = _variance_shares(loop, posterior, discrepancy, asked.seed, shaft, given)
    beyond = beyond_the_draws(shaft, given, posterior)
    together = meets_all_now(shaft, hunting)
    certificate, no_certificate = certify(shaft, hunting)
    summary = LoopMargins(
        name=loop.name,
        title=loop.title,
        loop_sha256=settings_sha256(loop),
        answer=_answer(shaft, judged, together, beyond, shares),
        plant=plant_of(shaft),
        compensation_signal=loop.compensation.signal,
        compensation_gain=float(np.median(shaft.gamma)),
        **_by_the_spec(judged),
        violation_probability_max=loop.spec.violation_probability_max,
        **_over_gain(shaft, judged, draws),
        hunting_map=_map(hunting, shaft),
        not_examined=hunting.not_examined,
        variance_share=shares,
        with_effects=_with_effects(loop, diagnosed, discrepancy, asked),
        with_effects_why=_why_without(diagnosed, posterior),
        meets_all=together,
        certificate=certificate,
        certificate_why=no_certificate,
        nyquist=nyquist_fans(shaft),
        bode=bode_bands(shaft),
        warnings=loop_warnings(shaft, given, judged.linear, discrepancy, posterior),
        beyond=beyond,
        **_on_request(shaft, hunting, asked),
    )
    return shaft, summary


def _over_gain(shaft: LoopAtShaft, judged: Judged, draws: float) -> dict[str, Any]:
    """Return the fields on hunting over γ, and on the specs at the largest safe γ."""
    hunting, safe, spec = judged.hunting, judged.safe, shaft.loop.spec
    return {
        "limit_cycle_probability": limit_cycle_curve(hunting, draws),
        "limit_cycle_probability_max": spec.limit_cycle_probability_max,
        "limit_cycle_method": hunting.method,
        "largest_safe_compensation_gain_se": safe.se,
        "at_safe_gain": at_safe_gain(shaft, hunting, safe.gamma, spec, draws),
    }


def _variance_shares(
    loop: Loop,
    posterior: Posterior,
    discrepancy: RigDiscrepancy,
    seed: int,
    shaft: LoopAtShaft,
    given: Assembly,
) -> dict[str, dict[str, float]]:
    """Return the share of each group of uncertain inputs in the variance of each metric."""
    estimate = float(shaft.estimate.mean())
    some = np.arange(min(SHARED, given.draws))
    other = draw_assembly(loop, posterior, discrepancy, seed, stream=1)

    def evaluate(assembly: Assembly) -> Mapping[Key, Array]:
        shaft_tried = reflected(loop, assembly, estimate=estimate)
        return closed_forms(shaft_tried, linear_of(shaft_tried))

    return variance_shares(evaluate, given.taken(some), other.taken(some))


def _answer(
    shaft: LoopAtShaft,
    judged: Judged,
    together: float,
    beyond: tuple[str, ...],
    shares: Mapping[str, Mapping[str, float]],
) -> str:
    """Return the answer in a few sentences."""
    spec = shaft.loop.spec
    sentences = [
        against_the_spec(judged.rows, judged.missed, judged.hunting.now, spec),
        "All specs at once are met with probability "
        f"{stated_of_draws(together, judged.hunting.now.size)}.",
    ]
    if beyond:
        sentences.append(f"Beyond what was measured: {'; '.join(beyond)}.")
    limit = spec.limit_cycle_probability_max
    sentences.append(which_gain(shaft, judged.hunting, judged.safe, limit))
    return " ".join([*sentences, *what_to_measure(shares)])


def _on_request(shaft: LoopAtShaft, hunting: Hunting, asked: Asked) -> dict[str, Any]:
    """Return the fields that take long and are computed only on request."""
    limit = shaft.loop.spec.violation_probability_max
    why = _why_not_followed(shaft, asked.moves)
    return {
        "verification": verify(shaft, hunting, asked.verify) if asked.verify else None,
        "tuning": tune(shaft, limit) if asked.tune else None,
        "following": None if why else follow_all(shaft, asked.simulated),
        "following_why": why,
    }


def _map(hunting: Hunting, shaft: LoopAtShaft) -> HuntingMap | None:
    chart = hunting.map
    if chart is None:
        return None
    speeds = [condition.speed_of(shaft) for condition in chart.speeds]
    tip = float(np.median(shaft.tip_per_rad))
    return HuntingMap(
        draws=chart.hunts.shape[2],
        gamma=chart.gammas,
        speed_rad_s=tuple(float(np.median(speed)) for speed in speeds),
        speed_tip_m_s=tuple(float(np.median(speed * shaft.tip_per_rad)) for speed in speeds),
        probability=chart.hunts.mean(axis=2).tolist(),
        rms_error_m=(tip * np.median(chart.rms_error, axis=2)).tolist(),
    )


def _why_not_followed(shaft: LoopAtShaft, moves: bool) -> str | None:
    if not moves:
        return "it was not asked for (--ensembles)"
    if shaft.wrist is not None:
        return "not examined: the joint shares motors with others, which would move along"
    return None


def _why_without(diagnosed: Diagnosed | None, posterior: Posterior) -> str | None:
    if posterior.refitted:
        return "these are the margins of the law that the diagnosis refitted"
    if diagnosed is None:
        return "no diagnosis was given"
    return None if diagnosed.finds_something else "the diagnosis finds no effect that may act"


def _with_effects(
    loop: Loop, diagnosed: Diagnosed | None, discrepancy: RigDiscrepancy, asked: Asked
) -> WithEffects | None:
    if diagnosed is None or not diagnosed.finds_something:
        return None
    given = draw_assembly(loop, diagnosed.posterior, discrepancy, asked.seed)
    after = reflected(loop, given)
    judged = Judged.of(after, loop.spec, asked.simulated, diagnosed.posterior.effective_draws)
    return WithEffects(
        effects=tuple(drawn.effect.name for drawn in diagnosed.posterior.acting),
        left_out=diagnosed.left_out,
        answer=f"{against_the_spec(judged.rows, judged.missed, judged.hunting.now, loop.spec)} "
        + which_gain(after, judged.hunting, judged.safe, loop.spec.limit_cycle_probability_max),
        **_by_the_spec(judged),
    )


def _by_the_spec(judged: Judged) -> dict[str, Any]:
    """Return the fields that the margins have with and without effects."""
    return {
        "metrics": judged.rows,
        "missed_specs": judged.missed,
        "largest_safe_compensation_gain": judged.safe.gamma,
        "largest_safe_compensation_gain_why": judged.safe.why,
    }
