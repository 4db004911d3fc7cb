"""The numbers to use where a cause is named, and the law as a formula."""

import pytest
from report.diagnosis_sample import (
    cause,
    interval,
    stored_diagnosis,
    without_gap,
    words,
)

from bayesfric.report.chapters.symbols import symbol
from bayesfric.report.chapters.to_use import numbers_to_use, papers_law
from bayesfric.report.content import (
    Column,
)
from bayesfric.schemas.causes import LawNumber


def test_a_named_viscous_board_says_the_damping_of_a_pulley():
    """15 N times 0.0128 and 0.0261 N are 0.2181 N, and times the slope a damping."""
    law = {
        "c1[small]": LawNumber(unit="1", before=interval(0.013), after=interval(0.0128)),
        "c2[small]": LawNumber(unit="N", before=interval(0.0439), after=interval(0.0261)),
    }
    named = stored_diagnosis().record.model_copy(update={"law": law})
    slope = named.causes[0].parameters["slope"].q50
    (table,) = numbers_to_use(named)  # and the slope is not told again below it
    assert f"viscous.slope, {slope:.2g}"[:-1] in table.note
    assert table.columns[-1] == Column("damping of a pulley", "N·s/m")
    # Each is known to 5 % (sd): 0.0268 * (1, 0.88, 0.12 in quadrature) * 5 % * 1.645 = 0.0030.
    assert [words(row[-1]) for row in table.rows] == ["0.0268 ± 0.0030", ""]
    said = table.note.replace("\u00a0", " ")
    assert "n ((c₁ + c₃ (θ − 85°)) T + c₂ + d v), with T the cable tension, θ the wrap" in said
    assert "v the cable speed, d the damping of a pulley" in said


@pytest.mark.parametrize(
    ("law", "formula"),
    [
        ("tension", "T + c₂ + d v T/(15 N)), with"),
        ("wrap", "T + c₂ + d v θ/85°), with"),
        ("friction", "T + c₂) (1 + s v), with"),
    ],
)
def test_the_printed_law_has_the_term_of_viscous_friction_by_its_law(law, formula):
    assert formula in papers_law((cause("viscous", law=law),)).replace("\u00a0", " ")


def test_a_power_of_the_number_of_pulleys_is_a_factor_of_the_printed_law():
    """It is 1 at nine pulleys; nothing comes on top of it."""
    said = papers_law((cause("pulley-count-curvature"),)).replace("\u00a0", " ")
    assert "Friction of n pulleys: n (n/9)ᵏ ((c₁ + c₃ (θ − 85°)) T + c₂), with T" in said
    assert said.endswith("k pulley-count-curvature.exponent.")


def test_the_printed_law_says_which_causes_it_lacks():
    said = papers_law((cause("stribeck"), cause("viscous"), cause("clock-scale")))
    assert said.endswith("It lacks stribeck, whose law stands below.")
    assert "It lacks" not in papers_law()


def test_a_named_board_says_which_numbers_to_use():
    """The refit with the cause stands before the law alone, whose coefficients are biased."""
    law = {"c2[small]": LawNumber(unit="N", before=interval(0.0439), after=interval(0.0261))}
    record = stored_diagnosis().record.model_copy(update={"law": law})
    table, parameters = numbers_to_use(record)
    use, alone = ([words(cell) for cell in row] for row in table.rows)
    assert [use[0], alone[0]] == ["small", "small, law alone"]
    assert table.columns[1] == Column(symbol("c2"), "10⁻³\u202fN")
    note = words(table.note)
    assert "1 of 1 is biased by more than 2 combined standard deviations." in note
    assert "A simulator without viscous needs the law alone, and is then off by 0.049" in note
    number = record.law["c2[small]"]
    assert 1e-3 * float(use[1].split(" ± ")[0]) == pytest.approx(number.after.q50, rel=0.05)
    assert 1e-3 * float(alone[1].split(" ± ")[0]) == pytest.approx(number.before.q50, rel=0.05)
    said = words(parameters.text)
    assert said.startswith("viscous.slope 0.")
    assert "growth with speed, as a share of the friction of a pulley" in said
    assert not list(numbers_to_use(without_gap().record))
    (table,) = numbers_to_use(without_gap().record.model_copy(update={"law": law}), alone=True)
    assert words(table.rows[0][0]) == "small"


def test_a_parameter_means_what_it_means_in_the_variant_that_was_found():
    law = {"c2[small]": LawNumber(unit="N", before=interval(0.0439), after=interval(0.0261))}
    (slope,) = cause("viscous").parameters.values()
    curvature = {"curvature": slope.model_copy(update={"unit": "1"})}
    curved = cause("tension-curvature", law="power", parameters=curvature)
    record = stored_diagnosis().record.model_copy(update={"law": law, "causes": (curved,)})
    _, parameters = numbers_to_use(record)
    said = words(parameters.text)
    assert "is multiplied by (T/16.5 N)ᵃ" in said
    assert "a (T/16.5 N − 1)" not in said


def test_no_simulator_needs_the_law_that_errors_of_readings_bias():
    law = {"c2[small]": LawNumber(unit="N", before=interval(0.0439), after=interval(0.0261))}
    magnets = cause("magnet-spacing")
    record = stored_diagnosis().record.model_copy(update={"law": law, "causes": (magnets,)})
    table, *_ = numbers_to_use(record)
    assert "needs the law alone" not in words(table.note)


def test_sizes_stand_in_their_usual_order():
    record = stored_diagnosis().record
    number = LawNumber(unit="1", before=interval(0.01), after=interval(0.01))
    law = {f"c1[{size}]": number for size in ("large", "small", "mine", "medium")}
    table, _ = numbers_to_use(record.model_copy(update={"law": law}))
    sizes = [words(row[0]) for row in table.rows[:4]]
    assert sizes == ["small", "medium", "large", "mine"]


def test_numbers_of_an_open_verdict_are_the_best_so_far():
    named, *_ = numbers_to_use(stored_diagnosis().record)
    open_still, *_ = numbers_to_use(stored_diagnosis(verdict="undecided").record)
    assert named.caption.startswith("Use these numbers: ")
    assert open_still.caption.startswith("The best numbers while the verdict is open: ")
