"""A quick look at claims, of which none is judged."""

from dataclasses import replace

from bayesfric.analysis import Analysis
from bayesfric.claims import registered
from bayesfric.claims.checking import rival_effects
from bayesfric.claims.comparison import bayes_factor
from bayesfric.claims.entered import Entered
from bayesfric.claims.studies import study_all


def screen_claims(recording):
    """Return the log10 Bayes factor and its error of the claims for which they can be had.

    Of all sizes together.
    """
    analysis = Analysis()
    entered = Entered.of(recording)
    entered = replace(entered, data={name: entered.data[name] for name in entered.rigs})
    compared = [claim for claim in registered() if claim.by_size and claim.rivals]
    claims = [claim for claim in compared if not claim.untestable(entered)]
    tasks = list(dict.fromkeys(task for claim in claims for task in claim.tasks(entered)))
    effects = rival_effects(analysis)
    studied = study_all(tasks, entered.data, analysis, effects, None)
    factors = {}
    for claim in claims:
        own, *rivals = (studied[task] for task in claim.tasks(entered))
        if all(study.evidence is not None for study in (own, *rivals)):
            factors[claim.name] = bayes_factor(own, rivals)
    return factors
