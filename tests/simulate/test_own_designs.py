"""Rigs that no protocol of the paper's lays out: what a simulation adds is what rows answer to."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bayesfric.analysis import Analysis
from bayesfric.effects import all_effects
from bayesfric.effects.candidates import Candidate
from bayesfric.errors import InputError
from bayesfric.fitting.drawing import bounded_mode
from bayesfric.inference.model import Model
from bayesfric.inference.priors import to_normal
from bayesfric.recording import read_recording, write_recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Unsupported
from bayesfric.simulate import Truth, simulate_recording
from bayesfric.simulate.strength import at_strength

DESIGNS = {rig.own_design.name: rig for rig in all_rigs().values() if rig.own_design}
PAIRS = [
    # A log of an axis takes a second to open: the first law of each effect, and all by night.
    pytest.param(name, effect, law, marks=[pytest.mark.nightly] if name == "axis" and place else [])
    for name, rig in DESIGNS.items()
    for effect, offered in all_effects(rig.own_design.offers).items()
    for place, law in enumerate(offered.laws)
]
STRENGTH = 0.03  # so small that every law is linear in its amplitude
# Law and rows are evaluated on paths that differ where an axis turns: rows by the log.
NEAR = {"axis": 0.05, "points": 5e-3}  # second order of a power law is 2e-3 here
AT_TURNS = {"presliding": 0.25, "hysteresis": 0.25, "stribeck": 0.1, "backlash": 0.25}
AT_TURNS |= {"transmission-compliance": 0.35}  # friction's jump has a curvature of its own


def quiet(name):
    return Truth(coefficients=DESIGNS[name].own_design.coefficients, tau=0.0, omega=0.0)


def rows_of(name, truth):
    rig = DESIGNS[name]
    recording = simulate_recording(name, seed=3, truth=truth)
    return rig.trials(recording).linear(dict(truth.coefficients))


@cache
def plain(name):
    return rows_of(name, quiet(name))


def read(name, rows):
    return rows.readings.force if name == "axis" else rows.reading


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "effect", "law"), PAIRS)
def test_what_an_effect_adds_is_its_column_or_the_rig_says_why_not(name, effect, law):
    design, truth = DESIGNS[name].own_design, quiet(name)
    offered = all_effects(design.offers)[effect]
    change = design.change(offered, design.constants, truth)
    shape = offered.shape
    node = 0.0 if shape is None else float(to_normal(shape.prior, shape.typical))
    force = plain(name).relative_force(Candidate(offered, law, node))
    if change is None or isinstance(force, Unsupported):
        assert change is None
        assert isinstance(force, Unsupported)
        assert len(force.reason) > 20
        return
    try:
        applied = at_strength(effect, STRENGTH, design, design.constants, truth, law)
    except InputError:  # no amplitude makes a force here, and no row answers
        assert not np.any(force)
        return
    acted = rows_of(name, replace(truth, effects=(applied,)))
    added = read(name, acted) - read(name, plain(name))
    friction = acted.friction_of_row if name == "axis" else acted.friction_n
    force = acted.relative_force(Candidate(offered, law, node))
    expected = applied.values[offered.amplitude.name] * friction * np.ravel(force)
    off = np.sqrt(np.mean((added - expected) ** 2) / np.mean(added**2))
    assert off < max(NEAR[name], AT_TURNS.get(effect, 0.0) if name == "axis" else 0.0)


@pytest.mark.parametrize("name", sorted(DESIGNS))
def test_a_recording_is_what_the_format_allows_and_comes_back(name, tmp_path):
    recording = simulate_recording(name, seed=1, effects={"viscous": 0.5})
    write_recording(recording, tmp_path / "made")
    back = read_recording(tmp_path / "made")
    assert len(DESIGNS[name].trials(back).table) > 5
    write_recording(back, tmp_path / "again")  # opening an axis twice takes longer
    for table in (tmp_path / "made").glob("*.csv"):
        assert (tmp_path / "again" / table.name).read_bytes() == table.read_bytes()
    assert back.metadata["simulation"]["truth"]["effects"][0]["name"] == "viscous"


def test_a_payload_is_carried_by_the_test_runs_alone():
    with_load = simulate_recording("axis", seed=1, effects={"payload": 0.5})
    assert (with_load.axis.runs["role"] == "test").sum() == 2
    assert "role" not in simulate_recording("axis", seed=1).axis.runs


def test_an_effect_of_a_board_is_none_of_an_axis():
    with pytest.raises(InputError, match="found 'slip', expected one of"):
        simulate_recording("axis", effects={"slip": 1.0})


def test_rigs_of_a_design_are_not_chosen():
    with pytest.raises(ValueError, match="the protocol axis has one of its own"):
        simulate_recording("axis", rigs=["gravity"])


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [1, 2])
def test_a_fit_takes_clocks_that_differ_either_way(seed):
    """At these seeds the clocks' difference is found below and above 0: neither is a noise of 0."""
    trials = DESIGNS["axis"].trials(simulate_recording("axis", seed=seed))
    model = Model([trials.likelihood(Analysis())])
    mode = model.natural(bounded_mode(model, model.start()).mode)
    mode_by_name = dict(zip((parameter.name for parameter in model.parameters), mode, strict=True))
    assert abs(mode_by_name["latency"]) < 5e-4
    assert (mode_by_name["mass"], mode_by_name["coulomb"]) == pytest.approx((2.0, 1.5), rel=0.04)
