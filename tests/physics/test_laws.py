"""The laws that claims compare with eq. (15): what a wrap angle does to each."""

import pytest

from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES, RIVAL_LAWS

LAW = Coefficients(0.0128, 0.0261, 2.79e-5)


@pytest.mark.parametrize(("wrap", "share"), [(85.0, 1.0), (60.0, 0.5 / 0.675590208), (180.0, None)])
def test_rival_laws_at_a_wrap_angle(wrap, share):
    """Without wrap n (c1 T + c2); with the bearings' load c1 sin(θ/2) / sin(42.5°) for c1."""
    share = share or 1 / 0.675590208
    expected = {"no-wrap": 9 * (0.0128 * 20 + 0.0261), "bearing-load": 9 * 0.0128 * share * 20}
    expected["bearing-load"] += 9 * 0.0261
    for name, friction in expected.items():
        computed = float(RIVAL_LAWS[name].at_tension(LAW, 9, wrap, 20.0))
        assert computed == pytest.approx(friction, rel=1e-8), name


def test_every_law_is_one_at_the_reference_wrap_angle():
    laws = [law for name, law in (BASELINES | RIVAL_LAWS).items() if name != "recursive"]
    frictions = [float(law.at_tension(LAW, 9, 85.0, 20.0)) for law in laws]
    assert frictions == pytest.approx([9 * (0.0128 * 20 + 0.0261)] * len(laws), rel=1e-12)
