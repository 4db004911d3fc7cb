"""A force that goes together along an axis is no scatter: known forces beside known scatter."""

from types import SimpleNamespace

import numpy as np
import pytest
from report.diagnosis_sample import diagnosis, interval

from bayesfric.diagnosis import structure
from bayesfric.diagnosis.concluded import _why_no_scatter
from bayesfric.diagnosis.sentence import Statement, sentence_of
from bayesfric.diagnosis.structure import differs_within_runs, shared_by_neighbours, unlike_scatter
from bayesfric.diagnosis.verdict import KnownEffect

COUNT, PRACTICAL = 200, 0.02


def windows(force, *, time_s=None, scatter=0.01, seed=0, stated=None):
    """Return windows with a force as a share of friction in scatter that is told, or another."""
    rng = np.random.default_rng(seed)
    stated = scatter if stated is None else stated
    order = np.arange(1.0, COUNT + 1)
    speed = np.random.default_rng(5).uniform(0, 1, COUNT)
    residual = force(order, speed) + scatter * rng.standard_normal(COUNT)
    residuals = SimpleNamespace(
        residual_n=residual,
        trial=np.arange(COUNT),
        friction_rms=1.0,
        covariates={"order": order, "velocity": speed, "setup": order},
        axes=("order", "velocity", "setup"),
        time_s=time_s,
        counts=None,
        without_law=lambda values: values - values.mean(axis=0),
    )
    return residuals, stated


@pytest.fixture
def shared_force(monkeypatch):
    """Return what goes together, where redrawn residuals have the scatter that is told."""

    def of(force, **options):
        residuals, stated = windows(force, **options)
        monkeypatch.setattr(
            structure,
            "redrawn",
            lambda residuals, count, rng: stated * rng.standard_normal((COUNT, count)),
        )
        return shared_by_neighbours(
            residuals, residuals.residual_n, PRACTICAL, np.random.default_rng(1)
        )

    return of


@pytest.mark.parametrize("seed", range(5))
def test_scatter_goes_together_along_no_axis(shared_force, seed):
    assert shared_force(lambda order, speed: 0.0 * order, seed=seed) is None


@pytest.mark.parametrize(
    ("force", "axis"),
    [
        (lambda order, speed: 0.03 * np.sqrt(2) * np.sin(2 * np.pi * order / 7), "time"),
        (lambda order, speed: 0.19 * np.exp(-order / 10), "time"),
        (lambda order, speed: 0.09 * np.exp(-(((speed - 0.3) / 0.06) ** 2)), "velocity"),
    ],
)
@pytest.mark.parametrize("stated", [0.01, 0.032])
def test_a_wave_a_start_and_a_resonance_of_three_per_cent_do(shared_force, force, axis, stated):
    """Also where the force has gone into the scatter that is told."""
    together = shared_force(force, stated=stated)
    assert together.axis == axis
    assert 0.015 < together.share < 0.035
    assert together.p_value < 0.01
    assert f"along {axis} share a force of 1 N" in together.words("1 N")


def test_what_goes_together_and_does_not_matter_is_left_alone(shared_force):
    """Half a per cent of friction in scatter of a tenth of a per cent."""

    def wave(order, speed):
        return 0.005 * np.sin(2 * np.pi * order / 9)

    assert shared_force(wave, scatter=0.001) is None


def test_a_wave_in_time_shows_where_runs_have_it_at_the_same_time(shared_force):
    """Four runs of fifty windows each: the order of windows alone has it too."""
    time = np.tile(np.linspace(0.0, 10.0, 50), 4)
    wave = 0.03 * np.sin(2 * np.pi * time / 1.3)
    assert shared_force(lambda order, speed: wave, time_s=time).axis == "time"


def test_the_force_that_is_known_is_taken_off(monkeypatch):
    residuals, _ = windows(lambda order, speed: 0.1 * speed)
    monkeypatch.setattr(
        structure, "redrawn", lambda r, count, rng: 0.01 * rng.standard_normal((COUNT, count))
    )
    gap = diagnosis().gap.model_copy(update={"friction_rms": 1.0})
    viscous_force = 0.1 * residuals.covariates["velocity"][:, None] * np.ones(3)
    for force, words in ((viscous_force, None), (0 * viscous_force, "along velocity")):
        posterior, rng = SimpleNamespace(force=force), np.random.default_rng(1)
        said = unlike_scatter(gap, residuals, residuals.residual_n, posterior, PRACTICAL, rng)
        assert (said is None) == (words is None)
        assert words is None or words in said


def test_what_is_left_of_held_out_data_is_no_scatter_either():
    gap = diagnosis().gap.model_copy(update={"held_out_excess": 0.05, "friction_rms": 1.0})
    said = unlike_scatter(gap, None, None, None, 0.02, None)
    assert said == "after scatter is subtracted, an error of 0.05 N rms is left on held-out data"
    nothing = gap.model_copy(update={"before": interval(0.6)})  # of friction of 1 N
    assert unlike_scatter(nothing, None, None, None, 0.02, None) is None


@pytest.mark.parametrize(("measuring", "is_open"), [(True, False), (False, True)])
def test_sensors_that_are_known_to_be_off_explain_what_is_left(measuring, is_open):
    """Magnets off by a part of their distance: felt in every window, and no part of a gap."""
    gap = diagnosis().gap.model_copy(update={"held_out_excess": 0.05, "friction_rms": 1.0})
    felt = KnownEffect("magnet-spacing", 1.0, 0.0, 0.01, measuring)
    judged = SimpleNamespace(
        effects_known=[felt],
        present=["magnet-spacing"],
        residuals=None,
        posterior=None,
        settled=SimpleNamespace(psi=None),
    )
    measured = SimpleNamespace(gap=gap, held_out=SimpleNamespace(inside=[None, None]))
    model = SimpleNamespace(noise=SimpleNamespace(named=lambda psi: {}))
    assert (_why_no_scatter(model, judged, measured, 0.02, None) is not None) == is_open


def test_the_sentence_says_that_scatter_does_not_explain_what_is_left():
    together = structure.SharedForce("trial_in_setup", 0.028, 0.0025)
    statement = Statement(
        "undecided", 0.5, diagnosis().gap, 0.02, unlike_scatter=together.words("2.8%")
    )
    said = sentence_of(statement)
    assert "neighbouring residuals along trial in setup share a force of 2.8% (scatter" in said
    assert "Either something else acts, or the assumed scatter is wrong" in said


@pytest.mark.parametrize(
    ("noise", "words"),
    [
        ({}, None),
        ({"slow_axis": 0.01, "map_axis": 0.01, "run_map_axis": 0.01}, None),
        ({"slow_axis": 0.03}, "friction changes slowly in time within a run, by 3.0% of itself"),
        ({"map_axis": 0.03}, "friction differs along the path within a run, by 3.0% of itself"),
        # A load's asymmetry of 5 % of friction, of which every second command was not logged.
        (
            {"slow_axis": 0.0176, "map_axis": 0.0113, "run_map_axis": 0.025},
            "friction differs along the path within a run, by 3.3% of itself",
        ),
    ],
)
def test_friction_that_differs_within_runs_by_what_counts_is_said(noise, words):
    reason = differs_within_runs(noise, 0.02)
    assert reason is None if words is None else reason.startswith(words)
