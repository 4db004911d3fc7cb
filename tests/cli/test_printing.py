"""Lines of a terminal are broken between words, below their text."""

from bayesfric.cli.printing import wrapped


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
