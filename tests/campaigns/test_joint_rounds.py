"""What rounds of joints are made of, and what their figures count."""

import json
import sys
from collections import Counter

import numpy as np
import pytest
from campaigns import joint_rounds, joint_world
from joint_worlds import simulator
from rigs import ladder


def test_a_third_of_the_joints_is_empty_and_all_else_comes():
    drawn = [joint_rounds.withheld_of(place, 21000) for place in range(60)]
    kinds = Counter(kind for kind, _ in drawn)
    assert (kinds["none"], kinds["outsider"], kinds["pair"]) == (20, 4, 2)
    strengths = Counter(strength for kind, effects in drawn if kind == "effect"
                        for _, strength in effects)  # fmt: skip
    assert strengths == {joint_world.FULL: 26, joint_world.WEAK: 8}
    effects = {name for kind, given in drawn if kind == "effect" for name, _ in given}
    assert len(effects) > 15


def test_all_cases_are_sixty_of_each_part():
    names = joint_rounds.everything()
    assert len(names) == 300
    assert names["perfect-29000-000"] == ("perfect", 0, 29000)
    assert names["arms-26000-059"] == ("arms", 59, 26000)
    assert list(joint_rounds.cases("servos", 3, 5, 7)) == ["servos-7-003", "servos-7-004"]


def test_shares_have_the_interval_of_wilson():
    rate = joint_rounds.share([True] * 8 + [False] * 2)
    assert (rate["hits"], rate["of"]) == (8, 10)
    assert rate["wilson"] == pytest.approx([0.4902, 0.9433], abs=1e-4)
    assert joint_rounds.share([]) == {"hits": 0, "of": 0, "wilson": None}


def row(kind, seed, **changes):
    """Return what a case of joints comes to, right where nothing is changed."""
    usual = {
        "part": "joints",
        "kind": kind,
        "seed": seed,
        "strength": [1.0] if kind == "effect" else [],
        "exact": True,
        "possible": False,
        "wrong": [],
        "named": {},
        "others_wrong": {},
        "contradicts": [None],
        "numbers": {"coulomb": [1.0, 0.9, 1.02, 1.1]},
    }
    return usual | changes


def test_figures_count_what_is_named_and_what_intervals_hold():
    rows = [
        row("none", 1),
        row("none", 2, wrong=["spring"], named={"spring": 1.0}, exact=False),
        row("effect", 3, contradicts=[False, True]),
        row("effect", 4, exact=False, possible=True, numbers={"coulomb": [1.0, 1.05, 1.1, 1.2]}),
        row("effect", 5, strength=[0.3], exact=False),
    ]
    of_joints = joint_rounds.figures(rows)["joints"]
    counted = {name: (of_joints[name]["hits"], of_joints[name]["of"])
               for name in of_joints if name not in ("numbers", "wrong")}  # fmt: skip
    assert counted == {
        "exact": (1, 2),
        "exact_or_possible": (2, 2),
        "weak_named_or_possible": (0, 1),
        "wrongly_named": (0, 3),
        "empty_named": (1, 2),
        "outsiders_named": (0, 0),
        "contradicted": (1, 2),
    }
    coulomb = of_joints["numbers"]["coulomb"]
    assert (coulomb["hits"], coulomb["of"], coulomb["outside"]) == (4, 5, [4])
    assert coulomb["median_off"] == pytest.approx(0.02)
    outcomes = {
        outcome.promise: outcome.met for outcome in joint_rounds.promises({"joints": of_joints})
    }
    assert not outcomes["an empty joint has something named"]
    assert outcomes["held-out data contradict what is named"] is False
    assert "the rung is named or possible" not in outcomes


def test_numbers_that_an_effect_is_part_of_have_no_truth():
    seed = next(
        s for s in range(50) if drawn_at(s).knows == "nothing" and not drawn_at(s).arm.upright
    )
    world, law = drawn_at(seed), {"coulomb": 1.0, "viscous": 2.0, "offset": 3.0, "armature": 4.0}
    whole = joint_world.truths_of(world, {"law": law}, ())
    mass, length = world.arm.masses[0], world.arm.lengths[0]
    assert whole["gravity"] == pytest.approx(9.81 * mass * length / 2)
    rod = whole["inertia"] - world.arm.armature[0]
    assert mass * length**2 / 3 < rod < 1.2 * mass * length**2 / 3  # by its ends
    beside = joint_world.truths_of(world, {"law": law}, (("spring", 1.0),))
    assert whole.keys() - beside.keys() == {"gravity", "offset"}


def drawn_at(seed):
    return simulator.drawn_world(seed, frozenset(), "real")


def test_one_load_that_is_lifted_alone_moves_one_way_at_each_pose():
    joint = ladder.drawn("M3", 5, **joint_rounds.ONE_LOAD)
    for number in range(joint.runs):
        _, position, speed, *_ = joint.run(number)
        assert (speed > 0).all()
        assert (np.sin(position) > 0).all()


def test_other_joints_are_played_and_nothing_is_written(monkeypatch, capsys, tmp_path):
    played = []

    def play(function, cases, folder, workers):
        played.append((list(cases), workers))
        return {name: row("none", 1) for name in cases}

    monkeypatch.setattr(joint_rounds, "run_on_processes", play)
    monkeypatch.setattr(joint_rounds.evidence, "write", None)
    monkeypatch.setattr(sys, "argv", "rounds joints 4 6 --base 21000 --workers 1".split())
    joint_rounds.main()
    assert played == [(["joints-21000-004", "joints-21000-005"], 1)]
    assert json.loads(capsys.readouterr().out)["joints"]["empty_named"]["of"] == 2


@pytest.mark.nightly
@pytest.mark.parametrize("rung", ["M3", "M6"])
def test_of_one_load_that_is_lifted_alone_nothing_is_told_of_the_ladder(rung):
    place = next(p for p in range(30) if p % 5 == 4 and list(ladder.RUNGS)[p % 6] == rung)
    record = joint_rounds.rung(place, 22500)
    assert record["one_way"]
    assert record["cannot_tell"], record["sentence"]
