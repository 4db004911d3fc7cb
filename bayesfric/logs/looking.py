"""Guesses about a log: the format of its CSV, and the meaning of each column."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from textwrap import shorten

import numpy as np

from bayesfric.arrays import Array
from bayesfric.errors import Fault
from bayesfric.logs.clock import is_stamp
from bayesfric.logs.mapping import CsvForm
from bayesfric.logs.readers.csv import lines_of, split
from bayesfric.logs.spelling import (
    QUANTITIES,
    SPELLINGS,
    is_unit,
    kind_of_unit,
    unit_in_name,
    unit_of_text,
    words_of,
)
from bayesfric.logs.table import Cells, Log, numbers_of, texts_of
from bayesfric.logs.units import SECONDS

ROWS = 5000  # number of rows that are examined
LINES = 200
LONGEST = 60  # most characters of a line that are shown
SEPARATORS = (",", ";", "\t", "|", "space")
NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
SINCE_1970 = (1e9, 4.2e9)  # seconds, from 2001 to 2103
USUAL_S = (2e-4, 0.2)  # usual sample intervals of a joint: 5 Hz to 5 kHz
MOST_JOINTS, LEAST_ROWS = 60, 3  # of a log with a row for each joint, and rows of each
JOINT_WORDS = r"joint|jnt|motor|servo|actuator|axis|id|name|names|index"
WHOLE_SHARE = 1.01  # of a PWM, rounded
WHOLE_TURNS_RAD = 40.0  # a larger position is unlikely to be in rad

WORDS = {
    "time": r"time|timestamp|stamp|t|clock|sec|secs|seconds|micros|millis|us|ms|ns|epoch",
    "command": r"cmd|command|commanded|target|desired|des|ref|reference|setpoint|goal|action|sp",
    "position": r"position|pos|q|angle|theta|qpos|encoder|enc|state|travel|ticks|deg|rad",
    "velocity": r"velocity|vel|qd|dq|qdot|speed|omega|qvel|rpm",
    "force": r"torque|tau|effort|force|trq|iq|amps|amp|volt|voltage|pwm|duty|nm",
    "temperature": r"temperature|temp",
}
"""Words in names, by the kind of column that has them."""
OF_MOTOR = r"current|load"
"""Words for a force if no other word contradicts: the current velocity is no current."""
LETTERS = {"position": "x", "force": "f|m|i"}
"""Letters that count if there is no word."""
OTHERS = r"acc|accel|acceleration|qdd|ddq|qddot|jerk|gyro|imu|id"
"""Words of quantities that no mapping has; id is the current without torque."""
RANK = {r"error|err|deviation|limit|lim|min|max": 2, WORDS["command"]: 1}
"""Words that give a column a lower rank among columns of its kind."""
OF_UNITS = tuple(word for words in (*SPELLINGS.values(), *QUANTITIES.values()) for word in words)
OF_ANY = r"joint|joints|motor|sensor|actual|act|measured|meas|feedback|fb|log|data|observation"
"""Words that are no names of joints."""


@dataclass(frozen=True)
class Belief:
    """The guess for a column, with its reason.

    Parameters
    ----------
    column : str
        Its name.
    kind : str or None
        A key of :data:`WORDS`, or ``joint`` for a column that names the joint of each row; None
        without evidence.
    unit : str or None
        Unit; None if unknown.
    why : str
        The reason, a clause.
    shown : str
        Content of its cells.
    rows : int
        Number of rows.
    """

    column: str
    kind: str | None
    unit: str | None
    why: str
    shown: str
    rows: int


def csv_form(text: str) -> tuple[CsvForm, list[str]]:
    """Return the probable format of a CSV, with reasons."""
    lines = lines_of(text)[:LINES]
    separator = max(SEPARATORS, key=lambda sign: _evenness(lines, sign))
    cells = list(split(lines, separator))
    width = _usual_width(cells)
    numeric = [row for row, line in enumerate(cells) if len(line) == width and _is_data(line)]
    first = numeric[0] if numeric else min(1, max(len(cells) - 1, 0))
    names = [row for row in range(first) if len(cells[row]) == width and any(cells[row])]
    decimal = "," if separator != "," and _has_commas(cells[first:]) else "."
    shown = {"\t": "tab"}.get(separator, separator)
    why = [f"{width} cells in most lines, between which stands {shown!r}"]
    header = bool(names)
    preamble = names[0] if names else first
    unit_rows = first - preamble - 1 if header else 0
    if header:
        names_shown = shorten(", ".join(cells[preamble]), LONGEST, placeholder=" …")
        why.append(f"line {preamble + 1} has names: {names_shown}")
    else:
        why.append(f"line {first + 1} is the first, and has numbers: there is no header")
    if unit_rows:
        why.append(f"line {preamble + 2} below it has no numbers: {', '.join(cells[preamble + 1])}")
    form = CsvForm(
        separator=shown, header=header, preamble=preamble, unit_rows=unit_rows, decimal=decimal
    )
    return form, why


def _evenness(lines: Sequence[str], separator: str) -> tuple[int, int]:
    """Return how many lines have the commonest number of cells, of those above one."""
    rows = split([line for line in lines if line.strip()], separator)
    several = [cells for cells in rows if len(cells) > 1]
    width = _usual_width(several)
    count = sum(len(cells) == width for cells in several)
    return count, width if separator != "space" else 1


def _usual_width(cells: list[list[str]]) -> int:
    widths = [len(line) for line in cells if line]
    return max(set(widths), key=widths.count) if widths else 1


def _is_data(cells: list[str]) -> bool:
    """Return whether a line has only numbers, stamps and blanks, or nearly so."""
    texts = [cell.strip() for cell in cells]
    data = sum(bool(NUMBER.fullmatch(text)) or is_stamp(text) for text in texts)
    return data > len(cells) / 2


def _has_commas(lines: list[list[str]]) -> bool:
    cells = [cell for line in lines for cell in line]
    commas = sum(bool(re.fullmatch(r"[+-]?\d+,\d+", cell.strip())) for cell in cells)
    points = sum(bool(re.fullmatch(r"[+-]?\d+\.\d+", cell.strip())) for cell in cells)
    return commas > points


def believed(log: Log) -> list[Belief]:
    """Return the guess for each column of a log."""
    return [_belief(log, column, cells) for column, cells in log.columns.items()]


def _belief(log: Log, column: str, cells: Cells) -> Belief:
    rows, few = len(cells), cells[:ROWS]
    texts = [text for text in texts_of(few) if text]
    if not texts:
        return Belief(column, None, None, "it is blank", "nothing", rows)
    if is_stamp(texts[0]):
        shown = f"{texts[0]} to {texts[-1]}"
        return Belief(
            column, "time", "s", "its cells are stamps, which say their unit", shown, rows
        )
    numbers = first_numbers(log, column)
    if (why := _names_joints(column, few)) is not None:
        shown = shorten(", ".join(dict.fromkeys(texts)), LONGEST, placeholder=" …")
        return Belief(column, "joint", None, why, shown, rows)
    if numbers is None:
        return Belief(column, None, None, "its cells are no numbers", texts[0][:40], rows)
    numbers = numbers[np.isfinite(numbers)]
    shown = f"{numbers.min():.6g} to {numbers.max():.6g}"
    if rows > len(few):
        shown += f" in the first {len(few):,}"
    if np.ptp(numbers) == 0:
        shown = f"{numbers[0]:.6g} throughout"
    said = (log.units or {}).get(column, "").strip(" []()")
    clock = _clock_unit(numbers, column, said)
    kind = _kind(column, clock is not None)
    if kind is not None and _counts_rows(column, numbers):
        return Belief(column, None, None, "it counts the rows", shown, rows)
    if kind == "time":
        tick, why = clock or ("s", "")
        return Belief(column, "time", tick, f"its name, and it increases; {why}", shown, rows)
    if kind is None:
        return Belief(column, None, None, "its name says nothing", shown, rows)
    unit, why = _unit(kind, column, said, numbers)
    return Belief(column, kind, unit, f"its name; {why}", shown, rows)


def _names_joints(column: str, cells: Cells) -> str | None:
    """Return the reason why a column names the joint of each row; None if it does not."""
    texts = [text.strip() for text in texts_of(cells) if text and text.strip()]
    names = set(texts)
    of_joint = [re.fullmatch(JOINT_WORDS, word) is not None for word in words_of(column)]
    is_text = not any(NUMBER.fullmatch(name) for name in names)
    if not 2 <= len(names) <= MOST_JOINTS or len(texts) < LEAST_ROWS * len(names):
        return None
    alternate = np.mean([a != b for a, b in pairwise(texts)]) > 0.5
    if is_text and (alternate or any(of_joint)):
        return f"it has {len(names)} texts, each in many rows: names of joints"
    if alternate and of_joint and all(of_joint) and all(name.isdigit() for name in names):
        return f"its name, and {len(names)} numbers that alternate: a row for each joint"
    return None


def first_numbers(log: Log, column: str) -> Array | None:
    """Return the first numbers of a column, NaN for blank cells; None if cells are no numbers."""
    faults: list[Fault] = []
    part = Log(log.name, {column: log.columns[column][:ROWS]}, log.first_row)
    numbers = numbers_of(part, column, faults)
    return None if faults or not np.isfinite(numbers).any() else numbers


def name_of_joint(column: str) -> str:
    """Return the part of a name that may be the joint: in brackets, a number, or other words."""
    bracket = re.search(r"\[([^\]]+)\]", column)
    if bracket and words_of(bracket.group(1)) and not is_unit(bracket.group(1)):
        return bracket.group(1)
    number = re.search(r"(\d+)(?!.*\d)", column)
    if number:
        return number.group(1)
    used = "|".join(
        (*WORDS.values(), OF_MOTOR, *LETTERS.values(), *map(re.escape, OF_UNITS), OF_ANY)
    )
    unit = bracket is not None and is_unit(bracket.group(1))
    words = list(re.finditer(r"[^\W_]+", column[: bracket.start()] if bracket and unit else column))
    left = [at for at, word in enumerate(words) if not re.fullmatch(used, word.group().lower())]
    if not left or left[-1] - left[0] >= len(left):  # none, or other words between them
        return ""
    return column[words[left[0]].start() : words[left[-1]].end()]


def rank_of(belief: Belief) -> int:
    """Return the rank of a column in its kind, 0 being the best: a limit is no position."""
    words = words_of(belief.column)
    return sum(
        rank
        for pattern, rank in RANK.items()
        if _has(words, pattern) and not (pattern == WORDS["command"] and belief.kind == "command")
    )


def _has(words: list[str], pattern: str) -> bool:
    return any(re.fullmatch(pattern, word) for word in words)


def _kind(column: str, is_clock: bool) -> str | None:
    """Return the kind from the words of a name, unambiguous words first."""
    words = words_of(column)
    if is_clock:
        return "time"
    if _has(words, OTHERS):
        return None
    said = {kind for kind, pattern in WORDS.items() if _has(words, pattern)}
    by_unit = kind_of_unit(column)
    if "temperature" in said:
        return "temperature"
    if "velocity" in said or by_unit == "velocity":
        return "velocity"
    if "position" in said:
        return "command" if "command" in said else "position"
    if "force" in said:
        return "force"
    is_of_motor = _has(words, OF_MOTOR) or by_unit == "force"
    if "command" in said and (not is_of_motor or by_unit == "position"):
        return "command"
    if by_unit is not None:
        return by_unit
    if is_of_motor:
        return "force"
    return next((kind for kind, letters in LETTERS.items() if _has(words, letters)), None)


def _counts_rows(column: str, numbers: Array) -> bool:
    """Return whether a column whose name is a letter counts the rows."""
    return (
        len("".join(words_of(column))) == 1
        and numbers.size > 1
        and bool(np.all(np.diff(numbers) == 1))
    )


def _clock_unit(numbers: Array, column: str, said: str) -> tuple[str, str] | None:
    """Return the unit of a clock, and the reason; None if the column is no clock."""
    is_named = any(re.fullmatch(WORDS["time"], word) for word in words_of(column))
    steps = np.diff(numbers)
    if not steps.size or not is_named or (steps >= 0).mean() < 0.9:
        return None
    if (steps > 0).mean() < 1 / (2 * MOST_JOINTS):  # each joint may have a row at each time
        return None
    interval = float(np.median(steps[steps > 0]))
    for unit, second in SECONDS.items():
        if SINCE_1970[0] < numbers[0] * second < SINCE_1970[1]:
            return unit, f"{numbers[0]:.0f} is {unit} since 1970"
    written = unit_of_text("time", said) or unit_in_name("time", column)
    if written is not None and written.unit is not None:
        rate = 1 / (interval * SECONDS[written.unit])
        return written.unit, f"it says {written.unit}, which is {rate:.4g} Hz"
    usual = [
        unit for unit, second in SECONDS.items() if USUAL_S[0] <= interval * second <= USUAL_S[1]
    ]
    if usual:
        rate = 1 / (interval * SECONDS[usual[0]])
        return usual[0], f"in {usual[0]} it is {rate:.4g} Hz, and not in other units"
    return None


def _unit(kind: str, column: str, said: str, numbers: Array) -> tuple[str | None, str]:
    """Return a unit and the reason: from the file, from the name, or from a position's size."""
    of_kind = "position" if kind == "command" else kind
    by_file = unit_of_text(of_kind, said) if of_kind in SPELLINGS else None
    spelled = by_file or unit_in_name(of_kind, column)
    if spelled is not None:
        who = "its name" if by_file is None else "the file"
        if spelled.unit is None:
            return None, f"{who} says {spelled.text}, whose prefix no unit of a mapping has"
        if spelled.unit == "share" and np.abs(numbers).max() > WHOLE_SHARE:
            return None, f"{spelled.text} beyond 1 is no share of the whole: %, or counts (raw)"
        return spelled.unit, f"{who} says {spelled.text}"
    if kind not in ("position", "command"):
        return None, "nothing says its unit"
    largest = float(np.abs(numbers).max())
    if largest > WHOLE_TURNS_RAD and np.all(numbers == np.round(numbers)):
        return "tick", "whole numbers beyond 40 are counts rather than rad"
    if largest > WHOLE_TURNS_RAD:
        return "deg", f"{largest:.4g} is too large for rad"
    return "rad", f"{largest:.4g} is of the size of rad, or of a slide in m"
