"""The thresholds by which a log of a driven axis is read and believed, all in one place.

Numbers that only say how finely something is computed stand with what they are used for.
"""

from dataclasses import dataclass

from bayesfric.rules import rule

WINDOWS = "axis-windows"


@dataclass(frozen=True)
class AxisRules:
    """Thresholds of a driven axis; :func:`bayesfric.rules.rules_of` lists them."""

    least_samples: int = rule(16, "samples", "a run with fewer is left out", WINDOWS)
    uneven: float = rule(0.01, "interval", "samples farther from even are put on a grid", WINDOWS)
    longest_hole: float = rule(3.0, "intervals", "a longer hole parts a log in two", WINDOWS)
    sure_of_way: float = rule(
        4.0, "sd", "the way of an axis is known where its speed is larger than its noise", WINDOWS
    )
    quiet: float = rule(
        0.003, "drive force", "windows are as wide as makes the error by the position this", WINDOWS
    )
    told_apart: float = rule(
        0.1, "1", "and the acceleration's error this of what a known force leaves of it", WINDOWS
    )
    windows_a_pass: int = rule(4, "windows", "windows are so narrow that a pass has these", WINDOWS)
    narrowest: int = rule(8, "samples", "on either side of a window's middle, or more", WINDOWS)
    narrowest_at_turns: int = rule(
        4, "samples", "the same where an axis turns too soon for more", WINDOWS
    )
    often_spiked: float = rule(
        0.01, "readings", "from this share of them on spikes are a habit of a sensor", WINDOWS
    )
    least_windows: int = rule(8, "windows", "a recording with fewer tells nothing", WINDOWS)
    rows_a_number: int = rule(
        4, "windows", "a number of a rough estimate is told by at least so many", WINDOWS
    )
    rows_a_load_number: int = rule(
        6, "windows", "what pulls at a load is told by so many for each number", WINDOWS
    )
    forgotten: float = rule(
        0.2, "stroke", "after this way nobody need know by which way the axis came", WINDOWS
    )
    late_explained: float = rule(
        0.4, "1", "clocks are set right where this share of the squares is left, or less", WINDOWS
    )
    early: float = rule(
        3.0, "1", "a force may be early by this times what two clocks may be off by", WINDOWS
    )
    limit_explained: float = rule(
        0.5, "1", "a drive clips where a kink explains more of what a line leaves", WINDOWS
    )
    limit_least_rows: int = rule(10, "windows", "and so many lie within the limit", WINDOWS)
    answers: float = rule(
        0.5, "1", "quick forces shake the axis where the motion goes against them so far", WINDOWS
    )
    kept_of_dither: float = rule(
        0.2, "1", "shaken windows are left out where at least this share stays", WINDOWS
    )
    pulled: float = rule(
        0.02, "1", "something pulls to a place where it takes this share of the squares", WINDOWS
    )
    like_a_curve: float = rule(
        0.05, "1", "the acceleration is a curve over the place but for this part of it", WINDOWS
    )
    acceleration_shows: float = rule(
        0.5, "1", "inertia is told beside a pull where no error makes this part of its own", WINDOWS
    )
    one_force: float = rule(
        0.05, "1", "forces along the speed that differ by less than this part are one", WINDOWS
    )
    no_friction: float = rule(
        0.005, "1", "a joint has friction or inertia that takes this part of its force", WINDOWS
    )
    one_speed: float = rule(
        0.05, "1", "speeds that differ by less than this part are one speed", WINDOWS
    )
    own_length: float = rule(
        1.05, "1", "a load has shares of its own where these take so much more off", WINDOWS
    )
    least_length: float = rule(
        7.0, "sd", "a load's play or wind-up is told where positions resolve it so far", WINDOWS
    )
    few_runs: int = rule(6, "trials", "fewer runs are cut in parts, to hold some out", WINDOWS)
    least_setups: int = rule(3, "assemblies", "fewer do not scatter from one to another", WINDOWS)
    heavy_load: float = rule(
        0.3, "friction", "friction by the load is asked for where a gear carries more", WINDOWS
    )
    load_known: float = rule(
        0.05, "1", "a gear's gain can show where its load is known better than this", WINDOWS
    )
    rests_differ: float = rule(0.3, "s", "friction after a rest shows where rests differ", WINDOWS)
    both_ways: float = rule(
        0.5, "1", "a share of windows lies where the axis runs both ways, at least", WINDOWS
    )
    order_alike: float = rule(
        0.9, "1", "work and order of runs that correlate more are not told apart", WINDOWS
    )
    contradicted: float = rule(
        4.0, "sd", "a declared number that is farther off is contradicted by the data", WINDOWS
    )
    own_number: float = rule(
        0.95, "1", "data tell a declared number where its error falls below this part", WINDOWS
    )
    weak_instrument: float = rule(
        10.0, "1", "instruments whose F statistic is smaller tell too little", "two-engines"
    )
    instrument_differs: float = rule(
        1e-3, "1", "the loop bends numbers where chance makes less than this", "two-engines"
    )
    instrument_matters: float = rule(
        0.02, "1", "and some number differs by more than this part of itself", "two-engines"
    )
    least_pieces: int = rule(
        12, "stretches", "with fewer independent ones instruments are not compared", "two-engines"
    )


AXIS_RULES = AxisRules()
