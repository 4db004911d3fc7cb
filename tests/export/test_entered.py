"""Numbers to enter as words: digits by the error, what is lost, and what cannot be entered."""

from report.diagnosis_sample import diagnosis

from bayesfric.export.entered import COLUMNS, entered_lines, entered_remarks, entered_rows
from bayesfric.report.chapters.entering import numbers_to_enter
from bayesfric.report.content import BulletList, Table
from bayesfric.robots.fields import fields_of
from bayesfric.schemas import DiagnosisFile, Enter, Interval, SimulatorField


def number(parameter, mean, sd, unit="N·m", **more):
    value = Interval(mean=mean, sd=sd, q05=mean - 1.645 * sd, q50=mean, q95=mean + 1.645 * sd)
    fields = {
        name: None if field is None else SimulatorField(**field._asdict())
        for name, field in fields_of(parameter, turns=True).items()
    }
    return Enter(parameter=parameter, unit=unit, value=value, fields=fields, **more)


COULOMB = number("coulomb", 0.61234, 0.0213, in_your_simulator=0.7, lost_without=0.61234)
SHARE = number("load-friction.share", 0.12, 0.02, "1", lost_without=0.34, snippet="load_friction")


def test_digits_go_by_the_error_and_fields_by_the_simulator():
    (row,) = entered_rows([COULOMB])
    entry = dict(zip(COLUMNS, row, strict=True))
    assert entry["enter"] == "0.612"
    assert entry["90 % interval"] == "0.577 to 0.647"
    assert entry["your simulator"] == "0.7"
    assert entry["MuJoCo"] == "joint/@frictionloss"
    assert entry["URDF"] == "joint/dynamics/@friction"


def test_what_a_simulator_lacks_is_named_with_its_force():
    assert list(entered_remarks([COULOMB])) == [
        "Drake has no field for coulomb: without it the simulation stays off by 0.61 N·m rms."
    ]
    assert list(entered_remarks([COULOMB, SHARE]))[1] == (
        "No simulator has a field for load-friction.share: without it the simulation stays off by "
        "0.34 N·m rms. "
        "`bayesfric export --to mjcf` writes a callback for it, load_friction.py."
    )


def test_a_number_below_zero_is_not_passed_over():
    below = number("viscous", -0.05, 0.01, "N·m s/rad")
    assert "Below zero, which no simulator takes: viscous." in next(entered_remarks([below]))


def test_terminal_and_page_one_say_the_same():
    found = DiagnosisFile.model_construct(
        joint="elbow",
        joints=(),
        verdict="named",
        causes=(),
        enter=(COULOMB,),
        gap=diagnosis().gap.model_copy(update={"held_out_excess": 0.0}),
    )
    lines = list(entered_lines(found))
    assert lines[0].startswith("To enter in a simulator for the joint elbow")
    table, remarks = numbers_to_enter(found)
    assert isinstance(table, Table)
    assert isinstance(remarks, BulletList)
    assert "0.612" in lines[2]
    assert "0.612" in table.rows[0]
    nothing = DiagnosisFile.model_construct(joint=None, joints=(), causes=(), enter=())
    assert [*entered_lines(nothing), *numbers_to_enter(nothing)] == []
