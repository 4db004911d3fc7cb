"""Loops and draws to ``margins.json``."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.errors import Fault, InputError
from bayesfric.margins.answer import (
    against_the_spec,
    largest_safe_gain,
    limit_cycle_curve,
    what_to_measure,
    which_gain,
)
from bayesfric.margins.assembly import Assembly, draw_assembly, nominal_assembly
from bayesfric.margins.cable_run import Direction
from bayesfric.margins.certificate import certify
from bayesfric.margins.diagnosed import Diagnosed, read_diagnosed, with_effects
from bayesfric.margins.echo import plant_of
from bayesfric.margins.ensemble import Ensemble
from bayesfric.margins.following import follow_all, needs_motion
from bayesfric.margins.inputs import beyond_the_draws, refused
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Loop, loop_sha256, read_loop
from bayesfric.margins.metrics import Key, closed_forms, linear_of
from bayesfric.margins.nyquist import nyquist_fans
from bayesfric.margins.population import read_draws
from bayesfric.margins.posterior import Posterior, RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.rows import metric_rows
from bayesfric.margins.spec import missed_specs
from bayesfric.margins.thresholds import Hunting, find_hunting
from bayesfric.margins.tuning import meets_all_now
from bayesfric.margins.tuning import tune as find_gains
from bayesfric.margins.variance import variance_shares
from bayesfric.margins.verification import verify as verify_draws
from bayesfric.margins.warnings import loop_warnings
from bayesfric.results import identified, json_bytes, provenance, replace_outputs
from bayesfric.schemas import HuntingMap, LoopMargins, MarginsFile, WithEffects

if TYPE_CHECKING:
    import control

__all__ = ["Margins", "compute_margins"]


SIMULATED = 200
SHARED = 1000  # draws for the shares of variance


@dataclass(frozen=True)
class Margins:
    """Margins, ready to be written.

    Parameters
    ----------
    summary : MarginsFile
        What ``margins.json`` says.
    ensembles : tuple of Ensemble
        Its loops with their draws; none where the margins were read from a file.
    """

    summary: MarginsFile
    ensembles: tuple[Ensemble, ...] = ()

    def write(self, folder: Path | str) -> None:
        """Write ``margins.json``.

        Parameters
        ----------
        folder : Path or str
            Created if it is not there; other files in it are left alone.

        Raises
        ------
        InputError
            The folder cannot be written.
        """
        data = json_bytes(self.summary)
        replace_outputs(Path(folder), {"margins.json": lambda path: path.write_bytes(data)})

    def to_control(
        self, loop: str | None = None, *, draws: int = 50, direction: Direction | None = None
    ) -> "list[control.StateSpace]":
        """Return a loop's open loop L(s) as systems of python-control.

        Parameters
        ----------
        loop : str, optional
            Its name; needed where there are several.
        draws : int
            How many, spread evenly over those there are.
        direction : {"driving", "overhauling"}, optional
            Of a loop with an open run, in which the two differ; driving unless said.

        Returns
        -------
        list of control.StateSpace
            Nominal (means of the law, medians of the file's numbers), then the draws. From
            angle error to measured angle, for negative feedback, SI units; hold, delay and first
            difference are Padé approximants, off by less than 1e-7 up to 3/delay. Coulomb
            friction is no part of a linear loop, nor are the effects of a diagnosis.

        Raises
        ------
        InputError
            python-control is not installed, there is no such loop or direction, or the
            margins were read from a file, which holds no draws of loops.
        """
        if not self.ensembles:
            expected = "margins that compute_margins has returned; margins.json holds no draws"
            raise InputError([Fault("to_control", expected)])
        found = [one for one in self.ensembles if loop in (one.name, None)]
        if len(found) != 1:
            names = ", ".join(one.name for one in self.ensembles)
            raise InputError([Fault("to_control", f"one of {names}", column="loop", value=loop)])
        return found[0].to_control(draws, direction)


def compute_margins(
    loops: Path | str | Loop | Sequence[Path | str | Loop],
    draws: Path | str,
    analysis: Analysis | None = None,
    *,
    diagnosis: Path | str | None = None,
    verify: int = 0,
    tune: bool = False,
    ensembles: bool = False,
    simulated: int = SIMULATED,
    progress: Callable[[int, int], object] = lambda done, total: None,
) -> Margins:
    """Compute what the uncertainty of friction does to controllers.

    Parameters
    ----------
    loops : Path, str or Loop, or a sequence of them
        Loop files, names of bundled loops, or loops read already; each name once.
    draws : Path or str
        ``draws.nc`` of a fit. ``claims.json`` beside it says how far rigs differ.
    analysis : Analysis, optional
        Its seed is used.
    diagnosis : Path or str, optional
        A ``diagnosis.json``, with its ``diagnosis.nc`` beside it: margins with the law that
        it refitted and its effects on friction stand beside those without.
    verify : int
        Draws of each loop that are held against motor and joint on an elastic cable.
    tune : bool
        Whether to look for gains that meet all specs at once.
    ensembles : bool
        Whether to simulate references that move, with each compensator.
    simulated : int
        Draws in which hunting is simulated where no closed form holds, and motion.
    progress : callable
        Told how many of how many loops are done.

    Returns
    -------
    Margins
        To be read or written.

    Raises
    ------
    InputError
        With every fault of the loop files; or the draws lack a pulley size, a loop is
        unstable, or two have one name.
    """
    analysis = Analysis() if analysis is None else analysis
    read = _read_all([loops] if isinstance(loops, Path | str | Loop) else loops)
    path = Path(draws)
    posterior, discrepancy = read_draws(path)
    diagnosed = None
    if diagnosis is not None:
        diagnosed = read_diagnosed(Path(diagnosis), posterior, analysis.seed)
    for loop in read:
        _refuse_unstable(loop, posterior, ensembles)
    found, loops_drawn = [], []
    for place, loop in enumerate(read):
        progress(place, len(read))
        shaft, told = _one_loop(
            loop,
            posterior,
            discrepancy,
            diagnosed,
            analysis.seed,
            verify,
            tune,
            ensembles,
            max(simulated, 2),
        )
        found.append(told)
        nominal = at_shaft(loop, nominal_assembly(loop, posterior), float(shaft.estimate.mean()))
        loops_drawn.append(Ensemble(nominal, shaft))
    progress(len(read), len(read))
    common = provenance(
        recording=posterior.recording,
        analysis=analysis,
        created=posterior.created,
    )
    summary = MarginsFile(
        **common.model_dump(),
        draws=posterior.count,
        effective_draws=posterior.effective_draws,
        draws_analysis_sha256=posterior.analysis_sha256,
        rig_discrepancy=discrepancy.sd,
        rig_discrepancy_source=discrepancy.source,
        loops=tuple(found),
    )
    return Margins(identified(summary), tuple(loops_drawn))


def _read_all(loops: Sequence[Path | str | Loop]) -> list[Loop]:
    read: list[Loop] = []
    faults: list[Fault] = []
    for one in loops:
        try:
            read.append(one if isinstance(one, Loop) else read_loop(Path(one)))
        except InputError as error:
            faults += error.faults
    names = [loop.name for loop in read]
    for name in sorted({name for name in names if names.count(name) > 1}):
        faults.append(Fault("loops", "a name of its own for each loop", column="name", value=name))
    if not loops:
        faults.append(Fault("loops", "at least one loop file"))
    if faults:
        raise InputError(faults)
    return read


def _refuse_unstable(loop: Loop, posterior: Posterior, moves: bool) -> None:
    """Raise for a loop whose median is unstable, unless the file says that friction holds it."""
    sizes = {run.pulley_size for _, run in loop.every_run} - set(posterior.coefficients)
    if sizes:  # told with its place by the drawing
        draw_assembly(loop, posterior, RigDiscrepancy(0.0, ""), 0)
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
        for direction, one in linear_of(shaft).items()
        if not one.stable.all() and not loop.controller.relies_on_friction
    ]
    if faults:
        raise InputError(faults)


def _one_loop(
    loop: Loop,
    posterior: Posterior,
    discrepancy: RigDiscrepancy,
    diagnosed: Diagnosed | None,
    seed: int,
    verify: int,
    tune: bool,
    moves: bool,
    simulated: int,
) -> tuple[LoopAtShaft, LoopMargins]:
    given = draw_assembly(loop, posterior, discrepancy, seed)
    shaft = at_shaft(loop, given)
    linear = linear_of(shaft, with_peaks=True)
    values = closed_forms(shaft, linear)
    allowed = loop.spec.limit_cycle_probability_max
    hunting = find_hunting(shaft, simulated, allowed)
    estimate = float(shaft.estimate.mean())
    some = np.arange(min(SHARED, given.draws))
    other = draw_assembly(loop, posterior, discrepancy, seed, stream=1)

    def evaluate(assembly: Assembly) -> Mapping[Key, Array]:
        one = at_shaft(loop, assembly, estimate=estimate)
        return closed_forms(one, linear_of(one))

    draws = posterior.effective_draws
    safe = largest_safe_gain(hunting, allowed, draws)
    beyond = beyond_the_draws(shaft, given, posterior)
    rows = metric_rows(shaft, values, linear, hunting, draws)
    shares = variance_shares(evaluate, given.taken(some), other.taken(some))
    hunts = float(hunting.now.mean())
    missed = missed_specs(rows, hunts, loop.spec)
    together = meets_all_now(shaft, hunting)
    certificate, no_certificate = certify(shaft, hunting)
    told = LoopMargins(
        name=loop.name,
        title=loop.title,
        loop_sha256=loop_sha256(loop),
        answer=" ".join(
            [
                against_the_spec(rows, missed, hunts, loop.spec),
                f"All at once are met with probability {together:.2g}.",
                *([f"Beyond what was measured: {'; '.join(beyond)}."] if beyond else []),
                which_gain(shaft, hunting, safe, allowed),
                *what_to_measure(shares),
            ]
        ),
        plant=plant_of(shaft),
        compensation_signal=loop.compensation.signal,
        compensation_gain=float(np.median(shaft.gamma)),
        metrics=rows,
        missed_specs=missed,
        violation_probability_max=loop.spec.violation_probability_max,
        limit_cycle_probability=limit_cycle_curve(hunting, draws),
        limit_cycle_probability_why=None,
        limit_cycle_probability_max=allowed,
        limit_cycle_method=hunting.method,
        largest_safe_compensation_gain=safe.gamma,
        largest_safe_compensation_gain_why=safe.why,
        largest_safe_compensation_gain_se=safe.se,
        hunting_map=_map(hunting, shaft),
        hunting_map_why="the file's reference rests, and a formula holds"
        if not hunting.map
        else None,
        not_examined=hunting.not_examined,
        variance_share=shares,
        verification=verify_draws(shaft, hunting, verify) if verify else None,
        verification_why=None if verify else "it was not asked for (--verify N)",
        with_effects=None
        if diagnosed is None or not diagnosed.finds_something
        else _with_effects(loop, diagnosed, discrepancy, seed, simulated),
        with_effects_why=_why_without(diagnosed),
        meets_all=together,
        tuning=find_gains(shaft, loop.spec.violation_probability_max) if tune else None,
        tuning_why=None if tune else "it was not asked for (--tune)",
        certificate=certificate,
        certificate_why=no_certificate,
        following=follow_all(shaft, simulated) if moves and shaft.wrist is None else None,
        following_why=_why_not_followed(shaft, moves),
        nyquist=nyquist_fans(shaft),
        warnings=loop_warnings(shaft, given, linear, discrepancy, posterior),
    )
    return shaft, told


def _map(hunting: Hunting, shaft: LoopAtShaft) -> HuntingMap | None:
    chart = hunting.map
    if chart is None:
        return None
    speeds = [one.speed_of(shaft) for one in chart.speeds]
    tip = float(np.median(shaft.tip_per_rad))
    return HuntingMap(
        draws=chart.hunts.shape[2],
        gamma=chart.gammas,
        speed_rad_s=tuple(float(np.median(one)) for one in speeds),
        speed_tip_m_s=tuple(float(np.median(one * shaft.tip_per_rad)) for one in speeds),
        probability=_rows(chart.hunts.mean(axis=2)),
        rms_error_m=_rows(tip * np.median(chart.rms_error, axis=2)),
    )


def _rows(table: Array) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(float(value) for value in row) for row in table)


def _why_not_followed(shaft: LoopAtShaft, moves: bool) -> str | None:
    if not moves:
        return "it was not asked for (--ensembles)"
    if shaft.wrist is not None:
        return "not examined: the joint shares motors with others, which would move along"
    return None


def _why_without(diagnosed: Diagnosed | None) -> str | None:
    if diagnosed is None:
        return "no diagnosis was given"
    return None if diagnosed.finds_something else "the diagnosis finds no effect that may act"


def _with_effects(
    loop: Loop, diagnosed: Diagnosed, discrepancy: RigDiscrepancy, seed: int, simulated: int
) -> WithEffects:
    given = draw_assembly(loop, diagnosed.posterior, discrepancy, seed)
    after = with_effects(at_shaft(loop, given), given, diagnosed.acting)
    linear = linear_of(after, with_peaks=True)
    allowed = loop.spec.limit_cycle_probability_max
    hunting = find_hunting(after, simulated, allowed)
    draws = diagnosed.posterior.effective_draws
    safe = largest_safe_gain(hunting, allowed, draws)
    rows = metric_rows(after, closed_forms(after, linear), linear, hunting, draws)
    hunts = float(hunting.now.mean())
    missed = missed_specs(rows, hunts, loop.spec)
    return WithEffects(
        effects=tuple(one.effect.name for one in diagnosed.acting),
        left_out=diagnosed.left_out,
        answer=" ".join(
            [
                against_the_spec(rows, missed, hunts, loop.spec),
                which_gain(after, hunting, safe, allowed),
            ]
        ),
        metrics=rows,
        missed_specs=missed,
        largest_safe_compensation_gain=safe.gamma,
        largest_safe_compensation_gain_why=safe.why,
    )
