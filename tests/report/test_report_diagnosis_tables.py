"""The tables and lists of the diagnosis in the report: each shows the stored numbers."""

from report.diagnosis_sample import (
    axis,
    diagnosis,
    figures,
    glance,
    interval,
    paragraphs,
    rows,
    stored_diagnosis,
    tables,
    two_causes,
    without_gap,
    words,
)

from bayesfric.report.assembly import build_document
from bayesfric.report.chapters.diagnosis import diagnosis as chapter
from bayesfric.report.content import (
    Notice,
)
from bayesfric.report.stored import StoredResults
from bayesfric.report.typst import render_pdf
from bayesfric.schemas.causes import Unseparated
from bayesfric.schemas.diagnosis import ConditionAsked, FrictionAsked


def test_probabilities_are_the_stored_ones_most_probable_first():
    table = tables(stored_diagnosis())["hypotheses"]
    cells = [[words(cell) for cell in row] for row in table.rows]
    assert cells[0] == ["viscous", "0.971", "0.975", "0.961"]
    assert cells[1][:2] == ["viscous+stribeck", "0.009"]
    assert cells[-1] == ["none", "<\u00a00.001", "<\u00a00.001", "0.001"]
    assert [words(column.title) for column in table.head][2:] == ["none at 0.1", "none at 0.9"]
    assert "none 0.5, one 0.3, two 0.08" in words(table.note)
    assert "0.002 at most" in words(table.note)


def test_long_lists_of_hypotheses_are_cut_and_say_so():
    probabilities = {f"effect-{k:02d}": (40 - k) / 820 for k in range(40)}
    table = tables(stored_diagnosis(probabilities=probabilities))["hypotheses"]
    assert [words(row[0]) for row in table.rows] == [f"effect-{k:02d}" for k in range(20)]
    assert "20 least probable are in diagnosis.json" in words(table.note)


def test_hypotheses_of_which_only_a_bound_is_told_are_counted_alone():
    probabilities = {"viscous": 0.999, "stribeck": 0.0009, "none": 0.0001}
    stored = stored_diagnosis(
        probabilities=probabilities, prior_sensitivity={"0.1": {}, "0.9": probabilities}
    )
    few = stored_diagnosis(probabilities=probabilities, prior_sensitivity={"0.9": probabilities})
    assert list(rows(few, "hypotheses")) == ["viscous"]
    assert "The 2 least probable are in diagnosis.json" in words(tables(few)["hypotheses"].note)
    assert len(rows(stored, "hypotheses")) == 3  # a dash is not a bound


def test_a_cause_has_its_numbers():
    stored = stored_diagnosis()
    assert rows(stored, "causes")["viscous"] == [
        "slope [s/m]",
        "0.123 [0.113, 0.133]",
        "0.0062",
        "half-normal(scale=0.15)",
        "0 to 0.3",
    ]
    text = paragraphs(stored)
    for part in (
        "have probability 0.987",
        "against the same hypotheses without it: >\u00a06",
        "rms force is 7.9\u202f% of rms friction. Plausible.",
        "Harris and Kotzalas (2006)",
    ):
        assert part in text


def test_an_implausible_cause_below_the_floor_says_both():
    text = paragraphs(two_causes())
    assert "which is below the floor. Not plausible." in text
    assert list(rows(two_causes(), "causes")) == ["viscous", "pulley-count-curvature"]


def test_axes_have_their_shares_and_blind_ones_say_so():
    stored = stored_diagnosis()
    axes = rows(stored, "axes")
    assert axes["velocity [m/s]"] == [
        "0.62 [0.57,\u00a00.67]",
        "0.74 [0.68,\u00a00.81]",
        "<\u00a00.001",
        "",
    ]
    assert axes["displacement [m]"][-1] == "tension"
    assert axes["setup"][0] == "0.00 [0.00,\u00a00.00]"
    assert axes["none of these"][0] == "0.05 [0.05,\u00a00.06]"
    assert axes["wrap angle [°]"] == ["—", "—", "—", "the covariate did not vary"]
    figure = figures(stored)["where"]
    for text in (paragraphs(stored).lower(), figure.alt):
        assert "did not vary" in text
        assert "wrap angle" in text


def test_all_blind_axes_are_no_failure():
    blind = stored_diagnosis(
        where=(axis("wrap_angle", "deg", None), axis("rig", "1", None)),
        unexplained=interval(1.0, 0.0),
        all_unexplained_because="no axis varied in these data",
    )
    assert glance(blind)["Where does it lie?"] == "open: no axis varied in these data"
    assert render_pdf(build_document(StoredResults(diagnosis=blind))).startswith(b"%PDF")


def test_gap_table_is_in_newtons_row_by_row():
    gaps = rows(stored_diagnosis(), "gap")
    assert gaps["cross-validation over assemblies"] == [
        "0.095 [0.087,\u00a00.103]",
        "0.0523 [0.0480,\u00a00.0566]",
        "0.0187 [0.0172,\u00a00.0202]",
        "0.0174 [0.0160,\u00a00.0188]",
        "98.1 [97.4,\u00a098.8]",
    ]
    assert gaps["top tension"][1] == "0.068 [0.062,\u00a00.074]"  # 0.0523 × 1.3 = 0.06799
    assert gaps["largest number of pulleys"][0] == "—"
    millimetres = gaps["free-running trajectory [mm]"][:2]
    assert millimetres == ["19.0 [17.5,\u00a020.6]", "10.5 [9.6,\u00a011.3]"]
    assert gaps["not held out: the data of the fit"][1] == "0.0471 [0.0432,\u00a00.0509]"
    note = words(tables(stored_diagnosis())["gap"].note)
    assert "no published values for this size (largest number of pulleys)" in note


def test_reasons_that_differ_in_a_number_are_one_reason_with_its_range():
    stored = stored_diagnosis()
    gap = stored.record.gap
    held = tuple(
        row.model_copy(update={"shrink": None, "shrink_why": f"above with {p} only"})
        for row, p in zip(gap.held_out, ("0.77", "0.65", "0.9"), strict=False)
    )
    changed = gap.model_copy(update={"held_out": held})
    note = words(tables(stored_diagnosis(gap=changed))["gap"].note)
    assert note.count("No number for shrink") == 1
    assert "shrink: above with 0.65 to 0.9 only (cross-validation over assemblies, " in note


def test_tuning_and_effect_are_told_apart_in_the_caption():
    caption = words(figures(stored_diagnosis())["how-far"].caption)
    assert "changes the held-out error from 0.095 [0.087, 0.103]\u202fN to" in caption
    assert "to 0.0523 [0.0480, 0.0566]" in caption
    assert "removes 98.1 [97.4, 98.8]\u202f% of the systematic gap (mean square)" in caption


def test_no_gap_names_nothing_and_gives_its_reasons():
    stored = without_gap()
    assert "causes" not in tables(stored)
    assert "None is named" in paragraphs(stored)
    assert "which" not in figures(stored)  # a picture of bars that are all next to nothing
    assert "No effect has a posterior probability above 0.020" in paragraphs(stored)
    assert "Nothing to propose: no two plausible hypotheses" in paragraphs(stored)
    assert "does not favour a further, smooth force" in paragraphs(stored)
    caption = words(figures(stored)["how-far"].caption)
    for reason in (
        "No error as shipped: the user's simulator has no published values",
        "No effect is added.",
        "No number in millimetres: no trial of the gravity board was held out",
    ):
        assert reason in caption
    heads = [words(column.title) for column in tables(stored)["gap"].head]
    assert heads == ["held out", "recalibrated", "floor"]
    note = words(tables(stored)["gap"].note)
    assert note.count("the user's simulator") == 1  # each reason once, with its rows


def test_unknown_and_unseparated_are_boxes_of_attention():
    for verdict, title in (("unknown", "Cause unknown"), ("unseparated", "Causes not told apart")):
        stored = stored_diagnosis(verdict=verdict, causes=())
        (notice,) = [b for b in chapter(stored, alone=False) if isinstance(b, Notice)]
        assert notice.kind == "attention"
        assert notice.title == title  # its sentence has the probability
        stored = stored_diagnosis(verdict=verdict, causes=(), sentence="It is so.")
        (notice,) = [b for b in chapter(stored, alone=False) if isinstance(b, Notice)]
        assert notice.title.startswith(f"{title} (probability ")


def test_reasons_for_not_telling_apart_are_told_apart():
    text = paragraphs(stored_diagnosis())
    assert "viscous and cable-weight: they are identical on this rig" in text
    assert "air-drag and stribeck: these data do not" in text
    three = Unseparated(effects=("a", "b", "c"), reason="these-data")
    assert "a, b and c: these data" in paragraphs(stored_diagnosis(unseparated=(three,)))
    assert rows(stored_diagnosis(), "absorbed") == {"mass-error": ["c2[medium]", "0.00134\u202fN"]}


def test_trials_that_stray_are_told():
    text = paragraphs(stored_diagnosis(stray_trials=("g0042", "g0099")))
    assert "far from the others of their own assembly: g0042, g0099." in text
    assert "own assembly" not in paragraphs(stored_diagnosis())


def test_remainder_effects_and_next_experiment_are_the_stored_ones():
    stored = stored_diagnosis()
    assert "does not favour a further, smooth force (log₁₀ Bayes factor −0.7)" in paragraphs(stored)
    assert rows(stored, "effects") == {
        "viscous": [">\u00a06"],
        "air-drag": [">\u00a06"],
        "torque-constant": ["—"],
    }
    note = words(tables(stored)["effects"].note)
    assert "No Bayes factor for torque-constant: absent from these data." in note
    assert rows(stored, "next") == {
        "size medium, number of pulleys 9, mass drive 1.85\u202fkg": ["viscous and air-drag", "3.2"]
    }
    asked = diagnosis().remainder.model_copy(
        update={"significant": True, "share_of_gap": interval(0.5)}
    )
    text = paragraphs(stored_diagnosis(remainder=asked))
    assert "The evidence favours" in text
    assert "It would make up 50.0 [45.9, 54.1]\u202f% of the squared gap" in text
    point = interval(0.5).model_copy(update={"q05": 0.5, "q95": 0.5})
    without_width = asked.model_copy(update={"share_of_gap": point})
    assert "make up 50\u202f% of the" in paragraphs(stored_diagnosis(remainder=without_width))
    whole = asked.model_copy(update={"share_of_gap": None, "share_of_gap_why": "no cause"})
    more = asked.model_copy(update={"share_of_gap": interval(1.64)})
    text = paragraphs(stored_diagnosis(remainder=more))
    assert "It would be at least as large as the gap." in text
    assert "164" not in text
    assert "it is all of the gap" in paragraphs(stored_diagnosis(remainder=whole, causes=()))
    assert "it is all of the gap" not in paragraphs(stored_diagnosis(remainder=whole))


def test_conditions_that_were_asked_about_have_a_table():
    asked = ConditionAsked(
        condition={"pulley_size": "medium", "n_pulleys": 25.0},
        friction=interval(4.88),
        gap_without_causes=interval(-0.19),
        gap_with_causes=interval(0.0006),
        outside=("n_pulleys",),
    )
    target = FrictionAsked(
        unit="N", rows=(asked,), stays_behind={"slip": "acts elsewhere"}, unknown_probability=0.2
    )
    assert "asked" not in tables(stored_diagnosis())
    stored = stored_diagnosis(target=target)
    assert rows(stored, "asked") == {
        "25 medium pulleys": ["4.88 (4.48 to 5.28)", "−0.19", "0.00", "n_pulleys"]
    }
    assert "slip acts elsewhere" in paragraphs(stored)
    assert "An unknown force (probability 0.20)" in paragraphs(stored)
