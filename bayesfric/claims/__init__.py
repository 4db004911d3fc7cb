"""The paper's claims, one in each file: comparison with rivals, and verdict by stated rules.

Every file of this folder that defines ``CLAIM`` is a claim; there is no list of them.
"""

from bayesfric.claims.base import Claim
from bayesfric.claims.checking import Checked, check_claims, registered

__all__ = ["Checked", "Claim", "check_claims", "registered"]
