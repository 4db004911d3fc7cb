"""Numbers to enter as words: digits by the error, what is lost, and what cannot be entered."""

from export.entered import number

from bayesfric.attention.diagnosis import why_untrusted
from bayesfric.export.entered import (
    COLUMNS,
    entered_lines,
    entered_remarks,
    entered_rows,
    with_error,
)
from bayesfric.report.chapters.entering import numbers_to_enter
from bayesfric.report.chapters.joints import joints
from bayesfric.report.content import BulletList, Notice, Strong, Table
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.gap import Gap

COULOMB = number("coulomb", 0.61234, 0.0213, in_your_simulator=0.7, lost_without=0.61234)
SHARE = number("load-friction.share", 0.12, 0.02, "1", lost_without=0.34, snippet="load_friction")


def test_digits_go_by_the_error_and_fields_by_the_simulator():
    (row,) = entered_rows([COULOMB])
    entry = dict(zip(COLUMNS, row, strict=True))
    assert entry["proposed"] == "0.612"
    assert entry["90 % interval"] == "0.577 to 0.647"
    assert entry["now"] == "0.7"
    assert entry["MuJoCo"] == "joint/@frictionloss"
    assert entry["URDF"] == "joint/dynamics/@friction"


def test_what_a_simulator_lacks_is_named_with_its_force():
    assert list(entered_remarks([COULOMB])) == [
        "Drake has no field for coulomb (dry friction). A simulation without it is off by "
        "0.61 N·m rms."
    ]
    assert list(entered_remarks([COULOMB, SHARE]))[1] == (
        "No simulator has a field for load-friction.share. It is 0.120 ± 0.033. A simulation "
        "without it is off by 0.34 N·m rms (56% of Coulomb friction). "
        "`bayesfric export --to mjcf` writes a callback for it, load_friction.py."
    )


def test_a_number_below_zero_is_not_passed_over():
    below = number("viscous", -0.05, 0.01, "N·m s/rad")
    assert "Below zero, which no simulator accepts: viscous." in next(entered_remarks([below]))


def joint(**gap):
    """Return a joint with a number to enter, that misses held-out data by as much as scatter."""
    gap = {
        "as_shipped": None,
        "held_out_excess": 0.0,
        "no_share": None,
        "floor": middle(0.1),
        **gap,
    }
    return DiagnosisFile.model_construct(
        joint="elbow",
        joints=(),
        verdict="named",
        causes=(),
        law={},
        shipped=None,
        enter=(COULOMB,),
        practical_share=0.02,
        gap=Gap.model_construct(unit="N·m", friction_rms=0.8, **gap),
    )


def test_terminal_and_page_one_say_the_same():
    entered = joint()
    lines = list(entered_lines(entered))
    assert lines[0].startswith("For the joint elbow, to enter in a simulator (")
    table, remarks = numbers_to_enter(entered)
    assert isinstance(table, Table)
    assert isinstance(remarks, BulletList)
    assert "0.612" in lines[2]
    assert Strong("0.612") in table.rows[0]
    nothing = DiagnosisFile.model_construct(joint=None, joints=(), causes=(), enter=())
    assert [*entered_lines(nothing), *numbers_to_enter(nothing)] == []


def middle(value):
    return Interval(mean=value, sd=0.0, q05=value, q50=value, q95=value)


def test_how_far_the_simulator_is_off_today_stands_beside_the_numbers():
    entered = joint(as_shipped=middle(0.4), after=middle(0.003))
    said = (
        "Error on held-out data: 0.4 N·m rms (50% of friction) with its own numbers (now), "
        "0.003 N·m rms with the proposed numbers."
    )
    (table, _) = numbers_to_enter(entered)
    assert said in table.caption
    assert any(said in line for line in entered_lines(entered))


def test_numbers_that_miss_held_out_data_carry_a_warning():
    """0.015 N·m beyond scatter is below 2 % of 0.8 N·m, 0.017 N·m is above."""
    quiet, loud = (
        joint(held_out_excess=excess, after=middle(0.3), floor=middle(0.1), systematic=middle(0.1))
        for excess in (0.015, 0.017)
    )
    assert not any(isinstance(block, Notice) for block in numbers_to_enter(quiet))
    warning, *_ = numbers_to_enter(loud)
    assert isinstance(warning, Notice)
    assert warning.text.startswith(
        "Enter these numbers with care for the joint elbow. On data that the fit has not seen, the "
        "law with these numbers is off by 0.017 N·m rms (2% of friction) after scatter is "
        "subtracted; scatter alone makes 0.1 N·m rms."
    )
    assert any(line.strip() in warning.text for line in entered_lines(loud))


def test_a_share_of_friction_that_cannot_be_told_is_in_no_warning():
    """Five times a friction that is within its error of zero is no reason by itself."""
    gap = {"held_out_excess": 4.0, "after": middle(0.3), "floor": middle(1.0)}
    assert "5 times friction" in why_untrusted(joint(**gap))
    warning = why_untrusted(joint(**gap, no_share="friction is within its error of zero"))
    assert warning.startswith("Enter these numbers with care")
    assert "%" not in warning


def test_what_an_instrument_tells_is_not_said_to_miss_what_least_squares_miss():
    by_it = {"coulomb": LawNumber.model_construct(least_squares=middle(0.5))}
    entered = joint(as_shipped=middle(0.4), after=middle(0.3), held_out_excess=0.1,
                    floor=middle(0.1))  # fmt: skip
    by_instrument = entered.model_copy(update={"law": by_it, "shipped": {"c2": 0.5}})
    lines = " ".join(entered_lines(by_instrument))
    assert "0.4 N·m rms (50% of friction) with the shipped numbers, " in lines
    assert (
        "0.3 N·m rms with the least-squares numbers, which differ from the proposed ones." in lines
    )
    assert "the law with those of least squares is off by" in lines


OFFSET = number("offset", 0.0135, 0.004, lost_without=0.0131)


def test_what_no_simulator_takes_stands_apart_from_what_to_enter():
    arm = joint().model_copy(update={"enter": (COULOMB, OFFSET)})
    assert [row[0] for row in entered_rows(arm.enter)] == ["coulomb"]
    said = "No simulator has a field for offset (a constant force, as of a sensor's zero)."
    table, apart, remarks = numbers_to_enter(arm)
    assert len(table.rows) == 1
    for fields in (True, False):
        lines = list(entered_lines(arm, fields=fields))
        assert not any(line.startswith("  offset") for line in lines)
        assert f"  {said} It is 0.0135 ± 0.0066 N·m. A simulation without it is off by" in lines[-1]
    assert apart.caption.startswith("Numbers that no simulator has a field for.")
    assert [row[2] for row in apart.rows] == ["0.0135 ± 0.0066 N·m"]
    assert not any(said in item for item in remarks.items)


def test_the_error_of_what_can_be_entered_stands_beside_the_error_of_the_law():
    """Without an offset of 0.0131 N·m the law's own 0.003 N·m are 0.0134 N·m."""
    off = joint(as_shipped=middle(0.4), after=middle(0.003))
    table, *_ = numbers_to_enter(off.model_copy(update={"enter": (COULOMB, OFFSET)}))
    assert (
        "about 0.013 N·m rms with the proposed numbers, and 0.003 N·m rms if those that no "
        "simulator has a field for act as well."
    ) in table.caption


def test_what_two_joints_lack_alike_is_said_once():
    joints = [
        joint().model_copy(update={"joint": name, "enter": (COULOMB, OFFSET)})
        for name in ("shoulder", "elbow")
    ]
    arm = joints[0].model_copy(update={"joints": tuple(joints)})
    *tables, apart, remarks = numbers_to_enter(arm)
    assert len(tables) == 2
    assert list(remarks.items) == [
        "Drake has no field for coulomb (dry friction). A simulation without it is off by "
        "0.61 N·m rms at shoulder and 0.61 N·m rms at elbow.",
    ]
    offset = "offset (a constant force, as of a sensor's zero)"
    error = "0.013 N·m rms (2.1% of Coulomb friction)"
    assert apart.rows == [
        ["shoulder", offset, "0.0135 ± 0.0066 N·m", error],
        ["elbow", offset, "0.0135 ± 0.0066 N·m", error],
    ]


def test_a_share_is_of_the_coulomb_friction_that_the_table_proposes():
    """Two modes: the mean, 0.047, is proposed, and the median is 0.082."""
    value = COULOMB.value.model_copy(update={"mean": 0.0466, "sd": 0.0374, "q50": 0.0819})
    coulomb = COULOMB.model_copy(update={"value": value, "lost_without": 0.0466})
    offset = number("offset", 0.012, 0.0124, lost_without=0.012)
    of_coulomb, of_offset = entered_remarks([coulomb, offset])
    assert of_coulomb.endswith("is off by 0.047 N·m rms.")
    assert of_offset.endswith("is off by 0.012 N·m rms (26% of Coulomb friction).")


def test_a_lost_force_is_not_printed_as_nothing():
    """The digits of an error of 20 N·m would leave 0 of 0.24 N·m."""
    vague = number("offset", 0.24, 20.0, lost_without=0.24)
    assert "A simulation without it is off by 0.24 N·m rms." in next(entered_remarks([vague]))


def test_a_negligible_lost_force_has_no_digits():
    small = number("offset", 0.00003, 0.002, lost_without=0.00003)
    said = list(entered_remarks([COULOMB, small]))[-1]
    assert said.endswith("A simulation without it is off by less than 0.1% of Coulomb friction.")


def test_an_offset_has_the_same_digits_wherever_it_stands():
    """Its mean stands at the table, in the sentence and among the joints; the median nowhere."""
    skewed = number("offset", -0.00094, 0.002, lost_without=0.00094)
    skewed = skewed.model_copy(update={"value": skewed.value.model_copy(update={"q50": -0.0008})})
    assert "It is -0.0009 ± 0.0033 N·m. A simulation without it is off by 0.0009 N·m rms." in next(
        entered_remarks([skewed])
    )
    assert with_error(skewed) == "-0.0009 ± 0.0033 N·m"
    arm = joint().model_copy(update={"enter": (skewed,), "model_error": ()})
    _, table, _ = joints(arm.model_copy(update={"joints": (arm,)}))
    assert table.rows[0][-1] == "−0.0009 ± 0.0033 N·m"
