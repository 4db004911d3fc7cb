"""Blind cases that are scored, as they are laid out: effects, pairs, outsiders, empty boards.

Seeds are fixed before a run: those after the last evidence, which have been looked at since.
``BAYESFRIC_BLIND_CASES=200`` runs or scores the first 200 cases, which are a balanced sample.
``docs/blind.md`` lists all that were scored.
"""

import os

from campaigns import evidence
from campaigns.promises import Outcome

from bayesfric.blind.case import catalogue_of
from bayesfric.blind.running import run_blind
from bayesfric.plots.scorecard import promises_and_reliability
from bayesfric.plots.style import to_svg

FINGERPRINT = ("effects", "diagnosis.gravity", "diagnosis.motor", "whole.gravity", "whole.motor")
WORKERS = 2
SHORT = ("withheld", "form", "strength", "noise_free_gap", "verdict", "causes", "correct")


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


def gather(folder):
    """Run the campaign."""
    number, first = number_of(whole()), scoring_seed()
    folder = folder.with_name(f"{folder.name}-{first}")
    card = run_blind(folder, number=number, first_seed=first, workers=WORKERS)
    return gathered(card, folder, f"BAYESFRIC_BLIND_CASES={number} {evidence.COMMAND}")


def gathered(card, folder, command):
    """Return what a scorecard says; it stands with its picture beside the raw cases."""
    (folder / "scorecard.svg").write_bytes(to_svg(promises_and_reliability(card)))
    figures = card.model_dump(mode="json", exclude={"cases", "versions", "confusion"})
    return evidence.Gathered(
        seeds=[card.cases[0].seed, card.cases[-1].seed],
        figures={key: figures[key] for key in sorted(figures)},
        cases={c.name: c.model_dump(mode="json", include=set(SHORT)) for c in card.cases},
        command=command,
    )


def promises(figures):
    """Return what was promised beside what was found, where cases were there to judge it by."""
    return [
        Outcome(
            target["name"],
            target["rate"]["rate"],
            target["at_least"],
            target["at_most"],
            target["rate"]["low"],
            target["rate"]["high"],
            n=target["rate"]["cases"],
        )
        for target in figures["targets"]
        if target["rate"]["cases"]
    ]
