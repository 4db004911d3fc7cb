"""The model in a page."""

from collections.abc import Iterator

from bayesfric.report.content import Block, Equation, Heading, Math, Paragraph
from bayesfric.report.stored import StoredResults

__all__ = ["methods"]


def methods(_: StoredResults) -> Iterator[Block]:
    """Yield law, likelihood and sampler."""
    yield Heading(1, "Method")
    yield Paragraph(
        [
            "The law is that of M. Miyasaka, J. Matheson, A. Lewis and B. Hannaford, "
            "“Measurement of the Cable-Pulley Coulomb and Viscous Friction for a Cable-Driven "
            "Surgical Robotic System”, IROS 2015, eqs. (15) and (16): friction of ",
            Math("n"),
            " pulleys with the average wrap angle ",
            Math("θ"),
            " in degrees at the nominal tension ",
            Math("T"),
            ",",
        ]
    )
    yield Equation(
        "f_c = n((c_1 + c_3(θ − 85))T + c_2)",
        "f c equals n times, in brackets, c 1 plus c 3 times theta minus 85, times T, plus c 2.",
        label="law",
    )
    yield Paragraph(
        [
            "On the gravity board the nominal tension is the mean of both sides and depends on "
            "the acceleration, which depends on friction; both are solved for together, in closed "
            "form. The friction of trial ",
            Math("j"),
            " on assembly ",
            Math("i"),
            " scatters around the law:",
        ]
    )
    yield Equation(
        "f_{ij} = f_c(1 + η_i + ε_{ij})",
        "f i j equals f c times one plus eta i plus epsilon i j.",
        label="scatter-law",
    )
    yield Paragraph(
        [
            "with ",
            Math("η_i"),
            " normal with standard deviation ",
            Math("ω"),
            " and ",
            Math("ε_{ij}"),
            " with ",
            Math("τ"),
            ". The data are the times of the Hall events. Each has a position error (",
            Math("σ_x"),
            ") and a clock error (",
            Math("σ_t"),
            ", beside the rounding of the clock). The phase of a sensor is uniform over one "
            "spacing and the first speed half-normal; both are integrated out in closed form, and "
            "so are ",
            Math("η_i"),
            " and ",
            Math("ε_{ij}"),
            ". Priors are listed with the diagnostics; none is derived from Table I.",
        ]
    )
    yield Paragraph(
        [
            "Draws come from emcee: nine moves in ten propose from a Student-t fitted around the "
            "posterior, independent of the walker's place, and the rest are differential "
            "evolution. A parameter counts as informed where the curvature of the likelihood alone "
            "pins it down better than its prior does.",
        ]
    )
