import math

import pytest
import xarray as xr

from bayesfric.plots.rig_tables import RigTable
from bayesfric.probabilities import stated_of_draws
from bayesfric.report.quantities import (
    MISSING,
    error_cells,
    factor_cells,
    format_count,
    format_fixed,
    format_interval,
    format_number,
    format_probability,
    format_share,
    format_shift,
    format_unit,
    interval_cells,
    three_digits,
)
from bayesfric.report.rig_words import counted, law_words

THIN = "\u202f"


@pytest.mark.parametrize(
    ("interval", "unit", "text"),
    [
        ((0.012812, 0.01212, 0.01349), "-", "0.0128 [0.0121, 0.0135]"),
        ((0.0261, 0.0231, 0.03), "N", f"0.0261 [0.0231, 0.0300]{THIN}N"),
        ((2.79e-5, 2.71e-5, 2.87e-5), "1/deg", f"2.79 [2.71, 2.87] × 10⁻⁵{THIN}deg⁻¹"),
        ((-1e-7, -3e-4, 3e-4), "N", f"0.0 [−3.0, 3.0] × 10⁻⁴{THIN}N"),
        ((85.0, 84.1, 86.0), "deg", "85.0 [84.1, 86.0]°"),
        ((12345.0, 11000.0, 13000.0), "N/m", f"12300 [11000, 13000]{THIN}N/m"),
        ((5.0, 5.0, 5.0), None, "5.000 [5.000, 5.000]"),
        ((None, 1.0, 2.0), "N", "—"),
    ],
)
def test_an_interval_has_two_digits_of_its_width(interval, unit, text) -> None:
    assert format_interval(*interval, unit=unit) == text


def test_cells_share_their_decimals_under_the_power_that_the_head_states() -> None:
    assert interval_cells(7.37e-6, 7.0e-6, 7.74e-6, exponent=-5) == ("0.737", "0.700", "0.774")
    assert interval_cells(None, 1.0, 2.0) == ("—", "1.00", "2.00")
    assert format_unit("1/deg", exponent=-5) == f"10⁻⁵{THIN}deg⁻¹"


@pytest.mark.parametrize(
    ("value", "error", "cells"),
    [
        (9.0976, 0.18965, ("9.10", "0.19")),
        (275.338, 0.0577, ("275.338", "0.058")),
        (-2.7218, 0.0996, ("−2.72", "0.10")),
        (1234.6, 87.3, ("1235", "87")),
        (1.5, 0.0, ("1.500", "0.000")),
        (0.0, 0.02, ("0.000", "0.020")),
        (1.5, None, ("1.50", "—")),
        (None, None, ("—", "—")),
    ],
)
def test_a_value_and_its_error_end_at_the_second_digit_of_the_error(value, error, cells) -> None:
    assert error_cells(value, error) == cells


def test_priors_are_told_to_three_digits() -> None:
    rounded = three_digits("log-normal(median=0.0438168, sd_log=0.7), normal(0, 2.5e-05), 15000")
    assert rounded == "log-normal(median=0.0438, sd_log=0.7), normal(0, 2.5e-05), 15000"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0.00"),
        (-5.0, "−5.00"),
        (1234.567, "1230"),
        (0.00099996, "0.00100"),
        (-0.00012, "−1.20 × 10⁻⁴"),
        (999_999.0, "1.00 × 10⁶"),
        (None, "—"),
    ],
)
def test_a_number_keeps_three_digits(value, text) -> None:
    assert format_number(value) == text


def test_units_counts_shares_and_probabilities() -> None:
    assert format_unit("m/s^2") == "m/s²"
    assert format_unit("N*s/m^-1") == "N·s/m⁻¹"
    assert format_unit("-") == ""
    assert format_count(9999) == "9999"
    assert format_count(-1234567) == f"−1{THIN}234{THIN}567"
    assert format_share(0.1234) == f"12{THIN}%"
    shown = [format_probability(p) for p in (0, 1e-5, 0.004, 0.5, 0.967, 0.9999, 1, None)]
    assert shown == ["< 0.001", "< 0.001", "0.004", "0.50", "0.967", "> 0.999", "> 0.999", "—"]
    assert stated_of_draws(1, 200) == "> 0.985"  # none of 200: below 1.5 % at 95 %
    assert stated_of_draws(0, 3200) == "< 0.001"
    assert stated_of_draws(0.25, 200) == "0.25"


@pytest.mark.parametrize(
    "call",
    [
        lambda: format_number(math.nan),
        lambda: format_number(math.inf),
        lambda: format_number(1.0, digits=0),
        lambda: format_interval(1.0, 2.0, 1.5),
        lambda: interval_cells(1.0, math.nan, 1.5),
        lambda: format_probability(1.01),
        lambda: format_share(math.nan),
    ],
)
def test_what_is_no_number_is_refused(call) -> None:
    with pytest.raises(ValueError, match="expected"):
        call()


@pytest.mark.parametrize(
    ("law", "rigs", "words"),
    [
        ("paper", ["single-axis"], "driven axis's own"),
        ("viscous", ["single-axis"], "viscous"),
        ("paper", ["gravity"], "paper"),
    ],
)
def test_a_law_is_the_papers_on_its_own_boards_alone(law, rigs, words):
    assert law_words(law, rigs) == words


@pytest.mark.parametrize(
    ("count", "words"),
    [(1, "1 trial"), (2, "2 trials"), (12_000, f"12{THIN}000 trials")],
)
def test_one_trial_is_no_trials(count, words):
    rows = xr.Dataset(coords={"trial": range(count)})
    table = RigTable("motor_board", "motor board", "trial", "trials", "setup", "trial", rows, None)
    assert counted(table) == f"{words} of the motor board"


@pytest.mark.parametrize(
    ("value", "error", "cells"),
    [
        (582011.4, 21000.0, ("582000", "21000")),
        (25.295725, 0.000028, ("25.2957", "< 0.0001")),
        (0.0129, 0.00083, ("0.01290", "0.00083")),
        (-0.0001, 0.12, ("0.00", "0.12")),
    ],
)
def test_digits_by_the_error_and_six_at_most(value, error, cells):
    assert error_cells(value, error) == cells


@pytest.mark.parametrize(
    ("log10", "error", "cells"),
    [
        (-1015.847, 0.018, ("< −6", MISSING)),
        (7.2, 0.1, ("> 6", MISSING)),
        (2.3456, 0.021, ("2.346", "0.021")),
        (None, None, (MISSING, MISSING)),
    ],
)
def test_odds_beyond_a_million_are_told_as_that(log10, error, cells):
    assert factor_cells(log10, error) == cells


def test_a_shift_beyond_ten_is_told_as_that():
    assert format_shift(-54285.9) == "< −10"
    assert format_shift(10.5) == "> 10"
    assert format_shift(1.234) == "1.23"
    assert format_fixed(-0.0001, 1) == "0.0"
