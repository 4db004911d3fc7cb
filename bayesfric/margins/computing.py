"""Loops and draws to ``margins.json``."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bayesfric.analysis import Analysis
from bayesfric.attention.margins import of_margins
from bayesfric.errors import Fault, InputError
from bayesfric.margins.assembly import nominal_assembly, refuse_sizes
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.ensemble import Ensemble
from bayesfric.margins.following import needs_motion
from bayesfric.margins.inputs import refused
from bayesfric.margins.law_used import ChosenLaw, LawAsked, choose_law
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.loop_margins import Asked, loop_margins
from bayesfric.margins.loop_reading import read_loop
from bayesfric.margins.metrics import linear_of
from bayesfric.margins.plant import plant_of
from bayesfric.margins.posterior import Posterior, RigDiscrepancy, fit_beside, read_draws
from bayesfric.margins.reflecting import at_shaft
from bayesfric.results import identified, provenance, replace_outputs
from bayesfric.schemas import FitFile, MarginsFile
from bayesfric.schemas.margins import LoopMargins

if TYPE_CHECKING:
    import control

SIMULATED = 200


@dataclass(frozen=True)
class Margins:
    """Margins, ready to be written.

    Parameters
    ----------
    summary : MarginsFile
        Content of ``margins.json``.
    ensembles : tuple of Ensemble
        Its loops with their draws; empty if the margins were read from a file.
    """

    summary: MarginsFile
    ensembles: tuple[Ensemble, ...] = ()

    def write(self, folder: Path | str) -> None:
        """Write ``margins.json``.

        Parameters
        ----------
        folder : Path or str
            Created if it does not exist; other files in it are kept.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        replace_outputs(Path(folder), {"margins.json": self.summary})

    def to_control(
        self, loop: str | None = None, *, draws: int = 50, direction: Direction | None = None
    ) -> "list[control.StateSpace]":
        """Return a loop's open loop L(s) as systems of python-control.

        Parameters
        ----------
        loop : str, optional
            Its name; required if there are several.
        draws : int
            Number of draws, evenly spaced among all draws.
        direction : {"driving", "overhauling"}, optional
            Direction, for a loop with an open run, in which the two differ; default: driving.

        Returns
        -------
        list of control.StateSpace
            The nominal loop (means of the law, medians of the file's numbers), then the draws.
            From angle error to measured angle, for negative feedback, SI units. Hold, delay and
            first difference are Padé approximants with an error below 1e-7 up to 3/delay. A
            linear loop has no Coulomb friction. Draws of a refitted law have the damping of the
            diagnosed effects; the nominal loop has none.

        Raises
        ------
        InputError
            python-control is not installed, there is no such loop or direction, or the
            margins were read from a file, which has no draws of loops.
        """
        if not self.ensembles:
            expected = "margins that compute_margins has returned; margins.json holds no draws"
            raise InputError([Fault("to_control", expected)])
        chosen = [ensemble for ensemble in self.ensembles if loop in (ensemble.name, None)]
        if len(chosen) != 1:
            names = ", ".join(ensemble.name for ensemble in self.ensembles)
            raise InputError([Fault("to_control", f"one of {names}", column="loop", value=loop)])
        return chosen[0].to_control(draws, direction)


def compute_margins(
    loops: Path | str | Loop | Sequence[Path | str | Loop],
    draws: Path | str,
    analysis: Analysis | None = None,
    *,
    diagnosis: Path | str | None = None,
    law: LawAsked | None = None,
    verify: int = 0,
    tune: bool = False,
    ensembles: bool = False,
    simulated: int = SIMULATED,
    progress: Callable[[int, int], object] = lambda done, total: None,
) -> Margins:
    """Compute the margins of controllers under the uncertainty of friction.

    Parameters
    ----------
    loops : Path, str or Loop, or a sequence of them
        Loop files, names of bundled loops, or loops that are already read; each name once.
    draws : Path or str
        ``draws.nc`` of a fit. ``claims.json`` beside it gives the difference between rigs.
    analysis : Analysis, optional
        Its seed is used.
    diagnosis : Path or str, optional
        A ``diagnosis.json`` beside its ``diagnosis.nc``; by default the one beside the draws. If
        it names a cause, the margins use the refitted law with its effects on friction. If not,
        and if it is given here, the margins with effects are added to those without.
    law : {"fitted", "refitted"}, optional
        The law to use; `fitted` is the law alone, even if causes are named.
    verify : int
        Number of draws of each loop that are compared with simulations of an elastic cable.
    tune : bool
        Whether to search for gains that meet all specs at once.
    ensembles : bool
        Whether to simulate references that move, with each compensator.
    simulated : int
        Number of draws in which motion is simulated, and hunting if it has no closed form.
    progress : callable
        Called with the number of loops done and the number of loops.

    Returns
    -------
    Margins
        To be read or written.

    Raises
    ------
    InputError
        With every fault of the loop files; or the draws lack a pulley size, or a loop is unstable.
    """
    analysis, path = Analysis() if analysis is None else analysis, Path(draws)
    read = _read_all([loops] if isinstance(loops, Path | str | Loop) else loops)
    posterior, discrepancy = read_draws(path)
    chosen = choose_law(path, posterior, diagnosis, law, analysis.seed)
    for loop in read:
        _refuse_unstable(loop, chosen.posterior, ensembles)
    asked = Asked(analysis.seed, verify, tune, ensembles, max(simulated, 2))
    margins, drawn = zip(*_of_loops(read, chosen, discrepancy, asked, progress), strict=True)
    summary = _summary(margins, chosen, discrepancy, analysis, fit_beside(path))
    return Margins(identified(summary), drawn)


def _of_loops(
    loops: Sequence[Loop],
    chosen: ChosenLaw,
    discrepancy: RigDiscrepancy,
    asked: Asked,
    progress: Callable[[int, int], object],
) -> Iterator[tuple[LoopMargins, Ensemble]]:
    """Yield the margins of each loop, and the loop with its draws."""
    posterior = chosen.posterior
    for place, loop in enumerate(loops):
        progress(place, len(loops))
        shaft, margins = loop_margins(loop, posterior, discrepancy, chosen.beside, asked)
        nominal = at_shaft(loop, nominal_assembly(loop, posterior), float(shaft.estimate.mean()))
        yield margins, Ensemble(nominal, shaft)
    progress(len(loops), len(loops))


def _summary(
    margins: tuple[LoopMargins, ...],
    chosen: ChosenLaw,
    discrepancy: RigDiscrepancy,
    analysis: Analysis,
    fit: FitFile | None,
) -> MarginsFile:
    """Return the content of ``margins.json``, without its id."""
    posterior = chosen.posterior
    common = provenance(recording=posterior.recording, analysis=analysis, created=posterior.created)
    return MarginsFile(
        **common.model_dump(),
        draws=posterior.count,
        effective_draws=posterior.effective_draws,
        draws_analysis_sha256=posterior.analysis_sha256,
        rig_discrepancy=discrepancy.sd,
        rig_discrepancy_source=discrepancy.source,
        law=chosen.used,
        attention=of_margins(chosen.used, margins, fit),
        loops=margins,
    )


def _read_all(loops: Sequence[Path | str | Loop]) -> list[Loop]:
    read: list[Loop] = []
    faults: list[Fault] = []
    for source in loops:
        try:
            read.append(source if isinstance(source, Loop) else read_loop(Path(source)))
        except InputError as error:
            faults += error.faults
    names = [loop.name for loop in read]
    for name in sorted({name for name in names if names.count(name) > 1}):
        faults.append(Fault("loops", "a different name for each loop", column="name", value=name))
    if not loops:
        faults.append(Fault("loops", "at least one loop file"))
    if faults:
        raise InputError(faults)
    return read


def _refuse_unstable(loop: Loop, posterior: Posterior, moves: bool) -> None:
    """Raise if the median loop is unstable, unless the file says that it relies on friction."""
    refuse_sizes(loop, posterior)
    shaft = at_shaft(loop, nominal_assembly(loop, posterior))
    unknown = [*refused(loop, posterior), *(needs_motion(shaft) if moves else ())]
    if unknown:
        raise InputError(unknown)
    faults = [
        Fault(
            loop.name,
            "a loop that is stable without friction, at the medians of its numbers"
            + ("" if direction is None else f" ({direction})")
            + ": smaller gains, less delay, or controller.relies_on_friction = true, which "
            f"computes it as it is. {plant_of(shaft).sentence.removesuffix('.')}",
            column="controller",
        )
        for direction, linear in linear_of(shaft).items()
        if not linear.stable.all() and not loop.controller.relies_on_friction
    ]
    if faults:
        raise InputError(faults)
