"""What ``check`` says beforehand comes true: errors, what can be told, and what cannot."""

import pytest
from campaigns import checks


@pytest.mark.nightly
@pytest.mark.parametrize("seed", checks.FIXED_SEEDS)
def test_what_check_says_comes_true(seed):
    record = checks.case(seed)
    assert not record["false"]
    assert record["said"] != "can" or record["found"]
    assert record["said"] != "cannot" or not record["named"]


def test_designs_have_every_effect_strong_and_weak_in_every_log():
    designs = [checks.design(seed) for seed in checks.SEEDS]
    acting = [design for design in designs if design[0]]
    assert len(acting) == 40
    assert {effect for effect, _, _ in acting} == set(checks.SIZES)
    assert {strength for _, strength, _ in acting} == set(checks.STRENGTHS)
    assert {cut for _, _, cut in designs} == set(checks.CUTS)
