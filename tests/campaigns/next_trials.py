"""The trial that a diagnosis proposes, run on the same board: does it tell apart what was open?

Boards have the effect of few pulleys in common with that of the wrap angle, since both change
together from cell to cell; at the other corners nothing was recorded. One effect acts. Where two
hypotheses stay in question, the first of the proposed trials runs on an assembly of its own, on
a board with the same law and the same effect, and the diagnosis is repeated.
"""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from campaigns import evidence
from campaigns.promises import Outcome, bounds, rate

from bayesfric.analysis import Analysis
from bayesfric.campaign import run_on_processes
from bayesfric.diagnosis import diagnose
from bayesfric.plots.style import COLORS, NEUTRAL, figure, to_svg
from bayesfric.recording.tables import Gravity
from bayesfric.rigs.protocols import Assembly, GravityTrial, Protocol
from bayesfric.simulate import Truth, simulate_recording
from bayesfric.simulate.strength import at_strength

FINGERPRINT = ("simulators", "effects", "diagnosis.gravity", "whole.gravity")
DESIGNS = {
    "few-at-wide": Protocol({(5, 135.0): 2, (15, 50.0): 2}, (6.0, 28.0), (6.0, 28.0), 2),
    "few-at-narrow": Protocol({(5, 50.0): 2, (15, 135.0): 2}, (6.0, 28.0), (6.0, 28.0), 2),
}
EFFECTS = (
    "fixed-drag",
    "mass-error",
    "pulley-count-curvature",
    "tension-curvature",
    "wrap-curvature",
    "wrap-intercept",
)
STRENGTHS = (0.5, 1.0)
FIRST_SEED, EACH = 43_000, 9
ANEW = 500_000  # added to a board's seed for the scatter and noise of a further trial
TOLD_APART = 20.0  # odds
LEAST_OPEN = 50
LEAST_SEPARATED = 0.8
FIXED = 8  # of the first cases, that the nightly job repeats


@dataclass(frozen=True)
class OneTrial:
    """A design of one trial on one assembly, for the simulator."""

    assembly: Assembly

    def assemblies(self):
        """Yield the assembly."""
        yield self.assembly


def cases():
    """Return design, effect, strength and seed of every case, by name."""
    kinds = [
        (design, effect, strength)
        for _ in range(EACH)
        for design in DESIGNS
        for effect in EFFECTS
        for strength in STRENGTHS
    ]
    return {f"{FIRST_SEED + k}": (*kind, FIRST_SEED + k) for k, kind in enumerate(kinds)}


def case(given):
    """Diagnose a board; run the proposed trial where there is one, and diagnose again."""
    design, effect, strength, seed = given
    protocol = DESIGNS[design]
    rig = simulate_recording(protocol, seed=seed, rigs=("gravity",)).rig
    truth = Truth(effects=(at_strength(effect, strength, protocol, rig, Truth()),))
    board = simulate_recording(protocol, seed=seed, truth=truth, rigs=("gravity",))
    before = diagnose(board, Analysis()).summary
    record = {"design": design, "effect": effect, "strength": strength, "seed": seed}
    record |= {"verdict": before.verdict, "separates": None}
    if not before.next_experiment:
        return record
    asked = before.next_experiment[0]
    after = diagnose(with_trial(board, asked.condition, truth, seed), Analysis()).summary
    return record | {
        "separates": list(asked.separates),
        "expected": asked.log10_bayes_factor,
        "before": log_odds(before.probabilities, asked.separates),
        "after": log_odds(after.probabilities, asked.separates),
    }


def with_trial(board, condition, truth, seed):
    """Return a recording with one further trial, on an assembly of its own."""
    assembly = Assembly(
        condition["pulley_size"],
        int(condition["n_pulleys"]),
        condition["wrap_angle_deg"],
        (GravityTrial(condition["mass_drive_kg"], condition["mass_load_kg"]),),
    )
    further = simulate_recording(
        OneTrial(assembly), seed=seed + ANEW, truth=truth, rigs=("gravity",)
    ).gravity
    order = board.gravity.trials["order"].max() + 1
    trials = further.trials.assign(trial="next", setup="next", order=order)
    return replace(
        board,
        gravity=Gravity(
            pd.concat([board.gravity.trials, trials], ignore_index=True),
            pd.concat([board.gravity.events, further.events.assign(trial="next")]),
        ),
    )


def log_odds(probabilities, pair):
    """Return the log10 odds of the first to the second; what is not listed is below 1e-6."""
    first, second = (max(probabilities.get(name, 0.0), 1e-6) for name in pair)
    return float(np.log10(first / second))


def figures(done):
    """Return how many were open, told apart, and told apart in favour of what acts."""
    open_ = [record for record in done if record["separates"]]
    if not open_:
        return {"boards": len(done), "open": 0}
    apart = [record for record in open_ if abs(record["after"]) >= np.log10(TOLD_APART)]
    with_acting = [record for record in apart if record["effect"] in record["separates"]]
    right = [record for record in with_acting if towards(record) > 0]
    return {
        "boards": len(done),
        "open": len(open_),
        "told_apart": share(len(apart), len(open_)),
        "of_these_in_favour_of_what_acts": share(len(right), len(with_acting)),
        "median_expected": float(np.median([record["expected"] for record in open_])),
        "median_realised": float(
            np.median([abs(record["after"] - record["before"]) for record in open_])
        ),
    }


def towards(record):
    """Return the log10 odds, after the trial, of the effect that acts."""
    return record["after"] if record["separates"][0] == record["effect"] else -record["after"]


def share(hits, number):
    """Return a share with its 95 % interval; of nothing there is none."""
    counted = {"count": hits, "of": number}
    return counted | {"share": hits / number} | bounds(hits, number) if number else counted


def picture(done):
    """Draw the realised change of log10 odds over the expected Bayes factor, case by case."""
    open_ = [record for record in done if record["separates"]]
    with figure(height=70.0) as fig:
        panel = fig.subplots()
        expected = np.array([record["expected"] for record in open_])
        realised = np.array([abs(record["after"] - record["before"]) for record in open_])
        panel.plot([0.3, 30], [0.3, 30], color=NEUTRAL, linewidth=0.8)
        panel.plot(expected, np.maximum(realised, 0.03), ".", color=COLORS["blue"])
        panel.set(xscale="log", yscale="log")
        panel.set_xlabel("expected log10 Bayes factor of the proposed trial")
        panel.set_ylabel("change of log10 odds that it made")
        return fig


def gather(folder):
    """Run the campaign; its picture stands beside the raw cases."""
    done = list(run_on_processes(case, cases(), folder, workers=2).values())
    (folder / "next_trials.svg").write_bytes(to_svg(picture(done)))
    return evidence.Gathered(
        [done[0]["seed"], done[-1]["seed"]], figures(done), done, fixed=done[:FIXED]
    )


def promises(figures):
    """Return what was promised beside what was found."""
    apart = figures["told_apart"]
    return [
        Outcome("boards on which two hypotheses are open", figures["open"], least=LEAST_OPEN),
        rate(
            "the proposed trial tells them apart",
            apart["count"],
            apart["of"],
            least=LEAST_SEPARATED,
        ),
    ]
