"""A declared mass beside what the data say of it."""

import pytest

from bayesfric.recording.tables import RigConstants
from bayesfric.rigs.single_axis.declared import doubts
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber


@pytest.mark.parametrize(
    ("by_instrument", "said"), [(True, "1.8 ± 0.05"), (False, "1.902 ± 0.053")]
)
def test_a_declared_mass_is_taken_off_where_it_was_a_prior_alone(by_instrument, said):
    """1.8 ± 0.05 beside 1.0 ± 0.149 (0.11, and a tenth of what scales the force): of a
    posterior the data alone say (720 − 45.2) / 354.8 kg.
    """
    estimate = Interval.of_normal(1.8, 0.05)
    fitted = estimate if by_instrument else None
    number = LawNumber(unit="kg", before=estimate, after=estimate, least_squares=fitted)
    constants = RigConstants(moving_mass_kg=1.0, mass_sd_kg=0.11)
    (line,) = doubts(constants, {"inertia": number}, 1.8)
    assert f"the data give {said} kg" in line
