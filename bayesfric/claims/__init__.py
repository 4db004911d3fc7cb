"""The paper's claims, one a file: each compared with rivals, and judged by stated rules.

A file of this folder that holds a ``CLAIM`` is a claim; there is no list to add it to.
"""

from bayesfric.claims.base import Claim
from bayesfric.claims.checking import Checked, check_claims, registered

__all__ = ["Checked", "Claim", "check_claims", "registered"]
