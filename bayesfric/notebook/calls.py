"""The verbs as functions that take a path, a mapping or an object where each makes sense.

Each loads the rooms that it needs when it is called: all of them take longer to load than most
recordings to read.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from pydantic import BaseModel

from bayesfric.analysis import Analysis, Prior, checked_analysis, read_analysis
from bayesfric.progress import stage
from bayesfric.recording import read_recording
from bayesfric.recording.tables import Recording

if TYPE_CHECKING:
    from bayesfric.margins.loop_file import Loop
    from bayesfric.notebook.results import (
        ClaimsResult,
        DiagnosisResult,
        FitResult,
        MarginsResult,
        Results,
    )
    from bayesfric.planning import Power

FilePath: TypeAlias = str | PathLike[str]
Settings: TypeAlias = Analysis | FilePath | Mapping[str, Any]
Priors: TypeAlias = Mapping[str, Prior | Mapping[str, Any]]


def fit(
    recording: Recording | FilePath,
    analysis: Settings | None = None,
    *,
    seed: int | None = None,
    priors: Priors | None = None,
    **options: Any,
) -> "FitResult":
    """Draw from the posterior of the friction law.

    Parameters
    ----------
    recording : Recording, str or path-like
        A recording, or its folder.
    analysis : Analysis, str, path-like, mapping or None
        Settings: an object, an ``analysis.toml`` or its keys; None for the defaults.
    seed : int or None
        In the place of that of the analysis.
    priors : mapping of str to prior, or None
        By parameter, in the place of those of the analysis.
    **options
        Of :func:`bayesfric.fitting.posterior.fit`: ``rigs``, ``baseline``, ``checkpoint``,
        and ``progress``, in the place of the bar of a terminal or a notebook.

    Returns
    -------
    FitResult
        Posterior, predictions and diagnostics; ``write`` stores them.

    Raises
    ------
    InputError
        With every fault of the recording or the settings.

    Examples
    --------
    >>> import bayesfric as bf
    >>> quick = {"sampler": {"burn": 30, "steps": 80, "thin": 2, "extensions": 0}}
    >>> fitted = bf.fit("my-board", quick, seed=3, priors={"c1": bf.HalfNormal(0.05)})
    >>> fitted.summary.seed
    3
    >>> list(fitted.to_dataframe().columns[:4])
    ['mean', 'sd', 'q05', 'q50']
    """
    from bayesfric.fitting.posterior import fit as fit_recording
    from bayesfric.notebook.results import FitResult

    board, settings = _recording(recording), _analysis(analysis, seed, priors)
    with _stage_of(f"sampling {board.name}", options) as keywords:
        return FitResult.of(fit_recording(board, settings, **keywords))


def check_claims(
    recording: Recording | FilePath,
    analysis: Settings | None = None,
    *,
    seed: int | None = None,
    priors: Priors | None = None,
    **options: Any,
) -> "ClaimsResult":
    """Judge the paper's claims on a recording.

    Parameters
    ----------
    recording, analysis, seed, priors
        As of :func:`fit`.
    **options
        Of :func:`bayesfric.claims.check_claims`: ``rigs``, ``baseline``, ``only``,
        ``executor``, ``posterior``, ``checkpoint``, ``progress`` (as of :func:`fit`).
    """
    from bayesfric.claims import check_claims as judge
    from bayesfric.notebook.results import ClaimsResult

    board, settings = _recording(recording), _analysis(analysis, seed, priors)
    with _stage_of("comparing the claims with their rivals", options) as keywords:
        return ClaimsResult.of(judge(board, settings, **keywords))


def power(
    recording: Recording | FilePath,
    analysis: Settings | None = None,
    *,
    priors: Priors | None = None,
) -> "Power":
    """Return the errors and smallest effects that the conditions of a recording allow.

    Parameters
    ----------
    recording, analysis, priors
        As of :func:`fit`.
    """
    from bayesfric.planning import power as power_of

    return power_of(_recording(recording), _analysis(analysis, None, priors))


def diagnose(
    recording: Recording | FilePath,
    analysis: Settings | None = None,
    *,
    seed: int | None = None,
    priors: Priors | None = None,
    **options: Any,
) -> "DiagnosisResult":
    """Diagnose the gap between a friction law and a recording.

    Parameters
    ----------
    recording, analysis, seed, priors
        As of :func:`fit`.
    **options
        Of :func:`bayesfric.diagnosis.diagnose`: ``fixed``, ``effects``, ``shipped``,
        ``baseline``, ``checkpoint``.
    """
    from bayesfric.diagnosis import diagnose as diagnose_recording
    from bayesfric.notebook.results import DiagnosisResult

    board, settings = _recording(recording), _analysis(analysis, seed, priors)
    with stage("weighing the effects that the baseline leaves out"):
        return DiagnosisResult.of(diagnose_recording(board, settings, **options))


def compute_margins(
    loops: "FilePath | Loop | Sequence[FilePath | Loop]",
    draws: FilePath,
    analysis: Settings | None = None,
    *,
    seed: int | None = None,
    **options: Any,
) -> "MarginsResult":
    """Compute the margins of controllers under the uncertainty of friction.

    Parameters
    ----------
    loops : str, path-like, Loop, or a sequence of them
        Loop files, or loops read already.
    draws : str or path-like
        ``draws.nc`` of a fit, or the folder that holds it.
    analysis, seed
        As of :func:`fit`; the seed is used.
    **options
        Of :func:`bayesfric.margins.compute_margins`: ``diagnosis``, ``law``, ``verify``,
        ``tune``, ``ensembles``, ``simulated``, ``progress`` (as of :func:`fit`).
    """
    from bayesfric.margins import compute_margins as compute
    from bayesfric.margins.loop_file import Loop
    from bayesfric.notebook.results import MarginsResult

    several = [loops] if isinstance(loops, str | PathLike | Loop) else loops
    path = Path(draws)
    with _stage_of("computing margins", options) as keywords:
        margins = compute(
            [loop if isinstance(loop, Loop | str) else Path(loop) for loop in several],
            path / "draws.nc" if path.is_dir() else path,
            _analysis(analysis, seed, None),
            **keywords,
        )
    return MarginsResult.of(margins)


def load(folder: FilePath) -> "Results":
    """Read what the verbs stored in a folder.

    Parameters
    ----------
    folder : str or path-like
        Where ``bayesfric run`` or single verbs wrote.

    Returns
    -------
    Results
        ``fit``, ``claims``, ``diagnosis``, ``margins``, ``scorecard``: None for what is
        not there.

    Raises
    ------
    InputError
        No result is there, or one is damaged or of another run.

    Examples
    --------
    >>> import bayesfric as bf
    >>> results = bf.load("my-results")
    >>> results.fit.summary.pulleys["small"]["c1"].unit
    '1'
    >>> results.claims is None
    True
    """
    from bayesfric.notebook.results import Results
    from bayesfric.report.stored import read_stored

    return Results.of(read_stored(Path(folder)))


@contextmanager
def _stage_of(title: str, options: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Show the progress of a stage, unless ``progress`` is given; return options with it."""
    with stage(title, quiet="progress" in options) as progress:
        yield {"progress": progress, **options}


def _recording(given: Recording | FilePath) -> Recording:
    return given if isinstance(given, Recording) else read_recording(given)


def _analysis(given: Settings | None, seed: int | None, priors: Priors | None) -> Analysis:
    if given is None or isinstance(given, Analysis):
        settings = Analysis() if given is None else given
    elif isinstance(given, Mapping):
        settings = checked_analysis(given, "analysis")
    else:
        settings = read_analysis(Path(given))
    if seed is None and not priors:
        return settings
    values = settings.model_dump(exclude_unset=True)
    if seed is not None:
        values["seed"] = seed
    if priors:
        own = {
            name: prior.model_dump() if isinstance(prior, BaseModel) else prior
            for name, prior in priors.items()
        }
        values["priors"] = {**values.get("priors", {}), **own}
    return checked_analysis(values, "analysis")
