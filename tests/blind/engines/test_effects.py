"""Own forms against the package's effects, and strengths against sums by hand."""

import numpy as np
import pytest
from blind.engines.boards import G, nature

from bayesfric.blind.engines.boards import board_of, motor_currents, motor_state
from bayesfric.blind.engines.catalogue import EFFECTS, OUTSIDERS_BY_NAME
from bayesfric.blind.engines.design import Bench, Trials, bench_of, trials_of
from bayesfric.blind.engines.law import RADII_M, SIZES, TABLE_I
from bayesfric.blind.engines.motion import move
from bayesfric.blind.engines.recorder import event_trains
from bayesfric.blind.engines.state import ImposedEffect, Passage
from bayesfric.blind.engines.strength import CleanDesign, scaled, share_of_friction
from bayesfric.effects import Reading, all_effects
from bayesfric.paper import table1
from bayesfric.rigs.protocols import Protocol
from bayesfric.rigs.truth import AppliedEffect
from bayesfric.simulate import Truth, simulate_recording

SMALL = Protocol({(15, 50.0): 1}, (6.0, 30.0), (6.0, 30.0), 2)
STILL = {"tau": 0.0, "omega": 0.0, "sigma_x": 1e-12, "sigma_t": 1e-12}
STEADY = {"tau_motor": 0.0, "omega_motor": 0.0, "sigma_current": 1e-12, "load_noise": 0.0}
# Effect, our form, the package's law, amplitude, shape by the package's name.
OWN = [
    ("viscous", "constant", "constant", 0.12, {}),
    ("viscous", "with-tension", "tension", 0.12, {}),
    ("viscous", "with-wrap", "wrap", 0.12, {}),
    ("air-drag", "quadratic", "quadratic", 0.08, {}),
    ("stribeck", "exponential", "exponential", 0.2, {"speed": 0.15}),
    ("stribeck", "gaussian", "gaussian", 0.2, {"speed": 0.15}),
    ("presliding", "exponential", "exponential", 0.3, {"length": 0.02}),
    ("presliding", "rational", "rational", 0.3, {"length": 0.02}),
    ("hysteresis", "dahl", "dahl", 0.25, {"length": 0.05}),
    ("hysteresis", "bouc-wen", "bouc-wen", 0.25, {"length": 0.05}),
    ("tension-curvature", "quadratic", "quadratic", 0.2, {}),
    ("tension-curvature", "power", "power", -0.2, {}),
    ("wrap-curvature", "quadratic", "quadratic", 0.2, {}),
    ("wrap-intercept", "linear", "linear", 0.15, {}),
    ("fixed-drag", "constant", "constant", 0.05, {}),
    ("pulley-count-curvature", "power", "power", 0.2, {}),
    ("pulley-inertia", "same", "same", 0.006, {}),
    ("pulley-inertia", "discs", "discs", 0.006, {}),
    ("cable-weight", "passing", "passing", 0.012, {"middle": 0.6}),
    ("cable-weight", "off-centre", "passing", 0.012, {"middle": 0.4}),
    ("mass-error", "drive-side", "drive-side", 0.006, {}),
    ("mass-error", "load-side", "load-side", 0.006, {}),
    ("wear-drift", "linear", "exponential", 0.3, {"rate": 0.0}),
    ("wear-drift", "saturating", "exponential", 0.3, {"rate": -5.0}),
    ("end-asymmetry", "relative", "relative", -0.2, {}),
    ("end-asymmetry", "constant", "constant-part", -0.2, {}),
    ("bed-in", "exponential", "exponential", 0.3, {"trials": 2.0}),
    ("bed-in", "hyperbolic", "hyperbolic", 0.3, {"trials": 2.0}),
    ("length-scale", "proportional", "proportional", 0.02, {}),
    ("clock-scale", "proportional", "proportional", 0.01, {}),
    ("slip", "proportional", "proportional", 0.03, {}),
]


def simulated(effects, rigs):
    truth = Truth(effects=effects, **STILL, **STEADY)
    return simulate_recording(SMALL, seed=4, truth=truth, rigs=rigs)


def applied(name, law, amplitude, shape):
    effect = all_effects()[name]
    return AppliedEffect(effect, law, {effect.amplitude.name: amplitude, **shape})


def trials_like(table):
    return Trials(
        *(
            table["setup"].factorize()[0],
            table["pulley_size"].map(SIZES.index).to_numpy(),
            table["n_pulleys"].to_numpy(dtype=float),
            table["wrap_angle_deg"].to_numpy(),
            table["mass_drive_kg"].to_numpy(),
            table["mass_load_kg"].to_numpy(),
            (table["drive_end"] == "left").to_numpy(),
        )
    )


def accelerations(times):
    """Return the acceleration of a quadratic through each half of each train."""
    return np.array(
        [
            2 * np.polyfit(part - part[0], 0.0098 * np.arange(part.size), 2)[0]
            for time in times
            for part in (time[:30], time[30:60])
        ]
    )


@pytest.fixture(scope="module")
def plain():
    return simulated((), ["gravity"])


@pytest.fixture(scope="module")
def pure(plain):
    return accelerations(theirs(plain)), accelerations(ours(plain, []))


def theirs(recording):
    return [
        t.to_numpy() for _, t in recording.gravity.events.groupby(["trial", "sensor"])["time_s"]
    ]


def ours(recording, effects):
    """Return our times with the phases of theirs: their travel before the first event."""
    board = board_of(nature(), trials_like(recording.gravity.trials))
    phases = {False: [], True: []}
    for i, time in enumerate(theirs(recording)):
        fit = np.polyfit(time, 0.0098 * np.arange(time.size), 2)
        phases[i % 2 == 1].append([fit[1] ** 2 / fit[0] / 4 - fit[2]])
    phases = {end: np.array(travel) for end, travel in phases.items()}
    start = np.zeros_like(board.drive_kg)
    rng = np.random.default_rng(0)
    trains = event_trains(board, move(board, effects), effects, phases, start, None, rng)
    by_place = {(train.trial, train.sensor): train.time_s for train in trains}
    return [by_place[key] for key in sorted(by_place)]


@pytest.mark.parametrize(("name", "form", "law", "amplitude", "shape"), OWN)
def test_own_forms_do_what_the_packages_effects_do(plain, pure, name, form, law, amplitude, shape):
    recording = simulated([applied(name, law, amplitude, shape)], ["gravity"])
    expected = accelerations(theirs(recording)) - pure[0]
    kind = EFFECTS[name]
    (same,) = (candidate_form for candidate_form in kind.forms if candidate_form.name == form)
    assert same.own
    effect = ImposedEffect(kind, same, shape, amplitude)
    changed = accelerations(ours(plain, [effect])) - pure[1]
    # Of 15 pulleys with T's share c1, the tension grows by 15 c1 on the way, 19 % where small:
    # the two differ by about half of that where an effect changes the tension itself.
    size = np.repeat(plain.gravity.trials["pulley_size"].to_numpy(), 4)
    for name, tolerance in (("large", 0.025), ("medium", 0.04), ("small", 0.13)):
        of = size == name
        assert np.abs(changed - expected)[of].max() < tolerance * np.abs(expected)[of].max()
        assert np.abs(expected)[of].max() > 1e-3


def test_the_ringing_is_the_packages():
    time, masses = np.linspace(0, 0.4, 50)[None], (np.array([[1.6]]), np.array([[1.2]]))
    law = all_effects()["cable-compliance"].laws["ringing"]
    (form,) = (
        candidate_form for candidate_form in EFFECTS["cable-compliance"].forms if candidate_form.own
    )
    for at_load in (False, True):
        reading = Reading(0.0, 0.0, float(at_load), time, 1.0, 1.0, *masses, 5)
        nothing = np.zeros((1, 1))
        at = Passage(nothing, at_load, nothing, time, nothing, *masses, nothing, nothing, magnets=5)
        delay = form.law({"amplitude": 1e-4, "stiffness": 9400.0}, at, 0.0)
        expected = law({"stretch": 1e-4, "stiffness": 9400.0}, reading)
        assert delay == pytest.approx(expected, abs=1e-18)
        assert np.ptp(expected) > 5e-5


@pytest.mark.parametrize(
    ("name", "form", "law", "amplitude"),
    [
        ("viscous", "with-tension", "tension", 0.12),
        ("air-drag", "quadratic", "quadratic", 0.08),
        ("fixed-drag", "constant", "constant", 0.05),
        ("torque-constant", "scaled", "scaled", 0.02),
        ("current-offset", "constant", "constant", 0.02),
    ],
)
def test_own_forms_on_the_motor_board(name, form, law, amplitude):
    without = simulated((), ["motor"]).motor.runs
    recording = simulated([applied(name, law, amplitude, {})], ["motor"])
    expected = (recording.motor.runs["current_a"] - without["current_a"]).to_numpy()
    runs = recording.motor.runs
    bench = Bench(
        runs["setup"].factorize()[0],
        runs["pulley_size"].map(SIZES.index).to_numpy(),
        runs["n_pulleys"].to_numpy(dtype=float),
        runs["wrap_angle_deg"].to_numpy(),
        runs["hanging_mass_kg"].to_numpy(),
        runs["velocity_m_s"].to_numpy(),
    )
    kind = EFFECTS[name]
    (same,) = (candidate_form for candidate_form in kind.forms if candidate_form.name == form)
    state, ones = motor_state(nature(), bench), np.ones((len(bench), 1))
    currents = motor_currents(state, [ImposedEffect(kind, same, {}, amplitude)], ones)[0]
    currents = (currents - motor_currents(state, [], ones)[0])[:, 0]
    assert np.abs(currents - expected).max() < 0.03 * np.abs(expected).max()


def test_the_motor_raises_the_weight_against_friction():
    bench = Bench(*(np.array([value]) for value in (0, 1, 1.0, 85.0, 1.5, 0.3)))
    c1, c2, _ = TABLE_I[1]
    read, load = motor_currents(motor_state(nature(), bench), [], np.array([[1.1]]))
    by_hand = (1.5 * G + 1.1 * (c1 * 1.5 * G + c2)) * 0.0065 / 0.0259
    assert read[0, 0] == pytest.approx(by_hand, rel=1e-12)
    assert load[0, 0] == read[0, 0]


def clean_design():
    board = board_of(nature(), trials_of(np.random.default_rng(1)))
    phases = {end: np.full((180, 1), 0.004) for end in (False, True)}
    runs = motor_state(nature(), bench_of(np.random.default_rng(2)))
    return CleanDesign.of(board, move(board, ()), phases, runs)


@pytest.fixture(scope="module")
def clean():
    return clean_design()


def friction_by_hand(board):
    """Return friction and acceleration with the mean tension, eqs (4) and (15)."""
    s = board.state
    slope, constant = s.n_pulleys * s.slope, s.n_pulleys * s.constant_n
    pull, both = (board.drive_kg - board.load_kg) * G, board.drive_kg + board.load_kg
    change = (board.drive_kg - board.load_kg) / 2
    a = (pull - slope * both * G / 2 - constant) / (both - slope * change)
    return pull - both * a, a


def amplitude_of(clean, name, form, strength=1.0, **shape):
    kind = EFFECTS[name]
    (same,) = (candidate_form for candidate_form in kind.forms if candidate_form.name == form)
    return scaled(ImposedEffect(kind, same, shape, 1.0, strength), clean).amplitude


def test_full_strength_is_ten_per_cent_of_friction(clean):
    friction, a = friction_by_hand(clean.board)
    both = clean.board.drive_kg + clean.board.load_kg

    def rms(values):
        return np.sqrt(np.mean(np.square(values)))

    mass = amplitude_of(clean, "pulley-inertia", "same")
    assert rms(mass * clean.board.state.n_pulleys * a / friction) == pytest.approx(0.1, rel=0.03)
    excess = amplitude_of(clean, "length-scale", "proportional")
    assert rms(excess * both * a / friction) == pytest.approx(0.1, rel=0.03)
    # A clock that is off by ε is off by 2 ε in acceleration.
    assert amplitude_of(clean, "clock-scale", "proportional") == pytest.approx(excess / 2, rel=0.03)
    # One sensor of two sees it.
    slip = amplitude_of(clean, "slip", "proportional")
    assert slip == pytest.approx(np.sqrt(2) * excess, rel=1e-6)
    state = clean.bench
    runs = state.n_pulleys * (state.slope * (state.tension_n) + state.constant_n)
    drag = amplitude_of(clean, "fixed-drag", "constant")
    shares = rms(drag / friction), rms(drag / runs)
    assert rms(shares) == pytest.approx(0.1, rel=0.05)


def test_strength_follows_the_time_of_a_trial(clean):
    # From rest v = a t, so that over the time of a trial the mean of v² is v_end²/3.
    friction, a = friction_by_hand(clean.board)
    state = clean.bench
    runs = state.n_pulleys * (state.slope * state.tension_n + state.constant_n)
    ratio = clean.board.state.n_pulleys * clean.board.state.scale_n / friction
    trial = np.mean(ratio**2 * 2 * a * 0.6 / 3)
    run = np.mean((state.n_pulleys * state.scale_n * state.speed_m_s / runs) ** 2)
    slope = amplitude_of(clean, "viscous", "constant", 0.5)
    assert slope * np.sqrt((trial + run) / 2) == pytest.approx(0.05, rel=0.05)


def test_beds_in_by_the_trials_of_its_own_assembly(clean):
    state = clean.board.state
    place = state.trial_in_setup[:, 0]
    assert place.tolist() == list(range(6)) * 30  # 30 assemblies of 6 trials
    forms = {form.name: form for form in EFFECTS["bed-in"].forms}
    for name, shape, left in (
        ("exponential", {"trials": 2.0}, np.exp(-place / 2)),
        ("hyperbolic", {"trials": 2.0}, 1 / (1 + place / 2)),
        ("power", {}, 1 / np.sqrt(1 + place)),
    ):
        effect = ImposedEffect(EFFECTS["bed-in"], forms[name], shape, 0.2)
        entering = np.full_like(state.slope, 15.0)
        excess = effect(state, entering) / state.friction(entering)
        assert excess[:, 0] == pytest.approx(0.2 * left, rel=1e-12)


def test_only_the_constant_part_differs_with_the_end(clean):
    state = clean.board.state
    forms = {form.name: form for form in EFFECTS["end-asymmetry"].forms}
    effect = ImposedEffect(EFFECTS["end-asymmetry"], forms["constant"], {}, 0.2)
    # The trials of an assembly swap ends in turn, the first with the drive mass on the right.
    expected = 0.2 * np.tile([0.5, -0.5], 90)[:, None] * state.constant_n
    for tension in (5.0, 30.0):
        assert effect(state, np.full_like(state.slope, tension)) == pytest.approx(expected)


def test_a_guide_rubs_by_as_much_in_every_trial(clean):
    state = clean.board.state
    forms = {form.name: form for form in EFFECTS["end-asymmetry"].forms}
    effect = ImposedEffect(EFFECTS["end-asymmetry"], forms["guide"], {}, 0.2)
    force = effect(state, np.full_like(state.slope, 15.0))
    assert force[:, 0] == pytest.approx(np.tile([0.1, -0.1], 90))


@pytest.mark.parametrize("name", ["end-asymmetry", "bed-in"])
def test_the_motor_board_has_neither_ends_nor_an_assemblys_trials(clean, name):
    kind = EFFECTS[name]
    for form in kind.forms:
        shape = form.draw(np.random.default_rng(1), 1)
        effect = ImposedEffect(kind, form, shape, 0.3)
        assert not np.any(effect(clean.bench, clean.bench.tension_n))


def test_every_amplitude_reaches_its_strength(clean):
    rng = np.random.default_rng(3)
    for kind in (*EFFECTS.values(), *OUTSIDERS_BY_NAME.values()):
        form = kind.forms[-1]
        sign = -1.0 if kind.signed else 1.0
        effect = scaled(ImposedEffect(kind, form, form.draw(rng, 180), sign, 0.3), clean)
        assert share_of_friction(effect, clean) == pytest.approx(0.03, rel=1e-6), kind.name
        assert np.sign(effect.amplitude) == sign


def test_the_effects_are_those_of_the_package_and_the_outsiders_none():
    assert set(EFFECTS) == set(all_effects())
    for name, kind in EFFECTS.items():
        assert kind.name == name
        assert kind.amplitude == all_effects()[name].amplitude.name
        assert kind.forms[0].own
        assert len({form.name for form in kind.forms}) == len(kind.forms)
    assert [name for name, kind in EFFECTS.items() if all(form.own for form in kind.forms)] == [
        "mass-error",  # on one side or the other
        "length-scale",  # physics offers no other
    ]
    assert len(OUTSIDERS_BY_NAME) >= 8
    assert not set(OUTSIDERS_BY_NAME) & set(EFFECTS)
    assert not any(form.own for kind in OUTSIDERS_BY_NAME.values() for form in kind.forms)


def test_the_law_is_table_1():
    for row, numbers, radius in zip(table1().values(), TABLE_I, RADII_M, strict=True):
        assert (row.c1.value, row.c2.value, row.c3.value) == tuple(numbers)
        assert row.radius_m == radius
    assert tuple(table1()) == SIZES
