"""Tables of masses and accelerations alone, as a classroom's Atwood machine gives them.

Made here from ``a = ((m1 − m2) g − f) / (m1 + m2 + I)`` in closed form, friction constant.
"""

import json

import numpy as np
import pytest

import bayesfric as bf
from bayesfric.diagnosis.baseline import data_of
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import Candidate
from bayesfric.physics.friction import Coefficients
from bayesfric.rigs.base import Unsupported

G = 9.80665
FRICTION_N = 0.008
HEADER = "trial,pulley_size,n_pulleys,wrap_angle_deg,mass_drive_kg,mass_load_kg,acceleration_m_s2"


def written(folder, *, inertia_kg=0.0, share=0.0, sd=0.0, rows=24, stated=False, limits=None):
    """A table of two total masses, with an error that is a share of a beside a constant one."""
    rng = np.random.default_rng(rows)
    total = np.where(np.arange(rows) % 2, 0.6, 0.2)
    difference = total * np.tile(np.linspace(0.08, 0.4, 6), rows)[:rows]
    a = (difference * G - FRICTION_N) / (total + inertia_kg)
    error = share * a + sd
    measured = a + error * rng.standard_normal(rows)
    cells = [
        f"t{i},classroom,1,180,{(total[i] + difference[i]) / 2},{(total[i] - difference[i]) / 2},"
        f"{measured[i]}" + (f",{error[i]}" if stated else "")
        for i in range(rows)
    ]
    head = HEADER + (",acceleration_sd_m_s2" if stated else "")
    (folder / "gravity_trials.csv").write_text("\n".join([head, *cells]) + "\n")
    resource = {"name": "gravity-trials", "path": "gravity_trials.csv"}
    rig = {} if limits is None else {"limits": limits}
    package = {"name": "atwood", "title": "Made", "rig": rig, "resources": [resource]}
    (folder / "datapackage.json").write_text(json.dumps(package))
    return bf.read_recording(folder)


def why(summary, name):
    return next(
        tested.log10_bayes_factor_why for tested in summary.effects if tested.effect == name
    )


@pytest.mark.parametrize("stated", [True, False])
def test_a_pulleys_inertia_is_named_with_what_is_the_same(tmp_path, stated):
    summary = bf.diagnose(written(tmp_path, inertia_kg=0.01, share=0.01, stated=stated)).summary
    assert summary.verdict == "named"
    (cause,) = summary.causes
    (alike,) = (group for group in summary.unseparated if cause.effect in group.effects)
    assert alike.reason == "identical-on-this-rig"
    assert set(alike.effects) == {"mass-error", "pulley-inertia"}
    (value,) = cause.parameters.values()
    # All is linear around the motion without it, which runs by up to 0.01 / 0.21 faster.
    assert abs(value.mean - 0.01) < 3 * value.sd + 0.05 * 0.01


def test_the_error_of_accelerations_is_found_where_nobody_states_it(tmp_path):
    """Five times the rough one, to three standard errors of an estimate from 40 rows."""
    summary = bf.diagnose(written(tmp_path, sd=0.05, rows=40)).summary
    assert summary.causes == ()
    assert "rig.limits.travel_m" in why(summary, "air-drag")
    assert "single events" in why(summary, "clock-scale")
    assert 0.01 * np.sqrt(summary.scatter["kappa"]) == pytest.approx(0.05, rel=3 / np.sqrt(80))


def reason(recording, name):
    """Why rows say nothing of an effect; empty where they do."""
    data, _ = data_of(recording, "paper", None)
    rows = data.rigs[0].linear({"classroom": Coefficients(0.0, FRICTION_N, 0.0)})
    effect = all_effects()[name]
    force = rows.relative_force(Candidate(effect, next(iter(effect.laws)), 0.0))
    return force.reason if isinstance(force, Unsupported) else ""


def test_what_a_table_does_not_tell_is_not_examined(tmp_path):
    """No speed, place or time of an event is known of an acceleration."""
    with_travel = written(tmp_path, share=0.01, limits={"travel_m": [0.0, 0.8]})
    untold = written(tmp_path, share=0.01)
    for name in ("air-drag", "viscous", "stribeck", "cable-weight", "runout"):
        assert "rig.limits.travel_m" in reason(untold, name)
        assert "rig.limits.travel_m" not in reason(with_travel, name)
    for recording in (with_travel, untold):
        assert "single events" in reason(recording, "clock-scale")
        assert "single events" in reason(recording, "length-scale")
