"""Friction points of any machine: read by their sign, fitted, diagnosed, and not overclaimed."""

import numpy as np
import pytest
from reasons import explained
from rigs.friction_points import curved, joint, recorded, slide, warming

import bayesfric as bf
from bayesfric import rigs
from bayesfric.analysis import Analysis, HalfNormal, Normal, checked_analysis
from bayesfric.diagnosis.acting import Acting
from bayesfric.diagnosis.baseline import data_of
from bayesfric.diagnosis.model import LinearModel
from bayesfric.effects import Effect, EffectParameter
from bayesfric.effects.candidates import Candidate
from bayesfric.errors import InputError
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import BASELINES
from bayesfric.recording.steady_signs import against_motion
from bayesfric.rigs.opening import with_own_priors


def trials_of(recording):
    return rigs.all_rigs()["steady-points"].trials(recording)


@pytest.mark.parametrize("sign", ["size", "drives", "resists"])
def test_each_convention_for_the_sign_says_the_same(tmp_path, sign):
    table = joint(3.0)
    size = np.abs(table["friction_n"])
    way = {"size": 1.0, "drives": np.sign(table["velocity_m_s"])}.get(sign)
    table["friction_n"] = size * (-np.sign(table["velocity_m_s"]) if way is None else way)
    assert against_motion(recorded(tmp_path, table).steady) == pytest.approx(size)


def test_friction_that_pushes_half_of_the_time_is_refused(tmp_path):
    table = joint(0.0)
    table["friction_n"] = np.abs(table["friction_n"]) * np.tile([1, -1], 30)
    with pytest.raises(InputError, match=r"30 of 60 rows push"):
        recorded(tmp_path, table)


def test_points_at_no_speed_and_a_few_that_push_are_mentioned(tmp_path):
    table = joint(0.0)
    table["velocity_m_s"][0], table["friction_n"][5] = 0.0, -0.01
    notes = recorded(tmp_path, table).notes
    assert notes == (
        "run r005: friction that pushes, kept as it is",
        "run r000: at no speed, taken as friction at the brink of motion",
    )


def test_its_density_is_a_dense_normal(tmp_path):
    """With assemblies, and a standard error of some readings only."""
    table = slide() | {"setup": np.repeat(["a", "b", "c", "d", "e"], 8).tolist()}
    table["friction_sd_n"] = np.where(np.arange(40) % 3, 0.4, np.nan)
    trials = trials_of(recorded(tmp_path, table))
    likelihood = trials.likelihood(Analysis())
    assert {p.name for p in likelihood.parameters} == {
        *("c1", "c2"),
        *("tau_steady-points", "omega_steady-points", "sigma_friction"),
    }
    theta = {"c1": 0.1, "c2": 9.0, "tau_steady-points": 0.02}
    theta |= {"omega_steady-points": 0.03, "sigma_friction": 0.7}
    law = 0.1 * trials.table["tension_n"].to_numpy() + 9.0
    error = trials.table["friction_sd_n"].fillna(0.7).to_numpy()
    setup = trials.table["setup"].to_numpy()
    covariance = np.diag((0.02 * law) ** 2 + error**2)
    covariance += (setup[:, None] == setup) * np.outer(0.03 * law, 0.03 * law)
    off = trials.table["friction_n"].to_numpy() - law
    expected = -0.5 * (
        off @ np.linalg.solve(covariance, off) + np.linalg.slogdet(2 * np.pi * covariance)[1]
    )
    log_likelihood = likelihood.log_likelihood(
        {name: np.array([value]) for name, value in theta.items()}
    )
    assert log_likelihood[0] == pytest.approx(expected, abs=1e-8)


def test_an_assembly_of_pulleys_of_several_sizes_is_one_of_each(tmp_path):
    """Taken as one, it took off the first size what another's readings share: no information."""
    table = slide() | {"setup": np.repeat(["a", "b", "c", "d"], 10).tolist()}
    table["tension_n"] = table["tension_n"] / 10
    table["pulley_size"] = np.tile(["small", "large"], 20).tolist()
    data, law = data_of(recorded(tmp_path, table), "paper", None)
    points = data.rigs[0].table
    assert (points.groupby("setup")["pulley_size"].nunique() == 1).all()
    assert points.groupby("setup").size().tolist() == [5] * 8
    laws = dict.fromkeys(data.sizes, Coefficients(0.1, 9.0, 0.0))
    model = LinearModel(data, laws, (), Analysis(), frozenset(law.without))
    precision = model.evaluate(model.noise.start, Acting()).information.precision
    values = np.linalg.eigvalsh(precision)
    assert values[0] > -1e-9 * values[-1]


def test_a_machine_of_another_size_in_other_units_is_diagnosed_alike(tmp_path):
    """Forces and speeds times any number change no probability."""
    summaries = [
        bf.diagnose(recorded(tmp_path / str(force), joint(0.6, force=force, speed=speed))).summary
        for force, speed in ((1.0, 1.0), (1000.0, 0.01))
    ]
    first, second = summaries
    assert first.probabilities.keys() == second.probabilities.keys()
    for name, chance in first.probabilities.items():
        assert second.probabilities[name] == pytest.approx(chance, abs=1e-3)
    assert second.gap.systematic.q50 == pytest.approx(1000 * first.gap.systematic.q50, rel=0.02)


@pytest.fixture(scope="module")
def viscous(tmp_path_factory):
    """A joint with viscous friction."""
    return recorded(tmp_path_factory.mktemp("viscous"), joint(3.0), rotary=True)


@pytest.fixture(scope="module")
def viscous_diagnosed(viscous):
    return bf.diagnose(viscous).summary


def test_a_joint_with_viscous_friction_is_named_with_its_slope(viscous, viscous_diagnosed):
    explanation = explained(viscous_diagnosed)
    assert explanation.verdict == "named"
    (cause,) = explanation.causes
    assert cause.effect == "viscous"
    assert cause.parameters["slope"].unit == "s/rad"
    assert "cable" not in cause.sentence
    # The settings that are stored have the priors of the joint, so that a rerun has them too.
    stored, trials = checked_analysis(explanation.analysis, "stored").priors, trials_of(viscous)
    (own,) = trials.own_priors.values()
    (size,) = trials.own_priors
    assert own.c1 is not None
    assert stored.pulleys[size].c1 == own.c1 != stored.c1
    again = with_own_priors(checked_analysis(explanation.analysis, "stored"), [trials])
    assert again.priors.pulleys == stored.pulleys


def test_cold_grease_without_a_thermometer_may_be_wear_as_well(tmp_path):
    summary = bf.diagnose(recorded(tmp_path, warming(), rotary=True)).summary
    assert summary.verdict == "named"
    assert {cause.effect for cause in summary.causes} & {"thermal", "wear-drift"}
    assert ("thermal", "wear-drift") in [group.effects for group in summary.unseparated]
    assert "wear-drift" in summary.sentence
    assert "thermal" in summary.sentence


def test_a_share_of_friction_is_told_where_no_load_was_recorded(viscous_diagnosed):
    """Without a load no friction grows with one: a constant is all of it, and is told."""
    diagnosed = viscous_diagnosed
    assert list(diagnosed.law) == ["c2"]
    constant = diagnosed.law["c2"].after
    assert abs(constant.mean - 8.0) < 4 * constant.sd
    assert constant.sd < 0.1
    assert diagnosed.gap.no_share is None
    # What a constant cannot take up of 3 N·m s/rad at 0.1 to 2 rad/s, beside the law's 8 N·m.
    share = 3.0 * np.linspace(0.1, 2.0, 15).std() / 8.0
    assert diagnosed.gap.before.mean / diagnosed.gap.friction_rms == pytest.approx(share, rel=0.05)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [2, 3, 4])
def test_a_stribeck_curve_beside_viscous_friction_is_these_two_and_no_drag_of_air(tmp_path, seed):
    """Each alone says little, and a drag of air beside the first more than the second."""
    summary = bf.diagnose(recorded(tmp_path, curved(seed))).summary
    causes = {cause.effect: cause.parameters for cause in summary.causes}
    assert set(causes) == {"stribeck", "viscous"}
    assert causes["stribeck"]["speed"].mean == pytest.approx(0.04, rel=0.15)


def test_readings_whose_errors_are_known_leave_no_noise_to_draw(tmp_path):
    """All that scatters is the reading, as its error says: a diagnosis still has its answer."""
    velocity = np.tile(np.linspace(0.2, 3.0, 12), 2) * np.repeat([1.0, -1.0], 12)
    error = 0.01 * np.random.default_rng(5).standard_normal(24)
    table = {
        "velocity_m_s": velocity,
        "friction_n": np.sign(velocity) * (0.8 + 0.1 * np.abs(velocity) + error),
        "friction_sd_n": np.full(24, 0.01),
    }
    summary = bf.diagnose(recorded(tmp_path, table, rotary=True)).summary
    assert [cause.effect for cause in summary.causes] == ["viscous"]
    assert summary.gap.unit == "N·m"
    assert " N·m rms" in summary.sentence
    assert {axis.axis: axis.unit for axis in summary.where}["velocity"] == "rad/s"


def test_a_joint_that_rubs_more_one_way_is_named_so_whatever_makes_it(tmp_path):
    """A share of friction and a constant force are one where friction is the same everywhere."""
    table = joint(0.0)
    table["friction_n"] = table["friction_n"] * np.where(table["velocity_m_s"] > 0, 1.15, 0.85)
    summary = bf.diagnose(recorded(tmp_path, table)).summary
    assert summary.verdict == "named"
    (alike,) = (group for group in summary.unseparated if summary.causes[0].effect in group.effects)
    assert {*alike.effects} >= {"direction-asymmetry", "axis-bias"} - {summary.causes[0].effect}


def test_a_joint_with_nothing_is_not_accused(tmp_path):
    summary = bf.diagnose(recorded(tmp_path, joint(0.0))).summary
    assert summary.verdict == "no-gap"
    assert summary.probabilities["none"] > 0.5


def by_warmth(values, state):
    warm = np.asarray(state.covariates["oil_temperature_c"])
    return values["share"] * state.friction_n * (warm - 30) / 20


WARMTH = Effect(
    name="oil-warmth",
    acts_on="friction",
    sentence="friction falls as the oil warms",
    amplitude=EffectParameter("share", "1", "a share", Normal(mean=0, sd=0.2), (-1, 1), "argued"),
    laws={"linear": by_warmth},
    needs=frozenset({"oil_temperature_c"}),
)


def test_what_depends_on_a_covariate_is_found_there_and_named_by_a_users_effect(tmp_path):
    recording = recorded(tmp_path, slide(0.08))
    alone = bf.diagnose(recording).summary
    assert alone.verdict == "unknown"
    assert alone.where[0].axis == "oil_temperature_c"
    named = bf.diagnose(recording, effects=[WARMTH]).summary
    (cause,) = named.causes
    assert cause.effect == "oil-warmth"
    share = cause.parameters["share"]
    assert abs(share.mean + 0.08) < 4 * share.sd < 0.02


def test_an_effect_whose_covariate_is_absent_is_said_to_be(tmp_path):
    summary = bf.diagnose(recorded(tmp_path, joint(0.0)), effects=[WARMTH]).summary
    (tested,) = (effect for effect in summary.effects if effect.effect == "oil-warmth")
    assert "oil_temperature_c" in tested.log10_bayes_factor_why


@pytest.mark.parametrize(
    ("baseline", "reason"),
    [("recursive", "nothing goes pulley by pulley"), ("proportional", "No tension_n")],
)
def test_a_law_that_makes_no_sense_is_refused(tmp_path, baseline, reason):
    with pytest.raises(InputError, match=reason):
        bf.diagnose(recorded(tmp_path, joint(0.0)), baseline=baseline)


def test_a_law_without_its_constant_has_no_such_parameter(tmp_path):
    trials = trials_of(recorded(tmp_path, slide()))
    likelihood = trials.likelihood(Analysis(), BASELINES["proportional"])
    assert "c2" not in {p.name for p in likelihood.parameters}
    theta = {p.name: np.array([0.1]) for p in likelihood.parameters}
    assert likelihood.law(theta)[0] == pytest.approx(0.1 * trials.table["tension_n"])


def test_no_claim_on_pulleys_is_judged_by_a_machine_without(tmp_path):
    summary = bf.check_claims(recorded(tmp_path, joint(0.0))).summary
    assert {claim.verdict for claim in summary.claims} == {"not-testable"}


def test_a_users_prior_stands_where_the_rig_has_one(tmp_path):
    """And the others of the rig too."""
    from bayesfric.rigs.opening import with_own_priors

    trials = trials_of(recorded(tmp_path, slide()))
    analysis = Analysis.model_validate({"priors": {"c2": HalfNormal(scale=7.0).model_dump()}})
    own = with_own_priors(analysis, [trials])
    by_name = {p.name: p.prior for p in trials.likelihood(own).parameters}
    assert by_name["c2"] == HalfNormal(scale=7.0)
    assert by_name["c1"].scale == pytest.approx(
        2 * np.sqrt(np.mean(slide()["friction_n"] ** 2)) / 800
    )


def test_effects_in_proportion_do_to_friction_what_they_do_on_a_board(tmp_path):
    """At the highest speed a slope of one prior width is 3 · 0.15 · 1.3 of friction."""
    trials = trials_of(recorded(tmp_path, joint(0.0)))
    from bayesfric.effects import all_effects

    effect = trials.suited(all_effects()["viscous"])
    rows = trials.linear({"": Coefficients(0.0, 8.0, 0.0)})
    force = rows.relative_force(Candidate(effect, "friction", 0.0))[0, :, 0]
    assert effect.amplitude.prior.scale * force.max() == pytest.approx(3 * 0.15 * 1.3)


def test_the_next_point_is_where_two_curves_through_the_same_ends_differ(tmp_path):
    """A line and a parabola meet where all points are; between them lies one that is poor."""
    velocity = np.array([0.1] * 8 + [1.0] + [2.0] * 8)
    error = np.where(velocity == 1.0, 3.0, 0.05)
    friction = 8 + 3 * velocity + error * np.random.default_rng(8).standard_normal(17)
    table = {"velocity_m_s": velocity, "friction_n": friction, "friction_sd_n": error}
    summary = bf.diagnose(recorded(tmp_path, table)).summary
    assert {"viscous", "air-drag"} <= set(list(summary.probabilities)[:3])
    proposal = next(
        proposed
        for proposed in summary.next_experiment
        if set(proposed.separates) == {"viscous", "air-drag"}
    )
    assert proposal.condition == {"rig": "steady-points", "velocity_m_s": 1.0}
    # 1.3 N apart beside 0.05 N, friction's scatter of 8 to 14 N and what the ends leave open.
    assert 1 < proposal.log10_bayes_factor < 1.3**2 / (2 * 0.05**2 * np.log(10))


def test_friction_that_is_higher_at_middling_speeds_alone_is_a_gap_along_speed(tmp_path):
    """Effects of which two together take the law's place leave nothing to be a share of."""
    rng = np.random.default_rng(11)
    setup = np.arange(150) % 25
    n = rng.choice([1, 3, 5, 9, 15], 25)[setup]
    wrap = rng.choice([50.0, 85.0, 110.0, 135.0], 25)[setup]
    tension = rng.choice(np.linspace(4, 30, 8), 150)
    speed = rng.choice(np.geomspace(0.02, 1.2, 9), 150)
    friction = n * ((0.006 + 1.2e-5 * (wrap - 85)) * tension + 0.02)
    friction *= 1 + 0.35 * np.exp(-0.5 * (np.log(speed / 0.15) / 0.4) ** 2)
    friction *= 1 + 0.015 * rng.standard_normal(150) + 0.01 * rng.standard_normal(25)[setup]
    table = {
        "setup": [f"s{number}" for number in setup],
        "n_pulleys": n,
        "wrap_angle_deg": wrap,
        "tension_n": tension,
        "velocity_m_s": speed,
        "friction_n": friction,
    }
    summary = bf.diagnose(recorded(tmp_path, table)).summary
    assert summary.verdict == "unknown"
    assert summary.where[0].axis == "velocity"
    assert summary.gap.systematic.q50 > 0.05 * summary.gap.friction_rms  # 0.12 by the formula


def test_a_next_point_of_a_bench_at_one_speed_has_that_speed(tmp_path):
    """A column that did not vary is a column all the same."""
    tension = np.tile(np.linspace(5.0, 20.0, 8), 2)
    table = {"tension_n": tension, "velocity_m_s": 0.3, "friction_n": 0.1 * tension + 0.2}
    trials = trials_of(recorded(tmp_path / "bench", table))
    laws = {size: Coefficients(0.1, 0.2, 0.0) for size in trials.table["pulley_size"].unique()}
    laid = trials.next_trials(laws)
    assert (laid.table["velocity_m_s"] == 0.3).all()
    assert np.isfinite(laid.linear(laws).coefficient_columns()).all()
