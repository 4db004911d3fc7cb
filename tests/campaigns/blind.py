"""Blind cases: the fixed ones that are repeated, and the campaigns that are scored.

Fixed cases have seeds of tuning. Those of scoring are fixed before a run: what is laid out has
the seeds after those of the last evidence, which have been looked at since, and what is drawn
from the prior those from 60,000 on. ``docs/blind.md`` lists all that were scored.
"""

import os
import sys

from campaigns import evidence

from bayesfric.analysis import Analysis
from bayesfric.blind.case import catalogue_of, run_case
from bayesfric.blind.design import cases_of
from bayesfric.plots.scorecard import promises_and_reliability
from bayesfric.plots.style import to_svg

RIGS = ("gravity_board", "motor_board")
FIXED_SEEDS = range(1, 16)
PRIOR_SEED = 60_000
PRIOR_CASES = 200
SHORT = ("withheld", "form", "strength", "noise_free_gap", "verdict", "causes", "correct")


def fixed():
    """Return the fixed cases by name."""
    return cases_of(catalogue_of("reference"), len(FIXED_SEEDS), FIXED_SEEDS.start)


def run_fixed(case, folder):
    """Run a fixed case; return what is compared."""
    found = run_case(case, folder, Analysis())
    return {key: found[key] for key in (*SHORT, "probability", "shrink")}


def whole():
    """Return the number of cases of the whole campaign."""
    effects = len(catalogue_of("reference").effects)
    return 200 + 15 * effects + 60 + 40


def number_of(everything):
    """Return how many cases to run: of fewer, the sample is balanced all the same."""
    return min(int(os.environ.get("BAYESFRIC_BLIND_CASES", everything)), everything)


def scoring_seed():
    """Return the first seed of scoring that has never been looked at."""
    return evidence.read("blind")["seeds"][1] + 1


def keep(card, work, name, command):
    """Write the evidence: scorecard and picture, and the figures with commit and command."""
    folder = evidence.EVIDENCE / name
    folder.mkdir(exist_ok=True)
    (folder / "scorecard.json").write_bytes((work / "scorecard.json").read_bytes())
    (folder / "scorecard.svg").write_bytes(to_svg(promises_and_reliability(card)))
    figures = card.model_dump(mode="json", exclude={"cases", "versions", "confusion"})
    evidence.write(
        name,
        sys.modules[__name__],
        command=command,
        seeds=[card.cases[0].seed, card.cases[-1].seed],
        figures={key: figures[key] for key in sorted(figures)},
        cases={c.name: c.model_dump(mode="json", include=set(SHORT)) for c in card.cases},
    )
