"""Scored cases, made up."""

from bayesfric.schemas.scorecard import ScoredCase


def scored(kind="none", **changes):
    """A case of a kind, correct where nothing else is said; what is correct has come true."""
    effect = {"none": (), "effect": ("viscous",), "pair": ("viscous", "runout")}
    names = changes.pop("withheld", effect.get(kind, ("wave",)))
    fields = {
        "name": "010000",
        "seed": 10_000,
        "engine": "reference",
        "design": "quick",
        "envelope_sha256": "c" * 64,
        "kind": kind,
        "withheld": names,
        "form": ("plain",) * len(names),
        "own": True if names else None,
        "strength": dict.fromkeys(names, 1.0),
        "noise_free_gap": 0.03 if names else 0.0,
        "oracle_power": 0.9 if names else None,
        "counts_as_none": not names,
        "verdict": "named" if kind in ("effect", "pair") else "no-gap",
        "causes": names if kind in ("effect", "pair") else (),
        "outcome": {"effect": names[:1], "pair": ["pair"]}.get(kind, ["none"])[0],
        "correct": True,
        "probability": 0.97,
        "came_true": changes.get("correct", True),
        "truth_probability": 0.97,
        "falsely_named": False,
        "flagged": False,
        "remainder_significant": False,
        "shrink": None,
        "true_shrink": None,
        "shrink_covered": None,
        "parameters_covered": {},
    }
    return ScoredCase(**(fields | changes))
