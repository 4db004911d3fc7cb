"""Fixed points of the parameters of each rig, by name."""

TABLE1 = {
    "c1[small]": 0.0131,
    "c1[medium]": 0.0041,
    "c1[large]": 0.0025,
    "c2[small]": 0.0255,
    "c2[medium]": 0.0170,
    "c2[large]": 0.0125,
    "c3[small]": 2.9e-5,
    "c3[medium]": 0.9e-5,
    "c3[large]": 0.8e-5,
}
STIFF = {name: 3 * value for name, value in TABLE1.items() if name.startswith("c1")}
SMOOTH = {name: 0.2 * value for name, value in TABLE1.items() if name.startswith("c1")}
FALLING = {name: -4 * value for name, value in TABLE1.items() if name.startswith("c3")}
LITTLE = {name: 1e-4 for name in TABLE1 if name.startswith("c2")}

GRAVITY = {
    **TABLE1,
    "tau": 0.012,
    "omega": 0.018,
    "omega_intercept": 0.035,
    "wander": 0.005,
    "wander_length": 0.11,
    "sigma_x": 3.2e-5,
    "sigma_t": 1.8e-5,
}
MOTOR = {
    **TABLE1,
    "tau_motor": 0.011,
    "omega_motor": 0.02,
    "omega_intercept_motor": 0.03,
    "torque_constant_factor": 1.01,
    "sigma_current": 0.0025,
    "load_noise": 0.006,
}
POINTS = {
    **TABLE1,
    "tau_steady-points": 0.012,
    "omega_steady-points": 0.02,
    "sigma_friction": 0.006,
}
AXIS = {
    "mass": 2.02,
    "coulomb": 1.55,
    "viscous": 0.3,
    "offset": 0.05,
    "tau": 0.011,
    "omega": 0.014,
    "wander": 0.02,
    "row_error": 1.1,
    "latency": 2e-4,
}
BASE = {"gravity": GRAVITY, "motor": MOTOR, "points": POINTS, "axis": AXIS}
"""In the bulk of each posterior."""


def _scatter(tau: str, omega: str, intercept: str | None = None) -> dict[str, dict[str, float]]:
    changes = {
        "tau near 0": {tau: 1e-7},
        "omega near 0": {omega: 1e-7},
        "tau and omega near 0": {tau: 1e-6, omega: 1e-6},
        "tau far out": {tau: 0.4},
        "omega far out": {omega: 0.5},
    }
    if intercept:
        changes["intercept scatter near 0"] = {intercept: 1e-7}
        changes["intercept scatter far out"] = {intercept: 0.6}
    return changes


LAWS = {
    "bulk": {},
    "three times the slope": STIFF,
    "a fifth of the slope": SMOOTH,
    "friction falls with wrap": FALLING,
    "hardly a constant part": LITTLE,
}
CHANGES: dict[str, dict[str, dict[str, float]]] = {
    "gravity": {
        **LAWS,
        **_scatter("tau", "omega", "omega_intercept"),
        "wander near 0": {"wander": 1e-7},
        "wander far out": {"wander": 0.2},
        "short wander": {"wander_length": 0.02},
        "long wander": {"wander_length": 0.9},
        "places without error": {"sigma_x": 2e-6},
        "clock without error": {"sigma_t": 2e-7},
        "places far off": {"sigma_x": 5e-4},
        "clock far off": {"sigma_t": 4e-4},
        "all scatter near 0": dict.fromkeys(("tau", "omega", "omega_intercept", "wander"), 1e-6),
    },
    "motor": {
        **LAWS,
        **_scatter("tau_motor", "omega_motor", "omega_intercept_motor"),
        "torque constant low": {"torque_constant_factor": 0.93},
        "torque constant high": {"torque_constant_factor": 1.12},
        "current without noise": {"sigma_current": 1e-4},
        "current far off": {"sigma_current": 0.1},
        "load without noise": {"load_noise": 1e-6},
        "load far off": {"load_noise": 0.08},
    },
    "points": {
        **LAWS,
        **_scatter("tau_steady-points", "omega_steady-points"),
        "readings without error": {"sigma_friction": 1e-5},
        "readings far off": {"sigma_friction": 0.3},
    },
    "axis": {
        "bulk": {},
        "light": {"mass": 1.4},
        "heavy": {"mass": 2.9},
        "hardly friction": {"coulomb": 0.3},
        "much friction": {"coulomb": 4.0},
        **_scatter("tau", "omega"),
        "wander near 0": {"wander": 1e-7},
        "wander far out": {"wander": 0.5},
        "rows exact": {"row_error": 0.4},
        "rows far off": {"row_error": 3.0},
        "force early": {"latency": -3e-3},
        "force late": {"latency": 4e-3},
    },
}
"""Names of points to what differs from the bulk."""


def points_of(rig: str) -> dict[str, dict[str, float]]:
    """Return the fixed points of a rig by name; each has all parameters that the rig may have."""
    return {name: BASE[rig] | change for name, change in CHANGES[rig].items()}


NOISE = {
    "gravity": {
        "tau": 0.012,
        "omega": 0.016,
        "omega_intercept": 0.03,
        "wander": 0.005,
        "wander_length": 0.11,
        "kappa": 1.1,
    },
    "motor": {
        "tau_motor": 0.011,
        "omega_hung": 0.007,
        "omega_motor": 0.015,
        "omega_intercept_hung": 0.012,
        "omega_intercept_motor": 0.02,
        "sigma_current": 0.0025,
        "load_noise": 0.006,
    },
    "points": {
        "tau_steady-points": 0.012,
        "load_steady-points": 0.004,
        "omega_steady-points": 0.02,
        "sigma_friction": 0.006,
    },
    "axis": {
        "sigma_position": 3e-6,
        "sigma_force": 0.02,
        "wander_axis": 0.02,
        "wander_length_axis": 0.025,
        "tau_axis": 0.012,
        "omega_axis": 0.015,
        "map_axis": 0.01,
        "run_map_axis": 0.006,
        "map_length_axis": 0.03,
        "map_decay_axis": 1.8,
        "slow_axis": 0.005,
        "slow_time_axis": 0.4,
    },
}
"""Noise of a diagnosis."""
