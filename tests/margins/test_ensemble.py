"""Loops handed to python-control: its margins are the package's; what is refused."""

import sys
from pathlib import Path

import control
import numpy as np
import pytest
from margins.loops import loop, posterior, write_draws

from bayesfric.errors import InputError
from bayesfric.margins import compute_margins, read_loop
from bayesfric.margins.assembly import draw_assembly, nominal_assembly
from bayesfric.margins.computing import Margins
from bayesfric.margins.ensemble import Ensemble
from bayesfric.margins.metrics import linear_of
from bayesfric.margins.open_loop import OpenLoop
from bayesfric.margins.posterior import RigDiscrepancy
from bayesfric.margins.reflecting import at_shaft

OPEN = {"runs.0.topology": "open", "joint.viscous_n_m_s": 0.1, "cable.length_m": 1.0,
        "controller.ki_n_m_per_rad_s": 0.05,
        "controller.velocity_filter": "low-pass", "controller.velocity_cutoff_hz": 80.0,
        "joint.inertia_kg_m2": {"family": "log-normal", "median": 0.1, "sd_log": 0.2}}  # fmt: skip


FINE = np.exp(np.linspace(-0.03, 0.03, 601))  # a step of the package's grid either way


def ensemble(settings):
    drawn = posterior(20, sd=0.1)
    given = draw_assembly(settings, drawn, RigDiscrepancy(0.0, ""), seed=1)
    return Ensemble(
        at_shaft(settings, nominal_assembly(settings, drawn)), at_shaft(settings, given)
    )


@pytest.mark.parametrize(
    "settings",
    [*map(Path, ("raven-elbow", "raven-insertion", "raven-tool-rotation")), OPEN],
    ids=["elbow", "insertion", "tool", "integral and low-pass"],
)
def test_python_control_finds_the_margins_of_the_package(settings):
    made = ensemble(loop(settings) if isinstance(settings, dict) else read_loop(settings))
    rows = made.some(1)
    for direction in made.drawn.directions:
        systems = made.to_control(rows.size, direction)
        nominal = linear_of(made.nominal, with_peaks=True)[direction].values
        drawn = linear_of(made.drawn.taken(rows), with_peaks=True)[direction].values
        for row, system in enumerate(systems):
            ours = {key: nominal[key][0] if row == 0 else drawn[key][row - 1] for key in nominal}
            assert theirs(system, made.drawn, direction) == pytest.approx(ours, rel=1e-6)


def theirs(system, shaft, direction):
    """Margins by python-control alone, of a system as it is handed over."""
    with np.errstate(over="ignore"):  # in its own look at how well polynomials are conditioned
        gains, phases, _, _, crossed, _ = control.stability_margins(system, returnall=True)
    omega = OpenLoop(shaft, direction).frequencies()[0]
    disk = control.disk_margins(system, omega, returnall=True)[0]
    near = omega[np.nanargmin(disk)] * FINE
    phases = np.radians(phases)
    return {
        "gain_margin": np.exp(np.abs(np.log(gains[gains > 0])).min()),
        "phase_margin": np.abs(phases).min(),
        "delay_margin": (np.mod(phases, 2 * np.pi) / crossed).min(),
        "disk_margin": float(control.disk_margins(system, near)[0]),
        "sensitivity_peak": peak(control.feedback(1, system), omega),
        "complementary_peak": peak(control.feedback(system, 1), omega),
    }


def peak(closed, omega):
    top = omega[np.abs(closed(1j * omega)).argmax()]
    return np.abs(closed(1j * top * FINE)).max()


def test_results_hand_over_their_loop_and_its_draws(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=40)
    uncertain = {"drive.inertia_kg_m2": {"family": "uniform", "low": 1e-5, "high": 3e-5}}
    margins = compute_margins(loop(uncertain), draws, simulated=2)
    nominal, *others = margins.to_control(draws=6)
    assert [system.name for system in (nominal, *others[:2])] == ["bench nominal", "bench draw 0",
                                                            "bench draw 7"]  # fmt: skip
    # a high frequency sees the rotor alone: |L ω²| = |C|/J, J of the nominal 2e-5
    apart = [abs(transfer(1e5j) / nominal(1e5j)) for transfer in others]
    rotor = margins.ensembles[0].drawn.motor_inertia[[0, 7, 15, 23, 31, 39]]
    assert apart == pytest.approx(2e-5 / rotor, rel=1e-3)
    with pytest.raises(InputError, match="one of bench"):
        margins.to_control("other")
    with pytest.raises(InputError, match="direction"):
        margins.to_control(direction="driving")
    with pytest.raises(InputError, match=r"margins\.json holds no draws"):
        Margins(margins.summary).to_control()


def test_without_python_control_it_says_what_to_install(monkeypatch):
    made = ensemble(loop())
    monkeypatch.setitem(sys.modules, "control", None)
    with pytest.raises(InputError, match=r'pip install "\.\[control\]" in a clone'):
        made.to_control(1)
