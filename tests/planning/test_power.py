"""What a design can tell, against the exact likelihood of recordings that were made by it."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from rigs.driven_mass import Machine, simulate, write
from rigs.friction_points import joint, recorded, slide
from typer.testing import CliRunner

from bayesfric.analysis import Analysis, LogNormal, Priors
from bayesfric.cli import app
from bayesfric.effects import all_effects
from bayesfric.errors import InputError
from bayesfric.fitting.hypothesis import LawWithEffects, model_of
from bayesfric.inference.laplace import laplace_approximation
from bayesfric.inference.power import log_bayes_factor
from bayesfric.planning import power
from bayesfric.recording import read_recording, write_recording
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import open_rigs
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import AppliedEffect, Truth, simulate_recording

DESIGN = Protocol({(9, 85.0): 2, (15, 50.0): 1, (5, 135.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
USUAL = {"tau": 0.01, "omega": 0.015, "omega_intercept": 0.015, "wander": 0.001}
KNOWN = Priors(
    **{name: LogNormal(median=value, sd_log=0.01) for name, value in USUAL.items()},
    wander_length=LogNormal(median=0.1, sd_log=0.01),
    sigma_x=LogNormal(median=3e-5, sd_log=0.01),
    sigma_t=LogNormal(median=1e-6, sd_log=0.01),
)
ANALYSIS = Analysis(priors=KNOWN)
VISCOUS = ("viscous", "constant")


def made(seed, slope=0.0):
    effects = all_effects(None)
    acting = (AppliedEffect(effects["viscous"], "constant", {"slope": slope}),) if slope else ()
    truth = Truth(**USUAL, sigma_x=3e-5, sigma_t=1e-6, effects=acting)
    return simulate_recording(DESIGN, seed=seed, truth=truth, rigs=("gravity",))


def modes_and_sds(recording, effects=()):
    """Return mode and sd of each parameter by the exact likelihood, in their units."""
    data = Data(open_rigs(recording, ["gravity"]))
    model = model_of(data, ANALYSIS, LawWithEffects(effects=effects), all_effects(None))
    laplace = laplace_approximation(model.log_posterior, model.start(), model.scale())
    step = 1e-3 * np.sqrt(np.diag(laplace.covariance))
    ends = model.natural(laplace.mode + np.array([-1.0, 1.0])[:, None, None] * np.diag(step))
    slope = np.diagonal(ends[1] - ends[0]) / (2 * step)
    mode = model.natural(laplace.mode[None])[0]
    sd = slope * np.sqrt(np.diag(laplace.covariance))
    return dict(zip(model.names, zip(mode, sd, strict=True), strict=True))


@pytest.fixture(scope="module")
def plan():
    return power(made(1), ANALYSIS)


def test_coefficients_are_known_as_well_as_the_exact_likelihood_knows_them(plan):
    fits = modes_and_sds(made(2))
    for name, row in plan.coefficients.iterrows():
        assert row["sd"] == pytest.approx(fits[name][1], rel=0.15), name
    assert plan.coefficients["informed"].all()


def test_what_was_measured_does_not_enter(plan):
    """The same trials on a board with another friction: one answer."""
    again = power(made(1, slope=0.02), ANALYSIS)
    np.testing.assert_allclose(plan.coefficients["sd"], again.coefficients["sd"], rtol=1e-6)
    np.testing.assert_allclose(plan.effects["smallest"], again.effects["smallest"], rtol=1e-6)


def test_the_error_of_an_amplitude_is_that_of_the_exact_likelihood(plan):
    smallest = plan.effects.loc["viscous/constant", "smallest"]
    prior = all_effects(None)["viscous"].amplitude.prior
    mode, sd = modes_and_sds(made(3, slope=smallest), (VISCOUS,))["viscous.slope"]
    assert abs(mode - smallest) < 4 * sd
    # At the threshold's estimate, 1.28 errors below: the odds that support asks for.
    odds = ANALYSIS.claims.support_log10_bayes_factor * np.log(10)
    assert log_bayes_factor(smallest - 1.2816 * sd, sd, prior) == pytest.approx(odds, abs=0.7)


@pytest.mark.nightly
def test_an_effect_of_that_size_is_found_nine_times_in_ten(plan):
    """Of 60 recordings; bounds of 99 % of a binomial number of 54."""
    smallest = plan.effects.loc["viscous/constant", "smallest"]
    prior = all_effects(None)["viscous"].amplitude.prior
    odds = ANALYSIS.claims.support_log10_bayes_factor * np.log(10)
    hits = 0
    for seed in range(500, 560):
        mode, sd = modes_and_sds(made(seed, slope=smallest), (VISCOUS,))["viscous.slope"]
        hits += log_bayes_factor(mode + mode * sd**2 / prior.scale**2, sd, prior) > odds
    assert 47 <= hits <= 59


def test_what_acts_alike_is_a_pair(plan):
    """A longer spacing and a slower clock: one is the other, and no force is like them."""
    pairs = {frozenset(row) for row in plan.pairs[["effect", "other"]].to_numpy().tolist()}
    assert frozenset({"clock-scale", "length-scale"}) in pairs
    assert plan.pairs["correlation"].iloc[0] == pytest.approx(1.0, abs=1e-6)
    assert not any({"viscous", "end-asymmetry"} <= pair for pair in pairs)


def test_one_angle_leaves_c3_to_its_prior_and_another_angle_tells_it():
    design = Protocol({(9, 85.0): 2, (15, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
    planned = power(simulate_recording(design, seed=4, rigs=("gravity",)))
    informed = planned.coefficients["informed"]
    assert not informed[["c3[small]", "c3[medium]", "c3[large]"]].any()
    assert informed[["c1[small]", "c2[large]"]].all()
    # The prior is a share of the c1 of Table I, for which it is planned.
    assert planned.coefficients.loc["c3[large]", "sd"] == pytest.approx(0.005 * 0.00239, rel=1e-6)


def test_the_next_condition_is_one_that_this_size_can_have(plan):
    trials = made(1).gravity.trials
    for name, row in plan.next_condition.iterrows():
        own = trials[trials["pulley_size"] == name.partition("[")[2][:-1]]
        pairs = own[["mass_drive_kg", "mass_load_kg"]].to_numpy().tolist()
        assert [row["mass_drive_kg"], row["mass_load_kg"]] in pairs, name
        assert 0.3 < row["factor"] < 1.0


@pytest.mark.parametrize(("setups", "shared"), [(None, 0.001), (8, 0.015)])
def test_a_bench_knows_its_law_as_least_squares_does(tmp_path, setups, shared):
    """Of 40 points with stated errors: friction scatters by 1 %, and by the assembly if told."""
    setup = np.arange(40) % (setups or 40)
    points = slide() | {"friction_sd_n": np.full(40, 0.1)}
    if setups:
        points["setup"] = [f"a{number}" for number in setup]
    coefficients = power(recorded(tmp_path / "slide", points)).coefficients
    load = np.asarray(points["tension_n"])
    design = np.stack([load, np.ones(40)], axis=1)
    friction = design @ coefficients["value"].loc[["c1", "c2"]]
    alike = np.equal.outer(setup, setup)
    loaded = alike & np.equal.outer(load, load)
    covariance = np.diag((0.01 * friction) ** 2 + 0.1**2)
    covariance += np.outer(friction, friction) * (shared**2 * alike + 0.001**2 * loaded)
    sd = np.sqrt(np.diag(np.linalg.inv(design.T @ np.linalg.solve(covariance, design))))
    np.testing.assert_allclose(coefficients["sd"].loc[["c1", "c2"]], sd, rtol=0.02)


def test_a_machine_whose_friction_nobody_knows_takes_its_size_from_its_forces(tmp_path):
    """Twice the friction is twice the coefficient, known alike and to tell the same effects."""
    plans = [
        power(recorded(tmp_path / str(force), joint(3.0, force=force), rotary=True))
        for force in (1.0, 2.0)
    ]
    plain, twice = (plan.coefficients.loc["c2"] for plan in plans)
    assert twice["value"] == pytest.approx(2 * plain["value"], rel=1e-6)
    assert twice["sd"] == pytest.approx(2 * plain["sd"], rel=1e-3)
    shares = [plan.effects["share"].to_numpy(dtype=float) for plan in plans]
    np.testing.assert_allclose(*shares, rtol=1e-3)
    assert "viscous/constant" in plans[0].effects.index
    assert plans[0].left_out["tension-curvature/quadratic"].endswith("to its prior")


@pytest.mark.nightly
def test_an_axis_that_runs_twice_as_often_knows_its_mass_better_by_the_root_of_two(tmp_path):
    def again(table):
        more = {"run": "again-" + table["run"]}
        if "order" in table:
            more["order"] = table["order"] + len(table)
        else:  # an exact copy would count once
            more["force_n"] = table["force_n"] + 1e-6
        return table.assign(**more)

    machine = Machine()
    table, samples = simulate(machine, runs=4, seconds=5.0, seed=2)
    twice = [pd.concat([part, again(part)]) for part in (table, samples)]
    coefficients_of_plans = []
    for name, tables in (("once", (table, samples)), ("twice", twice)):
        written = write(tmp_path / name, machine, *tables)
        coefficients_of_plans.append(power(read_recording(written)).coefficients)
    few, doubled = coefficients_of_plans
    assert few.index.tolist() == ["mass", "coulomb", "viscous"]
    assert doubled["sd"]["mass"] == pytest.approx(few["sd"]["mass"] / np.sqrt(2), rel=0.05)


def test_a_motor_board_tells_its_torque_constant_from_friction():
    recording = simulate_recording(DESIGN, seed=5, rigs=("motor",))
    plan, again = power(recording), power(simulate_recording(DESIGN, seed=6, rigs=("motor",)))
    assert "torque-constant/scaled" in plan.effects.index
    planned, other = (power_of.coefficients["sd"].sort_index() for power_of in (plan, again))
    np.testing.assert_allclose(planned, other, rtol=0.02)


def test_conditions_at_which_nothing_moves_are_refused():
    recording = made(1)
    trials = recording.gravity.trials.assign(mass_load_kg=lambda t: t["mass_drive_kg"] - 1e-4)
    still = replace(recording, gravity=replace(recording.gravity, trials=trials))
    with pytest.raises(InputError, match=r"found 'gravity board'.*at which something moves"):
        power(still)


def test_the_verb_prints_it(tmp_path):
    plan_by_default = power(made(1))
    write_recording(made(1), tmp_path / "board")
    done = CliRunner().invoke(app, ["validate", str(tmp_path / "board"), "--power"])
    assert done.exit_code == 0, done.output
    lines = done.output.splitlines()
    assert "Effects: the smallest found with probability 0.9" in lines
    (row,) = (line.split() for line in lines if line.startswith("viscous/constant"))
    assert float(row[1]) == pytest.approx(plan_by_default.effects["smallest"][row[0]], rel=5e-3)
    nothing = lines[lines.index("Effects that are not computed") + 1 :]
    assert sum("runout" in line for line in nothing) == 1
