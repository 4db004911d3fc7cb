"""Smooth forces against the Gaussian process that they stand for."""

import numpy as np
from diagnosis.boards import model_of

from bayesfric.inference.smooths import NARROW, SHARP, WHOLE, Span, smooth_along

PLACES = np.linspace(2.0, 5.0, 40)


def squared_exponential(values, span):
    return np.exp(-0.5 * ((values[:, None] - values) / (span / 3)) ** 2)


def test_covariance_is_that_of_the_kernel():
    columns = smooth_along({"tension": Span(2.0, 5.0)}).columns({"tension": PLACES})
    kernel = squared_exponential(PLACES, 3.0)
    # 1 % of the variance is cut off; at the ends somewhat more of it.
    np.testing.assert_allclose(columns.T @ columns, kernel, atol=0.1)


def test_a_relative_force_is_twice_as_narrow():
    columns = smooth_along({"order": Span(2.0, 5.0)}, length=NARROW).columns({"order": PLACES})
    np.testing.assert_allclose(columns.T @ columns, squared_exponential(PLACES, 1.5), atol=0.1)


def test_two_axes_are_a_product():
    rng = np.random.default_rng(0)
    where = {"velocity": rng.uniform(0, 1, 30), "tension": rng.uniform(2, 5, 30)}
    smooth = smooth_along({"velocity": Span(0.0, 1.0), "tension": Span(2.0, 5.0)})
    columns = smooth.columns(where)
    kernel = squared_exponential(where["velocity"], 1.0) * squared_exponential(
        where["tension"], 3.0
    )
    np.testing.assert_allclose(columns.T @ columns, kernel, atol=0.1)


def test_what_does_not_vary_has_no_smooth():
    assert smooth_along({"wrap_angle": Span.of(np.ones(3))}) is None


def test_outside_the_range_a_force_is_that_of_the_edge():
    smooth = smooth_along({"tension": Span(2.0, 5.0)})
    beyond, edge = (smooth.columns({"tension": np.array([at])}) for at in (9.0, 5.0))
    np.testing.assert_array_equal(beyond, edge)


def test_a_constant_has_no_axis():
    smooth = smooth_along({}, "motor", relative=True)
    columns = smooth.columns({"tension": PLACES, "velocity": PLACES})
    np.testing.assert_array_equal(columns, np.ones((1, PLACES.size)))
    assert (smooth.count, smooth.axis) == (1, "rig")


def test_few_values_are_taken_one_by_one():
    """The covariance between the values is the kernel's, whatever lies between."""
    values = np.array([5.0, 9.0, 15.0, 19.0])
    smooth = smooth_along({"n_pulleys": Span.of(np.repeat(values, 7))})
    columns = smooth.columns({"n_pulleys": values})
    assert smooth.count <= 4
    kernel = np.exp(-0.5 * ((values[:, None] - values) / (14.0 / 3)) ** 2)
    np.testing.assert_allclose(columns.T @ columns, kernel, atol=0.1)


def test_a_worn_spot_is_had_without_forces_that_cancel():
    """A twentieth of the travel long: functions too wide would need large ones that cancel."""
    travel = np.linspace(0.0, 0.6, 200)
    spot = np.exp(-0.5 * ((travel - 0.28) / 0.03) ** 2)

    def fitted(smooth):
        columns = smooth.columns({"displacement": travel})
        numbers = np.linalg.lstsq(columns.T, spot, rcond=None)[0]
        return np.linalg.norm(numbers), (spot - numbers @ columns).std() / spot.std()

    along = {"displacement": Span(0.0, 0.6)}
    size, left = fitted(smooth_along(along, relative=True, length=SHARP, kept=WHOLE))
    assert size < 2.0
    assert left < 0.1
    assert fitted(smooth_along(along, relative=True, length=NARROW))[1] > 0.4


def test_a_law_of_decades_of_speed_is_had_along_a_logarithmic_axis():
    """Functions of speed itself leave three times as much of what changes, rms."""
    speed = np.linspace(0.01, 1.0, 300)
    law = np.log1p(speed / 0.02)
    law -= law.mean()

    def left(logarithmic):
        along = {"velocity": Span(0.0, 1.0, logarithmic=logarithmic)}
        columns = smooth_along(along, relative=True, length=NARROW).columns({"velocity": speed})
        numbers = np.linalg.lstsq(columns.T, law, rcond=None)[0]
        return np.std(law - numbers @ columns)

    assert left(logarithmic=True) < left(logarithmic=False) / 3


def test_places_along_a_logarithmic_axis():
    span = Span(1.0, 3.0, logarithmic=True)
    places = span.place(np.array([0.0, 1.0, 1.04, 3.0, 9.0]))
    np.testing.assert_allclose(places, [0.0, 0.0, np.log(2) / np.log(51), 1.0, 1.0])


def test_what_differs_between_two_ends_is_an_effect_where_that_is_examined():
    """The same force twice, the likelier of which would be the one without a name."""
    assert "drive_end" in model_of(("viscous",)).acting_axes
    assert "drive_end" not in model_of(("viscous", "end-asymmetry")).acting_axes
