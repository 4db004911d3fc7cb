"""Each effect is seen against its own claim, and against no other.

By a quick look at few data; whole verdicts are judged nightly, in tests/campaigns.
"""

import pytest
from altered import by_acceleration, one_size
from screening import screen_claims

from bayesfric.analysis import ClaimRules
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording

FEW = Protocol({(9, 85.0): 1, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 16.0, 28.0), (6.0, 28.0), 2)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("effect", "fallen"),
    [
        # A force that grows with speed is seen on both boards.
        ("viscous", {"no-viscous-motor", "no-viscous-gravity"}),
        ("tension-curvature", {"linear-in-tension"}),
    ],
)
def test_an_effect_is_seen_against_its_claim_and_no_other(effect, fallen):
    recording = simulate_recording(FEW, seed=3, effects={effect: 1.0})
    screened = screen_claims(by_acceleration(one_size(recording, "medium")))
    assert {"no-stribeck", "linear-in-wrap", "proportional-to-pulleys"} <= set(screened)
    limit = ClaimRules().refute_log10_bayes_factor
    # Beyond three errors of the importance draws, so that no verdict hangs on these.
    assert {n for n, (value, error) in screened.items() if value + 3 * error < limit} == fallen
