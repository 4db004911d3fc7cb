"""Units of a machine that turns, as the International System has them."""

import pytest

from bayesfric.rigs.rotary import rotary_unit


@pytest.mark.parametrize(
    ("slides", "turns"),
    [
        ("N", "N·m"),
        ("m", "rad"),
        ("kg", "kg·m²"),
        ("s/m", "s/rad"),
        ("m/s²", "rad/s²"),
        ("N s/m", "N·m s/rad"),
        ("s", "s"),
        ("1", "1"),
    ],
)
def test_a_unit_turns(slides, turns):
    assert rotary_unit(slides) == turns
