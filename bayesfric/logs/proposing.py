"""Proposes a mapping for a log, with the guess for each column and its reason, to be edited."""

import re
from dataclasses import dataclass
from pathlib import Path

from bayesfric.logs.looking import Belief, believed, csv_form, name_of_joint, rank_of
from bayesfric.logs.mapping import FORCE_IS, JOINT, SAY, CsvForm
from bayesfric.logs.readers import kind_of, read_log
from bayesfric.logs.readers.csv import decoded
from bayesfric.logs.relating import related
from bayesfric.logs.table import texts_of
from bayesfric.logs.units import ELECTRIC

NEEDED = {"time": "the clock", "position": "the position", "force": "the force"}
EFFORT = re.compile(r"/.*\.effort\[")  # an effort of a ROS 2 message, in N·m or N
SPEED = re.compile(r"/.*\.velocity\[")
LEROBOT_RUN = "episode_index"
BARE = re.compile(r"[A-Za-z0-9_-]+")  # a key of TOML without quotes
MOST_SHOWN = 60  # columns with a line of their own
DECLARED = (
    "",
    "# What the log does not say, and much hangs on. Take the # away where you know it:",
    '# other_joints = "still"  # the machine has no others, or they stood still; else "moving"',
    "# encoder_resolution = 0.001  # one count of the position [rad or m]",
    "# moving_mass = 0.5  # of a joint imported alone, what it moves [kg·m² or kg]",
)
"""Top-level keys of a mapping that a log cannot give."""


@dataclass(frozen=True)
class Proposal:
    """A mapping to be edited.

    Parameters
    ----------
    toml : str
        The file.
    open : tuple of str
        Values that the user must give before it can be used.
    joints : tuple of str
        Names of the joints that :data:`~bayesfric.logs.mapping.JOINT` stands for, if the log has
        several.
    """

    toml: str
    open: tuple[str, ...]
    joints: tuple[str, ...] = ()


def _of_robot(joints: tuple[str, ...]) -> list[str]:
    own = ", ".join(f'{joint} = "its name there"' for joint in joints or ("joint",))
    return [
        "",
        "# Your robot's model, in this folder, if you have one: it says weight and links' inertia,",
        "# and what your simulator has now is shown beside what is found.",
        "# [robot]",
        '# model = "robot.xml"  # MJCF or URDF',
        f"# joints = {{{own}}}  # log = model, where the names differ",
    ]


def _of_joints(joints: tuple[str, ...], *, in_rows: bool) -> list[str]:
    if not joints:
        return []
    names = ", ".join(map(_plain, joints))
    who = "joint_column names" if in_rows else f"{JOINT} stands for one of"
    return ["", f"# {who} the joints {names}; --joint all takes them all."]


def propose_mapping(path: Path, joint: str | None = None) -> Proposal:
    """Return a guess of the meaning of a log's columns, as a mapping with reasons.

    Parameters
    ----------
    path : Path
        The log.
    joint : str or None
        Joint whose columns are preferred.

    Raises
    ------
    InputError
        The log cannot be read.
    """
    form: CsvForm | None = None
    why: list[str] = []
    if kind_of(path) == "csv":
        form, why = csv_form(decoded(path))
    log = read_log(path, form)
    beliefs = related(log, believed(log))
    lines = [f"# Proposed for {_plain(path.name)}. Nothing is imported: look at each line, and put"]
    lines += [f"# what is right where {SAY} stands.", "#"]
    lines += [f"# {note}" for note in log.notes]
    lines += _belief_lines(beliefs)
    chosen, joints = _chosen(beliefs, joint)
    if "joint" in chosen:
        belief = chosen["joint"][0]
        texts = texts_of(log.columns[belief.column])
        joints = tuple(dict.fromkeys(text.strip() for text in texts if text and text.strip()))
        column = _name(belief.column, form is None or form.header)
        lines += ["", f"joint_column = {column}  # {_plain(belief.why)}"]
    if any(belief.column == LEROBOT_RUN for belief in beliefs):
        lines += ["", f'run = "{LEROBOT_RUN}"  # a run for each episode']
    if form is not None and form != CsvForm():
        lines += _of_csv(form, why)
    lines += _of_joints(joints, in_rows="joint" in chosen)
    lines += DECLARED
    lines += _sections(chosen, log_has_header=form is None or form.header)
    lines += _of_robot(tuple(name for name in joints if BARE.fullmatch(name)))
    toml = "\n".join(lines) + "\n"
    body = "\n".join(line.partition("#")[0] for line in lines)
    missing = [what for key, what in NEEDED.items() if key not in chosen and key != "force"]
    if "force" not in chosen and "command" not in chosen:
        missing.append(NEEDED["force"])
    count = body.count(f'"{SAY}"')
    asked = [f"{count} place{'s' * (count > 1)} with {SAY}"] if count else []
    return Proposal(toml, (*(f"which column is {what}" for what in missing), *asked), joints)


def _plain(text: str) -> str:
    """Return a text of the log without characters that end a comment or a string."""
    return "".join(sign if sign.isprintable() and sign not in '"\\' else "?" for sign in text)


def _belief_lines(beliefs: list[Belief]) -> list[str]:
    lines = ["# Columns, what each is believed to be, and why:"]
    for place, belief in enumerate(beliefs[:MOST_SHOWN], start=1):
        what = belief.kind or "not used"
        unit = f" in {belief.unit}" if belief.unit and belief.kind else ""
        lines.append(
            f"# {place}. {_plain(belief.column)}: {what}{unit} ({_plain(belief.why)}); "
            f"{belief.rows:,} rows, {_plain(belief.shown)}"
        )
    if len(beliefs) > MOST_SHOWN:
        lines.append(f"# … and {len(beliefs) - MOST_SHOWN:,} more")
    return lines


def _of_csv(form: CsvForm, why: list[str]) -> list[str]:
    lines = ["", "[csv]", *(f"# {_plain(reason)}" for reason in why)]
    for key, value in form.model_dump(exclude_defaults=True).items():
        shown = str(value).lower() if isinstance(value, bool) else value
        lines.append(f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {shown}")
    return lines


def _chosen(
    beliefs: list[Belief], joint: str | None
) -> tuple[dict[str, tuple[Belief, str]], tuple[str, ...]]:
    """Return the column of each kind with its pattern, preferably of one joint, and the joints.

    If there are several joints, they are named and columns have a pattern.
    """
    of_kind: dict[str, list[Belief]] = {}
    for belief in sorted(beliefs, key=rank_of):
        if belief.kind is not None:
            of_kind.setdefault(belief.kind, []).append(belief)
    chosen: dict[str, tuple[Belief, str]] = {}
    keys = [] if "joint" in of_kind else _joint_keys(of_kind)
    key = joint if joint in keys else next(iter(keys), None)
    table = of_kind.get("position", of_kind.get("force", [None]))[0]
    for kind, candidates in of_kind.items():
        own = [
            candidate
            for candidate in candidates
            if key is not None and name_of_joint(candidate.column) == key
        ]
        if kind == "time":
            own = [candidate for candidate in candidates if table and candidate.rows == table.rows]
        own = [
            candidate for candidate in own if table and _topic(candidate) == _topic(table)
        ] or own
        if not own and key is not None and kind in ("command", "velocity"):
            continue  # its joint is unknown
        # A force in N·m or N needs no factor, unlike a current.
        belief = min(own or candidates, key=lambda candidate: candidate.unit in ELECTRIC)
        pattern = belief.column
        if kind != "time" and key is not None and own and len(keys) > 1:
            pattern = _with_place(belief.column, key)
        chosen[kind] = (belief, pattern)
    return chosen, tuple(keys) if len(keys) > 1 else ()


def _topic(belief: Belief) -> str:
    return belief.column.rpartition(".")[0] if "." in belief.column else ""


def _joint_keys(of_kind: dict[str, list[Belief]]) -> list[str]:
    """Return the parts of names that identify joints in both positions and forces."""
    lead = "force" if "force" in of_kind else "command"
    others = {name_of_joint(belief.column) for belief in of_kind.get(lead, [])}
    keys = [name_of_joint(belief.column) for belief in of_kind.get("position", [])]
    return [key for key in dict.fromkeys(keys) if key in others and key]


def _with_place(column: str, key: str) -> str:
    before, _, after = column.rpartition(key) if key.isdigit() else column.partition(key)
    return f"{before}{JOINT}{after}"


def _sections(chosen: dict[str, tuple[Belief, str]], *, log_has_header: bool) -> list[str]:
    lines = ["", "[time]"]
    if "time" in chosen:
        belief, pattern = chosen["time"]
        lines += [f"# {_plain(belief.why)}", f"column = {_name(pattern, log_has_header)}"]
        lines.append(f'unit = "{belief.unit or SAY}"  # s, ms, us, ns')
    else:
        lines += ["# No column looks like a clock.", f'rate_hz = "{SAY}"  # samples a second']
    for key in ("position", "force", "command", "velocity"):
        if key in chosen:
            lines += _section(key, *chosen[key], log_has_header)
        elif key == "position" or (key == "force" and "command" not in chosen):
            lines += ["", f"[{key}]", f'column = "{SAY}"  # no column looks like it']
            lines += [f'unit = "{SAY}"', *_force_is(key)]
    return lines


def _section(key: str, belief: Belief, pattern: str, log_has_header: bool) -> list[str]:
    unit, why = belief.unit, belief.why
    if unit is None and EFFORT.match(belief.column):
        unit, why = "N·m", "an effort of ROS 2 is in N·m where a joint turns, in N where it slides"
    if unit is None and SPEED.match(belief.column):
        unit, why = "rad/s", "a velocity of ROS 2 is in rad/s where a joint turns"
    lines = ["", f"[{key}]", f"# {_plain(why)}", f"column = {_name(pattern, log_has_header)}"]
    lines.append(f'unit = "{unit or SAY}"')
    if key == "force" and unit is not None and unit in ELECTRIC:
        lines.append(f'factor = "{SAY}"  # N·m for 1 {unit}: the torque constant, of the motor')
    if unit == "tick":
        lines.append(f'counts_per_turn = "{SAY}"  # of the encoder')
    return [*lines, *_force_is(key)]


def _force_is(key: str) -> list[str]:
    if key != "force":
        return []
    return [f'force_is = "{SAY}"  # one of {", ".join(FORCE_IS)}; motor: from its current']


def _name(pattern: str, log_has_header: bool) -> str:
    if not log_has_header:
        return pattern  # a number
    return f'"{_escaped(pattern)}"'


def _escaped(text: str) -> str:
    return "".join(
        f"\\u{ord(sign):04x}" if not sign.isprintable() or sign in '"\\' else sign for sign in text
    )
