"""A case (a truth, its recording, its posterior, the ranks), and a campaign of them."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from bayesfric.analysis import Analysis, settings_sha256
from bayesfric.arrays import Array
from bayesfric.calibration.generating import SCATTER_AND_NOISE, draw_truth, generating_analysis
from bayesfric.calibration.ranks import band_of, rank_of
from bayesfric.campaign import case_folder, run_cases
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.diagnostics import diagnose_all
from bayesfric.inference.model import Model
from bayesfric.inference.priors import describe
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES
from bayesfric.results import created_date, package_versions, replace_outputs
from bayesfric.rigs import paper_rigs
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs
from bayesfric.rigs.truth import Truth
from bayesfric.schemas import CalibrationFile
from bayesfric.schemas.calibration import CalibratedQuantity, CalibrationCase
from bayesfric.simulate import simulate_recording

RANKED_DRAWS = 99  # L, of some thousand draws: as good as independent
TENSION_N = 10.0  # where c1 and c2 of Table I matter about as much


CASES = "calibration"
"""Folder of the cases beside ``calibration.json``."""
LEVEL = 0.95  # of all quantities together
MOST_STALLED = 0.01
LARGEST_R_HAT = 1.05  # beyond, 99 draws are not those of the posterior


class Given(NamedTuple):
    """The inputs of a case.

    Parameters
    ----------
    generating : Analysis
        With the generating prior.
    protocol : str
        Of the recording.
    number : int
        Of the case.
    """

    generating: Analysis
    protocol: str
    number: int


def calibrate(
    folder: Path | str,
    *,
    number: int = 50,
    workers: int = 1,
    scheduler: str | None = None,
    analysis: Analysis | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> CalibrationFile:
    """Rank truths among draws of their posteriors, and write ``calibration.json``.

    Cases that are done are kept under ``calibration/``, so that a campaign that was killed
    goes on where it stopped, and one of more cases continues one of fewer.

    Parameters
    ----------
    folder : Path or str
        Created if it is not there.
    number : int
        Of cases.
    workers : int
        Processes of this machine; any number gives the same ranks.
    scheduler : str or None
        Address of a Dask scheduler, whose workers take the place of processes.
    analysis : Analysis or None
        With its ``[calibration]``; its own priors of c1, c2, c3, scatter and noise do not
        enter.
    progress : callable or None
        Called with the cases done and the cases in all.

    Returns
    -------
    CalibrationFile
        What was written.

    Raises
    ------
    InputError
        A scatter that is not simulated, a scheduler that does not answer, or a folder that
        cannot be written.
    """
    folder = Path(folder)
    analysis = Analysis() if analysis is None else analysis
    generating = generating_analysis(analysis)
    protocol = analysis.calibration.protocol
    given = {
        f"{number_of_case:05d}": Given(generating, protocol, number_of_case)
        for number_of_case in range(number)
    }
    cases = run_cases(
        run_case,
        given,
        case_folder(folder, CASES, [settings_sha256(analysis), package_versions()]),
        workers,
        scheduler,
        progress,
    )
    result = calibration_of(list(cases.values()), analysis, planned=number)
    replace_outputs(folder, {"calibration.json": result})
    return result


def calibration_of(
    cases: Sequence[Mapping[str, Any]], analysis: Analysis, *, planned: int
) -> CalibrationFile:
    """Return the ranks of all cases with their bands.

    Parameters
    ----------
    cases : sequence of mapping
        As :func:`bayesfric.calibration.running.run_case` returns them; one at least.
    analysis : Analysis
        Of the campaign.
    planned : int
        Cases in all.
    """
    read = [CalibrationCase.model_validate(case) for case in cases]
    names = list(read[0].ranks)
    allowed = (1 - LEVEL) / len(names)  # Bonferroni: quantities depend on one another
    band = band_of(len(read), RANKED_DRAWS + 1, 1 - allowed)
    quantities = []
    for name in names:
        ranks = np.array([case.ranks[name] for case in read])
        difference, p_value = tuple(band.difference(ranks).tolist()), band.p_value(ranks)
        quantities.append(
            CalibratedQuantity(
                name=name, difference=difference, p_value=p_value, inside=p_value >= allowed
            )
        )
    stalled = sum(case.stalled for case in read) / sum(case.trials for case in read)
    r_hat = max(case.r_hat for case in read)
    outside = [quantity.name for quantity in quantities if not quantity.inside]
    attention = _attention(outside, stalled, r_hat)
    return CalibrationFile(
        seed=analysis.seed,
        versions=package_versions(),
        analysis_sha256=settings_sha256(analysis),
        created=created_date(None),
        protocol=analysis.calibration.protocol,
        priors=_stated(generating_analysis(analysis)),
        tension_n=TENSION_N,
        draws=RANKED_DRAWS,
        planned=planned,
        level=1 - allowed,
        probability=tuple(band.probability.tolist()),
        low=tuple(band.low.tolist()),
        high=tuple(band.high.tolist()),
        quantities=tuple(quantities),
        stalled_share=stalled,
        r_hat=r_hat,
        calibrated=not attention,
        attention=attention,
        cases=tuple(read),
    )


def _attention(outside: Sequence[str], stalled: float, r_hat: float) -> tuple[str, ...]:
    """Return why the computation is not calibrated, in sentences; none where it is."""
    attention = []
    if outside:
        attention.append(f"Not calibrated: the ranks of {', '.join(outside)} are not uniform")
    if stalled > MOST_STALLED:
        attention.append(
            f"{stalled:.1%} of the trials stalled: truths are drawn from a prior of which the "
            "recordings that are fitted are no fair sample; a smaller spread would move them"
        )
    if r_hat > LARGEST_R_HAT:
        attention.append(f"R-hat of some fit is {r_hat:.3f}: its draws have not converged")
    return tuple(attention)


def _stated(generating: Analysis) -> dict[str, str]:
    """Return the generating prior in words, by parameter."""
    priors = generating.priors
    of_size = {
        f"{name}[{size}]": describe(getattr(own, name))
        for size, own in priors.pulleys.items()
        for name in Coefficients._fields
    }
    return of_size | {name: describe(getattr(priors, name)) for name in SCATTER_AND_NOISE}


def run_case(given: Given) -> dict[str, Any]:
    """Draw a truth and a recording of the paper's first rig, fit it, and rank the truth.

    Parameters
    ----------
    given : Given
        The case.

    Returns
    -------
    dict
        Of plain JSON types: ``ranks`` by quantity, the largest ``r_hat``, and how many of
        how many ``trials`` ``stalled``.
    """
    rng = np.random.default_rng(np.random.SeedSequence([given.generating.seed, given.number]))
    truth = draw_truth(given.generating, rng)
    seed = int(rng.integers(2**32))
    rig = next(iter(paper_rigs()))
    recording = simulate_recording(given.protocol, seed=seed, truth=truth, rigs=(rig,))
    with threadpool_limits(limits=1):
        data = Data(open_rigs(recording, (rig,)))
        law = BASELINES["paper"]
        model = Model([trials.likelihood(given.generating, law) for trials in data.rigs])
        draws = draw_posterior(model, given.generating.model_copy(update={"seed": seed}))
        theta = model.natural(draws.z)
        flat = theta.reshape(-1, theta.shape[-1])
        some = flat[np.linspace(0, len(flat) - 1, RANKED_DRAWS).astype(int)]
        true = np.array([[true_value(truth, name) for name in model.names]])
        drawn, real = (quantities(model, points) for points in (some, true))
        ranks = {name: rank_of(float(real[name][0]), drawn[name]) for name in drawn}
    stalled = len(recording.metadata["simulation"]["stalled"])
    return {
        "ranks": ranks,
        "r_hat": max(diagnostics.r_hat for diagnostics in diagnose_all(theta)),
        "stalled": stalled,
        "trials": stalled + sum(len(trials.table) for trials in data.rigs),
    }


def quantities(model: Model, theta: Array) -> dict[str, Array]:
    """Return the quantities that are ranked, by name, each of shape (W,).

    Parameters
    ----------
    model : Model
        Of the posterior.
    theta : ndarray, shape (W, D)
        Parameters in their units.

    Returns
    -------
    dict of str to ndarray
        Every parameter; ``c1 + c2/T`` of each size, friction per tension and pulley at 10 N;
        and ``log_likelihood``, which alone sees a part of the data that does not count.
    """
    named = model.by_name(theta)
    sizes = [name[3:-1] for name in named if name.startswith("c1[")]
    slope = {
        f"c1 + c2/T[{size}]": named[f"c1[{size}]"] + named[f"c2[{size}]"] / TENSION_N
        for size in sizes
    }
    return named | slope | {"log_likelihood": model.log_likelihood(theta)}


def true_value(truth: Truth, name: str) -> float:
    """Return the true value of a parameter in a simulated recording."""
    stem, _, size = name.removesuffix("]").partition("[")
    return float(getattr(truth.coefficients[size] if size else truth, stem))
