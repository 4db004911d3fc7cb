"""Where the paper contradicts itself, in numbers."""

from typing import NamedTuple

import numpy as np

from bayesfric.paper import paper
from bayesfric.physics.friction import coulomb_friction
from bayesfric.simulate import table1_coefficients


class Contradiction(NamedTuple):
    """Two statements of the paper that contradict each other.

    Parameters
    ----------
    topic : str
        Topic in a word or two.
    statement : str
        The contradiction in a sentence, with numbers.
    figures : dict of str to float
        These numbers.
    """

    topic: str
    statement: str
    figures: dict[str, float]


def contradictions() -> list[Contradiction]:
    """Return the paper's contradictions, computed from its own numbers."""
    said, robot, bearings = paper(), paper()["robot"], paper()["bearings"]
    stiffness = said["stiffness"]
    law = table1_coefficients()[stiffness["pulley_size"]]
    by_law = float(
        coulomb_friction(
            law, stiffness["n_pulleys"], stiffness["wrap_angle_deg"], stiffness["tension_n"]
        )
    )
    measured = stiffness["friction_model3_n"]
    off = measured / by_law - 1
    low, high = said["table2"]["average_wrap_angle_deg"]
    wrap = robot["wrap_angle_deg"]["large"]
    load = (
        2
        * robot["tension_max_n"]
        * np.sin(np.radians(said["table2"]["average_wrap_angle_deg"][1] / 2))
    )
    ratings = bearings["static_rating_n"]
    peak, tested = robot["velocity_peak_m_s"], said["table2"]["velocity_max_m_s"]
    return [
        Contradiction(
            "friction of one trial",
            f"Eq. (16) with Table I gives {by_law:.3f} N where Sec. III.B measured "
            f"{measured:.3f} N ({stiffness['pulley_size']}, n = {stiffness['n_pulleys']}, "
            f"{stiffness['wrap_angle_deg']:.0f}°, {stiffness['tension_n']} N): {off:.0%} off, more "
            f"than the {said['rigs']['difference_at_most']:.0%} that are allowed between rigs.",
            {"by_law_n": by_law, "measured_n": measured, "relative_difference": off},
        ),
        Contradiction(
            "wrap angle of large pulleys",
            f"On the robot the cable wraps large pulleys by {wrap:.0f}°. Table II states the law "
            f"for mean wrap angles of {low:.0f}° to {high:.0f}°.",
            {"robot_deg": wrap, "valid_to_deg": high},
        ),
        Contradiction(
            "load on the bearings",
            f"At {robot['tension_max_n']:.0f} N and {high:.0f}° a bearing carries 2 T sin(θ/2) = "
            f"{load:.0f} N; its static rating is {ratings['small']:.1f} N for small pulleys and "
            f"{ratings['medium']:.1f} N for the others.",
            {
                "load_n": float(load),
                "static_rating_small_n": ratings["small"],
                "static_rating_others_n": ratings["medium"],
            },
        ),
        Contradiction(
            "speed",
            f"The robot's cables peak at {peak:.0f} m/s; the law was tested to {tested} m/s.",
            {"robot_m_s": peak, "tested_m_s": tested},
        ),
    ]
