"""What held-out data say, in a sentence."""

import pytest
from report.diagnosis_sample import cause, diagnosis, interval

from bayesfric.diagnosis.held_out_sentence import held_out_words


def test_the_sentence_says_what_data_held_out_say():
    gap, viscous = diagnosis().gap, [cause("viscous")]
    assert "removes 98.1% [97.4%, 98.8%] of the gap (mean square)" in held_out_words(gap, viscous)
    nothing = gap.held_out[0].model_copy(update={"below_floor": 0.4})
    why = {"shrink": None, "shrink_why": "the gap is as likely below"}
    open_still = gap.model_copy(update=why | {"held_out": (nothing,)})
    assert held_out_words(open_still, viscous).startswith(
        "How much of the gap it removes on data that the fit has not seen is unknown: the gap"
    )
    within = held_out_words(open_still, ())
    assert within.startswith("On data that the fit has not seen the law is off by 0.0")
    assert within.endswith("(90% intervals). The two are consistent (p = 0.40).")
    refitted = held_out_words(open_still, viscous, "no-gap")
    assert "N rms (refitted with viscous: 0.0" in refitted
    assert refitted.endswith(" The law's error and scatter are consistent (p = 0.40).")
    assert held_out_words(gap, ()).endswith("a difference that chance does not explain.")
    below = nothing.model_copy(update={"floor": nothing.before})
    assert held_out_words(gap.model_copy(update={"held_out": (below,)}), ()).endswith(
        "is off by 0.052 N rms, no more than scatter alone makes (0.052 N on average)."
    )


@pytest.mark.parametrize(
    ("shrink", "words"),
    [
        (
            (0.28, 0.52, 1.2),
            "On data that the fit has not seen, 52% [28%, 120%] is removed: a consistent but rough "
            "figure, since scatter alone makes",
        ),
        (
            (0.97, 0.98, 0.99),
            "On data that the fit has not seen, 98.0% [97.0%, 99.0%] is removed, which confirms th",
        ),
        (
            (0.85, 0.88, 0.93),
            "On data that the fit has not seen, 88.0% [85.0%, 93.0%] is removed. Rely on this "
            "lower figure: 98.5% is the model's own",
        ),
    ],
)
def test_of_two_shares_it_is_said_which_to_rely_on(shrink, words):
    """The model says 98.5 % (97 to 99.5): within, alike, and above what is measured."""

    def share(low, middle, high):
        return interval(middle).model_copy(update={"q05": low, "q50": middle, "q95": high})

    of_model = share(0.97, 0.985, 0.995)
    gap = diagnosis().gap.model_copy(update={"shrink": share(*shrink), "shrink_of_model": of_model})
    assert held_out_words(gap, [cause("viscous")], "named").startswith(words)
    # Where the sentence before it has no share, there is nothing to compare.
    assert "adding it removes" in held_out_words(gap, [cause("viscous")], "no-gap")
