"""What the fit predicts, beside what was measured."""

from collections.abc import Iterator

import numpy as np

from bayesfric.plots.speed import friction_against_speed
from bayesfric.plots.style import to_svg
from bayesfric.plots.tension import friction_against_tension
from bayesfric.plots.trajectories import measured_and_predicted
from bayesfric.report.content import Block, Figure, Heading, Paragraph
from bayesfric.report.stored import StoredResults

__all__ = ["predictions"]

REFERENCE_ANGLE_DEG = 85.0


def _motor(stored: StoredResults) -> Iterator[Block]:
    yield Figure(
        to_svg(friction_against_speed(stored.predictive)),
        "Friction of the motor board against speed, as in the paper's Figs 4 to 7: runs (dots), "
        "and the 5 % to 95 % band of a new run on a new assembly (without the noise of the "
        "current). A viscous term would tilt the dots against the level bands.",
        "Panels for each pulley size of level bands of friction with scattered dots, one band for "
        "each weight, wrap angle and number of pulleys.",
        label="motor",
    )


def predictions(stored: StoredResults) -> Iterator[Block]:
    """Yield trajectories like the paper's Fig. 11 and friction against tension like Fig. 12."""
    yield Heading(1, "Measured and predicted")
    if "runs" in stored.predictive:
        yield from _motor(stored)
    if "trials" not in stored.predictive:
        return
    if "travel_m" in stored.predictive["trajectories"].data_vars:
        yield Paragraph(
            "The prediction starts with the speed that the trial had at its first event and runs "
            "free to the end of travel. Its band is that of a new trial on a new assembly, scatter "
            "included, so nine trials in ten should stay inside it."
        )
        yield Figure(
            to_svg(measured_and_predicted(stored.predictive)),
            "Travel against time of a slow and a fast trial of each size, as in the paper's "
            "Fig. 11: Hall events of one sensor (dots), predicted median and 5 % to 95 % band; "
            "below each, measured minus predicted.",
            "Panels of parabolas of travel against time with measured dots on the predicted line, "
            "and below each panel the difference in millimetres within its band.",
            label="trajectories",
        )
    angles = np.unique(stored.predictive["trials"]["wrap_angle_deg"].to_numpy()).tolist()
    angle = REFERENCE_ANGLE_DEG if REFERENCE_ANGLE_DEG in angles else angles[0]
    yield Figure(
        to_svg(friction_against_tension(stored.predictive, angle)),
        f"Friction of each trial against nominal tension at a wrap angle of {angle:g}°, as in the "
        "paper's Fig. 12. The shaded band of the law (5 % to 95 %, without scatter) should run "
        "through the points of each number of pulleys; the dashed line is Table I.",
        "One panel for each pulley size with straight bands rising with tension, steeper for more "
        "pulleys, through the measured points.",
        label="tension",
    )
