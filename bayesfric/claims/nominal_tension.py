"""The nominal tensions that the paper quotes follow from its Table I."""

from bayesfric.claims.base import Case, Claim, Finding
from bayesfric.paper import paper
from bayesfric.physics.motor import MotorCondition, motor_friction
from bayesfric.physics.motor import nominal_tension as tension_of
from bayesfric.recording.tables import STANDARD_GRAVITY
from bayesfric.simulate import table1_coefficients


def _judge(claim: Claim, case: Case) -> Finding:
    """Arithmetic: no data, no probability."""
    if lack := claim.untestable(case.entered):
        return Finding("not-testable", lack)
    quoted = paper()["nominal_tension"]
    tolerance = case.analysis.claims.tension_tolerance_n
    condition = MotorCondition(
        quoted["n_pulleys"],
        quoted["wrap_angle_deg"],
        quoted["hanging_mass_kg"],
        1.0,
        STANDARD_GRAVITY,
    )
    figures = {}
    for size, law in table1_coefficients().items():
        tension = float(tension_of(condition, motor_friction(law, condition)))
        figures[f"{size}_n"] = tension
        figures[f"{size}_less_quoted_n"] = tension - quoted[f"{size}_n"]
    worst = max(abs(figures[f"{size}_less_quoted_n"]) for size in table1_coefficients())
    return Finding(
        "supported" if worst <= tolerance else "refuted",
        f"Eq. (16) gives the quoted tensions within {worst:.2f} N. This is arithmetic on Table I "
        "and does not depend on these data.",
        figures | {"tolerance_n": tolerance},
        why="arithmetic has no rival",
    )


CLAIM = Claim(
    name="nominal-tension",
    place=13,
    statement="The paper's Table I and a weight of 1.5 kg give the quoted nominal tensions.",
    paper="15.8, 15.1 and 15.0 N for small, medium and large pulleys, n = 9, 85° (Fig. 5).",
    judge=_judge,
    about_these_data=False,
)
