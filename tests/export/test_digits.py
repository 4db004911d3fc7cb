"""A number has the digits that its error leaves of it, and no more."""

import pytest

from bayesfric.export.digits import by_error, rounded


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.0500312876, 0.00052, "0.05003"),
        (0.0500312876, 0.0098, "0.0500"),
        (0.0500312876, 0.00998, "0.050"),  # the error is 0.010
        (1.499987, 0.012, "1.500"),
        (1234.56, 41.0, "1235"),
        (1234.56, 410.0, "1230"),
        (-0.00001, 0.02, "0.000"),
        (2.34567e-13, 1.2e-15, "2.346e-13"),
        (8.123456789, None, "8.12346"),
        (8.123456789, 0.0, "8.12346"),
    ],
)
def test_two_digits_of_the_error_count(value, error, text):
    assert by_error(value, error) == text
    assert rounded(value, error) == float(text)
