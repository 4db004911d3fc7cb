"""Judges every claim on a recording, and stores the verdicts."""

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from itertools import count
from pathlib import Path
from pkgutil import iter_modules

import numpy as np
import xarray as xr

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.attention.claims import of_claims
from bayesfric.checkpoint import NOTHING_KEPT, Checkpoint
from bayesfric.claims.base import Case, Claim, Finding
from bayesfric.claims.comparison import log_evidence
from bayesfric.claims.contradictions import contradictions
from bayesfric.claims.entered import PAPER, Entered
from bayesfric.claims.junit import write_junit
from bayesfric.claims.kept_draws import models_kept
from bayesfric.claims.studies import Studied, Task, study_all
from bayesfric.effects import Effect, all_effects, with_priors
from bayesfric.recording.tables import Recording
from bayesfric.results import identified, provenance_of, write_result
from bayesfric.rigs.opening import with_own_priors
from bayesfric.schemas import ClaimsFile
from bayesfric.schemas.base import Provenance
from bayesfric.schemas.claims import ClaimResult, PulleyEvidence, SelfContradiction


@cache
def registered() -> tuple[Claim, ...]:
    """Return the claims of this folder, in the order of the report."""
    package = __name__.rpartition(".")[0]
    folder = [str(Path(__file__).parent)]
    modules = [import_module(f"{package}.{module.name}") for module in iter_modules(folder)]
    claims = [module.CLAIM for module in modules if hasattr(module, "CLAIM")]
    return tuple(sorted(claims, key=lambda claim: claim.place))


def rival_effects(analysis: Analysis) -> dict[str, Effect]:
    """Return the effects of all rivals by name, with the priors of an analysis."""
    own = {effect.name: effect for claim in registered() for effect in claim.effects}
    return with_priors(all_effects() | own, analysis.priors.effects)


@dataclass(frozen=True)
class Checked:
    """Verdicts, ready to be written.

    Parameters
    ----------
    summary : ClaimsFile
        Content of ``claims.json``.
    curves : DataTree
        Content of ``claims.nc``: ``curves``, the log10 Bayes factor and the verdict over
        the width of the rivals' priors; and ``models``, see
        :func:`bayesfric.claims.kept_draws.models_kept`.
    seconds : float
        Wall time.
    """

    summary: ClaimsFile
    curves: xr.DataTree
    seconds: float

    @property
    def refuted(self) -> tuple[str, ...]:
        """Claims that these data refute."""
        return tuple(claim.id for claim in self.summary.claims if claim.verdict == "refuted")

    def write(self, folder: Path | str, *, junit: Path | None = None) -> None:
        """Write ``claims.json`` and ``claims.nc``, and a JUnit report if asked.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.
        junit : Path or None
            A test report, as of :func:`bayesfric.claims.junit.write_junit`.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        write_result(Path(folder), "claims", self.summary, self.curves)
        if junit is not None:
            write_junit(self.summary, junit)


def check_claims(
    recording: Recording,
    analysis: Analysis | None = None,
    *,
    posterior: Mapping[str, Mapping[str, Array]] | None = None,
    executor: Executor | None = None,
    only: Sequence[str] | None = None,
    rigs: Sequence[str] | None = None,
    baseline: str = PAPER,
    progress: Callable[[int, int], None] | None = None,
    checkpoint: Path | None = None,
) -> Checked:
    """Judge the paper's claims on a recording.

    Parameters
    ----------
    recording : Recording
        A recording of any rig.
    analysis : Analysis or None
        Priors, rules and seed; None for the defaults.
    posterior : mapping of str to mapping of str to ndarray of shape (S,), or None
        By rig, draws given this rig alone, from a fit of this recording and analysis.
    executor : Executor or None
        Studies hypotheses in parallel; None studies one after another.
    only : sequence of str or None
        Ids of the claims to judge; None is all.
    rigs : sequence of str or None
        Rigs whose data are used; None is all.
    baseline : str
        The law that the claims are about, a name in :data:`bayesfric.physics.laws.BASELINES`.
    progress : callable or None
        Called with the number of studied hypotheses, and the approximate total.
    checkpoint : Path or None
        Folder of finished studies, from which an interrupted run continues. Remove it afterwards.

    Returns
    -------
    Checked
        Verdicts and the numbers behind them.

    Raises
    ------
    InputError
        The law or a rig is unknown, or a named rig has no data.
    """
    began = time.perf_counter()
    analysis = Analysis() if analysis is None else analysis
    claims = [claim for claim in registered() if only is None or claim.name in only]
    entered = Entered.of(recording, rigs, baseline)
    analysis = with_own_priors(analysis, [entered.trials(name) for name in entered.rigs])
    effects = rival_effects(analysis)
    attributes = provenance_of(recording, analysis)
    key = f"{(entered.rigs, baseline, recording.metadata)} {attributes.model_dump_json()}"
    keeping = Checkpoint(checkpoint, key)
    studied = _studied(claims, entered, analysis, effects, executor, progress, keeping)
    case = Case(recording, analysis, entered, studied, effects, posterior or {})
    findings = [(claim, claim.judge(claim, case)) for claim in claims]
    groups = _curves(findings) | models_kept(studied, _compared(claims, entered, studied))
    summary = identified(_summary(findings, case, attributes))
    return Checked(summary, xr.DataTree.from_dict(groups), time.perf_counter() - began)


def _summary(
    findings: Sequence[tuple[Claim, Finding]], case: Case, attributes: Provenance
) -> ClaimsFile:
    """Return the content of ``claims.json``, without its id."""
    results = tuple(_result(claim, finding, case.entered) for claim, finding in findings)
    return ClaimsFile(
        **attributes.model_dump(),
        rigs=case.entered.rigs,
        baseline=case.entered.law,
        attention=of_claims(results),
        rules=case.analysis.claims.model_dump(),
        claims=results,
        self_contradictions=tuple(
            SelfContradiction.model_validate(contradiction._asdict())
            for contradiction in contradictions()
        ),
    )


def _studied(
    claims: Sequence[Claim],
    entered: Entered,
    analysis: Analysis,
    effects: dict[str, Effect],
    executor: Executor | None,
    progress: Callable[[int, int], None] | None = None,
    keeping: Checkpoint = NOTHING_KEPT,
) -> dict[Task, Studied]:
    """Study all hypotheses."""
    tasks = list(dict.fromkeys(task for claim in claims for task in claim.tasks(entered)))
    steps = count(1)

    def done() -> None:
        step = next(steps)
        if progress is not None:
            progress(step, len(tasks))

    return study_all(tasks, entered.data, analysis, effects, executor, keeping=keeping, done=done)


def _compared(
    claims: Sequence[Claim], entered: Entered, studied: Mapping[Task, Studied]
) -> set[Task]:
    """Return the law and each claim's best rival, given all sizes together."""
    compared = {task for task in studied if task.hypothesis == entered.claimed}
    for claim in claims:
        rivals = [
            task
            for task in claim.tasks(entered)
            if task.whole and task not in compared and studied[task].evidence is not None
        ]
        if rivals:
            compared.add(max(rivals, key=lambda task: log_evidence(studied[task])))
    return compared


def _result(claim: Claim, finding: Finding, entered: Entered) -> ClaimResult:
    elpd_se, elpd_se_why = finding.elpd_difference_se, _why(finding, finding.elpd_difference_se)
    if elpd_se is not None and not np.isfinite(elpd_se):
        elpd_se, elpd_se_why = None, "there is only one assembly"
    return ClaimResult(
        id=claim.name,
        statement=claim.statement,
        paper=claim.paper,
        about_these_data=claim.about_these_data,
        verdict=finding.verdict,
        reason=f"{finding.reason}{claim.elsewhere(entered)}",
        log10_bayes_factor=finding.log10_bayes_factor,
        log10_bayes_factor_why=_why(finding, finding.log10_bayes_factor),
        log10_bayes_factor_se=finding.log10_bayes_factor_se,
        elpd_difference=finding.elpd_difference,
        elpd_difference_why=_why(finding, finding.elpd_difference),
        elpd_difference_se=elpd_se,
        elpd_difference_se_why=elpd_se_why,
        figures=dict(finding.figures),
        by_pulley={
            size: PulleyEvidence(
                log10_bayes_factor=value,
                log10_bayes_factor_why=why or None,
                log10_bayes_factor_se=error,
            )
            for size, (value, error, why) in finding.by_pulley.items()
        },
    )


def _why(finding: Finding, value: float | None) -> str | None:
    return None if value is not None else finding.why or finding.reason


def _curves(findings: Sequence[tuple[Claim, Finding]]) -> dict[str, xr.Dataset]:
    compared = {claim.name: finding.curve for claim, finding in findings if finding.curve}
    if not compared:
        return {}
    width = next(iter(compared.values()))["width"]
    values = np.stack([curve["log10_bayes_factor"] for curve in compared.values()])
    verdicts = np.stack([curve["verdict"] for curve in compared.values()])
    curves = xr.Dataset(
        {
            "log10_bayes_factor": (("claim", "width"), values),
            "verdict": (("claim", "width"), verdicts),
        },
        coords={"claim": list(compared), "width": width},
    )
    return {"curves": curves}
