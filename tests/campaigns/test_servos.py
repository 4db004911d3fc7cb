"""Servos of which commands alone are logged: what is told holds, and nothing absolute without K."""

import pytest
from campaigns import servos


@pytest.mark.nightly
@pytest.mark.parametrize("seed", servos.FIXED_SEEDS)
def test_what_is_told_of_a_servo_holds(seed):
    record = servos.case(seed)
    assert not record["false"], record["sentence"]
    assert record["absolute" if record["loaded"] else "relative"]
    for name, (truth, low, middle, high) in record["numbers"].items():
        assert abs(middle - truth) < 2 * (high - low), name
    truth, _, middle, _ = record["numbers"]["coulomb"]
    assert middle == pytest.approx(truth, rel=0.05)


def test_half_of_the_servos_carry_a_payload_that_was_weighed():
    loaded = [seed for seed in servos.SEEDS if servos.is_loaded(seed)]
    assert len(loaded) == 30
    assert {servos.servo(seed).gravity == 0 for seed in loaded} == {True, False}


def test_shares_are_of_the_intervals_that_were_told():
    cases = [
        {
            "seed": seed,
            "loaded": seed == 1,
            "numbers": {name: [1.0, 0.9, 1.02, 1.1 - 0.15 * seed] for name in servos.NAMES},
            "relative": seed == 0,
            "absolute": seed == 1,
            "false": [],
        }
        for seed in (0, 1)
    ]
    shares = servos.figures(cases)
    assert shares["numbers"]["coulomb"] == {"inside": 1, "of": 2, "median_off": pytest.approx(0.02)}
    outcomes = {outcome.promise: outcome.met for outcome in servos.promises(shares)}
    assert outcomes["without a payload all is over K"]
    assert not outcomes["truths of coulomb inside"]
