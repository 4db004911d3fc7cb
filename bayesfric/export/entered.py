"""Numbers to enter in a simulator, in words: digits by the error, fields, and what is lost."""

from collections.abc import Iterator, Sequence

from bayesfric.attention.diagnosis import is_by_instrument, why_untrusted
from bayesfric.export.digits import by_error
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
"""Simulators with a column of their own; diagnosis.json has all."""
COLUMNS = (
    "number",
    "unit",
    "now",
    "enter",
    "90 % interval",
    *(CALLED[simulator] for simulator in SHOWN),
)
MEANT = {
    "armature": "armature (the rotor's inertia)",
    "coulomb": "coulomb (dry friction)",
    "offset": "offset (a constant force, as of a sensor's zero)",
}
"""Numbers whose names alone do not say what they are."""
NOT_BELOW_ZERO = {"inertia", "armature", "mass", "coulomb", "viscous"}


def entered_rows(enter: Sequence[Enter]) -> list[tuple[str, ...]]:
    """Return a row a number, a cell for each of :data:`COLUMNS`.

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
    ]


def off_now(diagnosis: DiagnosisFile) -> str:
    """Return how far a simulator is off with its own numbers and with those to enter.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Of one joint.

    Returns
    -------
    str
        A sentence; empty where nobody knows the simulator's own numbers.
    """
    gap = diagnosis.gap
    if gap.as_shipped is None:
        return ""
    now = gap.as_shipped.q50
    share = "" if gap.no_share is not None else f" ({now / gap.friction_rms:.0%} of friction)"
    whose = "the numbers that were shipped" if diagnosis.shipped else "its own numbers (now)"
    these = f"these by {gap.after.q50:.2g} {gap.unit}"
    if is_by_instrument(diagnosis):
        these = f"those of least squares, and not these of an instrument, by {these[9:]}"
    return f"With {whose} it misses held-out data by {now:.2g} {gap.unit} rms{share}, with {these}."


def entered_remarks(enter: Sequence[Enter]) -> Iterator[str]:
    """Yield what must be known before the numbers are entered, a sentence each."""
    if ratios := [number for number in enter if is_relative(number.unit)]:
        yield _multiply(ratios)
    below = [
        number.parameter
        for number in enter
        if number.parameter in NOT_BELOW_ZERO and number.value.q95 < 0
    ]
    if below:
        yield (
            f"Below zero, which no simulator takes: {', '.join(below)}. The law misses what makes "
            "it so: see the verdict."
        )
    for number in enter:
        lacking = [CALLED[name] for name, field in number.fields.items() if field is None]
        if number.lost_without is None or not lacking:
            continue
        force = f"{number.lost_without:.2g} {_force_unit(enter)} rms"
        nobody = len(lacking) == len(number.fields)
        has = "have" if len(lacking) > 1 else "has"
        who = "No simulator has a" if nobody else f"{' and '.join(lacking)} {has} no"
        instead = ""
        if number.snippet is not None:
            file = f"{number.snippet}.py"
            instead = f" `bayesfric export --to mjcf` writes a callback for it, {file}."
        yield (
            f"{who} field for {MEANT.get(number.parameter, number.parameter)}: without it the "
            f"simulation stays off by {force}.{instead}"
        )


def _multiply(ratios: Sequence[Enter]) -> str:
    """Return what to do with numbers that are over a servo's stiffness."""
    turns = any("N·m" in number.unit for number in ratios)
    angle, stiffness = ("rad", "N·m/rad") if turns else ("m", "N/m")
    friction = next((number for number in ratios if number.parameter == "coulomb"), None)
    example = ""
    if friction is not None:
        error = by_error(friction.value.mean, friction.value.sd)
        example = f" Coulomb friction is {error} {angle} of position error."
    return (
        f"No number is in newtons: all are over the stiffness K of your servo.{example} Multiply "
        f"each by K [{stiffness}] before you enter it."
    )


def entered_lines(diagnosis: DiagnosisFile, *, fields: bool = True) -> Iterator[str]:
    """Yield the table and its remarks as lines of a terminal; nothing where nothing is entered.

    Parameters
    ----------
    diagnosis : DiagnosisFile
        Of one joint, or of pulleys.
    fields : bool
        Whether the fields of simulators are among them, and what these lack.
    """
    if not diagnosis.enter:
        return
    of = "" if diagnosis.joint is None else f" for the joint {diagnosis.joint}"
    yield f"To enter in a simulator{of} (diagnosis.json has the fields of all simulators):"
    for remark in (why_untrusted(diagnosis), off_now(diagnosis)):
        if remark:
            yield f"  {remark}"
    last = -1 if fields else -len(SHOWN)
    table = [COLUMNS[:last], *(row[:last] for row in entered_rows(diagnosis.enter))]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    for row in table:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells).rstrip()}"
    if fields:
        yield from (f"  {remark}" for remark in entered_remarks(diagnosis.enter))


def _interval(number: Enter) -> str:
    low, high = (by_error(end, number.value.sd) for end in (number.value.q05, number.value.q95))
    return f"{low} to {high}"


def _field(number: Enter, simulator: str) -> str:
    field = number.fields.get(simulator)
    if field is None:
        return "–"
    return field.field if field.factor == 1 else f"{field.field} (× {field.factor:.6g})"


def _force_unit(enter: Sequence[Enter]) -> str:
    """Return N·m where any number is of something that turns."""
    return "N·m" if any("rad" in number.unit or "N·m" in number.unit for number in enter) else "N"
