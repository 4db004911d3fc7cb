"""A hypothesis (a friction law and acting effects), and its posterior given data."""

from dataclasses import dataclass

from bayesfric.analysis import Analysis
from bayesfric.effects import Effect
from bayesfric.effects.terms import ActiveEffect
from bayesfric.inference.model import Model
from bayesfric.inference.proposals import Chart
from bayesfric.physics.laws import BASELINES, RIVAL_LAWS
from bayesfric.rigs.data import Data

LAWS = BASELINES | RIVAL_LAWS


@dataclass(frozen=True)
class LawWithEffects:
    """A friction law, and one law of each acting effect.

    Parameters
    ----------
    law : str
        A name in :data:`bayesfric.physics.laws.BASELINES` or
        :data:`bayesfric.physics.laws.RIVAL_LAWS`.
    effects : tuple of (str, str)
        Names of effects, each with the name of one of its laws.
    """

    law: str = "paper"
    effects: tuple[tuple[str, str], ...] = ()

    @property
    def label(self) -> str:
        """Its effects with their laws, as in ``viscous/tension``; without any, its friction law."""
        return "+".join("/".join(effect) for effect in self.effects) or self.law


def model_of(
    data: Data, analysis: Analysis, hypothesis: LawWithEffects, effects: dict[str, Effect]
) -> Model:
    """Return the posterior of a hypothesis.

    Parameters
    ----------
    data : Data
        Data of one or more rigs.
    analysis : Analysis
        Priors and the form of the scatter.
    hypothesis : LawWithEffects
        The hypothesis.
    effects : dict of str to Effect
        Effects by name, including those of the hypothesis.

    Returns
    -------
    Model
        The posterior, with the likelihoods of all rigs.
    """
    law = LAWS[hypothesis.law]
    active = [ActiveEffect(effects[name], variant) for name, variant in hypothesis.effects]
    return Model([trials.likelihood(analysis, law, active) for trials in data.rigs])


def chart_of(model: Model) -> Chart:
    """Return a model's own coordinates, in which proposals are fitted to its posterior."""
    return Chart(model.coordinates, model.from_coordinates, model.coordinates_log_slope)
