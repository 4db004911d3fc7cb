"""A hypothesis is a law and what acts beside it; with data it is a model."""

from dataclasses import dataclass

from bayesfric.analysis import Analysis, PriorOverrides, Uniform
from bayesfric.effects import Effect
from bayesfric.effects.terms import ActiveEffect
from bayesfric.inference.model import Model
from bayesfric.paper import table1
from bayesfric.physics.laws import BASELINES, RIVAL_LAWS
from bayesfric.rigs.data import Data

__all__ = ["Hypothesis", "model_of"]

LAWS = BASELINES | RIVAL_LAWS


@dataclass(frozen=True)
class Hypothesis:
    """A law, and one law of each effect that acts.

    Parameters
    ----------
    law : str
        A name in :data:`bayesfric.physics.laws.BASELINES` or
        :data:`bayesfric.physics.laws.RIVAL_LAWS`.
    effects : tuple of (str, str)
        Names of effects, each with the name of one of its laws.
    printed : bool
        Whether the coefficients are those of Table I: uniform over what rounds to the
        printed digits, instead of the analysis' priors.
    """

    law: str = "paper"
    effects: tuple[tuple[str, str], ...] = ()
    printed: bool = False

    @property
    def label(self) -> str:
        """The law alone, or its effects as in ``viscous/tension``."""
        if self.printed:
            return "table-1"
        return "+".join("/".join(one) for one in self.effects) or self.law


def model_of(
    data: Data, analysis: Analysis, hypothesis: Hypothesis, effects: dict[str, Effect]
) -> Model:
    """Return the posterior of a hypothesis.

    Parameters
    ----------
    data : Data
        Of one rig or several.
    analysis : Analysis
        Priors and the form of the scatter.
    hypothesis : Hypothesis
        What is assumed.
    effects : dict of str to Effect
        Where the effects of the hypothesis are found by name.

    Returns
    -------
    Model
        Of the likelihoods of all rigs.
    """
    law = LAWS[hypothesis.law]
    if hypothesis.printed:
        analysis = _with_table1(analysis)
    active = [ActiveEffect(effects[name], variant) for name, variant in hypothesis.effects]
    return Model([one.likelihood(analysis, law, active) for one in data.rigs])


def _with_table1(analysis: Analysis) -> Analysis:
    """Return the analysis with priors of the sizes of Table I as narrow as its rounding."""
    printed = {}
    for size, row in table1().items():
        numbers = {"c1": row.c1, "c2": row.c2, "c3": row.c3}
        printed[size] = PriorOverrides(
            **{
                name: Uniform(low=n.value - n.rounding, high=n.value + n.rounding)
                for name, n in numbers.items()
            }
        )
    pulleys = {**analysis.priors.pulleys, **printed}
    priors = analysis.priors.model_copy(update={"pulleys": pulleys})
    return analysis.model_copy(update={"priors": priors})
