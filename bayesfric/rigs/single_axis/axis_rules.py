"""The thresholds for reading a log of a driven axis and for accepting its results.

Constants that only set the resolution of a computation are in the modules that use them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class AxisRules:
    """Thresholds of a driven axis; :func:`bayesfric.rules.rules_of` lists them.

    Each has a unit, a page of docs/decisions with its reasons, and a sentence on what it decides.

    Fields
    ------
    least_samples: a run with fewer samples is left out [samples; axis-windows]
    uneven: samples that are farther from an even grid are interpolated to a grid [interval;
        axis-windows]
    longest_hole: a longer gap between samples divides a log in two [intervals; axis-windows]
    sure_of_way: the direction of an axis is known if its speed exceeds its error by this factor
        [sd; axis-windows]
    quiet: a window is wide enough that the error of the position makes at most this part of the
        drive force [drive force; axis-windows]
    told_apart: and that the error of the acceleration is at most this part of what known forces and
        the law leave of it [1; axis-windows]
    windows_a_pass: a window is narrow enough that a pass contains this many [windows; axis-windows]
    narrowest: the half-width of a window is at least this [samples; axis-windows]
    narrowest_at_turns: the same if the axis reverses too soon for more samples [samples;
        axis-windows]
    often_spiked: if at least this part of the readings are spikes, spikes are a property of the
        sensor [readings; axis-windows]
    least_windows: a recording with fewer windows gives no result [windows; axis-windows]
    rows_a_number: a rough estimate has at most one coefficient for this many windows [windows;
        axis-windows]
    rows_a_load_number: the force at a load has at most one coefficient for this many windows
        [windows; axis-windows]
    forgotten: after this travel the direction from which the axis arrived no longer matters
        [stroke; axis-windows]
    late_explained: clocks are corrected if the corrected clocks leave at most this part of the
        squared residuals [1; axis-windows]
    early: a force may be early by this multiple of the usual difference of two clocks [1;
        axis-windows]
    limit_explained: a drive has a limit if a kink explains a larger part of the squared residuals
        of a line [1; axis-windows]
    limit_least_rows: and if this many windows are within the limit [windows; axis-windows]
    answers: fast forces shake the axis if the motion opposes them by at least this part [1;
        axis-windows]
    kept_of_dither: windows with dither are left out if at least this part of the windows remains
        [1; axis-windows]
    pulled: a force depends on position if it explains at least this part of the squared force [1;
        axis-windows]
    like_a_curve: the acceleration is a function of position if the rest is a smaller part of its
        square [1; axis-windows]
    acceleration_shows: inertia is reported beside a force of position if errors leave at least this
        part of the independent acceleration [1; axis-windows]
    given_force: the force of each run is given if it varies within runs by less than this part of
        the force of inertia [1; axis-windows]
    relaxes: a joint spins up if its speed explains a larger part of the mean square of its
        acceleration [1; axis-windows]
    one_force: forces along the speed that differ by a smaller part are a single force [1;
        axis-windows]
    no_friction: a joint has friction or inertia if it makes at least this part of the drive force
        [1; axis-windows]
    one_speed: speeds that differ by a smaller part are a single speed [1; axis-windows]
    own_length: a load gets its own ratio of mass to friction if this ratio explains more by this
        factor [1; axis-windows]
    least_length: play or wind-up of a load is reported if its length is at least this many standard
        deviations of a position [sd; axis-windows]
    few_runs: with fewer runs each run is cut into parts, so that some can be held out [trials;
        axis-windows]
    least_setups: with fewer assemblies there is no scatter between assemblies [assemblies;
        axis-windows]
    heavy_load: friction by the load is examined if the load of the gear is larger [friction;
        axis-windows]
    load_known: a gain of the gear is examined if the relative error of its load is smaller [1;
        axis-windows]
    rests_differ: friction after a rest is examined if the durations of rests differ by more [s;
        axis-windows]
    both_ways: loads are used if at least this part of the windows is at positions with motion in
        both directions [1; axis-windows]
    order_alike: work and order of runs with a larger correlation are not distinguished [1;
        axis-windows]
    contradicted: the data contradict a declared value if the difference is larger [sd;
        axis-windows]
    own_number: the data inform a declared value if its posterior error is below this part of the
        declared error [1; axis-windows]
    weak_instrument: instruments with a smaller F statistic are too weak [1; two-engines]
    instrument_differs: the loop biases least squares if chance makes the difference with a smaller
        probability [1; two-engines]
    instrument_matters: and if some coefficient differs by a larger part of its value [1;
        two-engines]
    instrument_errors: and by more standard errors of the difference [sd; two-engines]
    least_pieces: with fewer independent stretches the instruments are not compared, and their
        scatter is no error of a coefficient [stretches; two-engines]
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
    given_force: float = 0.2
    relaxes: float = 0.5
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
