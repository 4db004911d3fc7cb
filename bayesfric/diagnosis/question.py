"""The input of a diagnosis: a recording, a law, fixed numbers and effects."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.baseline import data_of
from bayesfric.diagnosis.examined import examinable, remarks_on_priors, widened
from bayesfric.diagnosis.shipped import Shipped, held_of, shipped_of
from bayesfric.diagnosis.simulated import own_law_of
from bayesfric.diagnosis.target import check_target
from bayesfric.effects import Effect, with_priors
from bayesfric.effects.candidates import Candidate, candidates_of
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw
from bayesfric.recording.tables import Recording
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import with_own_priors
from bayesfric.rigs.own_law import OwnLaw
from bayesfric.simulators import SimulatorCalls


class Sources(NamedTuple):
    """Sources of randomness of a diagnosis, one for each step that draws."""

    folds: np.random.Generator
    bootstrap: np.random.Generator
    axes: np.random.Generator
    draws: np.random.Generator
    checks: np.random.Generator
    blocks: np.random.Generator
    order: np.random.Generator
    scatter: np.random.Generator


@dataclass(frozen=True)
class Question:
    """A recording, and all settings of its diagnosis.

    Parameters
    ----------
    recording : Recording
        The recording as read.
    data : Data
        Trials that are used.
    analysis : Analysis
        The analysis, including default priors of the rigs.
    law : FrictionLaw
        The law whose gap is diagnosed.
    own_law : OwnLaw or None
        A user's simulator that replaces the law.
    shipped : Shipped or None
        The simulator's values as the user gave them.
    law_shipped : mapping of str to Coefficients
        The law with these values, by pulley size.
    held : frozenset of str
        Numbers that are not fitted.
    examined : mapping of str to Effect
        Examined effects by name.
    lacking : mapping of str to tuple of str
        What these data lack, for each effect that cannot be examined.
    own_effects : tuple of str
        Names of the user's effects.
    target : DataFrame or None
        Conditions at which friction is predicted.
    remarks : tuple of str
        Sentences on user priors that have no effect or override the data.
    fixed : tuple of str
        Fixed numbers by the user's names.
    widened : tuple of str
        Effects whose priors were too tight and have been widened.
    """

    recording: Recording
    data: Data
    analysis: Analysis
    law: FrictionLaw
    own_law: OwnLaw | None
    shipped: Shipped | None
    law_shipped: Mapping[str, Coefficients]
    held: frozenset[str]
    examined: Mapping[str, Effect]
    lacking: Mapping[str, tuple[str, ...]]
    own_effects: tuple[str, ...]
    target: pd.DataFrame | None
    remarks: tuple[str, ...] = ()
    fixed: tuple[str, ...] = ()
    widened: tuple[str, ...] = ()

    @property
    def practical(self) -> float:
        """Share of friction below which a gap does not matter."""
        return self.analysis.diagnosis.practical_share

    @property
    def sources(self) -> Sources:
        """New sources of randomness from the seed of the analysis."""
        children = np.random.SeedSequence(self.analysis.seed).spawn(len(Sources._fields))
        return Sources(*map(np.random.default_rng, children))

    @property
    def candidates(self) -> list[Candidate]:
        """Candidates of all examined effects."""
        return [
            candidate for effect in self.examined.values() for candidate in candidates_of(effect)
        ]


def question_of(
    recording: Recording,
    analysis: Analysis,
    fixed: Collection[str],
    effects: Collection[Effect],
    shipped: Shipped | None,
    baseline: str,
    simulator: SimulatorCalls | None,
    target: pd.DataFrame | None,
) -> Question:
    """Return the question; parameters as of :func:`bayesfric.diagnosis.diagnose`."""
    data, law = data_of(recording, baseline, simulator)
    own_law = own_law_of(data)
    if target is not None:
        check_target(target, data.rigs[0], data.sizes)
    stated, analysis = analysis, with_own_priors(analysis, data.rigs)
    law_shipped = shipped_of(shipped, data)
    held = held_of(fixed, data, law_shipped)
    examined, lacking = examinable(data, {effect.name: effect for effect in effects})
    remarks = remarks_on_priors(stated, examined, data.rigs[0])
    examined = with_priors(examined, analysis.priors.effects)
    return Question(
        recording,
        data,
        analysis,
        law,
        own_law,
        shipped,
        law_shipped,
        held,
        {name: widened(effect, analysis) for name, effect in examined.items()},
        lacking,
        tuple(effect.name for effect in effects),
        target,
        remarks,
        tuple(sorted(set(fixed))),
    )
