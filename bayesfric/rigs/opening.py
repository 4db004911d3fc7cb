"""Selects the rigs of a recording, the trials of each that are used, and the friction law."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from bayesfric.analysis import Analysis, PriorOverrides
from bayesfric.errors import Fault, InputError, one_of
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import ALIASES, BASELINES, FrictionLaw
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import RigTrials, Unsupported

if TYPE_CHECKING:
    from bayesfric.simulators import SimulatorCalls

DEFAULT = "paper"  # law if the user names none; a rig may replace it by its usual law
COEFFICIENTS = set(Coefficients._fields)


def chosen_rigs(recording: Recording, rigs: Sequence[str] | None) -> tuple[str, ...]:
    """Return the names of the rigs to fit, in the order of :func:`bayesfric.rigs.all_rigs`.

    Parameters
    ----------
    recording : Recording
        The recording.
    rigs : sequence of str or None
        Names of rigs; None is the first rig with data in the recording.

    Raises
    ------
    InputError
        A rig is unknown, or has no data in the recording.
    """
    rigs_by_name = all_rigs()
    recorded = [name for name, rig in rigs_by_name.items() if rig.trials(recording) is not None]
    if rigs is None:
        if not recorded:
            if faults := left_out(recording):
                raise InputError(faults)
            kinds = " or ".join(rig.tables[0] for rig in rigs_by_name.values())
            raise InputError([Fault(recording.name, f"{kinds}, the kinds that can be fitted")])
        return (recorded[0],)
    unknown = [
        Fault("rigs", one_of(rigs_by_name, name), value=name)
        for name in rigs
        if name not in rigs_by_name
    ]
    absent = [
        fault
        for name in rigs
        if name in rigs_by_name and name not in recorded
        for fault in rigs_by_name[name].left_out(recording)
        or [Fault(recording.name, f"data of the rig {name!r}, which was asked for")]
    ]
    if unknown or absent or not rigs:
        raise InputError([*unknown, *absent] or [Fault("rigs", one_of(rigs_by_name, ""))])
    return tuple(name for name in rigs_by_name if name in rigs)


def left_out(recording: Recording) -> list[Fault]:
    """Return the excluded trials of all rigs as faults, each with its rule.

    Parameters
    ----------
    recording : Recording
        The recording.
    """
    return [fault for rig in all_rigs().values() for fault in rig.left_out(recording)]


def open_rigs(
    recording: Recording, rigs: Sequence[str], *, exclude: bool = True
) -> tuple[RigTrials, ...]:
    """Return the trials of each rig that are used in a fit, without those of role ``test``.

    Parameters
    ----------
    recording : Recording
        A recording with data of all these rigs.
    rigs : sequence of str
        Names of rigs, from :func:`chosen_rigs`.
    exclude : bool
        False also uses trials that a rule excludes, if they can be computed.

    Raises
    ------
    InputError
        A rig has no trial that can be used.
    """
    opened = []
    for name in rigs:
        trials = all_rigs()[name].trials(recording, exclude=exclude)
        entering = None if trials is None or trials.table.empty else calibrating(trials)
        if trials is None or trials.table.empty:
            none = Fault(recording.name, "a trial that can be used; all are left out")
            raise InputError([none, *all_rigs()[name].left_out(recording)])
        if entering is None:
            expected = f"a {trials.rig.words.trial} that fits the law; all have the role test"
            raise InputError([Fault(recording.name, expected, column="role")])
        opened.append(entering)
    return tuple(opened)


def rigs_with_trials(recording: Recording) -> dict[str, RigTrials]:
    """Return the trials that are used in a fit, by the name of their rig."""
    by_name = {}
    for name, rig in all_rigs().items():
        trials = rig.trials(recording)
        entering = None if trials is None or trials.table.empty else calibrating(trials)
        if entering is not None:
            by_name[name] = entering
    return by_name


def remarks_of(recording: Recording) -> list[tuple[str, str]]:
    """Return remarks on the measurements that need no fit, each a label and a text.

    Raises
    ------
    InputError
        The measurements cannot be used.
    """
    return [remark for rig in all_rigs().values() for remark in rig.remarks(recording)]


def beside_simulator(rigs: Sequence[RigTrials], simulator: "SimulatorCalls") -> list[RigTrials]:
    """Return trials with a user's simulator as their law.

    Parameters
    ----------
    rigs : sequence of RigTrials
        Trials of each rig of a recording.
    simulator : SimulatorCalls
        The user's simulator.

    Raises
    ------
    InputError
        The simulator cannot simulate a rig, or it fails.
    """
    simulated, faults = [], []
    for trials in rigs:
        beside = trials.beside(simulator)
        if isinstance(beside, Unsupported):
            faults.append(
                Fault("--simulator", f"no {trials.rig.words.rig} in the recording: {beside.reason}")
            )
        else:
            simulated.append(beside)
    if faults:
        raise InputError(faults)
    return simulated


def diagnosed_law(name: str, rigs: Sequence[RigTrials]) -> FrictionLaw:
    """Return the law of a diagnosis: the user's simulator, if any, otherwise a law by name.

    Raises
    ------
    InputError
        A law is named although a simulator replaces it, or the law is unknown or does not apply.
    """
    own = [
        (trials.rig.words.rig, own.law) for trials in rigs if (own := trials.own_law) is not None
    ]
    if not own:
        return baseline_of(name, rigs)
    rig, law = own[0]
    faults = []
    if name != DEFAULT:
        expected = f"no --baseline, since {law.name} is the baseline"
        faults.append(Fault("--baseline", expected, value=name))
    if len(rigs) > 1:
        expected = f"the {rig} alone, whose baseline is {law.name}"
        faults += [
            Fault("recording", expected, value=trials.rig.words.rig)
            for trials in rigs
            if trials.rig.words.rig != rig
        ]
    if faults:
        raise InputError(faults)
    return law


def baseline_of(name: str, rigs: Sequence[RigTrials]) -> FrictionLaw:
    """Return a friction law by its name.

    :data:`DEFAULT` is replaced by the usual law of the rigs, if they all have the same.

    Parameters
    ----------
    name : str
        Key of :data:`bayesfric.physics.laws.BASELINES`, or an older name of a law.
    rigs : sequence of RigTrials
        Trials of each rig, to which the law must apply.

    Raises
    ------
    InputError
        The law is unknown, or does not apply to a rig.
    """
    name = ALIASES.get(name, name)
    if name not in BASELINES:
        raise InputError([Fault("baseline", one_of(BASELINES, name), value=name)])
    own = {trials.usual_law for trials in rigs}
    law = BASELINES[own.pop() if name == DEFAULT and len(own) == 1 else name]
    faults = [
        Fault(
            "baseline", f"a law that the {trials.rig.words.rig} can have. {why.reason}", value=name
        )
        for trials in rigs
        if (why := trials.refuses(law)) is not None
    ]
    if faults:
        raise InputError(faults)
    return law


def with_own_priors(analysis: Analysis, rigs: Sequence[RigTrials]) -> Analysis:
    """Return an analysis with the rigs' own priors of their sizes.

    Priors that the user set, for all sizes or for one, are kept.

    Parameters
    ----------
    analysis : Analysis
        The user's analysis.
    rigs : sequence of RigTrials
        Trials of each rig.
    """
    priors, written = analysis.priors, analysis.priors.model_fields_set
    pulleys = dict(priors.pulleys)
    for trials in rigs:
        for size, own in trials.own_priors.items():
            given = pulleys.get(size, PriorOverrides())
            # A user's prior of c1 does not apply to the parameter of a simulator.
            of_law = set() if trials.own_law is not None else COEFFICIENTS & written
            free = own.model_copy(update=dict.fromkeys(of_law))
            chosen = given.model_dump(exclude_none=True)
            pulleys[size] = PriorOverrides.model_validate(
                free.model_dump(exclude_none=True) | chosen
            )
    if pulleys == priors.pulleys:
        return analysis
    return analysis.model_copy(update={"priors": priors.model_copy(update={"pulleys": pulleys})})


def calibrating(trials: RigTrials) -> RigTrials | None:
    """Return the trials to which the law is fitted (role not ``test``); None without any."""
    if "role" not in trials.table:
        return trials
    return trials.select(trials.table["role"] != "test")
