"""Mistakes that mappings have: each is one line that says where, and what was expected."""

import numpy as np
import pytest
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.logs.readers import kind_of

TIME = np.arange(40) / 100
HEADER = "t,q1,qd1,q2,tau1,tau2\n"
GOOD = """
[csv]
separator = ","
[time]
column = "t"
[position]
column = "q{joint}"
unit = "rad"
[velocity]
column = "qd1"
unit = "rad/s"
[force]
column = "tau{joint}"
unit = "N·m"
force_is = "motor"
"""


def lines(separator=","):
    columns = (TIME, np.sin(9 * TIME), 9 * np.cos(9 * TIME), TIME, np.cos(TIME), 2 * TIME)
    return "".join(separator.join(map(repr, row)) + "\n" for row in np.stack(columns, 1).tolist())


TEXT = HEADER + lines()


def imported(folder, mapping=GOOD, text=TEXT, joint="1", name="log.csv"):
    (folder / name).write_text(text, encoding="utf-8")
    (folder / "map.toml").write_text(mapping, encoding="utf-8")
    call = ["import", str(folder / name), "-o", str(folder / "made")]
    call += ["--map", str(folder / "map.toml")] + ([] if joint is None else ["--joint", joint])
    return CliRunner().invoke(app, call)


def test_without_a_mistake_it_is_imported(tmp_path):
    done = imported(tmp_path)
    assert done.exit_code == 0, done.output


def instead(before, after):
    assert before in GOOD
    return GOOD.replace(before, after)


def without(line):
    return instead(f"{line}\n", "")


HEADERLESS = instead('separator = ","', "header = false")
BY_NUMBER = HEADERLESS.replace('"t"', "1").replace('"q{joint}"', "2").replace('"qd1"', "3")
MISTAKES = {
    "a force that nobody says what it is": (
        {"mapping": without('force_is = "motor"')},
        "force.force_is: expected one of commanded, motor, link, measured, unknown",
    ),
    "a proposal that is not edited": (
        {"mapping": instead('"motor"', '"SAY"')},
        "force.force_is: found 'SAY', expected 'commanded', 'motor', 'link', 'measured' or",
    ),
    "a proposal that is edited in part": (
        {"mapping": instead('"rad"', '"SAY"')},
        "position.unit: found 'SAY', expected the right value, which the log does not state",
    ),
    "amperes without a torque constant": (
        {"mapping": instead('"N·m"', '"A"')},
        "force.factor: expected N·m for 1 A: the torque constant; a gear is gear_ratio",
    ),
    "a share of the PWM without what all of it gives": (
        {"mapping": instead('"N·m"', '"share"')},
        "force.factor: expected N·m for all of the PWM",
    ),
    "ticks without counts a turn": (
        {"mapping": instead('"rad"', '"tick"')},
        "position.counts_per_turn: expected counts of the encoder a turn",
    ),
    "counts a turn of radians": (
        {"mapping": instead('"rad"', '"rad"\ncounts_per_turn = 4096')},
        "position.unit: found 'rad', expected unit = \"tick\"",
    ),
    "newtons of a joint that turns": (
        {"mapping": instead('"N·m"', '"N"')},
        "force.unit: found 'N', expected a torque, since position is in rad",
    ),
    "a torque of a slide": (
        {"mapping": instead('"rad"', '"mm"')},
        "force.unit: found 'N·m', expected a force, since position is in mm",
    ),
    "a unit that there is not": (
        {"mapping": instead('"rad"', '"degree"')},
        "position.unit: found 'degree', expected one of m, cm, mm",
    ),
    "degrees said to be radians": (
        {"mapping": instead('"rad"', '"deg"')},
        "joints.1.position: found '0.017",
    ),
    "a sign the wrong way round": (
        {"mapping": instead('unit = "rad"\n', 'unit = "rad"\nsign = -1\n')},
        "times the velocity', expected a position that moves as the velocity says",
    ),
    "a clock in milliseconds said to be in seconds": (
        {"mapping": instead('column = "t"', 'column = "t"\nunit = "ms"')},
        "and at the clock, or leave [velocity] out",
    ),
    "a misspelt column": (
        {"mapping": instead('"t"', '"time"')},
        "log.csv, time: expected one of t, q1, qd1, q2, tau1, tau2",
    ),
    "a misspelt key": (
        {"mapping": instead("force_is", "force_ist")},
        "force.force_ist: expected no such key",
    ),
    "no position": (
        {"mapping": instead("[position]", "[positions]")},
        "positions: expected no such key (see docs/howto/log.md); is 'position' meant?",
    ),
    "no force": (
        {"mapping": GOOD.partition("[force]")[0]},
        "force: expected the column of a force, or [command] where only positions",
    ),
    "a column and a rate": (
        {"mapping": instead('column = "t"', 'column = "t"\nrate_hz = 100')},
        "time.rate_hz: expected a column or a rate, not both",
    ),
    "no clock": (
        {"mapping": without('column = "t"')},
        "time.column: expected the column of the clock, or rate_hz",
    ),
    "a joint that there is not": (
        {"joint": "3"},
        "--joint: found '3', expected all, or one of its joints (1, 2)",
    ),
    "a joint that the mapping does not name": (
        {
            "mapping": GOOD.replace("{joint}", "1") + "[joints.elbow.force]\ncolumn = 'tau2'\n",
            "joint": "elbwo",
        },
        "the mapping, --joint: found 'elbwo', expected all, or one of its joints (elbow); is "
        "'elbow' meant?",
    ),
    "a joint of forces that there is not": (
        {"mapping": GOOD.replace('"q{joint}"', '"q1"'), "joint": "3"},
        "log.csv, --joint: found '3', expected all, or one of its joints (1, 2)",
    ),
    "ticks by a factor and by counts a turn": (
        {"mapping": instead('"rad"', '"tick"\nfactor = 0.001\ncounts_per_turn = 4096')},
        "position.factor: found '0.001', expected counts_per_turn or a factor, not both",
    ),
    "one rate and tables of different lengths": (
        {
            "name": "log.json",
            "mapping": GOOD.replace('[csv]\nseparator = ","\n', "")
            .replace('column = "t"', "rate_hz = 100")
            .partition("[velocity]")[0]
            + "[force]"
            + GOOD.partition("[force]")[2],
            "text": '{"q1": [0, 1, 2, 3, 4, 5], "tau1": [0, 1, 2]}',
        },
        "log.json, tau1: found '3 rows', expected 6 rows, as q1 has, where time.rate_hz stands for",
    ),
    "no joint": ({"joint": None}, "--joint: expected all, or one of the joints 1, 2"),
    "all joints, and columns of one": (
        {"mapping": GOOD.replace("{joint}", "1"), "joint": "all"},
        "expected columns with {joint} in their names, or [joints.NAME.position] with a column",
    ),
    "all joints, and a column of their own for none": (
        {
            "mapping": GOOD.replace("{joint}", "1") + "[joints.a.force]\nsign = -1\n",
            "joint": "all",
        },
        "expected columns with {joint} in their names, or [joints.NAME.position] with a column",
    ),
    "another separator": (
        {"text": HEADER.replace(",", ";") + lines(";")},
        'expected several columns; is separator = ";" of [csv] meant?',
    ),
    "no header": (
        {"text": lines()},
        "expected names of columns; is header = false of [csv] meant?",
    ),
    "a number beyond the columns": (
        {
            "mapping": BY_NUMBER.replace('"tau{joint}"', "7"),
            "text": lines(),
            "joint": None,
        },
        "log.csv, 7: expected a number of a column, from 1 to 6",
    ),
    "numbers that count from 0": (
        {"mapping": BY_NUMBER.replace('"tau{joint}"', "0"), "text": lines(), "joint": None},
        "log.csv, 0: expected a number of a column, from 1 to 6",
    ),
    "units below the header": (
        {"text": HEADER + "s,rad,rad/s,rad,Nm,Nm\n" + lines()},
        "row 2: found 's,rad,rad/s,rad,Nm,Nm', expected numbers; is unit_rows = 1 of [csv] meant?",
    ),
    "decimal commas": (
        {
            "mapping": instead('","', '";"'),
            "text": HEADER.replace(",", ";") + lines(";").replace(".", ","),
        },
        'expected a number; is decimal = "," of [csv] meant?',
    ),
    "a form of CSV for JSON": (
        {"name": "log.json", "text": '{"t": [1]}'},
        "found 'a log of the kind json', expected a CSV file, where the mapping has [csv]",
    ),
    "a run that ends before it begins": (
        {"mapping": GOOD + '[[runs]]\nname = "a"\nfrom_s = 2\nto_s = 1\n'},
        "runs.a: found '1', expected to_s above from_s",
    ),
    "a run of a file that there is not": (
        {"mapping": GOOD + '[[runs]]\nname = "a"\nfile = "other.csv"\n'},
        "runs.a: expected a file that is one of log.csv",
    ),
    "a kind of log that is not read": (
        {"name": "log.xlsx"},
        "found '.xlsx', expected a log: a file that ends in .csv",
    ),
    "a covariate that is a list": (
        {"mapping": GOOD + '[[runs]]\nname = "a"\npayload = [1, 2]\n'},
        "runs.a.payload: found '[1, 2]', expected a number or a text",
    ),
    "a covariate that is no number": (
        {"mapping": GOOD + '[[runs]]\nname = "a"\npayload = nan\n'},
        "runs.a.payload: found 'nan', expected a number or a text",
    ),
    **{
        f"a blank column of {signal}": (
            {
                "mapping": f'{GOOD}[{signal}]\ncolumn = "extra"\nunit = "{unit}"\n',
                "text": HEADER.strip() + ",extra\n" + lines().replace("\n", ",\n"),
            },
            f"log.csv, extra: found 'no number', expected some number, where the mapping has "
            f"[{signal}]",
        )
        for signal, unit in (
            ("known_force", "N·m"),
            ("temperature", "degC"),
            ("measured_force", "N·m"),
        )
    },
    "another sign of a signal that is not there": (
        {"mapping": GOOD + "[joints.1.torque]\nsign = -1\n"},
        "joints.1.torque: expected one of position, force, velocity",
    ),
}


def test_a_log_that_is_not_there_is_said_to_be_missing(tmp_path):
    with pytest.raises(InputError, match=r"no-such\.csv: found 'no such file', expected a log"):
        kind_of(tmp_path / "no-such.csv")


@pytest.mark.parametrize(("given", "said"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_line(tmp_path, given, said):
    done = imported(tmp_path, **given)
    assert done.exit_code == 2
    assert said in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert not (tmp_path / "made").exists()


def test_there_are_twenty_of_them():
    assert len(MISTAKES) >= 20
