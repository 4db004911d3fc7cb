"""The thresholds by which a log of a driven axis is read and believed, all in one place.

Numbers that only say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class AxisRules:
    """Thresholds of a driven axis; :func:`bayesfric.rules.rules_of` lists them.

    Each has its unit, the page of docs/decisions where it is argued, and what it decides.

    Parameters
    ----------
    least_samples : samples (axis-windows)
        a run with fewer is left out
    uneven : interval (axis-windows)
        samples farther from even are put on a grid
    longest_hole : intervals (axis-windows)
        a longer hole parts a log in two
    sure_of_way : sd (axis-windows)
        the way of an axis is known where its speed is larger than its noise
    quiet : drive force (axis-windows)
        windows are as wide as makes the error by the position this
    told_apart : 1 (axis-windows)
        and the acceleration's error this of what a known force leaves of it
    windows_a_pass : windows (axis-windows)
        windows are so narrow that a pass has these
    narrowest : samples (axis-windows)
        on either side of a window's middle, or more
    narrowest_at_turns : samples (axis-windows)
        the same where an axis turns too soon for more
    often_spiked : readings (axis-windows)
        from this share of them on spikes are a habit of a sensor
    least_windows : windows (axis-windows)
        a recording with fewer tells nothing
    rows_a_number : windows (axis-windows)
        a number of a rough estimate is told by at least so many
    rows_a_load_number : windows (axis-windows)
        what pulls at a load is told by so many for each number
    forgotten : stroke (axis-windows)
        after this way nobody need know by which way the axis came
    late_explained : 1 (axis-windows)
        clocks are set right where this share of the squares is left, or less
    early : 1 (axis-windows)
        a force may be early by this times what two clocks may be off by
    limit_explained : 1 (axis-windows)
        a drive clips where a kink explains more of what a line leaves
    limit_least_rows : windows (axis-windows)
        and so many lie within the limit
    answers : 1 (axis-windows)
        quick forces shake the axis where the motion goes against them so far
    kept_of_dither : 1 (axis-windows)
        shaken windows are left out where at least this share stays
    pulled : 1 (axis-windows)
        something pulls to a place where it takes this share of the squares
    like_a_curve : 1 (axis-windows)
        the acceleration is a curve over the place but for this part of it
    acceleration_shows : 1 (axis-windows)
        inertia is told beside a pull where no error makes this part of its own
    one_speed : 1 (axis-windows)
        speeds that differ by less than this part are one speed
    own_length : 1 (axis-windows)
        a load has shares of its own where these take so much more off
    least_length : sd (axis-windows)
        a load's play or wind-up is told where positions resolve it so far
    few_runs : trials (axis-windows)
        fewer runs are cut in parts, to hold some out
    least_setups : assemblies (axis-windows)
        fewer do not scatter from one to another
    heavy_load : friction (axis-windows)
        friction by the load is asked for where a gear carries more
    load_known : 1 (axis-windows)
        a gear's gain can show where its load is known better than this
    rests_differ : s (axis-windows)
        friction after a rest shows where rests differ
    both_ways : 1 (axis-windows)
        a share of windows lies where the axis runs both ways, at least
    order_alike : 1 (axis-windows)
        work and order of runs that correlate more are not told apart
    contradicted : sd (axis-windows)
        a declared number that is farther off is contradicted by the data
    own_number : 1 (axis-windows)
        data tell a declared number where its error falls below this part
    weak_instrument : 1 (two-engines)
        instruments whose F statistic is smaller tell too little
    instrument_differs : 1 (two-engines)
        the loop bends numbers where chance makes less than this
    instrument_matters : 1 (two-engines)
        and some number differs by more than this part of itself
    instrument_errors : sd (two-engines)
        and by more errors of the difference
    least_pieces : stretches (two-engines)
        with fewer independent ones instruments are not compared
    """

    least_samples: int = 16
    uneven: float = 0.01
    longest_hole: float = 3.0
    sure_of_way: float = 4.0
    quiet: float = 0.003
    told_apart: float = 0.1
    windows_a_pass: int = 4
    narrowest: int = 8
    narrowest_at_turns: int = 4
    often_spiked: float = 0.01
    least_windows: int = 8
    rows_a_number: int = 4
    rows_a_load_number: int = 6
    forgotten: float = 0.2
    late_explained: float = 0.4
    early: float = 3.0
    limit_explained: float = 0.5
    limit_least_rows: int = 10
    answers: float = 0.5
    kept_of_dither: float = 0.2
    pulled: float = 0.02
    like_a_curve: float = 0.05
    acceleration_shows: float = 0.5
    one_speed: float = 0.05
    own_length: float = 1.05
    least_length: float = 7.0
    few_runs: int = 6
    least_setups: int = 3
    heavy_load: float = 0.3
    load_known: float = 0.05
    rests_differ: float = 0.3
    both_ways: float = 0.5
    order_alike: float = 0.9
    contradicted: float = 4.0
    own_number: float = 0.95
    weak_instrument: float = 10.0
    instrument_differs: float = 1e-3
    instrument_matters: float = 0.02
    instrument_errors: float = 2.0
    least_pieces: int = 12


AXIS_RULES = AxisRules()
