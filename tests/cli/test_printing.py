"""Lines of a terminal are broken between words, below their text."""

from export.test_entered import joint

from bayesfric.cli.claims import claim_lines
from bayesfric.cli.diagnose import diagnosis_lines
from bayesfric.cli.printing import wrapped
from bayesfric.resources import reference_folder
from bayesfric.results import read_json
from bayesfric.schemas import ClaimsFile


def test_a_line_is_broken_between_words_and_hangs_below_its_text():
    line = "  medium         60 trials on 10 setups, n = 5, 9, 15, 19, wrap 50, 85, 135 deg"
    first, second = wrapped(line, 60).split("\n")
    assert first == "  medium         60 trials on 10 setups, n = 5, 9, 15, 19,"
    assert second == " " * 17 + "wrap 50, 85, 135 deg"
    said = wrapped("  At γ = 1, as in the file, it hunts in 200 of 200 draws.", 40)
    assert said == "  At γ = 1, as in the file, it hunts in\n    200 of 200 draws."


def test_a_short_line_and_a_narrow_terminal_are_left_alone():
    assert wrapped("no gap", 80) == "no gap"
    assert wrapped("word " * 30, 20) == "word " * 30


def screen(lines):
    """Return how many lines of 80 columns a terminal needs."""
    return sum(len(wrapped(line, 80).splitlines()) for line in lines)


def test_claims_fit_on_a_screen_unless_all_is_asked_for():
    claims = read_json(ClaimsFile, reference_folder() / "claims.json").claims
    short, full = (list(claim_lines(claims, verbose=verbose)) for verbose in (False, True))
    assert screen(short) <= 24 < screen(full)
    assert len(short) == len(full) == len(claims)
    for claim, line in zip(claims, short, strict=True):
        assert line.startswith(claim.id)
        assert (claim.reason in line) == (claim.verdict in ("refuted", "undecided"))
    why = "No pulleys."
    none = [claim.model_copy(update={"verdict": "not-testable", "reason": why}) for claim in claims]
    assert list(claim_lines(none, verbose=False)) == [
        f"None of the {len(claims)} claims is testable. {why}"
    ]


def test_several_joints_fit_on_a_screen_unless_all_is_asked_for():
    chances = {"none": 0.9, "delay": 0.1}
    block = joint().model_copy(
        update={
            "verdict": "no-gap",
            "sentence": "It has no gap. " * 20,
            "probabilities": chances,
            "replay": None,
        }
    )
    both = block.model_copy(update={"joints": (block, block), "sentence": "Two joints."})
    short, full = (list(diagnosis_lines(both, verbose=verbose)) for verbose in (False, True))
    assert screen(short) <= 24 < screen(full)
    assert short.count("elbow: no-gap") == 2
    assert not any("joint/@frictionloss" in line for line in short)
    assert any("joint/@frictionloss" in line for line in full)
