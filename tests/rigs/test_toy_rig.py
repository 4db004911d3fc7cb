"""A rig that nobody has seen is one folder: fitted, simulated and reported as the others are."""

from pathlib import Path

import numpy as np
import pytest

import bayesfric as bf
from bayesfric import rigs
from bayesfric.analysis import Analysis, Sampler
from bayesfric.effects import all_effects
from bayesfric.recording.columns import TABLES
from bayesfric.recording.tables import Recording, RigConstants
from bayesfric.recording.writing import write_recording
from bayesfric.report.writing import write_report
from bayesfric.rigs.protocols import PROTOCOLS
from bayesfric.rigs.truth import AppliedEffect, Truth, table1_coefficients

TOYS = str(Path(__file__).parent / "toy")
SHORT = Analysis(seed=3, sampler=Sampler(burn=10, steps=120, thin=3, extensions=0))


@pytest.fixture(scope="module")
def scale():
    rigs.__path__.append(TOYS)
    rigs.all_rigs.cache_clear()
    yield rigs.all_rigs()["scale"]
    rigs.__path__.remove(TOYS)
    TABLES.pop("pull_scale.csv")
    rigs.all_rigs.cache_clear()


@pytest.fixture(scope="module")
def recording(scale, tmp_path_factory):
    simulated = scale.simulate(PROTOCOLS["quick"], RigConstants(), Truth(), seed=4)
    made = Recording("toy", "Readings of a toy", RigConstants(), **simulated.tables)
    folder = tmp_path_factory.mktemp("toy") / "recording"
    write_recording(made, folder)
    return bf.read_recording(folder)


@pytest.fixture(scope="module")
def fitted(recording):
    return bf.fit(recording, SHORT)


def test_it_is_found_by_being_there(scale):
    names = ["gravity", "motor", "scale", "single-axis", "steady-points"]
    assert list(rigs.all_rigs()) == names
    assert "scale" not in rigs.paper_rigs()


def test_it_is_fitted_to_the_law_from_which_it_was_simulated(fitted):
    for size, law in table1_coefficients().items():
        if size != "medium":
            for name in ("c1", "c2"):
                coefficient = fitted.summary.pulleys[size][name]
                assert abs(coefficient.mean - getattr(law, name)) < 4 * coefficient.sd
                assert coefficient.sd < 0.2 * getattr(law, name)


def test_a_clean_one_is_not_said_to_have_a_gap(recording):
    summary = bf.diagnose(recording).summary
    assert summary.rigs == ("scale",)
    assert summary.verdict in ("no-gap", "undecided")
    assert not summary.causes


def test_an_effect_of_it_is_named(scale, tmp_path):
    """Friction per tension that changes by a fifth for each 100 % of tension."""
    curved = AppliedEffect(all_effects()["tension-curvature"], "quadratic", {"curvature": 0.2})
    truth = Truth(effects=(curved,))
    simulated = scale.simulate(PROTOCOLS["quick"], RigConstants(), truth, seed=5)
    write_recording(Recording("t", "Toy", RigConstants(), **simulated.tables), tmp_path / "toy")
    summary = bf.diagnose(bf.read_recording(tmp_path / "toy")).summary
    assert summary.inclusion[0].effect == "tension-curvature"
    assert summary.inclusion[0].probability > 0.9


@pytest.mark.nightly
def test_it_is_reported(fitted, tmp_path):
    fitted.write(tmp_path)
    write_report(tmp_path)
    text = (tmp_path / "report.html").read_text("utf-8")
    assert "pull scale" in text
    assert "gravity board" not in text


def test_its_density_is_a_dense_normal(recording, scale):
    """Against the covariance written out."""
    likelihood = scale.trials(recording).likelihood(Analysis())
    theta = {name: np.array([value]) for name, value in likelihood.start().items()}
    law = likelihood.law(theta)[0]
    setup = likelihood.trials["setup"].to_numpy()
    same = setup[:, None] == setup
    covariance = np.diag((0.02 * law) ** 2 + 0.01**2) + same * np.outer(0.02 * law, 0.02 * law)
    off = likelihood.trials["friction_n"].to_numpy() - law
    expected = -0.5 * (
        off @ np.linalg.solve(covariance, off) + np.linalg.slogdet(2 * np.pi * covariance)[1]
    )
    assert likelihood.log_likelihood(theta)[0] == pytest.approx(expected, abs=1e-8)
