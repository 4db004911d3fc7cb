"""A loop and draws that the tests change in one place at a time."""

import copy
from pathlib import Path

import numpy as np

from bayesfric.margins.assembly import nominal_assembly
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.posterior import Posterior
from bayesfric.margins.reflecting import at_shaft
from bayesfric.physics.friction import Coefficients
from bayesfric.results import draws_tree, write_netcdf
from bayesfric.schemas.base import RecordingId

SMALL = (0.0128, 0.0261, 2.79e-5)
MEDIUM = (0.00416, 0.0165, 1.02e-5)

# At the shaft: kp 0.02, kd 1e-3, J 2e-5 + 1e-5, lag 1.5 ms, F 0.002 + 1e-3 × cable force.
BASE = {
    "name": "bench",
    "joint": {"kind": "revolute", "inertia_kg_m2": 0.1, "transmission_rad_per_rad": 100.0},
    "drive": {
        "torque_constant_n_m_per_a": 0.05,
        "gearbox_ratio": 10.0,
        "capstan_radius_m": 0.01,
        "friction_n_m": 0.002,
        "inertia_kg_m2": 2e-5,
        "current_limit_a": 2.0,
    },
    "runs": [
        {
            "pulley_size": "small",
            "count": 5,
            "wrap_angle_deg": 85,
            "tension_n": 10.0,
            "tension_known_at": "mean",
            "topology": "antagonist-pair",
            "model": "nominal",
        }
    ],
    "cable": {"axial_stiffness_n": 15e3, "length_m": 0.01},
    "controller": {
        "kp_n_m_per_rad": 0.02,
        "kd_n_m_s_per_rad": 1e-3,
        "torque_at": "motor",
        "angle_of": "motor",
        "sample_time_s": 1e-3,
        "delay_s": 1e-3,
        "encoder_counts_per_revolution": 4000,
    },
    "compensation": {"signal": "measured", "estimate_n_m": 0.003},
    "kick": {"reference_range_rad_s": [0.0, 0.0]},  # held at rest: where the formula holds
    "tool": {"lever_m": 0.5},
}


def changed(changes):
    """Return the base as a dictionary with some dotted keys changed; None takes one out."""
    values = copy.deepcopy(BASE)
    for dotted, value in changes.items():
        *path, last = dotted.split(".")
        place = values
        for key in path:
            place = place[int(key)] if isinstance(place, list) else place.setdefault(key, {})
        if value is None:
            del place[last]
        else:
            place[last] = copy.deepcopy(value)
    return values


def loop(changes=None):
    return Loop.model_validate(changed(changes or {}))


def posterior(n=2, sd=0.0, omega=0.0, seed=1):
    """Draws around Table I; every coefficient scatters by its own factor."""
    rng = np.random.default_rng(seed)
    coefficients = {
        size: Coefficients(*(value * (1 + sd * rng.standard_normal(n)) for value in values))
        for size, values in (("small", SMALL), ("medium", MEDIUM))
    }
    scatter = {size: np.full(n, omega) for size in coefficients}
    identity = RecordingId(name="made-up", title="", sha256="a" * 64)
    return Posterior(coefficients, scatter, float(n), identity, "b" * 64, None)


def shaft(changes=None):
    """The base loop at the shaft, one draw, at Table I."""
    settings = loop(changes)
    return at_shaft(settings, nominal_assembly(settings, posterior()))


def write_draws(path: Path, n=400, sd=0.01, omega=0.02, seed=1, **scatters):
    """A draws.nc of 2 ensembles with 2 walkers each."""
    rng = np.random.default_rng(seed)
    shape = (4, n // 4)

    def column(place):
        table = np.array([SMALL[place], MEDIUM[place]])
        return table * (1 + sd * rng.standard_normal((*shape, 2)))

    tree = draws_tree(
        {
            "posterior": {
                "c1": column(0),
                "c2": column(1),
                "c3": column(2),
                "omega": np.full(shape, omega),
                **{name: np.full(shape, value) for name, value in scatters.items()},
            }
        },
        dims={name: ["pulley"] for name in ("c1", "c2", "c3")},
        coords={"pulley": ["small", "medium"]},
        ensembles=2,
        attributes={
            "recording.name": "made-up",
            "recording.title": "",
            "recording.sha256": "a" * 64,
            "analysis_sha256": "b" * 64,
            "created": "",
        },
    )
    write_netcdf(tree, path)
    return path
