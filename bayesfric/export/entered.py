"""Numbers to enter in a simulator, in words: rounded by the error, with fields and losses."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Literal

from bayesfric.attention.diagnosis import is_by_instrument, is_contradicted, why_untrusted
from bayesfric.export.digits import by_error
from bayesfric.probabilities import two_digits
from bayesfric.rigs.rotary import is_relative
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.diagnosis import Enter

CALLED = {
    "mujoco": "MuJoCo",
    "isaaclab": "Isaac Lab",
    "usd": "USD (PhysX)",
    "newton": "Newton",
    "genesis": "Genesis",
    "drake": "Drake",
    "sdf": "SDF (Gazebo)",
    "urdf": "URDF",
}
SHOWN = ("mujoco", "isaaclab", "urdf")
"""Simulators with a column of their own; diagnosis.json has all simulators."""
COLUMNS = (
    "parameter",
    "unit",
    "now",
    "proposed",
    "90 % interval",
    *(CALLED[simulator] for simulator in SHOWN),
)
MEANT = {
    "armature": "armature (the rotor's inertia)",
    "coulomb": "coulomb (dry friction)",
    "offset": "offset (a constant force, as of a sensor's zero)",
}
"""Explanations of numbers with names that do not explain themselves."""
NEGLIGIBLE = 1e-3  # smallest lost force that is given in digits, relative to Coulomb friction
SAME = 1e-6  # relative difference of forces below which they are equal
NOT_BELOW_ZERO = {"inertia", "armature", "mass", "coulomb", "viscous"}


def entered_rows(enter: Sequence[Enter]) -> list[tuple[str, ...]]:
    """Return a row for each number that has a field, with a cell for each of :data:`COLUMNS`.

    Parameters
    ----------
    enter : sequence of Enter
        Of one joint.
    """
    return [
        (
            number.parameter,
            number.unit,
            "–" if number.in_your_simulator is None else f"{number.in_your_simulator:.4g}",
            by_error(number.value.mean, number.value.sd),
            _interval(number),
            *(_field(number, simulator) for simulator in SHOWN),
        )
        for number in enter
        if not _has_no_field(number)
    ]


def _has_no_field(number: Enter) -> bool:
    """Return whether no simulator has a field for a number, if it were in newtons."""
    fields = number.fields.values()
    return bool(fields) and all(field is None for field in fields) and not is_relative(number.unit)


def off_now(diagnosis: DiagnosisFile) -> str:
    """Return the error of a simulator with its own numbers and with those to enter.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Of one joint.

    Returns
    -------
    str
        A sentence; empty if the simulator's own numbers are unknown.
    """
    gap = diagnosis.gap
    if gap.as_shipped is None:
        return ""
    now = gap.as_shipped.q50
    share = "" if gap.no_share is not None else f" ({now / gap.friction_rms:.0%} of friction)"
    whose = "the shipped numbers" if diagnosis.shipped else "its own numbers (now)"
    these = "the proposed numbers"
    if is_by_instrument(diagnosis):
        these = "the least-squares numbers, which differ from the proposed ones,"
    begun = f"Error on held-out data: {two_digits(now)} {gap.unit} rms{share} with {whose}, "
    entered = f"{two_digits(gap.after.q50)} {gap.unit} rms"
    lacking = [number.lost_without for number in diagnosis.enter if _has_no_field(number)]
    if not lacking:
        return f"{begun}{entered} with {these.removesuffix(',')}."
    if None in lacking:
        return f"{begun}{entered} with {these} and those that no simulator has a field for."
    # The forces that a simulation lacks are independent of what the law leaves.
    alone = math.hypot(gap.after.q50, *filter(None, lacking))
    return (
        f"{begun}about {two_digits(alone)} {gap.unit} rms with {these.removesuffix(',')}, and "
        f"{entered} if "
        "those that no simulator has a field for act as well."
    )


def entered_remarks(enter: Sequence[Enter]) -> Iterator[str]:
    """Yield what a user must know before entering the numbers, a sentence each.

    Parameters
    ----------
    enter : sequence of Enter
        Of one joint.
    """
    yield from remarks_of_numbers(enter)
    yield from remarks_of_fields({"": enter})


def remarks_of_numbers(enter: Sequence[Enter]) -> Iterator[str]:
    """Yield what must be done with the numbers of a joint in any simulator."""
    if ratios := [number for number in enter if is_relative(number.unit)]:
        yield _multiply(ratios)
    below = [
        number.parameter
        for number in enter
        if number.parameter in NOT_BELOW_ZERO and number.value.q95 < 0
    ]
    if below:
        yield (
            f"Below zero, which no simulator accepts: {', '.join(below)}. The law lacks the force "
            "that causes this: see the verdict."
        )


def rows_without_field(joints: Mapping[str, Sequence[Enter]]) -> list[tuple[str, ...]]:
    """Return a row for each number that no simulator has a field for.

    Parameters
    ----------
    joints : mapping of str to sequence of Enter
        Numbers by the joint's name, which is empty for a single joint.

    Returns
    -------
    list of tuple of str
        The joint, the number, its value ± half the width of its 90 % interval, and the rms force
        that a simulation lacks without it.
    """
    return [
        (
            joint,
            MEANT.get(number.parameter, number.parameter),
            with_error(number),
            "" if number.lost_without is None else _lost(number, enter),
        )
        for joint, enter in joints.items()
        for number in enter
        if _has_no_field(number)
    ]


def callbacks(enter: Iterable[Enter]) -> Iterator[str]:
    """Yield a sentence for each number without a field for which `export` writes a callback."""
    snippets = {number.snippet for number in enter if _has_no_field(number)}
    for snippet in sorted(filter(None, snippets)):
        yield f"`bayesfric export --to mjcf` writes a callback for it, {snippet}.py."


def remarks_of_fields(
    joints: Mapping[str, Sequence[Enter]], lacked_by: Literal["any", "all", "some"] = "any"
) -> Iterator[str]:
    """Yield the numbers without a field in simulators, a sentence for joints with the same ones.

    Parameters
    ----------
    joints : mapping of str to sequence of Enter
        Numbers by the joint's name, which is empty for a single joint.
    lacked_by : {"any", "all", "some"}
        "any": numbers that at least one simulator lacks. "all": numbers that all simulators lack,
        with their values. "some": numbers that some simulators lack and others have.
    """
    alike: dict[tuple[str, str], list[tuple[str, Enter]]] = {}
    for joint, enter in joints.items():
        at = f" at {joint}" if joint else ""
        for number in enter:
            lacking = [CALLED[name] for name, field in number.fields.items() if field is None]
            nobody = _has_no_field(number)
            if not lacking or not (nobody or number.lost_without is not None):
                continue
            if lacked_by == ("some" if nobody else "all"):
                continue
            has = "have" if len(lacking) > 1 else "has"
            who = "No simulator has a" if nobody else f"{' and '.join(lacking)} {has} no"
            alike.setdefault((who, number.parameter), []).append((at, number))
    for (who, parameter), numbers in alike.items():
        said = [f"{who} field for {MEANT.get(parameter, parameter)}."]
        if _has_no_field(numbers[0][1]):
            said.append(f"It is {_listed(f'{with_error(number)}{at}' for at, number in numbers)}.")
        lost = _listed(
            f"{_lost(number, joints[at.removeprefix(' at ')])}{at}"
            for at, number in numbers
            if number.lost_without is not None
        )
        if lost:
            said.append(f"A simulation without it is off by {lost}.")
        yield " ".join([*said, *callbacks(number for _, number in numbers)])


def _lost(lacking: Enter, enter: Sequence[Enter]) -> str:
    """Return the force that is lost, compared with the proposed Coulomb friction.

    If the number itself is this force, it has the digits of its value, unless these leave only 0.
    """
    force, value = lacking.lost_without or 0.0, lacking.value
    coulomb = next((number.value.mean for number in enter if number.parameter == "coulomb"), 0.0)
    if force < NEGLIGIBLE * coulomb:
        return f"less than {NEGLIGIBLE:.1%} of Coulomb friction"
    is_itself = _has_no_field(lacking) and math.isclose(force, abs(value.mean), rel_tol=SAME)
    shown = by_error(force, value.sd) if is_itself else two_digits(force)
    if float(shown) == 0:
        shown = two_digits(force)
    words = f"{shown} {_force_unit(enter)} rms"
    share = f"{two_digits(100 * force / coulomb)}% of Coulomb friction" if coulomb > force else ""
    return f"{words} ({share})" if share else words


def with_error(number: Enter) -> str:
    """Return a number ± half the width of its 90 % interval, rounded by its error, with its unit.

    Parameters
    ----------
    number : Enter
        Of one joint.
    """
    sd, unit = number.value.sd, "" if number.unit == "1" else f" {number.unit}"
    half = by_error((number.value.q95 - number.value.q05) / 2, sd)
    return f"{by_error(number.value.mean, sd)} ± {half}{unit}"


def _listed(words: Iterable[str]) -> str:
    return " and ".join(words)


def _multiply(ratios: Sequence[Enter]) -> str:
    """Return what to do with numbers that are divided by a servo's stiffness."""
    turns = any("N·m" in number.unit for number in ratios)
    angle, stiffness = ("rad", "N·m/rad") if turns else ("m", "N/m")
    friction = next((number for number in ratios if number.parameter == "coulomb"), None)
    example = ""
    if friction is not None:
        error = by_error(friction.value.mean, friction.value.sd)
        example = f" Coulomb friction is {error} {angle} of position error."
    return (
        f"All numbers are divided by the stiffness K of your servo.{example} Multiply each by K "
        f"[{stiffness}] before you enter it."
    )


def entered_lines(diagnosis: DiagnosisFile, *, fields: bool = True) -> Iterator[str]:
    """Yield the table and its remarks as lines for a terminal; nothing without numbers to enter.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Diagnosis of one joint, or of pulleys.
    fields : bool
        Whether to include the fields of simulators, and the numbers that have none.
    """
    if not diagnosis.enter:
        return
    contradicted = is_contradicted(diagnosis)
    title = "to enter in a simulator (diagnosis.json has the fields of all simulators):"
    if contradicted:
        title = "estimates that are not to be entered in a simulator:"
    if diagnosis.joint is not None:
        title = f"for the joint {diagnosis.joint}, {title}"
    yield title[:1].upper() + title[1:]
    for remark in (why_untrusted(diagnosis), off_now(diagnosis)):
        if remark:
            yield f"  {remark}"
    last = -1 if fields and not contradicted else -len(SHOWN)
    table = [COLUMNS[:last], *(row[:last] for row in entered_rows(diagnosis.enter))]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for row in table:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells).rstrip()}"
    if contradicted:
        return
    if fields:
        yield from (f"  {remark}" for remark in entered_remarks(diagnosis.enter))
    else:
        alone = remarks_of_fields({"": diagnosis.enter}, "all")
        yield from (f"  {remark}" for remark in alone)


def _interval(number: Enter) -> str:
    low, high = (by_error(end, number.value.sd) for end in (number.value.q05, number.value.q95))
    return f"{low} to {high}"


def _field(number: Enter, simulator: str) -> str:
    field = number.fields.get(simulator)
    if field is None:
        return "–"
    return field.field if field.factor == 1 else f"{field.field} (× {field.factor:.6g})"


def _force_unit(enter: Sequence[Enter]) -> str:
    """Return N·m if any number belongs to a joint that turns."""
    return "N·m" if any("rad" in number.unit or "N·m" in number.unit for number in enter) else "N"
