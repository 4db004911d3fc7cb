"""What the fit predicts, beside what was measured, and what the paper says of it."""

from collections import Counter
from collections.abc import Iterator
from functools import partial
from math import isnan

from bayesfric.plots.rig_tables import RigTable, rig_tables
from bayesfric.plots.slopes import friction_against_wrap, line_against_pulleys, wrap_slopes
from bayesfric.plots.speed import friction_against_speed, has_speeds
from bayesfric.plots.style import svg_of
from bayesfric.plots.tension import friction_against_tension, tension_charts
from bayesfric.plots.trajectories import measured_and_predicted
from bayesfric.report.content import (
    Block,
    Emphasis,
    Figure,
    Heading,
    Inline,
    Paragraph,
    Reference,
    prose,
)
from bayesfric.report.quantities import format_number, format_probability
from bayesfric.report.stored import StoredFit

REFERENCE_ANGLE_DEG = 85.0
AGAIN = (
    "Grey bars: 90 % predictive intervals of a repeated recording, with new scatter on new "
    "assemblies."
)


def predictions(stored: StoredFit) -> Iterator[Block]:
    """Yield what is there of the paper's Figs 11 and 12, and 4 to 7."""
    figures = [*_trajectories(stored)]
    figures += [_tension(stored)] if _holds(stored, "curves", "law_n") else []
    figures += [_speed(rig) for rig in rig_tables(stored.predictive) if has_speeds(rig)]
    if figures:
        yield Heading(1, "Measured and predicted")
        yield from figures


def further_predictions(stored: StoredFit) -> Iterator[Block]:
    """Yield the paper's further steps, from lines in tension to slopes in the wrap angle."""
    figures = list(_slopes(stored)) if _holds(stored, "curves", "law_n") else []
    if figures:
        yield Heading(2, "The paper's own steps")
        yield Paragraph(
            prose(
                "{} to {} show the slope of friction in tension, and the slopes of that in the "
                "number of pulleys and the wrap angle. The posterior does not use these steps: its "
                "bands come from all trials at once.",
                Reference(str(figures[0].label)),
                Reference(str(figures[-1].label)),
            )
        )
        yield from figures


def _caption(text: str, paper: str) -> list[Inline]:
    """Return a caption that ends with what the paper says, and where the numbers are from."""
    return prose("{} {} {} From `predictive.nc`.", text, Emphasis("In the paper:"), paper)


def _trajectories(stored: StoredFit) -> Iterator[Block]:
    if not _holds(stored, "trajectories", "travel_m"):
        return
    yield Paragraph(
        prose(
            "The prediction of @trajectories starts from the speed that the trial had at its "
            "first event and simulates it to the end of travel. The band is the 90 % predictive "
            "interval of a new trial on a new assembly, scatter included."
            # the sentence that leads to the figure over tension, where there is one
            + " @tension shows the friction of each trial."
            * _holds(stored, "curves", "law_n")
        )
    )
    yield Figure(
        svg_of(measured_and_predicted, stored.predictive),
        _caption(
            "Travel against time, as in the paper's Fig. 11: one fast and one slow trial of each "
            "pulley size. Titles give the condition, the driving mass and the lifted mass. Dots "
            "are Hall events of one sensor: some of them in the upper panel, all in the lower one. "
            "The lower panel has the residual, measured minus predicted median, which should stay "
            "inside the band. A constant error of friction makes this residual a parabola from "
            "zero; an S or a wave means that the law lacks a force.",
            "trajectories fit without a viscous term, with R² of a trial often above 0.95"
            f"{_least(stored, 'least_trial_r_squared', 'trial')}.",
        ),
        "Pairs of panels, one for each trial. In the upper ones travel rises with time along a "
        "parabola to the end of travel, and the measured dots lie on the predicted line. In "
        "the lower ones measured minus predicted, in millimetres, starts at zero and drifts "
        "slowly, within a band that widens with time.",
        label="trajectories",
        floats=True,
    )


def _tension(stored: StoredFit) -> Figure:
    counts = Counter(stored.predictive["trials"]["wrap_angle_deg"].to_numpy().tolist())
    angle = REFERENCE_ANGLE_DEG
    if angle not in counts:
        angle = max(sorted(counts), key=counts.__getitem__)
    return Figure(
        svg_of(friction_against_tension, stored.predictive, angle),
        _caption(
            f"Friction of each trial against nominal tension at a wrap angle of {angle:g}°, as in "
            "the paper's Fig. 12: above in newtons, below relative to the law "
            "(numbers of pulleys side by side). Points should scatter evenly about the line, nine "
            "in ten within the pale bars; a bend, or a step from one number of pulleys to the "
            "next, would contradict the law.",
            "friction is linear in tension at 85°, with R² above 0.99 for each line"
            f"{_least(stored, 'least_r_squared', 'line, at any angle,')}.",
        ),
        "Two panels for each pulley size. Above, straight lines of friction rise with tension, "
        "steeper for more pulleys, with the measured points on them. Below, the points as a "
        "percentage of the law scatter about a line at zero.",
        label="tension",
        floats=True,
        charts=partial(tension_charts, stored.predictive, angle),
        beside=True,
    )


def _least(stored: StoredFit, name: str, of: str) -> str:
    """Return the least R² of this recording as a clause, where there is one."""
    table = stored.predictive["tension_lines"]
    if name not in table.data_vars or isnan(value := float(table[name])):
        return ""
    # Below 0 a constant would fit better, which is no share.
    written = format_probability(value) if value >= 0 else format_number(value)
    return f"; the least R² of a {of} is {written} here"


def _slopes(stored: StoredFit) -> Iterator[Figure]:
    """Yield what rests on straight lines in tension and in the wrap angle, where there are any."""
    if (
        _holds(stored, "tension_lines", "slope")
        and stored.predictive["tension_lines"]["upright"].to_numpy().any()
    ):
        yield Figure(
            svg_of(line_against_pulleys, stored.predictive),
            _caption(
                "Slope and intercept of the least-squares lines of friction against tension at "
                f"85°, over the number of pulleys, as in the paper's Fig. 13. {AGAIN} Points off "
                "the line through the origin would mean an offset: friction that no pulley makes.",
                "both are proportional to n, without an offset, eqs. (6) and (7); per pulley they "
                "are c1 and c2.",
            ),
            "Two panels for each pulley size, slope above and intercept below. Measured points lie "
            "on straight lines that rise from the origin with the number of pulleys.",
            label="pulleys",
            floats=True,
        )
    if not _holds(stored, "wrap_lines", "slope_n_per_deg"):
        return
    yield Figure(
        svg_of(friction_against_wrap, stored.predictive),
        _caption(
            "Friction against the wrap angle for each number of pulleys at three tensions, as in "
            "the paper's Fig. 14. Each point is read off the least-squares line of its trials "
            f"against tension, within the tensions measured. {AGAIN}",
            "friction is linear in the wrap angle at each n and T.",
        ),
        "A grid of panels, a row for each number of pulleys and a column for each pulley size. In "
        "each, three nearly level lines, one for each tension, rise slightly with the wrap angle, "
        "with the measured points on them.",
        label="wrap",
        floats=True,
    )
    yield Figure(
        svg_of(wrap_slopes, stored.predictive),
        _caption(
            "Slopes of these lines over the wrap angle, above against the number of pulleys and "
            f"below against tension, like the paper's Figs 15 and 16. {AGAIN}",
            "the slope is proportional to n, eqs. (10) and (11), and to T. At zero tension "
            "this term vanishes (9), so c2 does not depend on the wrap angle.",
        ),
        "Two panels for each pulley size. The slope in the wrap angle rises from the origin in "
        "proportion to the number of pulleys above, and to tension below.",
        label="wrap-slopes",
        floats=True,
    )


def _holds(stored: StoredFit, group: str, name: str) -> bool:
    return group in stored.predictive and name in stored.predictive[group].data_vars


def _speed(rig: RigTable) -> Figure:
    return Figure(
        svg_of(friction_against_speed, rig),
        _caption(
            f"Friction on the {rig.title} against speed, as in the paper's Figs 4 to 7: "
            f"{rig.trials} (markers), and the 5 % to 95 % band of a new {rig.trial} on a new "
            f"assembly, without the noise of the sensor, so that {rig.trials} may scatter beyond "
            f"it. A viscous term would tilt the {rig.trials} against the level bands.",
            "friction does not depend on speed, at any tension (Figs 4 and 5), wrap angle (Fig. 6) "
            "or number of pulleys (Fig. 7).",
        ),
        "A column of panels for each pulley size; rows vary the weight, the wrap angle and the "
        "number of pulleys. Each panel has level bands of friction, one for each value, with "
        "markers scattered about them at all speeds.",
        label=f"speed-{rig.trials}",
    )
