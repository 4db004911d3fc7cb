"""What the fit predicts, beside what was measured."""

from collections import Counter
from collections.abc import Iterator

from bayesfric.plots.speed import friction_against_speed
from bayesfric.plots.style import to_svg
from bayesfric.plots.tension import friction_against_tension
from bayesfric.plots.trajectories import measured_and_predicted
from bayesfric.report.content import Block, Code, Figure, Heading, Paragraph
from bayesfric.report.stored import StoredResults

__all__ = ["predictions"]

REFERENCE_ANGLE_DEG = 85.0
SOURCE = Code("predictive.nc")


def predictions(stored: StoredResults) -> Iterator[Block]:
    """Yield trajectories like the paper's Fig. 11, friction like Figs 12 and 4 to 7."""
    yield Heading(1, "Measured and predicted")
    if "trials" in stored.predictive:
        yield from _gravity(stored)
    if "runs" in stored.predictive:
        yield from _motor(stored)


def _gravity(stored: StoredResults) -> Iterator[Block]:
    if "travel_m" in stored.predictive["trajectories"].data_vars:
        yield Paragraph(
            "The prediction starts with the speed that the trial had at its first event and runs "
            "free to the end of travel. Its band is that of a new trial on a new assembly, scatter "
            "included, so nine trials in ten should stay inside it."
        )
        yield Figure(
            to_svg(measured_and_predicted(stored.predictive)),
            [
                "Travel against time of a fast and a slow trial of each size, as in the paper's "
                "Fig. 11; titles give the condition and the driving and the lifted mass. Dots are "
                "Hall events of one sensor (some of them above, all below). Below each trial, the "
                "residual, measured minus median: it should stay inside the band and follow a "
                "parabola from zero, as a constant error of friction makes it; an S or a wave "
                "would be a force that the law lacks. From ",
                SOURCE,
                ".",
            ],
            "Pairs of panels, one for each trial. In the upper ones travel rises with time along a "
            "parabola to the end of travel, and the measured dots lie on the predicted line. In "
            "the lower ones measured minus predicted, in millimetres, starts at zero and drifts "
            "slowly, within a band that widens with time.",
            label="trajectories",
        )
    counts = Counter(stored.predictive["trials"]["wrap_angle_deg"].to_numpy().tolist())
    angle = REFERENCE_ANGLE_DEG
    if angle not in counts:
        angle = max(sorted(counts), key=counts.__getitem__)
    yield Figure(
        to_svg(friction_against_tension(stored.predictive, angle)),
        [
            f"Friction of each trial against nominal tension at a wrap angle of {angle:g}°, as in "
            "the paper's Fig. 12: above in newtons, below relative to the law "
            "(numbers of pulleys side by side). Points should scatter evenly about the line, nine "
            "in ten within the pale bars; a bend, or a step from one number of pulleys to the "
            "next, would contradict the law. From ",
            SOURCE,
            ".",
        ],
        "Two panels for each pulley size. Above, straight lines of friction rise with tension, "
        "steeper for more pulleys, with the measured points on them. Below, the points as a "
        "percentage of the law scatter about a line at zero.",
        label="tension",
    )


def _motor(stored: StoredResults) -> Iterator[Block]:
    yield Figure(
        to_svg(friction_against_speed(stored.predictive)),
        [
            "Friction on the motor board against speed, as in the paper's Figs 4 to 7: runs "
            "(markers), and the 5 % to 95 % band of a new run on a new assembly, without the noise "
            "of the current, so that runs may scatter beyond it. A viscous term would tilt the "
            "runs against the level bands. From ",
            SOURCE,
            ".",
        ],
        "A column of panels for each pulley size; rows vary the weight, the wrap angle and the "
        "number of pulleys. Each panel has level bands of friction, one for each value, with "
        "markers scattered about them at all speeds.",
        label="motor",
    )
