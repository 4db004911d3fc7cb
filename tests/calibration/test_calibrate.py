"""A campaign of two small cases: what is drawn, ranked, written, and gone on with."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner

from bayesfric.analysis import Analysis, CalibrationRules, Scatter
from bayesfric.calibration import running as one_case
from bayesfric.calibration.generating import SCATTER_AND_NOISE, draw_truth, generating_analysis
from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.inference.priors import log_density
from bayesfric.simulate import table1_coefficients


def test_truths_are_drawn_from_the_stated_prior():
    generating = generating_analysis(Analysis(calibration=CalibrationRules(spread=0.2)))
    rng = np.random.default_rng(1)
    truths = [draw_truth(generating, rng) for _ in range(80)]
    for name in SCATTER_AND_NOISE:
        values = np.array([getattr(truth, name) for truth in truths])
        middle = getattr(Analysis().calibration, name)
        assert 0.8 * middle <= values.min() < 0.84 * middle
        assert 1.16 * middle < values.max() <= 1.2 * middle
        assert np.isfinite(log_density(getattr(generating.priors, name), values)).all()
    for size, law in table1_coefficients().items():
        for place, value in enumerate(law):
            ratio = np.array([truth.coefficients[size][place] for truth in truths]) / value
            assert np.abs(ratio - 1).max() <= 0.2 + 1e-12
            assert ratio.std() == pytest.approx(0.2 / np.sqrt(3), rel=0.25)


def test_scatter_that_is_not_simulated_is_refused():
    with pytest.raises(InputError, match="normal scatter that sizes share"):
        generating_analysis(Analysis(scatter=Scatter(trial="student-t")))


def test_quantities_by_hand():
    class Stub:
        def by_name(self, theta):
            return {"c1[small]": theta[:, 0], "c2[small]": theta[:, 1], "tau": theta[:, 2]}

        def log_likelihood(self, theta):
            return -theta[:, 2]

    quantities = one_case.quantities(Stub(), np.array([[0.01, 0.03, 0.5]]))
    assert quantities["c1 + c2/T[small]"] == pytest.approx([0.013])
    assert quantities["log_likelihood"] == pytest.approx([-0.5])
    assert set(quantities) == {
        "c1[small]",
        "c2[small]",
        "tau",
        "c1 + c2/T[small]",
        "log_likelihood",
    }


@pytest.fixture
def quick_cases(monkeypatch):
    """Cases in this process, counted; their ranks depend on the case alone."""
    done = []

    def run_case(given):
        done.append(given.number)
        rank = (37 * given.number + given.generating.seed) % 100
        return {"ranks": {"tau": rank}, "r_hat": 1.0, "stalled": 0, "trials": 4}

    def in_process(function, cases, folder, workers, progress=None):
        from concurrent.futures import ThreadPoolExecutor

        from bayesfric.campaign import run_campaign

        with ThreadPoolExecutor(workers) as executor:
            return run_campaign(function, cases, folder, executor, progress)

    monkeypatch.setattr("bayesfric.calibration.running.run_case", run_case)
    monkeypatch.setattr("bayesfric.campaign.run_on_processes", in_process)
    return done


def test_the_verb_writes_and_goes_on(tmp_path, quick_cases):
    arguments = ["calibrate", "-o", str(tmp_path), "--seed", "3", "--quiet", "--n"]
    assert CliRunner().invoke(app, [*arguments, "60"]).exit_code == 0
    assert sorted(quick_cases) == list(range(60))
    first = (tmp_path / "calibration.json").read_bytes()
    done = CliRunner().invoke(app, [*arguments, "100"])
    assert "1 of 1 quantities have uniform ranks" in done.output
    assert sorted(quick_cases) == list(range(100))
    stored = json.loads((tmp_path / "calibration.json").read_text())
    assert stored["schema"] == "bayesfric.calibration/1"
    assert [case["ranks"]["tau"] for case in stored["cases"]] == [
        (37 * k + 3) % 100 for k in range(100)
    ]
    assert stored["priors"]["tau"] == "uniform(low=0.007, high=0.013)"
    CliRunner().invoke(app, [*arguments, "60", "--workers", "2"])
    assert (tmp_path / "calibration.json").read_bytes() == first  # whatever the workers
    CliRunner().invoke(
        app, ["calibrate", "-o", str(tmp_path), "--seed", "4", "--quiet", "--n", "2"]
    )
    assert len(quick_cases) == 102  # another seed is another campaign


def test_fail_on_uncalibrated(tmp_path, monkeypatch, quick_cases):
    def stuck(given):
        return {"ranks": {"tau": 0}, "r_hat": 1.2, "stalled": 1, "trials": 4}

    monkeypatch.setattr("bayesfric.calibration.running.run_case", stuck)
    arguments = ["calibrate", "-o", str(tmp_path), "--n", "30", "--fail-on", "uncalibrated"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1
    stored = json.loads((tmp_path / "calibration.json").read_text())
    said = " ".join(stored["attention"])
    assert not stored["calibrated"]
    assert "25.0% of the trials stalled" in said
    assert "R-hat of some fit is 1.200" in said
    assert "tau are not uniform" in said


def test_fits_that_have_not_converged_calibrate_nothing(tmp_path, monkeypatch, quick_cases):
    """Ranks that are uniform are none of the posterior, where R-hat is 1.2."""

    def unmixed(given):
        return {
            "ranks": {"tau": (37 * given.number) % 100},
            "r_hat": 1.2,
            "stalled": 0,
            "trials": 4,
        }

    monkeypatch.setattr("bayesfric.calibration.running.run_case", unmixed)
    arguments = ["calibrate", "-o", str(tmp_path), "--n", "60", "--fail-on", "uncalibrated"]
    assert CliRunner().invoke(app, arguments).exit_code == 1
    assert not json.loads((tmp_path / "calibration.json").read_text())["calibrated"]


def test_one_case_ranks_every_quantity():
    """A whole case, cheaply: each rank is one, and the truth is the one that was drawn."""
    rules = CalibrationRules(
        sampler={"burn": 20, "steps": 50, "thin": 2, "extensions": 0}  # 1,440 draws an ensemble
    )
    generating = generating_analysis(Analysis(seed=8, calibration=rules))
    case = one_case.run_case(one_case.Given(generating, "quick", 0))
    assert len(case["ranks"]) == 20
    assert all(0 <= rank <= one_case.RANKED_DRAWS for rank in case["ranks"].values())
    assert case["trials"] == 180
    assert case["stalled"] == 0
