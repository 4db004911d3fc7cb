"""Bayes factors against the truth: recordings drawn from the prior with which they are fitted.

The generating prior is that of simulation-based calibration. The law and the law with an
effect are equally likely; the effect's amplitude has a prior about twice as wide as the
data's error of it, so that most recordings leave both hypotheses possible.
"""

from dataclasses import replace

import numpy as np
from campaigns.evidence import Gathered
from campaigns.promises import Outcome, rate

from bayesfric.analysis import Analysis, HalfNormal, Normal
from bayesfric.calibration.generating import draw_truth, generating_analysis
from bayesfric.campaign import run_on_processes
from bayesfric.claims.entered import Entered
from bayesfric.claims.studies import Task, study_all
from bayesfric.effects import all_effects
from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.inference.priors import draw
from bayesfric.simulate import AppliedEffect, simulate_recording

FINGERPRINT = ("simulators", "effects", "likelihood.gravity", "evidence", "claims")
SEEDS = range(400)  # of each effect
FIXED_SEEDS = range(20)  # that the nightly job repeats
LEAST_OPEN = 0.4
AMPLITUDES = {
    ("viscous", "constant"): HalfNormal(scale=1.2e-4),
    ("tension-curvature", "quadratic"): Normal(mean=0.0, sd=0.008),
}
BINS = 10
RESAMPLES = 20_000
NARROW = 5  # place in WIDTHS: a third of the amplitude's prior width
OPEN = (0.05, 0.95)  # a probability in between leaves both hypotheses possible


def with_narrow_prior(name, law):
    """Return an effect whose amplitude has the prior of :data:`AMPLITUDES`."""
    effect = all_effects()[name]
    return replace(effect, amplitude=replace(effect.amplitude, prior=AMPLITUDES[name, law]))


def draw_case(generating, effect, law, rng):
    """Draw a truth, and whether the effect acts."""
    acts = bool(rng.uniform() < 0.5)
    amplitude = float(draw(effect.amplitude.prior, 1, rng)[0])
    applied = AppliedEffect(effect, law, {effect.amplitude.name: amplitude})
    return replace(draw_truth(generating, rng), effects=(applied,) if acts else ()), acts


def case(given):
    """Draw a recording of an effect's pair of hypotheses, and weigh the two.

    Parameters
    ----------
    given : (str, str, int)
        Effect, law and seed.

    Returns
    -------
    dict
        Whether the effect acts, its amplitude, the log Bayes factor for it with its
        error [nat], the same for a third of its prior's width, and how many trials did
        not move.
    """
    name, law, seed = given
    analysis = generating_analysis(Analysis(seed=seed))
    effect = with_narrow_prior(name, law)
    rng = np.random.default_rng([seed, *name.encode()])
    truth, acts = draw_case(analysis, effect, law, rng)
    number = int(rng.integers(2**32))
    recording = simulate_recording("quick", seed=number, truth=truth, rigs=("gravity",))
    hypotheses = LawWithEffects(), LawWithEffects(effects=((name, law),))
    tasks = [Task("gravity", hypothesis) for hypothesis in hypotheses]
    data = Entered.of(recording).data
    studied = study_all(tasks, data, analysis, {name: effect}, None)
    without, with_effect = (studied[task].evidence for task in tasks)
    narrower = float(studied[tasks[1]].widths[NARROW])
    log_bayes_factor = with_effect.log_evidence - without.log_evidence
    return {
        "effect": name,
        "seed": seed,
        "acts": acts,
        "amplitude": truth.effects[0].values[effect.amplitude.name] if acts else 0.0,
        "log_bayes_factor": log_bayes_factor,
        "narrow_log_bayes_factor": log_bayes_factor + narrower,
        "error": float(np.hypot(with_effect.error, without.error)),
        "stalled": len(recording.metadata["simulation"]["stalled"]),
    }


def figures(log_bayes_factor, narrow, acts):
    """Return how the probabilities of an effect compare with how often it acts.

    Consistency bands are those of recordings in which the effect acts as often as the
    probabilities say: the truth is drawn anew, the probabilities stay. They hold all
    bins at once.

    By Good's identity the mean Bayes factor of the wrong hypothesis is 1. Against the law
    it has a finite variance only where the effect's prior is narrower than the data's
    error: hence `narrow`, since without the effect the identity holds for any prior of it.
    That of the prior itself rests on factors so rare that a sample of hundreds lacks
    them, and is compared with the same band.

    Parameters
    ----------
    log_bayes_factor : ndarray, shape (N,)
        For the effect, whose prior probability is 1/2 [nat].
    narrow : ndarray, shape (N,)
        The same with the narrower prior [nat].
    acts : ndarray of bool, shape (N,)
        The truth.

    Returns
    -------
    dict
        Of plain JSON types.

    References
    ----------
    J. Bröcker, L. A. Smith, "Increasing the reliability of reliability diagrams",
    Weather and Forecasting 22 (2007).
    I. J. Good, "Weight of evidence: a brief survey", Bayesian Statistics 2 (1985).
    D. J. Spiegelhalter, "Probabilistic prediction in patient management and clinical
    trials", Statistics in Medicine 5 (1986).
    """
    p = 1 / (1 + np.exp(-log_bayes_factor))
    again = np.random.default_rng(95).uniform(size=(RESAMPLES, p.size)) < p
    member = np.minimum((p * BINS).astype(int), BINS - 1) == np.arange(BINS)[:, None]
    member = member[member.any(axis=1)].astype(float)
    count, expected = member.sum(axis=1), member @ p
    spread = np.sqrt(member @ (p * (1 - p)))
    furthest = (np.abs(again @ member.T - expected) / spread).max(axis=1)
    reach = float(np.quantile(furthest, 0.95)) * spread
    factor = np.exp(log_bayes_factor)
    drawn = (~again @ factor) / np.maximum((~again).sum(axis=1), 1)
    return {
        "recordings": int(p.size),
        "with_effect": int(acts.sum()),
        "share_open": float(((p > OPEN[0]) & (p < OPEN[1])).mean()),
        "spiegelhalter_z": spiegelhalter(p, acts),
        "reliability": [
            {"mean_probability": m, "frequency": f, "band": [low, high], "recordings": int(n)}
            for m, f, low, high, n in zip(
                (expected / count).tolist(),
                ((member @ acts) / count).tolist(),
                ((expected - reach) / count).tolist(),
                ((expected + reach) / count).tolist(),
                count,
                strict=True,
            )
        ],
        "good_without_effect": mean_and_error(np.exp(narrow[~acts])),
        "good_with_effect": mean_and_error(1 / factor[acts]),
        "whole_width_without_effect": {
            **mean_and_error(factor[~acts]),
            "band_99": np.quantile(drawn, [0.005, 0.995]).tolist(),
        },
    }


def mean_and_error(values):
    """Return the mean of values and its standard error."""
    error = values.std(ddof=1) / np.sqrt(values.size)
    return {"mean": float(values.mean()), "standard_error": float(error)}


def spiegelhalter(p, acts):
    """Return the z of the Brier score: N(0, 1) where probabilities are calibrated."""
    variance = ((1 - 2 * p) ** 2 * p * (1 - p)).sum()
    return float(((acts - p) * (1 - 2 * p)).sum() / np.sqrt(variance))


def faults(figures):
    """Return which promises of one effect its figures break."""
    return [outcome.promise for outcome in of_one_effect("it", figures) if not outcome.met]


def of_one_effect(name, figures):
    """Return what is promised of an effect's figures, beside them."""
    number = figures["recordings"]
    outside = sum(
        not point["band"][0] <= point["frequency"] <= point["band"][1]
        for point in figures["reliability"]
    )
    whole = figures["whole_width_without_effect"]

    def from_one(mean):
        return (mean["mean"] - 1) / mean["standard_error"]

    return [
        rate(
            f"{name}: probability is between {OPEN[0]} and {OPEN[1]}",
            round(figures["share_open"] * number),
            number,
            least=LEAST_OPEN,
        ),
        Outcome(f"{name}: bins of probability outside their band", outside, most=0),
        Outcome(f"{name}: Spiegelhalter's z", figures["spiegelhalter_z"], -2.0, 2.0),
        *(
            Outcome(
                f"{name}: Good's identity {which} the effect, in standard errors",
                from_one(figures[f"good_{which}_effect"]),
                -3.0,
                3.0,
            )
            for which in ("without", "with")
        ),
        Outcome(f"{name}: mean Bayes factor at the whole width", whole["mean"], *whole["band_99"]),
    ]


def cases(seeds=SEEDS):
    """Return effect, law and seed of every case, by name."""
    return {f"{name}-{seed:04d}": (name, law, seed) for name, law in AMPLITUDES for seed in seeds}


def of_effect(done, name):
    """Return log Bayes factors, those of the narrower prior, and where the effect acts."""
    own = [record for record in done if record["effect"] == name]
    columns = "log_bayes_factor", "narrow_log_bayes_factor", "acts"
    return tuple(np.array([record[column] for record in own]) for column in columns)


def gather(folder):
    """Run the campaign."""
    done = list(run_on_processes(case, cases(), folder, workers=2).values())
    by_effect = {name: figures(*of_effect(done, name)) for name, _ in AMPLITUDES}
    return Gathered(
        seeds=[SEEDS.start, SEEDS.stop - 1],
        figures=by_effect | {"stalled_trials": sum(record["stalled"] for record in done)},
        cases=done,
        fixed=[record for record in done if record["seed"] in FIXED_SEEDS],
    )


def promises(figures):
    """Return what was promised beside what was found."""
    stalled = Outcome("trials that did not move", figures["stalled_trials"], most=0)
    by_effect = (of_one_effect(name, figures[name]) for name, _ in AMPLITUDES)
    return [stalled, *(outcome for outcomes in by_effect for outcome in outcomes)]
