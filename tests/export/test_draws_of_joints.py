"""Draws of a joint that is exported are those that its intervals tell."""

import numpy as np
import pytest
import xarray as xr

from bayesfric.export.joints import _drawn_effects, _drawn_law
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import Cause, EffectNumber, LawNumber

DRAWS = np.random.default_rng(1).normal(0.5, 0.01, 1001)


def test_draws_of_a_number_are_as_wide_as_it_is_told_and_in_their_order():
    """Three times as wide by held-out data, and elsewhere by an instrument."""
    value = Interval(mean=0.6, sd=0.03, q05=0.55, q50=0.6, q95=0.66)
    law = {"coulomb": LawNumber.model_construct(after=value, least_squares=None)}
    block = DiagnosisFile.model_construct(law=law, causes=(), enter=())
    stored = xr.Dataset({"c2": (("draw", "pulley"), DRAWS[:, None])})
    drawn = _drawn_law(block, stored)["coulomb"]
    assert np.quantile(drawn, (0.05, 0.5, 0.95)) == pytest.approx((0.55, 0.6, 0.66))
    np.testing.assert_array_equal(np.argsort(drawn), np.argsort(DRAWS))


def test_draws_of_a_cause_are_told_where_it_acts_and_nothing_elsewhere():
    amplitude = EffectNumber.model_construct(mean=2.0, sd=0.2, q05=1.7, q50=2.0, q95=2.4)
    cause = Cause.model_construct(effect="air-drag", parameters={"coefficient": amplitude})
    block = DiagnosisFile.model_construct(law={}, causes=(cause,), enter=())
    amplitude = np.where(np.arange(1001) < 901, DRAWS, 0.0)
    stored = xr.Dataset({"amplitude": (("draw", "effect"), amplitude[:, None])},
                        coords={"effect": ["air-drag"]})  # fmt: skip
    drawn = _drawn_effects(block, stored)["air-drag.coefficient"]
    assert np.quantile(drawn[:901], (0.05, 0.5, 0.95)) == pytest.approx((1.7, 2.0, 2.4))
    assert not drawn[901:].any()
