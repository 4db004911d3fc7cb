"""The likelihood of event times against quadrature, and against a dense normal."""

import dataclasses

import numpy as np
import pandas as pd
import pytest
from rigs.hall import SPACING, TICK, design, few_trials, likelihood_of, one_point, truth_by_name
from scipy import integrate, linalg, stats

from bayesfric.analysis import Analysis
from bayesfric.inference.cosines import MODES, cosine_variances, cosines
from bayesfric.recording.tables import Gravity, RigConstants
from bayesfric.rigs.gravity_board import late_clock
from bayesfric.rigs.gravity_board.late_clock import clock_sd_s
from bayesfric.rigs.gravity_board.measurements import event_table
from bayesfric.rigs.gravity_board.places import TrialPlaces
from bayesfric.rigs.gravity_board.screening import screen_trials
from bayesfric.rigs.gravity_board.wander import Wander
from bayesfric.rigs.opening import open_rigs
from bayesfric.simulate import simulate_recording


@pytest.fixture
def every_clock_drawn(monkeypatch):
    """Integrate the clocks' offset out at the noise of each walker, however well it is known."""
    monkeypatch.setattr(late_clock, "FAR_BETTER", np.inf)


def law_friction(row, values):
    """fc of eq. (15), implicit in the acceleration, by fixed-point iteration."""
    g, m1, m2 = 9.80665, row["mass_drive_kg"], row["mass_load_kg"]
    c1, c2, c3 = (values[f"{c}[{row['pulley_size']}]"] for c in ("c1", "c2", "c3"))
    friction = 0.0
    for _ in range(100):
        a = ((m1 - m2) * g - friction) / (m1 + m2)
        tension = 0.5 * ((m1 + m2) * g - (m1 - m2) * a)
        slope = c1 + c3 * (row["wrap_angle_deg"] - 85)
        friction = row["n_pulleys"] * (slope * tension + c2)
    return friction


def earlier(events, speed):
    """What the load sensor's clock adds to the travel per second that it is late, half to each."""
    load = (events["sensor"] == "load").to_numpy(float)
    return (0.5 - load) * speed * (0 < load.mean() < 1)


def normal_log_density(x, sd):
    return -0.5 * (x / sd) ** 2 - np.log(sd) - 0.5 * np.log(2 * np.pi)


def by_quadrature(row, events, values, clock_sd_s, nodes=24):
    """log p(times), integrated over friction, clocks, offsets and first speed, exact speeds."""
    g, mass = 9.80665, row["mass_drive_kg"] + row["mass_load_kg"]
    tau, columns = design(events)
    travel = events["displacement_m"].to_numpy()
    columns = np.column_stack([columns, tau**2 / 2])
    # A grid around the least-squares motion, along its principal axes.
    centre = np.linalg.lstsq(columns, travel, rcond=None)[0]
    speed = centre[-2] + centre[-1] * tau
    clock2 = values["sigma_t"] ** 2 + TICK**2 / 12
    weight = 1 / (values["sigma_x"] ** 2 + clock2 * speed**2)
    both = events["sensor"].nunique() == 2
    per_second = earlier(events, speed)
    if both:
        columns, nodes = np.column_stack([per_second, columns]), 12
    precision = columns.T @ (weight[:, None] * columns)
    precision[0, 0] += both / clock_sd_s**2
    root = np.linalg.cholesky(np.linalg.inv(precision))
    centre = np.linalg.solve(precision, columns.T @ (weight * travel))
    place, mass_of_node = np.polynomial.hermite_e.hermegauss(nodes)
    grid = np.meshgrid(*[place] * centre.size, indexing="ij")
    u = np.stack([axis.ravel() for axis in grid])
    log_weight = sum(np.meshgrid(*[np.log(mass_of_node)] * centre.size, indexing="ij")).ravel()
    points = centre[:, None] + root @ u
    log_density = np.zeros(points.shape[1])
    rows = zip(tau, travel, columns, np.sign(per_second), strict=True)
    for t, read, regressor, sign in rows:  # event by event: there are many nodes
        passed = t + 0.5 * sign * points[0] if both else t  # on the mean of both clocks
        v = points[-2] + points[-1] * passed
        moved = points[-2] * passed + points[-1] * passed**2 / 2
        offset = regressor[both:-2] @ points[both:-2]
        log_density += np.log(v)
        sd = np.sqrt(values["sigma_x"] ** 2 + clock2 * v**2)
        log_density += normal_log_density(moved + offset - read, sd)
    log_density += stats.halfnorm(scale=1.0).logpdf(points[-2])
    log_density -= (centre.size - 2 - both) * np.log(SPACING)
    if both:
        log_density += normal_log_density(points[0], clock_sd_s)
    friction = (row["mass_drive_kg"] - row["mass_load_kg"]) * g - mass * points[-1]
    law = law_friction(row, values)
    scatter = law * np.hypot(values["tau"], values["omega"])
    log_density += stats.norm(law, scatter).logpdf(friction) + np.log(mass)
    log_jacobian = np.log(np.abs(np.diag(root))).sum()
    log_grid = log_weight + 0.5 * (u**2).sum(axis=0)
    return np.logaddexp.reduce(log_density + log_grid) + log_jacobian


@pytest.mark.usefixtures("every_clock_drawn")
@pytest.mark.parametrize("sensors", [("drive", "load"), ("load",)])
@pytest.mark.parametrize("noise", [(30e-6, 20e-6), (5e-6, 80e-6), (60e-6, 1e-6)])
def test_one_trial_against_quadrature_over_all_nuisances(sensors, noise):
    recording = few_trials(1, 12, sensors=sensors)
    values = truth_by_name() | {"sigma_x": noise[0], "sigma_t": noise[1]}
    log_likelihood = likelihood_of(recording).setup_log_likelihood(one_point(values))[0, 0]
    row = recording.gravity.trials.iloc[0]
    prior = clock_sd_s(recording.rig)
    expected = by_quadrature(row, recording.gravity.events, values, prior)
    assert log_likelihood == pytest.approx(expected, abs=2e-3)


@pytest.mark.usefixtures("every_clock_drawn")
def test_an_assembly_against_one_dense_normal():
    """All events of four trials are jointly normal once speeds are the pilot's."""
    recording = few_trials(4, 15)
    values = truth_by_name() | {"tau": 0.02, "omega": 0.05}
    likelihood = likelihood_of(recording)
    log_likelihood = likelihood.setup_log_likelihood(one_point(values))
    assert log_likelihood.sum() == pytest.approx(dense_assembly(recording, values), abs=1e-5)


@pytest.mark.usefixtures("every_clock_drawn")
@pytest.mark.parametrize(
    "third",
    [
        {"wander": 0.02, "wander_length": 0.12},
        {"omega_intercept": 0.07},
        {"wander": 0.05, "wander_length": 0.04, "omega_intercept": 0.1},
    ],
)
def test_wander_and_scatter_of_the_intercept_against_one_dense_normal(third):
    recording = few_trials(4, 60)
    values = truth_by_name() | {"tau": 0.02, "omega": 0.05}
    likelihood = likelihood_of(recording)
    without, wandering = (
        likelihood.setup_log_likelihood(one_point(point)).sum()
        for point in (values, values | third)
    )
    plain, dense = (dense_assembly(recording, point) for point in (values, values | third))
    assert abs(dense - plain) > 0.1
    assert wandering - without == pytest.approx(dense - plain, abs=1e-6)


def test_a_newton_along_a_cosine_adds_its_double_integral():
    """Along parabolas, whose events are exact: by quadrature of the force over the mass."""
    spacing, mass, speed, rate = 0.0098, 3.2, 0.12, 0.7
    displacement = spacing * np.arange(58)
    time = (-speed + np.sqrt(speed**2 + 2 * rate * displacement)) / rate
    trials = pd.DataFrame(
        {
            "trial": ["a"],
            "setup": ["s"],
            "pulley_size": ["medium"],
            "n_pulleys": [9],
            "wrap_angle_deg": [85.0],
            "mass_drive_kg": [1.75],
            "mass_load_kg": [mass - 1.75],
        }
    )
    events = pd.DataFrame(
        {"trial": "a", "sensor": "drive", "displacement_m": displacement, "time_s": time}
    )
    rig = RigConstants(hall_spacing_m=spacing, timer_resolution_s=TICK)
    wander = Wander(TrialPlaces(Gravity(trials, events), rig), Analysis())
    fine = np.linspace(0, time[-1], 40_001)
    travel = speed * fine + rate * fine**2 / 2 + min(speed**2 / (2 * rate), spacing)
    for k, column in enumerate(wander.columns.travel, start=1):
        force = np.sqrt(2) * np.cos(k * np.pi * travel / travel[-1])
        once = integrate.cumulative_trapezoid(-force / mass, fine, initial=0)
        twice = integrate.cumulative_trapezoid(once, fine, initial=0)
        expected = np.interp(time, fine, twice)
        assert column == pytest.approx(expected, abs=1e-4 * np.abs(expected).max()), k


def test_the_wander_has_its_rms_and_its_correlation():
    """Of many cosines against the Matérn form, away from the ends of the interval."""
    length, place, count = 0.05, np.linspace(0.25, 0.75, 101), 64
    variance = cosine_variances(length, count)
    assert variance.sum() == pytest.approx(1.0, abs=1e-12)
    shapes = cosines(place, count)
    covariance = (shapes * variance[:, None]).T @ shapes
    apart = np.sqrt(3) * np.abs(place - 0.5) / length
    matern = (1 + apart) * np.exp(-apart)
    # Without its mean over the interval, and with what is reflected at the ends.
    assert covariance[50] / covariance[50, 50] == pytest.approx(matern, abs=0.15)
    assert np.diff(covariance[50, 50:]).max() < 0
    middle = cosines((np.arange(1000) + 0.5) / 1000, count)
    assert middle.mean(axis=1) == pytest.approx(np.zeros(count), abs=1e-12)
    assert (middle**2).mean(axis=1) == pytest.approx(np.ones(count), abs=1e-9)


def dense_assembly(recording, values):
    """Return the log density of all events of trials of one assembly, as one normal."""
    likelihood = likelihood_of(recording)
    columns_of_wander = likelihood.model._wander.columns.travel
    extent = likelihood.model._places.travel_m.max()
    order = np.arange(1, len(columns_of_wander) + 1)
    share = (1 + (order * np.pi * values["wander_length"] / extent) ** 2 / 3) ** -2.0
    share = share / share.sum()
    g, clock2 = 9.80665, values["sigma_t"] ** 2 + TICK**2 / 12
    means, noise, loads, intercepts, nuisances, travels, wanders, late = ([] for _ in range(8))
    log_factor, done = 0.0, 0
    for _, row in likelihood.trials.iterrows():
        events = recording.gravity.events.query("trial == @row.trial")
        tau, columns = design(events)
        travel = events["displacement_m"].to_numpy()
        pilot = np.linalg.lstsq(np.column_stack([columns, tau**2 / 2]), travel, rcond=None)[0]
        speed = pilot[-2] + pilot[-1] * tau
        law, mass = law_friction(row, values), row["mass_drive_kg"] + row["mass_load_kg"]
        drive = (row["mass_drive_kg"] - row["mass_load_kg"]) * g
        means.append((drive - law) / mass * tau**2 / 2)
        loads.append(-law / mass * tau**2 / 2)  # of 1 + η + ε
        intercept = row["n_pulleys"] * values[f"c2[{row['pulley_size']}]"]
        intercepts.append(-intercept / mass * tau**2 / 2)  # of κ
        noise.append(values["sigma_x"] ** 2 + clock2 * speed**2)
        late.append(clock_sd_s(recording.rig) * earlier(events, speed))
        wanders.append(law * columns_of_wander[:, done : done + len(tau)])
        done += len(tau)
        nuisances.append(columns)
        travels.append(travel)
        # Flat offsets of density 1/h; the prior of the first speed at the pilot's.
        log_factor += np.log(speed).sum() - 2 * np.log(SPACING)
        log_factor += stats.halfnorm.logpdf(pilot[2])
    covariance = np.diag(np.concatenate(noise))
    covariance += linalg.block_diag(*(np.outer(column, column) for column in late))
    covariance += values["omega"] ** 2 * np.outer(*2 * [np.concatenate(loads)])
    covariance += values["omega_intercept"] ** 2 * np.outer(*2 * [np.concatenate(intercepts)])
    covariance += linalg.block_diag(
        *(
            values["tau"] ** 2 * np.outer(load, load)
            + values["wander"] ** 2 * (wander.T * share) @ wander
            for load, wander in zip(loads, wanders, strict=True)
        )
    )
    # Flat numbers are integrated out of a dense normal by generalised least squares.
    root = np.linalg.cholesky(covariance)
    columns = np.linalg.solve(root, linalg.block_diag(*nuisances))
    residual = np.linalg.solve(root, np.concatenate(travels) - np.concatenate(means))
    fit = np.linalg.lstsq(columns, residual, rcond=None)[0]
    square = ((residual - columns @ fit) ** 2).sum()
    freedom = residual.size - fit.size
    log_determinant = 2 * np.log(np.diag(root)).sum() + np.linalg.slogdet(columns.T @ columns)[1]
    return log_factor - 0.5 * (freedom * np.log(2 * np.pi) + log_determinant + square)


def test_pilot_speeds_cost_less_than_a_hundredth_of_a_nat_over_quick():
    """Exact speeds in weights and Jacobian, by quadrature around each trial's motion."""
    recording = simulate_recording("quick", seed=11)
    likelihood = likelihood_of(recording)
    place, mass_of_node = np.polynomial.hermite_e.hermegauss(5)
    u = np.stack([axis.ravel() for axis in np.meshgrid(*[place] * 4, indexing="ij")])
    node = np.prod(np.meshgrid(*[mass_of_node / mass_of_node.sum()] * 4), axis=0).ravel()
    events_of = dict(list(recording.gravity.events.groupby("trial")))
    sd_of_bulk = {"sigma_x": 0.02, "sigma_t": 0.08, "tau": 0.1, "omega": 0.2, "c1": 0.01}
    for sign in (-1, 0, 1):  # the truth, and two corners of the posterior's bulk
        values = {
            name: value * (1 + sign * sd_of_bulk.get(name.partition("[")[0], 0.0))
            for name, value in truth_by_name().items()
        }
        clock2 = values["sigma_t"] ** 2 + TICK**2 / 12
        error = 0.0
        for _, row in likelihood.trials.iterrows():
            tau, columns = design(events_of[row["trial"]])
            travel = events_of[row["trial"]]["displacement_m"].to_numpy()
            columns = np.column_stack([columns, tau**2 / 2])
            pilot = np.linalg.lstsq(columns, travel, rcond=None)[0]
            speed = pilot[2] + pilot[3] * tau
            sd = np.sqrt(values["sigma_x"] ** 2 + clock2 * speed**2)
            law = law_friction(row, values)
            mass = row["mass_drive_kg"] + row["mass_load_kg"]
            prior = ((row["mass_drive_kg"] - row["mass_load_kg"]) * 9.80665 - law) / mass
            prior_sd = law * np.hypot(values["tau"], values["omega"]) / mass
            precision = columns.T @ (columns / sd[:, None] ** 2)
            right = columns.T @ (travel / sd**2)
            precision[3, 3] += 1 / prior_sd**2
            right[3] += prior / prior_sd**2
            root = np.linalg.cholesky(np.linalg.inv(precision))
            points = np.linalg.solve(precision, right)[:, None] + root @ u
            exact = points[2] + points[3] * tau[:, None]
            exact_sd = np.sqrt(values["sigma_x"] ** 2 + clock2 * exact**2)
            residual = columns @ points - travel[:, None]
            log_ratio = np.log(exact / speed[:, None]) - np.log(exact_sd / sd[:, None])
            log_ratio -= 0.5 * residual**2 * (1 / exact_sd**2 - 1 / sd[:, None] ** 2)
            error += np.log(node @ np.exp(log_ratio.sum(axis=0)))
        assert abs(error) < 0.01


def test_clock_rounding_adds_its_own_variance():
    recording = few_trials(1, 12)
    one_clock = dataclasses.replace(recording.rig, sensor_clock_sd_s=0.0)  # else the tick widens it
    recording = dataclasses.replace(recording, rig=one_clock)
    likelihood = likelihood_of(recording)
    coarse = dataclasses.replace(recording.rig, timer_resolution_s=40e-6)
    rounded = likelihood_of(dataclasses.replace(recording, rig=coarse))
    values = truth_by_name()
    same = values | {"sigma_t": np.sqrt(values["sigma_t"] ** 2 + (40e-6**2 - TICK**2) / 12)}
    log_likelihood = rounded.setup_log_likelihood(one_point(values))
    assert log_likelihood == pytest.approx(
        likelihood.setup_log_likelihood(one_point(same)), abs=1e-6
    )


def test_numbers_are_integrated_out_walker_by_walker():
    """A few walkers in several intervals, against each of them alone."""
    recording = few_trials(4, 40)
    gravity = recording.gravity
    wander = TrialPlaces(gravity, recording.rig).wander
    table = event_table(gravity, recording.rig, wander, wander)
    rng = np.random.default_rng(1)
    sigma_x, sigma_t = 10.0 ** rng.uniform(-5, -4, (2, 7))
    sigma_t[3:] *= 30
    variances = list(rng.uniform(0, 1e-3, (MODES, 7, 4)))
    motions = [[*rng.standard_normal((1 + MODES, 7, 4)), end] for end in (0.0, -1.0)]
    together = table.at(sigma_x, sigma_t, variances, motions)
    for walker in range(7):
        row = slice(walker, walker + 1)
        alone = table.at(
            sigma_x[row],
            sigma_t[row],
            [variance[row] for variance in variances],
            [[*(x[row] for x in motion[:-1]), motion[-1]] for motion in motions],
        )
        assert together.triangle[:, walker] == pytest.approx(alone.triangle[:, 0], rel=1e-9)
        assert together.log_constant[walker] == pytest.approx(alone.log_constant[0], rel=1e-9)


def test_stalled_trial_enters_and_leaves_what_moved_all_the_way():
    recording = few_trials(3, 30)
    events = recording.gravity.events.copy()
    stalled = recording.gravity.trials["trial"][1]
    rows = (events["trial"] == stalled).to_numpy()
    travel = events.loc[rows, "displacement_m"].to_numpy()
    # 0.35 m/s at first, −0.2 m/s²: stops after 0.306 m, just past the 30th event.
    events.loc[rows, "time_s"] = 1.0 + (0.35 - np.sqrt(0.35**2 - 0.4 * travel)) / 0.2
    assert 0.35**2 / 0.4 - travel.max() < 2.5 * SPACING
    slower = Gravity(recording.gravity.trials, events)
    assert screen_trials(slower, recording.rig).excluded == {}
    events.loc[rows, "time_s"] = 1.0 + (0.339 - np.sqrt(0.339**2 - 0.4 * travel)) / 0.2
    slower = Gravity(recording.gravity.trials, events)
    screened = screen_trials(slower, recording.rig)
    assert screened.excluded == {}
    assert screened.stalled == (stalled,)
    (entering,) = open_rigs(dataclasses.replace(recording, gravity=slower), ["gravity"])
    assert stalled in set(entering.table["trial"])
    assert set(entering.table["trial"]) - set(entering.moved().table["trial"]) == {stalled}
    assert stalled not in set(entering.entering().table["trial"])
