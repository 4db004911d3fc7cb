"""Effects of a diagnosis in a loop, against figures by hand."""

import numpy as np
import pytest
from margins.loops import loop, posterior, shaft, write_draws
from report.diagnosis_sample import cause, diagnosis

from bayesfric.margins import compute_margins
from bayesfric.margins.assembly import nominal_assembly
from bayesfric.margins.diagnosed import carried_effects, with_effects
from bayesfric.results import json_bytes
from bayesfric.schemas import Cause, DiagnosisFile, EffectNumber

PULLEY = 0.0128 * 15 + 0.0261  # N of one small pulley at 15 N and 85°


def known(value, unit):
    return EffectNumber(
        mean=value, sd=0.0, q05=value, q50=value, q95=value, unit=unit, prior="none"
    )


def named(effect: str, law: str, **parameters: EffectNumber) -> Cause:
    return cause(effect, law=law, parameters=parameters)


def added(*causes, changes=None):
    one = shaft(changes)
    given = nominal_assembly(loop(changes), posterior())
    return one, with_effects(one, given, causes, seed=1)


def test_viscous_friction_becomes_damping_and_nothing_else():
    before, after = added(named("viscous", "constant", slope=known(0.2, "s/m")))
    # 10 pulleys, a cable at 1 mm/rad, force to torque by the same: N s/m × 1e-6
    assert after.viscous - before.viscous == pytest.approx(0.2 * 10 * PULLEY * 1e-6)
    assert after.friction == pytest.approx(before.friction)
    assert after.stiction_ratio == pytest.approx(1.0)
    assert after.kick == pytest.approx(before.kick)


def test_stribeck_friction_becomes_breakaway_and_nothing_else():
    parts = {"rise": known(0.4, "1"), "speed": known(1e-3, "m/s")}  # gone at 0.1 m/s
    before, after = added(named("stribeck", "exponential", **parts))
    # of the cable's 1.541e-3 only: motor and gearbox have none of it
    assert after.breakaway - before.breakaway == pytest.approx(0.4 * 1.541e-3)
    assert after.friction == pytest.approx(before.friction)
    assert after.viscous == pytest.approx(before.viscous)
    assert after.kick / before.kick == pytest.approx(after.breakaway / before.breakaway)


def test_what_belongs_to_the_board_stays_there():
    weight = named("cable-weight", "constant")
    strange = cause("viscous", law="no-such-law")
    found = carried_effects(diagnosis(causes=(weight, strange, cause("viscous"))))
    assert [one.effect for one in found.causes] == ["viscous"]
    assert [text.partition(":")[0] for text in found.left_out] == ["cable-weight", "viscous"]


def test_before_and_after_stand_side_by_side(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=80)
    stribeck = named("stribeck", "exponential", rise=known(0.4, "1"), speed=known(1e-3, "m/s"))
    record: DiagnosisFile = diagnosis(causes=(stribeck,))
    (tmp_path / "diagnosis.json").write_bytes(json_bytes(record))
    one = loop({"compensation.signal": "none"})
    (found,) = compute_margins([one], draws, diagnosis=tmp_path / "diagnosis.json").summary.loops
    assert found.with_effects.effects == ("stribeck",)
    before, after = (
        {metric.name: metric.interval for metric in rows}
        for rows in (found.metrics, found.with_effects.metrics)
    )
    wider = after["steady_error_servo"].mean / before["steady_error_servo"].mean
    assert wider == pytest.approx(1 + 0.4 * 1.541 / 3.541, rel=0.01)
    assert after["phase_margin"] == before["phase_margin"]
    (plain,) = compute_margins([one], draws).summary.loops
    assert plain.metrics == found.metrics
    assert plain.with_effects is None
    assert plain.with_effects_why == "no diagnosis was given"
    assert np.isfinite(before["friction_nominal"].mean)
