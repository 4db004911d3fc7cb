"""What a recording can determine, computed in seconds before a fit."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import zip_longest

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.question import question_of
from bayesfric.errors import Fault, InputError
from bayesfric.logs.telemetry import Telemetry, telemetry_of
from bayesfric.observation.feasible import name_and_unit
from bayesfric.planning import Power
from bayesfric.planning import power as power_of_conditions
from bayesfric.readiness.advice import advice_for
from bayesfric.readiness.measured import numbers_told, power_of_measured
from bayesfric.recording.joints import parted_by_joint
from bayesfric.recording.tables import Recording
from bayesfric.rigs.opening import left_out, remarks_of

OF_OTHERS = {"pulleys", "law-without-coulomb", "law-without-offset"}
"""Needs of effects of other rigs, and of effects that the law already contains."""
UNTOLD = "these data leave every number of the law to its prior"


MOST_SHOWN = 3  # number of conditions to record next that are shown, the most useful first
SHORT_CELL = 38  # longest cell [characters] of which two fit on a line


@dataclass(frozen=True)
class Part:
    """What a part of a recording can determine: a joint, or all boards.

    Parameters
    ----------
    name : str
        Name of the joint; empty if there is one part.
    power : Power or None
        None if nothing can be determined, or if only this was asked.
    why_not : tuple of Fault
        Why nothing can be determined.
    lacking : dict of str to tuple of str
        Effects that cannot be found, and what they need.
    largest : dict of str to float
        Largest plausible amplitude of each effect that is examined.
    untold : dict of str to str
        Numbers of the law that such data cannot determine, whatever their errors: name and
        reason.
    """

    name: str
    power: Power | None
    why_not: tuple[Fault, ...] = ()
    lacking: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    largest: Mapping[str, float] = field(default_factory=dict)
    untold: Mapping[str, str] = field(default_factory=dict)

    @property
    def effects(self) -> tuple[dict[str, str], list[str]]:
        """Effects that can be found, with the smallest size that is found, and those that cannot.

        For several laws the size is that of the law that is hardest to find. Below the size of
        the law that is easiest to find, if it is known, none is found. An effect that would be
        found only above its plausible sizes cannot be found.
        """
        smallest: dict[str, tuple[float, str]] = {}
        unseen: dict[str, float] = {}
        rows = {} if self.power is None else self.power.effects.to_dict("index")
        for name, row in rows.items():
            effect = str(name).partition("/")[0]
            size = (float(row["smallest"]), str(row["unit"]))
            smallest[effect] = max(size, smallest.get(effect, size))
            if "unseen" in row:
                unseen[effect] = min(float(row["unseen"]), unseen.get(effect, np.inf))
        can = {
            name: f"{size:.2g}{'' if unit == '1' else ' ' + unit}"
            + (f" (never below {unseen[name]:.2g})" if unseen.get(name) else "")
            for name, (size, unit) in smallest.items()
            if size <= self.largest.get(name, size)
        }
        return can, sorted({*self.largest, *self.lacking} - set(can))

    @property
    def advice(self) -> dict[str, list[str]]:
        """Effects that a recording would show, by what to record."""
        effects_by_wish: dict[str, list[str]] = {}
        for effect, needs in self.lacking.items():
            wanted = advice_for(needs)
            if wanted:
                effects_by_wish.setdefault("; ".join(wanted), []).append(effect)
        return effects_by_wish

    def lines(self) -> Iterator[str]:
        """Yield it as lines of a terminal."""
        of = f" of {self.name}" if self.name else ""
        if self.power is None:
            yield f"These data can determine nothing{of}:"
            yield from (f"  {fault}" for fault in self.why_not)
            return
        yield f"Expected values and errors{of}"
        for name, row in self.power.coefficients.iterrows():
            unit = "" if row["unit"] == "1" else f" {row['unit']}"
            text = f"{row['value']:.3g} ± {row['sd']:.2g}{unit}"
            if "sd_where_law_is_off" in row:
                off = row["sd_where_law_is_off"]
                text += f" by noise alone, ± {off:.2g}{unit} if the law is slightly wrong"
            said = text if row["informed"] else "decided by its prior"
            said = "not estimated" if name in self.untold else said
            yield f"  {self._called(str(name)):<24} {said}"
        yield from (f"  {reason}" for reason in dict.fromkeys(self.untold.values()))
        if self.power.beside:
            names = ", ".join(self.power.beside)
            yield f"  These errors allow for {names}, which a first look shows."
        can, cannot = self.effects
        if can:
            yield "Smallest size of each effect that a diagnosis finds"
            yield from _in_two_columns([f"{name:<23} {size}" for name, size in can.items()])
        if cannot:
            yield f"Effects that these data cannot show: {', '.join(cannot)}"
        if not self.power.pairs.empty:
            yield "Pairs of effects that these data cannot tell apart"
            for _, row in self.power.pairs.iterrows():
                yield f"  {row['effect']} and {row['other']} (correlation {row['correlation']:.2f})"
        yield from self._next()

    def _called(self, number: str) -> str:
        """Return the name of a number of the law: the mass of a joint that turns is its inertia."""
        assert self.power is not None
        unit = self.power.coefficients["unit"].get(number, "")
        return "inertia" if number == "mass" and unit != "kg" else number

    def _next(self) -> Iterator[str]:
        assert self.power is not None
        proposals = self.power.next_condition
        if proposals.empty and not self.advice:
            return
        yield "What to record next"
        for wanted, effects in self.advice.items():
            yield f"  {wanted}: for {', '.join(effects)}"
        most = proposals if proposals.empty else proposals.nsmallest(MOST_SHOWN, "factor")
        for name, row in most.iterrows():
            setting = ", ".join(
                _setting(str(key), value)
                for key, value in row.items()
                if key != "factor" and value == value
            )
            error = f"the error of {self._called(str(name))} falls by {1 - row['factor']:.0%}"
            yield f"  {setting}: {error}"


def _setting(name: str, value: object) -> str:
    """Write a setting of a run to record: duration 3.9 s."""
    own, unit = name_and_unit(name)
    number = f"{value:.3g}" if isinstance(value, float) else f"{value}"
    return f"{own.replace('_', ' ')} {number} {unit}".rstrip()


def _in_two_columns(cells: list[str]) -> Iterator[str]:
    """Yield lines of two cells, the first half on the left; of one cell if cells are long."""
    if max(map(len, cells)) > SHORT_CELL:
        yield from (f"  {cell}" for cell in cells)
        return
    half = (len(cells) + 1) // 2
    for left, right in zip_longest(cells[:half], cells[half:], fillvalue=""):
        yield f"  {left:<{SHORT_CELL}} {right}".rstrip()


@dataclass(frozen=True)
class Readiness:
    """Telemetry of a recording, and what the recording can determine.

    Parameters
    ----------
    recording : Recording
        The recording, as read.
    telemetry : tuple of Telemetry
        Telemetry of each joint; empty for boards.
    remarks : tuple of (str, str)
        Remarks of the rigs on their sensors.
    parts : tuple of Part
        The parts of the recording.
    """

    recording: Recording
    telemetry: tuple[Telemetry, ...]
    remarks: tuple[tuple[str, str], ...]
    parts: tuple[Part, ...]

    @property
    def hopeless(self) -> bool:
        """Whether no part of the recording can determine anything."""
        return all(part.why_not for part in self.parts)

    def lines(self) -> Iterator[str]:
        """Yield it as lines of a terminal."""
        turns = self.recording.rig.rotary
        for joint in self.telemetry:
            if joint.joint is not None:
                yield f"Joint {joint.joint}"
            for label, text in joint.lines(turns=turns):
                yield f"  {label:<14} {text}"
        for label, text in self.remarks:
            yield f"  {label:<14} {text}"
        for part in self.parts:
            yield from part.lines()


def readiness_of(
    recording: Recording,
    analysis: Analysis | None = None,
    *,
    baseline: str = "paper",
    numbers_alone: bool = False,
) -> Readiness:
    """Return the telemetry of a recording, and what the recording can determine.

    Parameters
    ----------
    recording : Recording
        As read.
    analysis : Analysis or None
        Priors, and the odds at which an effect is found.
    baseline : str
        The friction law, as for a diagnosis.
    numbers_alone : bool
        Whether to check only that some number can be determined, which takes less time.

    Raises
    ------
    InputError
        The law is unknown, or its measurements contradict each other.
    """
    parted = parted_by_joint(recording) or {"": recording}
    return Readiness(
        recording,
        () if recording.axis is None else telemetry_of(recording.axis),
        tuple(remarks_of(recording)),
        tuple(
            _part(name, part, analysis, baseline, numbers_alone) for name, part in parted.items()
        ),
    )


def _part(
    name: str,
    recording: Recording,
    analysis: Analysis | None,
    baseline: str,
    numbers_alone: bool,
) -> Part:
    if numbers_alone and recording.axis is None:
        return Part(name, None)  # boards with usable trials always determine coefficients
    try:
        question = question_of(
            recording, analysis or Analysis(), (), (), None, baseline, None, None
        )
        if question.data.rigs[0].has_pulleys:
            return Part(name, power_of_conditions(recording, analysis))
        power = numbers_told(question) if numbers_alone else power_of_measured(question)
    except InputError:
        reasons = left_out(recording)
        if not reasons:  # the data are not the reason
            raise
        return Part(name, None, tuple(reasons))
    numbers = power.coefficients
    if len(numbers) and not numbers["informed"].any():
        why = "; ".join((UNTOLD, *question.data.rigs[0].doubts({})))
        return Part(
            name, None, (Fault(recording.name, f"data that determine at least one number; {why}"),)
        )
    lacking, in_law = question.lacking, {*map(str, power.coefficients.index)}
    return Part(
        name,
        power,
        (),
        {effect: needs for effect, needs in lacking.items() if not OF_OTHERS.intersection(needs)},
        {
            effect: examined.amplitude.plausible[1]
            for effect, examined in question.examined.items()
            if effect not in in_law
        },
        question.data.rigs[0].untold,
    )


def refuse_untold(readiness: Readiness) -> None:
    """Refuse a recording that can determine nothing.

    Raises
    ------
    InputError
        No part of it can determine anything; with the reasons and what is needed.
    """
    if readiness.hopeless:
        raise InputError([fault for part in readiness.parts for fault in part.why_not])
