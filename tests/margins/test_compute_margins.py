"""From a loop and draws to margins.json, with known answers."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from margins.loops import loop, posterior, write_draws
from reasons import explained
from scipy import stats

from bayesfric.errors import InputError
from bayesfric.margins import compute_margins
from bayesfric.margins.answer import largest_safe_gain, limit_cycle_curve
from bayesfric.margins.assembly import draw_assembly
from bayesfric.margins.posterior import RigDiscrepancy, read_posterior, rig_discrepancy
from bayesfric.margins.reflecting import at_shaft
from bayesfric.margins.scanning import REST
from bayesfric.margins.thresholds import Hunting
from bayesfric.probabilities import bound_of_hits, percent
from bayesfric.results import json_bytes
from bayesfric.schemas import MarginsFile

CONTRACT = """friction_nominal friction_recursive steady_error_servo lost_motion headroom_clip
headroom_continuous gamma_necessary gamma_hunting amplitude_margin limit_cycle_amplitude
limit_cycle_frequency gain_margin phase_margin disk_margin delay_margin backdrive_force
smallest_step reversal_error cable_stretch least_tension peak_tension sensitivity_peak
complementary_peak""".split()


@pytest.fixture(scope="module")
def draws(tmp_path_factory):
    return write_draws(tmp_path_factory.mktemp("fit") / "draws.nc", n=400)


@pytest.fixture(scope="module")
def many_draws(tmp_path_factory):
    return write_draws(tmp_path_factory.mktemp("fit") / "draws.nc", n=1000)


@pytest.fixture(scope="module")
def few_draws(tmp_path_factory):
    return write_draws(tmp_path_factory.mktemp("fit") / "draws.nc", n=60)


@pytest.fixture(scope="module")
def as_it_is(draws):
    """Margins of the loop without any change."""
    return computed(draws)


def computed(draws, changes=None, simulated=8, **options):
    return explained(
        compute_margins([loop(changes)], draws, simulated=simulated, **options).summary
    )


def metric(summary, name, direction=None):
    (chosen,) = [m for m in summary.loops[0].metrics if (m.name, m.direction) == (name, direction)]
    return chosen


def test_it_has_every_metric_in_order_and_round_trips(draws, as_it_is):
    margins = as_it_is
    assert [entry.name for entry in margins.loops[0].metrics] == CONTRACT
    data = json_bytes(margins)
    assert MarginsFile.model_validate_json(data) == margins
    assert json.loads(data)["schema"] == "bayesfric.margins/1"
    assert json_bytes(computed(draws)) == data


def test_every_missing_number_has_its_reason(draws):
    def walk(value):
        if isinstance(value, dict):
            for key, inner in value.items():
                # a direction and a spec are absent by nature, not missing
                if inner is None and not key.endswith("_why") and key not in (
                    "direction", "spec", "created", "predicted", "simulated",
                    "largest_safe_compensation_gain_se",
                ):  # fmt: skip
                    assert value.get(f"{key}_why"), key
                walk(inner)
        elif isinstance(value, list):
            for inner in value:
                walk(inner)

    for signal in ("none", "reference", "measured"):
        stored = json.loads(json_bytes(computed(draws, {"compensation.signal": signal})))
        stored["analysis"] = {}  # settings as they were given: none of them is missing
        walk(stored)


def test_friction_alone_does_not_spread_linear_margins(few_draws, as_it_is):
    margins = as_it_is
    for name in ("gain_margin", "phase_margin", "disk_margin", "delay_margin"):
        margin = metric(margins, name)
        assert margin.interval.sd == 0
        assert margin.interval.q05 == margin.interval.q95
        assert "Coulomb friction is not in the linear loop" in margin.note
        assert name not in margins.loops[0].variance_share
    inertia = {"family": "log-normal", "median": 0.1, "sd_log": 0.3}
    moved = computed(few_draws, {"joint.inertia_kg_m2": inertia})
    assert metric(moved, "phase_margin").interval.sd > 0
    assert moved.loops[0].variance_share["phase_margin"] == {
        "c1, c2, c3": 0.0,
        "new assembly and rig": 0.0,
        "joint.inertia_kg_m2": pytest.approx(1.0, abs=0.15),
    }


def test_an_open_run_reports_both_directions(few_draws):
    changes = {"runs.0.topology": "open", "runs.0.count": 13, "cable.length_m": 1.0}
    margins = computed(few_draws, changes)
    for name in ("gain_margin", "phase_margin", "disk_margin", "delay_margin"):
        driving, overhauling = (metric(margins, name, d) for d in ("driving", "overhauling"))
        assert driving.interval.mean != overhauling.interval.mean
    assert metric(margins, "phase_margin", "driving").interval.sd > 0


def test_draws_are_those_of_a_new_assembly():
    # friction is a factor 1 + ω z + s z': its spread is √(ω² + s²)
    law = posterior(20_000, sd=0.0, omega=0.03)
    given = draw_assembly(loop(), law, RigDiscrepancy(0.04, ""), seed=3)
    cable = at_shaft(loop(), given).stages[0].runs[0].nominal
    assert cable.std() / cable.mean() == pytest.approx(0.05, rel=0.03)
    assert cable.mean() == pytest.approx(1.541, rel=2e-3)


def test_the_discrepancy_of_rigs_is_that_of_the_claims(tmp_path, root):
    assert rig_discrepancy(tmp_path).sd == 0.05
    path = root / "reports" / "reference" / "claims.json"
    stored = json.loads(path.read_text(encoding="utf-8"))
    (rigs,) = [claim for claim in stored["claims"] if claim["id"] == "rigs-agree"]
    # rms of 3 % with an sd of 4 %, which is 5 %, and of a sure −5 %: neither calms the other
    half = stats.norm.ppf(0.95) * 0.04
    rigs["figures"] = {
        "difference_q05": {"small": 0.03 - half, "large": -0.05},
        "difference": {"small": 0.03, "large": -0.05},
        "difference_q95": {"small": 0.03 + half, "large": -0.05},
    }
    (tmp_path / "claims.json").write_text(json.dumps(stored), encoding="utf-8")
    discrepancy = rig_discrepancy(tmp_path)
    assert discrepancy.sd == pytest.approx(0.05, rel=1e-9)
    assert "rigs-agree" in discrepancy.source


def test_a_probability_of_violation_in_closed_form(many_draws):
    # no cable friction to speak of: the error is that of a normal drive friction
    drive = {"family": "normal", "mean": 0.02, "sd": 0.002}
    changes = {"drive.friction_n_m": drive, "runs.0.tension_n": 0.001, "runs.0.count": 1,
               "spec.steady_error_max_m": 0.0054, "tool.lever_m": 0.5}  # fmt: skip
    margin = metric(computed(many_draws, changes), "steady_error_servo")
    # m at the tip: F/0.02 × 0.5/100; the cable adds 2 c2 × 1e-3
    p = stats.norm.sf(0.0054 * 100 / 0.5 * 0.02, 0.02 + 2 * 0.0261e-3, 0.002)
    assert margin.probability_of_violation == pytest.approx(p, abs=3 * margin.monte_carlo_se)
    assert margin.monte_carlo_se == pytest.approx(np.sqrt(p * (1 - p) / 1000), rel=0.25)
    assert margin.interval.sd == pytest.approx(0.1 * margin.interval.mean, rel=0.1)


def test_shares_of_variance_by_hand(many_draws):
    # F = 1e-3·10·(c1 T + c2) + drive: sd 1e-3·10·0.0128·2 = 2.56e-4 and 3e-4, and a little else
    changes = {
        "runs.0.tension_n": {"family": "normal", "mean": 10.5, "sd": 2.0},
        "drive.friction_n_m": {"family": "normal", "mean": 0.002, "sd": 3e-4},
        "joint.inertia_kg_m2": {"family": "log-normal", "median": 0.1, "sd_log": 0.3},
    }
    variance_shares = computed(many_draws, changes).loops[0].variance_share
    for name, by_input in variance_shares.items():  # what does not enter explains exactly nothing
        outside = "joint.inertia_kg_m2" if "margin" not in name else "drive.friction_n_m"
        assert by_input[outside] == 0.0, name
    shares = variance_shares["steady_error_servo"]
    other = (1.541e-3 * np.hypot(0.02, 0.05)) ** 2
    total = 2.56e-4**2 + 3e-4**2 + other
    assert shares["runs.0.tension_n"] == pytest.approx(2.56e-4**2 / total, abs=0.1)
    assert shares["drive.friction_n_m"] == pytest.approx(3e-4**2 / total, abs=0.1)
    assert shares["new assembly and rig"] == pytest.approx(other / total, abs=0.07)


def test_hunting_by_formula_has_the_quantile_of_the_threshold(draws):
    summary = computed(draws, {"spec.limit_cycle_probability_max": 0.1})
    loop = summary.loops[0]
    assert loop.limit_cycle_method == "formula"
    hunting = metric(summary, "gamma_hunting")
    assert loop.largest_safe_compensation_gain == pytest.approx(
        0.95 * np.interp(0.1, [0.05, 0.10], hunting.quantiles[1:3]), rel=1e-3
    )
    p = {point.gamma: point.p for point in loop.limit_cycle_probability}
    assert p[0.0] == 0
    assert p[3.0] == 1
    assert ". Set γ to " in loop.answer
    assert f"{np.floor(100 * loop.largest_safe_compensation_gain) / 100:.2f}" in loop.answer


def test_a_compensator_of_the_reference_is_simulated_and_does_not_hunt(draws):
    loop = computed(draws, {"compensation.signal": "reference"}).loops[0]
    assert loop.limit_cycle_method == "simulation"
    assert all(point.p == 0 for point in loop.limit_cycle_probability)
    assert loop.largest_safe_compensation_gain == 3.0
    assert "0 of 8 draws (at 95 % confidence, in less than 31 %)" in loop.answer  # 1 − 0.05^(1/8)
    assert "which biases" in loop.answer


def made_up(thresholds):
    draws, empty = thresholds.size, np.empty(0)
    first = np.where(np.isfinite(thresholds), 0, -1)
    return Hunting("formula", np.arange(draws), thresholds, (REST,), first,
                   np.zeros((1, draws), bool), empty, empty, (REST,), None, (), "")  # fmt: skip


def test_the_largest_safe_gain_by_hand():
    thresholds = np.append(np.linspace(1.0, 1.99, 100), [np.inf] * 100)
    hunting = made_up(thresholds)
    safe = largest_safe_gain(hunting, 0.05, 200.0)
    # 5 % below where one draw in twenty hunts, by formula as by simulation, and 0.01 at least
    assert safe.gamma == pytest.approx(0.95 * 1.10)
    assert safe.se == pytest.approx(0.03, abs=0.005)  # √(0.05·0.95/200) of 2 a unit of γ
    curve = {point.gamma: point for point in limit_cycle_curve(hunting, 50.0)}
    assert curve[1.5].p == pytest.approx(51 / 200)
    assert curve[1.5].mcse == pytest.approx(np.sqrt(0.255 * 0.745 / 50))
    simulated = replace(hunting, method="simulation")
    assert largest_safe_gain(simulated, 0.05, 200.0).gamma == pytest.approx(0.95 * 1.10)
    small = replace(simulated, threshold=thresholds / 10)
    assert largest_safe_gain(small, 0.05, 200.0).gamma == pytest.approx(0.11 - 0.01)
    never = made_up(np.full(2, np.inf))
    assert largest_safe_gain(replace(never, method="simulation"), 0.05, 2.0).gamma == 3.0
    assert largest_safe_gain(never, 0.05, 2.0).gamma == 3.0
    always = made_up(np.zeros(2))
    none = largest_safe_gain(always, 0.05, 2.0)
    assert none.gamma is None
    assert none.why == "100 % of the draws hunt without any compensation, after the kick"
    # two of 200 hunt without any, ten more at the least γ that is told apart from none
    early = made_up(np.concatenate([np.zeros(2), np.full(10, 0.008), np.ones(188)]))
    none = largest_safe_gain(early, 0.05, 200.0)
    assert none.gamma is None
    assert none.why == "6 % of the draws hunt already at γ = 0.01, after the kick"


def test_a_tight_limit_is_told_with_its_digits_and_what_draws_can_bound(draws):
    strict = computed(draws, {"spec.limit_cycle_probability_max": 0.001}).loops[0]
    assert "the loop hunts with a probability of 0.1 % or less" in strict.answer
    # none of the 400 may hunt: 1 − 0.05^(1/400)
    assert "Of 400 draws 0.1 % are 0.4, so that they bound it only at 0.746 %" in strict.answer
    usual = computed(draws, {"spec.limit_cycle_probability_max": 0.05}).loops[0]
    assert "with a probability of 5 % or less" in usual.answer
    assert "bound it" not in usual.answer
    # one of 40: Clopper and Pearson's 11.3 %
    assert bound_of_hits(1, 40) == pytest.approx(stats.beta.ppf(0.95, 2, 39))
    assert percent(bound_of_hits(1, 40)) == "11.3 %"
    assert bound_of_hits(3, 3) == 1.0


WEAK = {"controller.kd_n_m_s_per_rad": 0.0}


def test_an_unstable_loop_is_refused_unless_friction_is_relied_on(draws):
    with pytest.raises(InputError, match="stable without friction"):
        computed(draws, WEAK)
    summary = computed(
        draws, {**WEAK, "controller.relies_on_friction": True, "compensation.signal": "none"}
    )
    assert metric(summary, "gain_margin").interval is None
    assert "unstable without friction" in metric(summary, "gain_margin").interval_why
    # 4 F/(π ω_n kp τ), F 3.541e-3 on average
    by_hand = 4 * 3.541e-3 / (np.pi * np.sqrt(0.02 / 3e-5) * 0.02 * 1.5e-3)
    assert metric(summary, "amplitude_margin").interval.mean == pytest.approx(by_hand, rel=0.01)


def test_an_amplitude_that_is_not_known_is_told_so_and_missed(draws):
    # kd/J of the motor is 1000 rad/s, which turns by 4.5 rad in the delay; b_eff is positive
    late = {
        "controller.delay_s": 4e-3, "controller.kd_n_m_s_per_rad": 2e-2,
        "controller.relies_on_friction": True,
        "compensation.signal": "none", "spec.amplitude_margin_min_rad": 0.01,
    }  # fmt: skip
    margin = metric(computed(draws, late), "amplitude_margin")
    assert margin.interval is None
    assert margin.interval_why == "not known: b_eff does not tell it in 100.0% of the draws"
    assert margin.probability_of_violation == 1.0


def test_all_bad_loops_are_told_together(draws, tmp_path):
    for name in ("one", "two"):
        (tmp_path / f"{name}.toml").write_text("name = 3\n", encoding="utf-8")
    with pytest.raises(InputError) as raised:
        compute_margins([tmp_path / "one.toml", tmp_path / "two.toml"], draws)
    assert {fault.file for fault in raised.value.faults} == {"one.toml", "two.toml"}
    with pytest.raises(InputError, match="a different name for each loop"):
        compute_margins([loop(), loop()], draws)


def test_one_loop_needs_no_list(draws, tmp_path):
    with pytest.raises(InputError) as raised:  # and its name is not a list of letters
        compute_margins(str(tmp_path / "own.toml"), draws)
    assert [Path(fault.file).name for fault in raised.value.faults] == ["own.toml"]
    assert compute_margins(loop(), draws).summary.loops[0].name == "bench"


def test_draws_without_the_pulley_size_are_refused(draws):
    with pytest.raises(InputError, match=r"runs\.0\.pulley_size: found 'large'"):
        computed(draws, {"runs.0.pulley_size": "large"})


def test_what_are_no_draws_is_refused(tmp_path):
    (tmp_path / "draws.nc").write_bytes(b"not netCDF")
    with pytest.raises(InputError, match="netCDF"):
        read_posterior(tmp_path / "draws.nc")


def test_warnings_name_assumptions_and_what_was_not_measured(draws, as_it_is):
    changes = {"assumptions": ["The wind is calm."], "cable.diameter_mm": 1.19,
               "runs.0.wrap_angle_deg": 170, "runs.0.tension_n": 40.0}  # fmt: skip
    said = "\n".join(computed(draws, changes).loops[0].warnings)
    for words in ("Assumed: The wind is calm.", "1.19 mm", "170°", "40 N", "5.0%"):
        assert words in said
    assert "Assumed" not in "\n".join(as_it_is.loops[0].warnings)


@pytest.mark.nightly
def test_formula_and_elastic_cable_agree_over_uncertain_loops(draws):
    changes = {
        "joint.inertia_kg_m2": {"family": "log-normal", "median": 0.1, "sd_log": 0.3},
        "controller.kd_n_m_s_per_rad": {"family": "uniform", "low": 2e-4, "high": 1.2e-3},
    }
    verification = computed(draws, changes, simulated=200, verify=200).loops[0].verification
    assert verification.inside_conditions >= 150
    assert verification.agreement >= 0.95
    assert verification.steady_error_agreement >= 0.95
