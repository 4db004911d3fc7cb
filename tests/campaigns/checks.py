"""What ``check`` says beforehand, beside what a diagnosis then finds, of simulated axes.

An effect acts in two of three recordings, strong, weak or hardly at all; logs are whole, slow, or
short. Of each number of the law the predicted error stands beside that of the diagnosis and the
one that is made. An effect that is at least as large as what check says would be found is one that
it says can be told. One that is smaller than what check says would be found, or among those that
cannot be told, may not be named. Friction that differs between directions does so as a whole:
of Coulomb friction alone that is a constant force, which the law has as its offset.
"""

import tempfile
from pathlib import Path

import numpy as np
from campaigns.axis import EFFECTS
from campaigns.evidence import gathered_over_seeds
from campaigns.promises import Outcome, rate
from rigs.driven_mass import Machine, simulate, write

from bayesfric.diagnosis import diagnose
from bayesfric.readiness import readiness_of
from bayesfric.recording import read_recording

FINGERPRINT = ("effects", "likelihood.axis", "diagnosis.axis", "whole.axis")
SIZES = {
    "stribeck": 0.4 / 1.5,
    "air-drag": 2.0,
    "presliding": 0.6,
    "cogging": 0.25,
    "spring": 2.0,
    "wear-drift": 0.3,
    "direction-asymmetry": 0.1,
    "delay": 0.008,
    "hysteresis": 0.6,
}
"""Amplitudes of effects, in the units of the package, as ``campaigns/axis.py`` has them."""
STRENGTHS = (1.0, 0.2, 0.05)  # of these
CUTS = {"whole": (6, 8.0, 1), "slow": (6, 8.0, 10), "short": (2, 4.0, 1)}
"""Runs, their length [s], and samples of which one is kept."""
VISCOUS = 0.6
WITHIN = 1.5
SEEDS = range(33000, 33060)
FIXED_SEEDS = (33001, 33002)
MACHINE = Machine()
IN_DIAGNOSIS = {"mass": "inertia"}


def design(seed):
    """Return effect, strength and cut of a recording; the effect is None in every third."""
    cuts = list(CUTS)
    if seed % 3 == 0:
        return None, 0.0, cuts[seed // 3 % 3]
    place = seed - seed // 3 - 1
    strength, cut = STRENGTHS[(place // 9 + place) % 3], cuts[(place // 27 + place // 3) % 3]
    return list(SIZES)[place % 9], strength, cut


def scaled(value, strength):
    """Return what a machine has of an effect, weaker; of two numbers the first is its size."""
    return (strength * value[0], *value[1:]) if isinstance(value, tuple) else strength * value


def recorded(seed):
    """Return a recording of an axis."""
    effect, strength, cut = design(seed)
    runs, seconds, every = CUTS[cut]
    acting = {name: scaled(value, strength) for name, value in EFFECTS.get(effect, {}).items()}
    machine = Machine(viscous=VISCOUS, **acting)
    table, samples = simulate(machine, runs=runs, seconds=seconds, seed=seed)
    is_kept = samples.groupby("run", sort=False).cumcount() % every == 0
    samples = samples[is_kept].reset_index(drop=True)
    with tempfile.TemporaryDirectory() as folder:
        return read_recording(write(Path(folder) / "axis", machine, table, samples))


def case(seed):
    """Check a recording, then diagnose it.

    Parameters
    ----------
    seed : int
        Of the recording.
    """
    effect, strength, cut = design(seed)
    recording, amplitude = recorded(seed), strength * SIZES.get(effect, 0.0)
    (part,) = readiness_of(recording).parts
    record = {"seed": seed, "effect": effect, "strength": strength, "cut": cut}
    if part.power is None:
        return record | {"hopeless": True, "numbers": {}, "said": None, "false": []}
    summary = diagnose(recording).summary
    named = [cause.effect for cause in summary.causes]
    reported = [*named, *(cause.effect for cause in summary.present)]
    can, cannot = part.effects
    laws = part.power.effects
    own = laws[[name.startswith(f"{effect}/") for name in laws.index]]
    smallest, unseen = (own["smallest"].max(), own["unseen"].min()) if len(own) else (None, None)
    said = None
    if effect in cannot or (effect in can and amplitude < unseen):
        said = "cannot"
    elif effect in can and amplitude >= smallest:
        said = "can"
    numbers = {}
    for name, row in part.power.coefficients.iterrows():
        number = summary.law.get(IN_DIAGNOSIS.get(name, name))
        if number is not None and row["informed"]:
            truth = {"mass": MACHINE.mass, "coulomb": MACHINE.coulomb, "viscous": VISCOUS}[name]
            predicted = float(row["sd_where_law_is_off"])
            numbers[name] = [predicted, number.after.sd, number.after.mean - truth]
    alike = {effect}.union(
        *(group.effects for group in summary.unseparated if effect in group.effects)
    )
    return record | {
        "hopeless": False,
        "numbers": numbers,
        "said": said,
        "named": bool(alike & set(named)),
        "found": bool(alike & set(reported)),
        "false": sorted(set(named) - alike - {None}),
        "verdict": summary.verdict,
        "amplitude": amplitude,
        "smallest": None if smallest is None else float(smallest),
        "unseen": None if unseen is None else float(unseen),
    }


def figures(cases):
    """Return how predictions came true."""
    numbers = [(record, *row) for record in cases for row in record["numbers"].values()]
    ratios = [predicted / diagnosed for _, predicted, diagnosed, _ in numbers]
    empty, acting = (
        [
            error / predicted
            for record, predicted, _, error in numbers
            if bool(record["effect"]) == acts
        ]
        for acts in (False, True)
    )
    near = [1 / WITHIN <= ratio <= WITHIN for ratio in ratios]
    can = [record["found"] for record in cases if record["said"] == "can"]
    cannot = [record["named"] for record in cases if record["said"] == "cannot"]
    return {
        "within_factor": [sum(near), len(near)],
        "median_ratio": float(np.median(ratios)),
        "rms_error_over_predicted": _rms(empty),
        "rms_error_over_predicted_beside_effects": _rms(acting),
        "can_found": [sum(can), len(can)],
        "cannot_named": [sum(cannot), len(cannot)],
        "hopeless": sum(record["hopeless"] for record in cases),
    }


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values)))) if values else None


def gather(folder):
    """Run the campaign."""
    return gathered_over_seeds(case, SEEDS, figures, FIXED_SEEDS, folder)


def promises(figures):
    """Return what was promised beside what was found."""
    named, of_cannot = figures["cannot_named"]
    return [
        rate("errors within a factor of 1.5", *figures["within_factor"], least=0.9),
        Outcome(
            "rms error over the predicted one",
            figures["rms_error_over_predicted"],
            least=1 / WITHIN,
            most=WITHIN,
        ),
        rate("found where check says can", *figures["can_found"], least=0.9),
        Outcome(f"named of {of_cannot} where check says cannot", named, most=0),
    ]
