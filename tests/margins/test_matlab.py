"""Loops as a .mat file: read back with known answers, the same bytes each time, and refused."""

from pathlib import Path

import numpy as np
import pytest
from margins.loops import loop, posterior
from scipy.io import loadmat

from bayesfric.errors import InputError
from bayesfric.margins.assembly import draw_assembly, nominal_assembly
from bayesfric.margins.ensemble import Ensemble
from bayesfric.margins.matlab import checked_name, uncertainty_weight, write_mat
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft

UNCERTAIN = {
    "controller.kp_n_m_per_rad": {"family": "uniform", "low": 0.01, "high": 0.03},
    "controller.kd_n_m_s_per_rad": {"family": "uniform", "low": 5e-4, "high": 1.5e-3},
}


def ensemble(changes):
    settings, drawn = loop(changes), posterior(100)
    given = draw_assembly(settings, drawn, RigDiscrepancy(0.0, ""), seed=1)
    return Ensemble(
        at_shaft(settings, nominal_assembly(settings, drawn)), at_shaft(settings, given)
    )


def test_a_file_read_back_has_the_loop_by_hand(tmp_path):
    made = ensemble(UNCERTAIN)
    write_mat(tmp_path / "new" / "loops.mat", [made])
    stored = loadmat(tmp_path / "new" / "loops.mat", simplify_cells=True)["loops"]
    assert (stored["name"], stored["direction"]) == ("bench", "both")
    assert stored["units"]["friction"] == "N m"
    assert stored["draws"]["kp"].tolist() == made.drawn.kp.tolist()
    omega, nominal = stored["frequency"], stored["nominal"]
    # (kp + kd (1 − e^{−sT})/T) e^{−1.5 T s} over two inertias on the cable, by hand
    s = 1j * omega
    spring = float(made.nominal.stiffness[0]) + s * float(made.nominal.damping[0])
    plant = (1e-5 * s**2 + spring) / (2e-10 * s**4 + 3e-5 * s**2 * spring)

    def by_hand(kp, kd):
        return (kp + kd * (1 - np.exp(-1e-3 * s)) / 1e-3) * np.exp(-1.5e-3 * s) * plant

    assert stored["nominal_response"] == pytest.approx(by_hand(0.02, 1e-3), rel=1e-6)
    kp, kd = stored["draws"]["kp"][7], made.drawn.kd[7]
    assert stored["draw_responses"][7] == pytest.approx(by_hand(kp, kd), rel=1e-6)
    low = omega < 1e3
    away = s[low, None, None] * np.eye(len(nominal["A"])) - nominal["A"]
    states = nominal["C"] @ np.linalg.solve(away, nominal["B"][:, None])[..., 0].T
    assert nominal["D"] == 0
    assert states == pytest.approx(stored["nominal_response"][low], rel=1e-6)
    # at low frequency L/L₀ − 1 is kp/kp₀ − 1 alone: up to a half, by the family
    assert 0.4 < stored["uncertainty_weight"][0] < 0.6
    off = np.abs(stored["draw_responses"] / stored["nominal_response"] - 1)
    inside = (off <= stored["uncertainty_weight"] * (1 + 1e-12)).all(axis=1)
    assert inside.sum() == 95


def test_the_weight_by_hand():
    # 100 loops off by 0.01 to 1.00 at one frequency, by twice that at the other
    size = np.arange(1, 101) / 100
    nominal = np.array([2.0 + 0j, 1j])
    draws = nominal * (1 + size[:, None] * np.array([1.0, 2.0j]))
    assert uncertainty_weight(nominal, draws) == pytest.approx([0.95, 1.9])
    # each is off at one of two frequencies: together 95 must be covered, not 95 at either
    draws = nominal * (1 + np.where(np.arange(100)[:, None] % 2 == [0, 1], size[:, None], 0.0))
    weight = uncertainty_weight(nominal, draws)
    inside = (np.abs(draws / nominal - 1) <= weight * (1 + 1e-12)).all(axis=1)
    assert inside.sum() == 95
    assert uncertainty_weight(nominal, np.tile(nominal, (5, 1))).tolist() == [0.0, 0.0]


def test_two_directions_and_the_same_bytes(tmp_path):
    made = ensemble({"runs.0.topology": "open"})
    for name in ("a.mat", "b.mat"):
        write_mat(tmp_path / name, [made])
    data = (tmp_path / "a.mat").read_bytes()
    assert data == (tmp_path / "b.mat").read_bytes()
    assert b"Created on" not in data[:128]  # SciPy's own has the time
    stored = loadmat(tmp_path / "a.mat", simplify_cells=True)["loops"]
    assert [entry["direction"] for entry in stored] == ["driving", "overhauling"]


def test_another_ending_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"ends in \.mat"):
        checked_name(Path("loops.m"))
    (tmp_path / "x.mat").mkdir()
    with pytest.raises(InputError, match=r"ends in \.mat"):
        checked_name(tmp_path / "x.mat")
