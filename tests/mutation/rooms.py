"""Which modules are mutated, and the fast tests of each, those first that kill soonest."""

from pathlib import Path
from types import ModuleType

from bayesfric import inference, physics
from bayesfric.rigs import gravity_board

ROOT = Path(__file__).resolve().parents[2]
BOARD = "rigs/test_gravity_model rigs/test_measurements rigs/test_hall_events rigs/test_at_rest"
ROOMS: dict[ModuleType, dict[str, str]] = {
    physics: {
        "axis friction gravity": (
            "physics/test_gravity_board physics/test_recursive rigs/test_measurements"
        ),
        "cable": "physics/test_compliant_board",
        "laws": "physics/test_laws rigs/test_gravity_model rigs/test_measurements",
        "loads": "physics/test_loads effects/test_transmissions",
        "motor": "physics/test_motor_board rigs/test_motor",
        "stepped": "effects/test_readings effects/test_forces_on_trials",
    },
    inference: {
        "diagnostics": "inference/test_diagnostics",
        "pareto": "inference/test_diagnostics",
        "evidence/bridge": (
            "inference/test_conjugate inference/test_bridge inference/test_leave_out"
        ),
        "evidence/importance": "inference/test_importance",
        "evidence/leave_out": "inference/test_leave_out",
        "evidence/refit": "inference/test_leave_out fitting/test_left_out",
        "grouped_normal heavy_groups quadratic student": (
            "rigs/test_heavy_groups rigs/test_grouped_normal"
        ),
        "hierarchy": "fitting/test_pooling",
        "information": "diagnosis/test_information diagnosis/test_likelihood",
        "laplace": (
            "inference/test_laplace inference/test_separated_modes inference/test_importance"
        ),
        "model": (
            "inference/test_model rigs/test_gravity_model inference/test_coordinates"
            " fitting/test_pooling"
        ),
        "power": "inference/test_power",
        "priors": "inference/test_priors inference/test_coordinates",
        "proposals": "inference/test_sampling",
        "thresholds": "rigs/test_at_rest",
    },
    gravity_board: {
        "hall_events": "rigs/test_hall_events",
        "likelihood measurements": f"{BOARD} effects/test_effects_in_likelihood",
    },
}


def tests_of() -> dict[str, tuple[str, ...]]:
    """Return the files of tests of each module, by its path from the root."""
    tests_by_file = {}
    for room, rows in ROOMS.items():
        folder = Path(room.__path__[0]).relative_to(ROOT)
        for names, tests in rows.items():
            files = tuple(f"tests/{file}.py" for file in tests.split())
            tests_by_file |= {f"{folder / name}.py": files for name in names.split()}
    return tests_by_file
