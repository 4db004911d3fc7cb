"""Blind cases: the fixed ones that are repeated, and the campaigns that are scored.

Fixed cases have seeds of tuning. Those of scoring are fixed before a run: from
`SCORING_SEED` on for what is laid out, 60,000 on for what is drawn from the prior. Seeds
10,000 to 10,629 scored commit 08012d5, 30,000 to 30,629 commit 8a61b00, 40,000 to 40,629
and, from the prior, 20,000 to 20,199 commit bde1875, 70,000 to 70,051 commit e1291a5,
71,000 to 71,033 commit 02cfb79, 71,034 to 71,073 commit 1944310, 71,074 to 71,113 commit
9e9287a, 71,114 to 71,153 commit ccb36c5, 71,154 to 71,193 commit 3aa40f8, 71,194 to
71,233 commit c51231a, 71,234 to 71,273 commit 5887a0a, 71,274 to 71,313 commit 7b37d59,
71,314 to 71,353 commit 9df2f12, 71,354 to 71,393 commit 005671f, 71,394 to 71,433 commit
4be024a, 71,434 to 71,473 commit a208700, 71,474 to 71,513
commit 740d861, 71,514 to 71,553 commit 83f0aef, 71,554 to 71,593 commit e27d908, 71,594 to
71,633 commit fc10dd2; all have been looked at since.
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
SCORING_SEED, PRIOR_SEED = 71_634, 60_000
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


def keep(card, name, command):
    """Write the evidence: scorecard and picture, and the figures with commit and command."""
    folder = evidence.EVIDENCE / name
    folder.mkdir(exist_ok=True)
    source = evidence.work(name, sys.modules[__name__]) / "scorecard.json"
    (folder / "scorecard.json").write_bytes(source.read_bytes())
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
