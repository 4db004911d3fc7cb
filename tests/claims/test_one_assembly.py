"""What needs several assemblies has a reason instead of a number where there is one.

A claim of one trial ended as a fault of bayesfric itself on its way to the file.
"""

import math

from reasons import explained

from bayesfric.claims import registered
from bayesfric.claims.base import Finding
from bayesfric.claims.checking import _result
from bayesfric.claims.entered import Entered


def test_the_error_of_one_assembly_is_missing_with_its_reason():
    finding = Finding("undecided", "Odds of 1 to 1.", {}, 0.1, 0.1, 0.5, math.inf)
    result = explained(_result(registered()[0], finding, Entered({})))
    assert (result.elpd_difference, result.elpd_difference_se) == (0.5, None)
    assert result.elpd_difference_se_why == "there is only one assembly"
