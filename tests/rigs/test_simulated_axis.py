"""A user's simulator in the place of an axis' law, against laws and machines that are known."""

import numpy as np
import pytest
from reasons import explained
from rigs.driven_mass import Machine, simulate, write

import bayesfric as bf
from bayesfric.errors import InputError
from bayesfric.rigs import all_rigs
from bayesfric.simulators import SimulatorCalls, SimulatorRun, around

MADE = {"control_hz": 250.0, "bandwidth_hz": 5.0, "loop_delay_s": 0.0}
PRIORS = (("mass", "kg", bf.HalfNormal(4.0)), ("coulomb", "N", bf.HalfNormal(3.0)))


class Mass:
    """A mass with Coulomb friction, by impulses, written without a look at the package."""

    parameters = PRIORS

    def __init__(self, gain=1.0):
        self.gain = gain

    def predict(self, run, theta, extra_force=None):
        mass, coulomb = theta["mass"], theta["coulomb"]
        step = run.interval_s / 2
        q, v = run.position_m, run.velocity_m_s
        path = np.empty(run.time_s.size)
        for k, start in enumerate(run.time_s):
            path[k] = q
            for t in (start, start + step):
                force = run.drive(t)
                if extra_force is not None:
                    force += self.gain * extra_force(t, q, v)
                free = v + step * force / mass
                v = np.sign(free) * max(abs(free) - step * coulomb / mass, 0.0)
                q += step * v
        return path


MACHINE = {"runs": 2, "seconds": 4.0, "seed": 6}


@pytest.fixture(scope="module")
def plain():
    made = Machine(**MADE)
    return made, *simulate(made, **MACHINE)


@pytest.fixture(scope="module")
def viscous():
    made = Machine(**MADE, viscous=0.8)
    return made, *simulate(made, **MACHINE)


def recorded(folder, tables, change=lambda samples: samples, **rig):
    made, runs, samples = tables
    return bf.read_recording(write(folder / "axis", made, runs, change(samples), **rig))


def trials_of(recording):
    return all_rigs()["single-axis"].trials(recording)


@pytest.mark.usefixtures("lengths_not_searched")
def test_the_needed_force_is_that_of_the_law(tmp_path, plain):
    """Mass times ∫ φ'' q dt and Coulomb friction, which nothing of the simulator's has to know."""
    trials = trials_of(recorded(tmp_path, plain))
    beside = trials.beside(SimulatorCalls(Mass()))
    (mass, coulomb), rows = beside.simulated.centre, beside.readings
    assert (mass, coulomb) == pytest.approx((2.0, 1.5), rel=0.02)
    off = beside.simulated.needed(rows, (mass, coulomb)) - mass * rows.acceleration - coulomb
    assert np.sqrt(np.mean(off**2)) < 0.02 * coulomb
    columns = beside.simulated.columns(rows)
    assert np.abs(columns[:, 1] - 1).mean() < 0.01
    assert np.sqrt(np.mean((columns[:, 0] - rows.acceleration) ** 2)) < 0.05 * np.std(
        rows.acceleration
    )
    assert not columns[:, 2].any()


@pytest.mark.usefixtures("lengths_not_searched")
def test_calls_are_counted_before_they_are_made_and_none_is_made_twice(tmp_path, plain):
    announced, simulator = [], Mass()
    calls = SimulatorCalls(simulator, announce=announced.append)
    beside = trials_of(recorded(tmp_path, plain)).beside(calls)
    assert announced == [
        "Mass: at most 19 calls of the simulator, 3 × 3 for each of 2 runs, and one for what a "
        "pull counts"
    ]
    assert beside.simulated.calls == calls.made == 19


@pytest.mark.nightly
def test_a_simulator_without_viscous_friction_lacks_it(tmp_path, viscous):
    summary = bf.diagnose(recorded(tmp_path, viscous), simulator=Mass()).summary
    assert explained(summary).simulator is not None
    assert [cause.effect for cause in summary.causes] == ["viscous"]
    (slope,) = summary.causes[0].parameters.values()
    assert slope.q50 * summary.gap.friction_rms == pytest.approx(0.8, rel=0.2)
    assert (summary.baseline, summary.simulator.calls) == ("Mass", 19)
    numbers = summary.simulator.parameters
    assert numbers["mass"].q50 == pytest.approx(2.0, rel=0.02)
    assert (numbers["mass"].unit, numbers["coulomb"].unit) == ("kg", "N")


class Odd(Mass):
    """Returns what it should not."""

    def __init__(self, answer):
        super().__init__()
        self.answer = answer

    def predict(self, run, theta, extra_force=None):
        extra_force(run.time_s[0], 0.0, 0.0)
        return self.answer(run)


class Deaf(Mass):
    def predict(self, run, theta, extra_force=None):
        return super().predict(run, theta)


class Many(Mass):
    parameters = tuple((f"p{place}", "N", bf.HalfNormal(1.0)) for place in range(4))


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("simulator", "reason"),
    [
        (Mass(gain=0.5), "of a pull in the place of a drive force of 1"),
        (Deaf(), "to call extra_force"),
        (Odd(lambda run: np.full(run.time_s.size, np.nan)), "found 'none at 0 s, with mass ="),
        (Odd(lambda run: run.time_s[1:]), r"found 'an array of shape \(999,\)'"),
        (Odd(lambda run: 1 / 0), "ZeroDivisionError"),
        (Many(), "found '4 parameters', expected at most 3 free parameters"),
        ("nowhere:arm", "found 'nowhere:arm', expected module:object"),
        (object(), "expected an object with parameters and predict"),
    ],
    ids=["half", "deaf", "nan", "short", "raises", "many", "nowhere", "none"],
)
def test_what_is_no_simulator_is_refused_with_a_reason(tmp_path, plain, simulator, reason):
    with pytest.raises(InputError, match=reason):
        bf.diagnose(recorded(tmp_path, plain), simulator=simulator)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_law_beside_a_simulator_is_refused(tmp_path, plain):
    with pytest.raises(InputError, match="no --baseline, since Mass is the baseline"):
        bf.diagnose(recorded(tmp_path, plain), simulator=Mass(), baseline="viscous")


def test_a_board_that_logs_no_path_is_refused():
    recording = bf.simulate_recording("quick", seed=1)
    with pytest.raises(InputError, match="only a single axis logs"):
        bf.diagnose(recording, simulator=Mass())


def test_what_acted_is_averaged_around_each_sample_in_whatever_order_it_came():
    run = SimulatorRun("a", np.arange(4) * 0.1, np.zeros(4), 0.0, 0.0)
    at = np.random.default_rng(0).permutation(np.linspace(0.0, 0.3, 3001))
    averages = around(run, np.column_stack([at, 5 + 2 * at]))
    assert averages == pytest.approx([5.05, 5.2, 5.4, 5.55], abs=1e-9)


def with_column(name, value):
    return lambda samples: samples.assign(**{name: value(samples)})


def inverse(mass, coulomb):
    """Return the force that a law needs for a path, by splines through clean positions."""

    def force(samples):
        from scipy.interpolate import make_smoothing_spline

        parts = []
        for _, run in samples.groupby("run", sort=False):
            path = make_smoothing_spline(run["time_s"], run["position_m"], lam=1e-9)
            moved = mass * path.derivative(2)(run["time_s"])
            parts.append(moved + coulomb * np.sign(path.derivative()(run["time_s"])))
        return np.concatenate(parts)

    return force


@pytest.mark.nightly
def test_a_recorded_force_is_a_baseline_of_which_nothing_is_fitted(tmp_path, viscous):
    """The simulator's mass and friction are right: what it lacks is viscous friction alone."""
    change = with_column("sim_force_n", inverse(2.0, 1.5))
    summary = bf.diagnose(recorded(tmp_path, viscous, change)).summary
    assert (summary.baseline, summary.simulator.parameters) == ("sim_force_n", {})
    assert [cause.effect for cause in summary.causes] == ["viscous"]
    (slope,) = summary.causes[0].parameters.values()
    assert slope.q50 * summary.gap.friction_rms == pytest.approx(0.8, rel=0.2)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_mass_that_is_wrong_in_a_recorded_force_is_not_mended(tmp_path, plain):
    """A law fitted on top would take all of the 0.5 kg; the gap is its force instead."""
    change = with_column("sim_force_n", inverse(1.5, 1.5))
    trials = trials_of(recorded(tmp_path, plain, change))
    rows = trials.under(trials.own_law.law).linear({"axis": (0.0, 0.0, 0.0)})
    lacking = 0.5 * rows.readings.acceleration
    assert not rows.coefficient_columns().any()
    assert np.corrcoef(rows.residual(), lacking)[0, 1] > 0.98
    assert np.std(rows.residual()) == pytest.approx(np.std(lacking), rel=0.05)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_recorded_path_is_a_force_by_the_mass_that_it_moves(tmp_path, plain):
    """A path with 0.02 m/s² more of acceleration everywhere lacks 0.02 times the mass."""
    change = with_column("sim_position_m", lambda s: s["position_m"] + 0.01 * s["time_s"] ** 2)
    trials = trials_of(recorded(tmp_path, plain, change, moving_mass_kg=2.0))
    assert trials.own_law.law.name == "sim_position_m"
    rows = trials.under(trials.own_law.law).linear({"axis": (0.0, 0.0, 0.0)})
    assert rows.residual() * rows.readings.way == pytest.approx(0.04, abs=1e-6)


@pytest.mark.usefixtures("lengths_not_searched")
def test_a_path_without_a_mass_leaves_the_law(tmp_path, plain):
    change = with_column("sim_position_m", lambda samples: samples["position_m"])
    assert trials_of(recorded(tmp_path, plain, change)).own_law is None


@pytest.mark.usefixtures("lengths_not_searched")
def test_columns_of_a_run_reach_the_simulator(tmp_path, plain):
    seen = {}

    class Payload(Mass):
        def predict(self, run, theta, extra_force=None):
            seen[run.name] = run.columns["payload_kg"]
            return super().predict(run, theta, extra_force)

    made, runs, samples = plain
    tables = made, runs.assign(payload_kg=[0.0, 0.5]), samples
    trials_of(recorded(tmp_path, tables)).beside(SimulatorCalls(Payload()))
    assert (seen["r00"], seen["r01"]) == (0.0, 0.5)
