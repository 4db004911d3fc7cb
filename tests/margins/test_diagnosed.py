"""Law and effects of a diagnosis in a loop, against figures by hand."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from margins.loops import SMALL, loop, posterior, shaft, write_draws
from report.diagnosis_sample import cause, diagnosis, interval

from bayesfric.diagnosis import diagnose
from bayesfric.diagnosis.drawn_effect import DrawnEffect
from bayesfric.effects import all_effects
from bayesfric.errors import InputError
from bayesfric.margins import compute_margins, read_loop
from bayesfric.margins.assembly import COEFFICIENTS as GROUP
from bayesfric.margins.assembly import draw_assembly, nominal_assembly
from bayesfric.margins.describing import effective_damping
from bayesfric.margins.diagnosed import read_diagnosed, with_effects
from bayesfric.margins.metrics import closed_forms, linear_of
from bayesfric.margins.posterior import RigDiscrepancy, read_posterior
from bayesfric.margins.reflecting import at_shaft
from bayesfric.physics.friction import Coefficients
from bayesfric.resources import bundled_loops
from bayesfric.results import identified, json_bytes, read_json, read_tree, write_netcdf
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import RecordingId
from bayesfric.schemas.causes import LawNumber
from bayesfric.simulate import simulate_recording, table1_coefficients

PULLEY = 0.0128 * 15 + 0.0261  # N of one small pulley at 15 N and 85°
CABLE = 1.541e-3  # N·m at the shaft: 10 pulleys at 10 N, a cable at 1 mm/rad


def acts(effect, variant, amplitude, shape=0.0):
    ones = np.ones(1)
    return DrawnEffect(all_effects()[effect], amplitude * ones, shape * ones, np.array([variant]))


def added(*acting, changes=None):
    bench = shaft(changes)
    given = replace(nominal_assembly(loop(changes), posterior()), acting=acting)
    return bench, with_effects(bench, given)


def write_diagnosis(folder, *names, coefficients=SMALL, probability=1.0, draws=200, **columns):
    """Write a diagnosis of some effects, of which each acts in a share of the draws."""
    acting = np.arange(draws) < probability * draws
    ones = np.ones((draws, 2))
    tables = {
        name: (("draw", "pulley"), value * ones)
        for name, value in zip(("c1", "c2", "c3"), coefficients, strict=True)
    }
    tables["omega"] = (("draw",), np.full(draws, 0.02))
    if columns:
        tables |= {
            name: (("draw", "effect"), np.where(acting[:, None], [values], [[type(values[0])()]]))
            for name, values in columns.items()
        }
    coords = {"pulley": ["small", "medium"]} | ({"effect": list(names)} if columns else {})
    tree = xr.DataTree.from_dict({"law": xr.Dataset(tables, coords=coords)})
    record = diagnosis(causes=tuple(cause(name) for name in names))
    path = folder / "diagnosis.json"
    path.write_bytes(json_bytes(record))
    write_netcdf(tree, folder / "diagnosis.nc", record.run_id)
    return path


def test_viscous_friction_becomes_damping_and_nothing_else():
    before, after = added(acts("viscous", "constant", 0.2))
    # force to torque by 1 mm/rad, as speed is: N s/m × 1e-6
    assert after.viscous - before.viscous == pytest.approx(0.2 * 10 * PULLEY * 1e-6)
    assert after.friction == pytest.approx(before.friction)
    assert after.breakaway == pytest.approx(before.breakaway)
    assert after.kick == pytest.approx(before.kick)


def test_falling_friction_is_more_at_rest_and_takes_damping_away():
    speed = 5e-3  # m/s; gone at 0.1 m/s
    before, after = added(acts("stribeck", "exponential", 0.4, speed))
    # of the cable's only: motor and gearbox have none of it
    assert after.breakaway - before.breakaway == pytest.approx(0.4 * CABLE)
    assert after.friction == pytest.approx(before.friction)
    assert after.viscous == pytest.approx(before.viscous)
    assert after.kick / before.kick == pytest.approx(after.breakaway / before.breakaway)
    # d/dv of 0.4 e^(−v/5 mm/s) at rest, 1 mm/rad
    lost = 0.4 * CABLE / (speed / 1e-3)
    assert after.falling_speed == pytest.approx(speed / 1e-3, rel=0.1)  # a grid of speeds
    assert effective_damping(before) - effective_damping(after) == pytest.approx(lost, rel=0.1)


def test_the_estimate_follows_the_law_unless_the_file_has_one():
    drag = acts("wrap-intercept", next(iter(all_effects()["wrap-intercept"].laws)), 0.02)
    changes = {"runs.0.wrap_angle_deg": 120, "compensation.estimate_n_m": None}
    before, after = added(drag, changes=changes)
    assert after.friction > 1.001 * before.friction
    assert before.estimate == pytest.approx(before.friction)
    assert after.estimate == pytest.approx(after.friction)
    _, given = added(drag, changes=changes | {"compensation.estimate_n_m": 0.003})
    assert given.estimate == pytest.approx(0.003)
    # the cable's friction is what stores cable
    longer = (after.friction - 0.002) / (before.friction - 0.002)
    assert after.lost_motion / before.lost_motion == pytest.approx(longer)


def test_an_effect_weighs_as_much_as_it_is_probable_and_the_law_is_the_refitted_one(tmp_path):
    fitted = replace(posterior(n=400), effective_draws=400.0)
    path = write_diagnosis(
        tmp_path, "viscous", coefficients=(0.01, 0.02, 1e-5), probability=0.25,
        amplitude=[0.2], shape=[0.0], variant=["constant"],
    )  # fmt: skip
    diagnosed = read_diagnosed(path, fitted, seed=1)
    (acting,) = diagnosed.posterior.acting
    assert acting.amplitude.mean() == pytest.approx(0.25 * 0.2)
    assert set(acting.variant) == {"", "constant"}
    assert diagnosed.posterior.coefficients["small"].c1 == pytest.approx(np.full(400, 0.01))
    assert diagnosed.posterior.omega["small"] == pytest.approx(np.full(400, 0.02))


@pytest.mark.nightly
def test_a_board_with_viscous_friction_makes_the_margins_of_the_true_law(tmp_path):
    """A whole diagnosis: 20 CPU-seconds. The law alone, fitted, is off by up to 12 %."""
    recording = simulate_recording("quick", seed=1, effects={"viscous": 1.0})
    diagnose(recording).write(tmp_path)
    (effect,) = recording.metadata["simulation"]["truth"]["effects"]
    diagnosed = read_diagnosed(tmp_path / "diagnosis.json", posterior(n=2000, omega=0.015), seed=1)
    true = replace(posterior(n=2000, omega=0.015), coefficients={
        size: Coefficients(*(np.full(2000, float(coefficient)) for coefficient in law))
        for size, law in table1_coefficients().items()
    })  # fmt: skip
    slope = DrawnEffect(
        all_effects()["viscous"], np.full(2000, effect["parameters"]["slope"]),
        np.zeros(2000), np.full(2000, effect["law"]),
    )  # fmt: skip
    for name in bundled_loops():
        settings = read_loop(Path(name))
        expected, got = (
            _figures(settings, law) for law in (replace(true, acting=(slope,)), diagnosed.posterior)
        )
        assert expected.keys() == got.keys()
        for key, values in expected.items():
            for q in (0.05, 0.5, 0.95):
                wanted = np.quantile(values, q)
                assert np.quantile(got[key], q) == pytest.approx(wanted, rel=0.02), (name, key, q)


def _figures(settings, law):
    given = draw_assembly(settings, law, RigDiscrepancy(0.0, ""), seed=1)
    after = with_effects(at_shaft(settings, given), given)
    values = closed_forms(after, linear_of(after)) | {("viscous", None): after.viscous}
    return {key: value for key, value in values.items() if np.isfinite(value).all()}


def test_what_belongs_to_the_board_stays_there(tmp_path):
    path = write_diagnosis(
        tmp_path, "cable-weight", "viscous",
        amplitude=[1.0, 0.2], shape=[0.0, 0.0], variant=["constant", "no-such-law"],
    )  # fmt: skip
    diagnosed = read_diagnosed(path, posterior(), seed=1)
    assert diagnosed.posterior.acting == ()
    assert [text.partition(":")[0] for text in diagnosed.left_out] == ["cable-weight", "viscous"]


def test_a_diagnosis_without_a_refitted_law_is_refused(tmp_path):
    path = write_diagnosis(tmp_path, "viscous")
    empty = xr.DataTree.from_dict({"residuals": xr.Dataset()})
    write_netcdf(empty, tmp_path / "diagnosis.nc", diagnosis().run_id)
    with pytest.raises(InputError, match="refitted law"):
        read_diagnosed(path, posterior(), seed=1)


def test_a_diagnosis_of_another_machine_than_a_board_is_refused(tmp_path):
    path = write_diagnosis(tmp_path, "viscous")
    law = xr.Dataset({"pulley": ["medium"], "omega_steady-points": ("draw", [0.01])})
    write_netcdf(xr.DataTree.from_dict({"law": law}), tmp_path / "diagnosis.nc", diagnosis().run_id)
    with pytest.raises(InputError, match="a diagnosis of a gravity or a motor board"):
        read_diagnosed(path, posterior(), seed=1)


def test_before_and_after_stand_side_by_side(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=80)
    path = write_diagnosis(
        tmp_path, "stribeck", amplitude=[0.4], shape=[1e-3], variant=["exponential"]
    )
    settings = loop({"compensation.signal": "none"})
    margins = compute_margins([settings], draws, diagnosis=path, law="fitted", simulated=8)
    (refitted_loop,) = margins.summary.loops
    assert refitted_loop.with_effects.effects == ("stribeck",)
    before, after = (
        {metric.name: metric.interval for metric in rows}
        for rows in (refitted_loop.metrics, refitted_loop.with_effects.metrics)
    )
    wider = after["steady_error_servo"].mean / before["steady_error_servo"].mean
    assert wider == pytest.approx(1 + 0.4 * 1.541 / 3.541, rel=0.01)
    (plain,) = compute_margins([settings], draws, law="fitted", simulated=8).summary.loops
    assert plain.metrics == refitted_loop.metrics
    assert plain.with_effects is None
    assert plain.with_effects_why == "no diagnosis was given"
    nothing = write_diagnosis(tmp_path)
    (none,) = compute_margins([settings], draws, diagnosis=nothing, simulated=8).summary.loops
    assert none.with_effects is None
    assert "no effect that may act" in none.with_effects_why


def beside(folder, **changes):
    """Draws with a diagnosis beside them that names Stribeck friction, which grows c2."""
    draws = write_draws(folder / "draws.nc", n=80)
    path = write_diagnosis(
        folder, "stribeck", coefficients=(0.0128, 0.0155, 2.79e-5),
        amplitude=[0.4], shape=[1e-3], variant=["exponential"],
    )  # fmt: skip
    numbers = {
        "c2[small]": LawNumber(
            unit="N", before=interval(0.0261, 1e-4), after=interval(0.0155, 1e-4)
        )
    }
    stored = read_json(DiagnosisFile, path)
    recording = read_posterior(draws).recording
    record = identified(
        stored.model_copy(update={"law": numbers, "recording": recording, **changes})
    )
    path.write_bytes(json_bytes(record))
    tree = read_tree(folder / "diagnosis.nc")
    write_netcdf(tree, folder / "diagnosis.nc", record.run_id)
    return draws, path


def test_margins_are_of_the_refitted_law_where_a_cause_is_named_beside_the_draws(tmp_path):
    draws, path = beside(tmp_path)
    settings = loop({"compensation.signal": "none"})
    summary = compute_margins([settings], draws, simulated=8).summary
    assert (summary.law.used, summary.law.effects) == ("refitted", ("stribeck",))
    assert "stribeck, which diagnosis.json names" in summary.law.sentence
    assert summary.attention == ()
    plain = compute_margins([settings], draws, diagnosis=path, law="fitted", simulated=8).summary
    after = {metric.name: metric.interval for metric in plain.loops[0].with_effects.metrics}
    now = {metric.name: metric.interval for metric in summary.loops[0].metrics}
    assert now == after  # the same draws of the same law
    assert summary.loops[0].with_effects is None
    assert "that the diagnosis refitted" in summary.loops[0].with_effects_why
    shares = summary.loops[0].variance_share  # computed over other draws of the same law
    assert all(0 <= share <= 1 for groups in shares.values() for share in groups.values())


def test_the_law_alone_says_that_a_cause_is_named_and_by_how_much_it_is_wrong(tmp_path):
    draws, _ = beside(tmp_path)
    summary = compute_margins([loop()], draws, law="fitted", simulated=8).summary
    assert summary.law.used == "fitted"
    (line,) = summary.attention
    assert "diagnosis.json names stribeck" in line
    assert line.endswith("fitted without it: c2[small] 68% too high")


def test_a_diagnosis_that_names_nothing_leaves_the_law_and_says_so(tmp_path):
    draws, _ = beside(tmp_path, causes=())
    summary = compute_margins([loop()], draws, simulated=8).summary
    assert (summary.law.used, summary.attention) == ("fitted", ())
    assert summary.law.sentence.endswith("diagnosis.json names no cause.")


def test_a_diagnosis_of_another_recording_is_not_used_and_told(tmp_path):
    other = {"name": "other", "title": "", "sha256": "0" * 64}
    draws, _ = beside(tmp_path, recording=RecordingId(**other))
    summary = compute_margins([loop()], draws, simulated=8).summary
    assert summary.law.used == "fitted"
    (line,) = summary.attention
    assert "of another recording, and is not used" in line
    with pytest.raises(InputError, match="of the recording of the draws"):
        compute_margins([loop()], draws, law="refitted", simulated=8)


def test_the_refitted_law_cannot_be_had_without_a_diagnosis(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=80)
    summary = compute_margins([loop()], draws, simulated=8).summary
    assert summary.law.sentence.endswith("no diagnosis lies beside the draws.")
    with pytest.raises(InputError, match="a diagnosis, which --law refitted needs"):
        compute_margins([loop()], draws, law="refitted", simulated=8)


def test_effects_go_with_the_draws_of_the_law():
    """Shuffled, taken in part, or exchanged: what acts stays in step with the coefficients."""
    ramp = np.arange(40.0)
    effect = DrawnEffect(all_effects()["viscous"], ramp, 0 * ramp, np.array(["constant"] * 40))
    law = posterior(n=40)
    numbered = replace(
        law,
        coefficients={size: Coefficients(ramp, *own[1:]) for size, own in law.coefficients.items()},
        acting=(effect,),
    )
    other = draw_assembly(loop(), numbered, RigDiscrepancy(0.0, ""), 1, stream=1)
    first = draw_assembly(loop(), numbered, RigDiscrepancy(0.0, ""), 1)
    for draws in (first, other, other.taken(np.array([5, 3, 9])), first.with_group(GROUP, other)):
        (acting,) = draws.acting
        np.testing.assert_array_equal(acting.amplitude, draws.coefficients["small"].c1)
    assert not np.array_equal(first.acting[0].amplitude, other.acting[0].amplitude)
