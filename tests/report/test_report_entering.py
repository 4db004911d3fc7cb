"""What to enter and its replay, as the report shows it."""

import numpy as np
import pytest
import xarray as xr
from report.diagnosis_sample import PROVENANCE, diagnosis, interval, words

from bayesfric.attention.diagnosis import of_diagnosis
from bayesfric.diagnosis.held_out_sentence import held_out_words
from bayesfric.export.entered import entered_lines
from bayesfric.plots.replay import replayed_forces
from bayesfric.plots.style import to_svg
from bayesfric.report.chapters.entering import numbers_to_enter, replays
from bayesfric.report.chapters.verdict import verdict_line
from bayesfric.report.content import Figure, Paragraph, Strong, Table, inlines
from bayesfric.report.stored import StoredDiagnosis
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.diagnosis import Replay, ReplayedError

LOWER = Interval(mean=-0.2, sd=0.01, q05=-0.22, q50=-0.2, q95=-0.18)
ERROR = ReplayedError(as_is=0.214, proposed=0.009, difference=LOWER)
REPLAY = Replay(
    held_out="it",
    windows=9,
    torque=ERROR,
    trajectory=ERROR,
    promoted=True,
    sentence="Promoted: so.",
)


def stored(replay=REPLAY, curves=None):
    gap = diagnosis().gap.model_copy(update={"unit": "N·m", "held_out_excess": 0.0})
    block = DiagnosisFile.model_construct(
        **PROVENANCE,
        verdict="no-gap",
        practical_share=0.02,
        joint="elbow",
        joints=(),
        causes=(),
        enter=(),
        gap=gap,
        replay=replay,
    )
    return StoredDiagnosis(block, curves or xr.DataTree(children={"replay": traces()}))


def traces(joints=("shoulder", "elbow")):
    time = np.linspace(0, 1, 50)
    values = np.stack([np.sin(7 * time) * k for k in range(1, len(joints) + 1)])
    arms = dict.fromkeys(("measured_n", "as_is_n", "proposed_n"), (("joint", "time_s"), values))
    return xr.DataTree(dataset=xr.Dataset(arms, {"joint": list(joints), "time_s": time}))


def test_a_replay_has_a_figure_and_a_sentence_for_who_does_not_see_it():
    (figure,) = replays(stored())
    assert isinstance(figure, Figure)
    assert "Promoted: so." in figure.alt
    assert figure.draw().startswith(b"<?xml")


def test_without_a_replay_there_is_none():
    assert not list(replays(stored(replay=None)))
    assert not list(replays(stored(curves=xr.DataTree(children={"law": xr.DataTree()}))))


def test_the_figure_has_a_panel_a_joint_and_four_at_the_most():
    six = traces([f"j{k}" for k in range(6)]).to_dataset()
    assert len(replayed_forces(six, "N·m").axes) == 4
    figure = replayed_forces(traces().to_dataset(), "N·m")
    assert [panel.get_ylabel() for panel in figure.axes] == ["shoulder [N·m]", "elbow [N·m]"]
    assert len(figure.axes[0].lines) == 3
    assert to_svg(figure) == to_svg(replayed_forces(traces().to_dataset(), "N·m"))


def test_page_one_says_what_came_of_the_replay():
    from export.test_entered import COULOMB

    block = stored().record.model_copy(update={"enter": (COULOMB,)})
    (paragraph,) = (part for part in numbers_to_enter(block) if isinstance(part, Paragraph))
    assert "Promoted: so." in "".join(
        inline for inline in inlines(paragraph.text) if isinstance(inline, str)
    )


def test_numbers_beside_a_force_without_a_cause_say_that_they_may_be_biased():
    from export.test_entered import COULOMB

    captions = {}
    for verdict in ("unknown", "no-gap"):
        block = stored().record.model_copy(update={"enter": (COULOMB,), "verdict": verdict})
        captions[verdict] = next(iter(numbers_to_enter(block))).caption
    assert captions["unknown"].startswith("Best available numbers for the joint")
    assert "They may be biased" in captions["unknown"]
    assert captions["no-gap"].startswith(
        "Enter these numbers in your simulator for the joint elbow."
    )
    assert captions["no-gap"].endswith("Its present coulomb lies outside its 90 % interval.")
    assert "biased" not in captions["no-gap"]
    own = COULOMB.model_copy(update={"in_your_simulator": COULOMB.value.q50})
    block = stored().record.model_copy(update={"enter": (own,), "verdict": "no-gap"})
    (table, *_) = numbers_to_enter(block)
    assert "Its present" not in table.caption
    both = (COULOMB, COULOMB.model_copy(update={"parameter": "viscous"}))
    (table, *_) = numbers_to_enter(block.model_copy(update={"enter": both}))
    assert table.caption.endswith("coulomb and viscous lie outside their 90 % intervals.")


@pytest.mark.parametrize(
    ("left", "advice"), [(0.0, None), (0.05, "Enter these numbers with care"), (0.6, "Do not")]
)
def test_numbers_that_miss_what_was_held_out_say_so_before_their_table(left, advice):
    """Left of friction of 1 N; scatter makes 0.04."""
    from export.test_entered import COULOMB

    record = diagnosis()
    floor = record.gap.floor.model_copy(update={"q50": 0.04})
    gap = record.gap.model_copy(
        update={"held_out_excess": left, "friction_rms": 1.0, "floor": floor}
    )
    block = record.model_copy(update={"enter": (COULOMB,), "gap": gap, "verdict": "no-gap"})
    first = next(iter(numbers_to_enter(block)))
    lines = list(entered_lines(block))
    said = [line for line in of_diagnosis(block) if "after scatter is subtracted" in line]
    if advice is None:
        assert isinstance(first, Table)
        assert not said
        assert not any("after scatter is subtracted" in line for line in lines)
    else:
        assert (first.kind, first.title) == ("attention", "Not confirmed")
        assert first.text.startswith(f"{said[0]}.")
        assert first.text.endswith("do not describe.")
        _, table, *_ = numbers_to_enter(block)
        bold = [cell for row in table.rows for cell in row if isinstance(cell, Strong)]
        # What nobody is to enter is not bold, and no field of a simulator stands beside it.
        assert bool(bold) == (advice != "Do not")
        assert ("MuJoCo" in table.columns) == (advice != "Do not")
        assert said[0].startswith(advice)
        assert f"is off by {left:.3g} N rms ({left:.0%} of friction) after scatter" in said[0]
        assert said[0] in lines[1]
        may = advice != "Do not"
        assert lines[0].startswith("To enter in" if may else "Estimates that are not to be entered")
        assert any("joint/@frictionloss" in line for line in lines) == may


def test_no_gap_beside_biased_coefficients_does_not_read_as_all_is_well():
    """The law absorbs a force that acts: no gap is left, and c2 is 60 % off."""
    record = diagnosis()

    def notice(sds):
        """Return the verdict where the numbers with the causes are these sds off those without."""
        alone = interval(0.017)
        refitted = alone.model_copy(update={"mean": alone.mean + sds * alone.sd})
        law = {"c2[small]": LawNumber(unit="N", before=alone, after=refitted)}
        return verdict_line(record.model_copy(update={"verdict": "no-gap", "law": law}))

    assert notice(9).kind == "attention"
    assert words(notice(9).text).startswith(
        "No gap, but the coefficients of the law alone are biased. "
    )
    assert notice(0).kind != "attention"
    assert words(notice(0).text).startswith("No gap. ")


@pytest.mark.parametrize(
    ("chance", "headline"),
    [(0.999, "There is a gap; its cause is undecided."), (0.6, "Undecided.")],
)
def test_a_certain_gap_of_an_open_cause_is_not_called_undecided(chance, headline):
    record = diagnosis()
    gap = record.gap.model_copy(update={"probability_above_practical": chance})
    block = record.model_copy(update={"verdict": "undecided", "causes": (), "gap": gap})
    assert words(verdict_line(block).text).startswith(f"{headline} ")


def test_what_held_out_data_contradict_is_warned_of_once():
    """In the verdict, in the numbers' warning and in the scatter it was the same miss."""
    from export.test_entered import COULOMB

    record = diagnosis()
    gap = record.gap.model_copy(
        update={
            "held_out_excess": 0.6,
            "friction_rms": 1.0,
            "floor_disagreement": "on data that the fit has not seen the law is off by more",
        }
    )
    words_of_held_out = held_out_words(gap, record.causes, record.verdict)
    sentence = f"There is a gap. {words_of_held_out}"
    block = record.model_copy(update={"gap": gap, "sentence": sentence})
    assert "which confirms this" in words(verdict_line(block).text)
    assert any("contradict the assumed scatter" in line for line in of_diagnosis(block))
    untrusted = block.model_copy(update={"enter": (COULOMB,)})
    assert "There is a gap. See" in words(verdict_line(untrusted).text)
    (line,) = [line for line in of_diagnosis(untrusted) if "has not seen" in line]
    assert "is off by 0.6 N rms (60% of friction) after scatter is subtracted" in line


def test_a_simulator_that_is_off_today_is_said_first_and_not_in_green():
    """1.6 of 2.25 N·m are 71 %; with the numbers to enter no gap is left."""
    from export.test_entered import COULOMB

    gap = stored().record.gap.model_copy(
        update={"as_shipped": interval(1.6), "friction_rms": 2.25, "no_share": None}
    )
    block = diagnosis(verdict="no-gap", causes=(), gap=gap, joint="elbow", enter=(COULOMB,))
    notice = verdict_line(block)
    assert notice.kind == "attention"
    assert words(notice.text).startswith(
        "Your simulator, as it is, is off by 1.6\u202fN·m rms (71\u202f% of friction) at elbow. "
        "The numbers below correct this: "
    )
    untrusted = gap.model_copy(update={"held_out_excess": 1.0})
    said = words(verdict_line(block.model_copy(update={"gap": untrusted})).text)
    assert "at elbow. No gap. " in said
    right = gap.model_copy(update={"as_shipped": interval(0.001)})
    good = verdict_line(block.model_copy(update={"gap": right}))
    assert words(good.text).startswith("No gap. ")
