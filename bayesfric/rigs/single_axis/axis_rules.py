"""The thresholds by which a log of a driven axis is read and believed, all in one place.

Numbers that only say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class AxisRules:
    """Thresholds of a driven axis; :func:`bayesfric.rules.rules_of` lists them.

    Each has its unit, the page of docs/decisions where it is argued, and what it decides.

    Fields
    ------
    least_samples: a run with fewer is left out [samples; axis-windows]
    uneven: samples farther from even are put on a grid [interval; axis-windows]
    longest_hole: a longer hole parts a log in two [intervals; axis-windows]
    sure_of_way: the way of an axis is known where its speed is larger than its noise [sd;
        axis-windows]
    quiet: windows are as wide as makes the error by the position this [drive force; axis-windows]
    told_apart: and the acceleration's error this of what a known force leaves of it [1;
        axis-windows]
    windows_a_pass: windows are so narrow that a pass has these [windows; axis-windows]
    narrowest: on either side of a window's middle, or more [samples; axis-windows]
    narrowest_at_turns: the same where an axis turns too soon for more [samples; axis-windows]
    often_spiked: from this share of them on spikes are a habit of a sensor [readings; axis-windows]
    least_windows: a recording with fewer tells nothing [windows; axis-windows]
    rows_a_number: a number of a rough estimate is told by at least so many [windows; axis-windows]
    rows_a_load_number: what pulls at a load is told by so many for each number [windows;
        axis-windows]
    forgotten: after this way nobody need know by which way the axis came [stroke; axis-windows]
    late_explained: clocks are set right where this share of the squares is left, or less [1;
        axis-windows]
    early: a force may be early by this times what two clocks may be off by [1; axis-windows]
    limit_explained: a drive clips where a kink explains more of what a line leaves [1;
        axis-windows]
    limit_least_rows: and so many lie within the limit [windows; axis-windows]
    answers: quick forces shake the axis where the motion goes against them so far [1; axis-windows]
    kept_of_dither: shaken windows are left out where at least this share stays [1; axis-windows]
    pulled: something pulls to a place where it takes this share of the squares [1; axis-windows]
    like_a_curve: the acceleration is a curve over the place but for this part of it [1;
        axis-windows]
    acceleration_shows: inertia is told beside a pull where no error makes this part of its own [1;
        axis-windows]
    one_force: forces along the speed that differ by less than this part are one [1; axis-windows]
    no_friction: a joint has friction or inertia that takes this part of its force [1; axis-windows]
    one_speed: speeds that differ by less than this part are one speed [1; axis-windows]
    own_length: a load has shares of its own where these take so much more off [1; axis-windows]
    least_length: a load's play or wind-up is told where positions resolve it so far [sd;
        axis-windows]
    few_runs: fewer runs are cut in parts, to hold some out [trials; axis-windows]
    least_setups: fewer do not scatter from one to another [assemblies; axis-windows]
    heavy_load: friction by the load is asked for where a gear carries more [friction; axis-windows]
    load_known: a gear's gain can show where its load is known better than this [1; axis-windows]
    rests_differ: friction after a rest shows where rests differ [s; axis-windows]
    both_ways: a share of windows lies where the axis runs both ways, at least [1; axis-windows]
    order_alike: work and order of runs that correlate more are not told apart [1; axis-windows]
    contradicted: a declared number that is farther off is contradicted by the data [sd;
        axis-windows]
    own_number: data tell a declared number where its error falls below this part [1; axis-windows]
    weak_instrument: instruments whose F statistic is smaller tell too little [1; two-engines]
    instrument_differs: the loop bends numbers where chance makes less than this [1; two-engines]
    instrument_matters: and some number differs by more than this part of itself [1; two-engines]
    instrument_errors: and by more errors of the difference [sd; two-engines]
    least_pieces: with fewer independent ones instruments are not compared [stretches; two-engines]
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
    one_force: float = 0.05
    no_friction: float = 0.005
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
