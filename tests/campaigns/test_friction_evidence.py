"""Bridge sampling of friction models agrees with importance samples of 300,000 draws.

The paper's law is repeated nightly and compared with the evidence.
"""

import numpy as np
import pytest
from campaigns import evidence, friction_evidence


@pytest.mark.nightly
def test_the_law_agrees_and_repeats():
    now = friction_evidence.case(friction_evidence.FIXED)
    assert all(
        outcome.met for outcome in friction_evidence.promises(friction_evidence.figures([now]))
    )
    (then,) = evidence.read("friction_evidence")["fixed"]
    for method in ("bridge", "importance"):
        error = np.hypot(now[f"{method}_error"], then[f"{method}_error"])
        assert abs(now[method] - then[method]) < 4 * error
