"""The model in a page."""

from collections.abc import Iterator

from bayesfric.report.content import Block, Equation, Heading, Math, Paragraph, Reference
from bayesfric.report.stored import StoredResults

__all__ = ["methods"]


def methods(stored: StoredResults) -> Iterator[Block]:
    """Yield law, likelihoods of the rigs that entered, and sampler."""
    yield Heading(1, "Method")
    yield from _law()
    if stored.fit.baseline == "recursive":
        yield from _recursive()
    if "gravity" in stored.fit.rigs:
        yield from _gravity()
    if "motor" in stored.fit.rigs:
        yield from _motor()
    yield Paragraph(
        [
            "Priors are proper and listed in ",
            Reference("diagnostics"),
            "; the default ones do not rest on Table I. Draws come from emcee: moves that propose "
            "from a Student-t fitted around the posterior, independent of the walker's place, "
            "mixed with differential evolution. A parameter counts as informed where the curvature "
            "of the likelihood alone pins it down better than its prior does.",
        ]
    )


def _law() -> Iterator[Block]:
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
            ", the mean of both ends, is",
        ]
    )
    yield Equation(
        "f_c = n((c_1 + c_3(θ − 85))T + c_2)",
        "f c equals n times, in brackets, c 1 plus c 3 times theta minus 85, times T, plus c 2.",
        label="law",
    )
    yield Paragraph(
        [
            "It opposes the motion. The tension depends on friction and friction on the tension; "
            "both are solved for together, in closed form. Friction of trial ",
            Math("j"),
            " on assembly ",
            Math("i"),
            " scatters around the law:",
        ]
    )
    yield Equation(
        "f_{ij} = f_c(1 + η_i + ε_{ij})",
        "f i j equals f c times, in brackets, one plus eta i plus epsilon i j.",
        label="scatter-law",
    )
    yield Paragraph(
        [
            "with ",
            Math("η_i"),
            " of standard deviation ",
            Math("ω"),
            " and ",
            Math("ε_{ij}"),
            " of scale ",
            Math("τ"),
            ". A second trial on the same assembly thus says less about the law than a new "
            "assembly does.",
        ]
    )


def _recursive() -> Iterator[Block]:
    yield Paragraph(
        [
            "This fit takes the law pulley by pulley: over pulley ",
            Math("k"),
            " the tension, ",
            Math("T_k"),
            " before it, drops by",
        ]
    )
    yield Equation(
        "Δ T_k = (c_1 + c_3(θ_k − 85))T_k + c_2",
        "delta T k equals, in brackets, c 1 plus c 3 times theta k minus 85, times T k, plus c 2.",
        label="recursive-law",
    )
    yield Paragraph(["and ", Math("f_c"), " is the sum of the drops."])


def _gravity() -> Iterator[Block]:
    yield Paragraph(
        [
            "The data of the gravity board are the times of the Hall events. Each has a position "
            "error (",
            Math("σ_x"),
            ") and a clock error (",
            Math("σ_t"),
            ", beside the rounding of the clock). The phase of a sensor is uniform over one "
            "spacing and the first speed half-normal; both are integrated out in closed form, and "
            "so are ",
            Math("η_i"),
            " and ",
            Math("ε_{ij}"),
            ".",
        ]
    )


def _motor() -> Iterator[Block]:
    yield Paragraph(
        [
            "The data of the motor board are the currents of the runs and of the idle motor. With "
            "the capstan radius ",
            Math("r"),
            ", the specified torque constant ",
            Math("k_t"),
            ", its factor ",
            Math("κ"),
            ", the weight ",
            Math("mg"),
            " and friction signed like the speed ",
            Math("v"),
            ", the current of a run is",
        ]
    )
    yield Equation(
        "I_{ij} = I_0(v) + \\frac{r}{κ k_t}(mg + f_{ij})",
        "I i j equals I zero of v plus r over kappa k t, times, in brackets, m g plus f i j.",
        label="motor-law",
    )
    yield Paragraph(
        [
            "with noise whose variance is ",
            Math("σ_I^2"),
            " plus the square of ",
            Math("λ"),
            " times the load current. The idle curve ",
            Math("I_0"),
            " is a parabola in the speed that all runs share; it is integrated out in closed form, "
            "and so is the scatter, which has ",
            Math("ω_\\text{motor}"),
            " and ",
            Math("τ_\\text{motor}"),
            " of its own.",
        ]
    )
