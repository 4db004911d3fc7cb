"""The data that claims are judged on, by name, and the law of the claims."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

from bayesfric.fitting.hypothesis import LawWithEffects
from bayesfric.recording.tables import Recording
from bayesfric.rigs import all_rigs
from bayesfric.rigs.base import Regime, RigTrials
from bayesfric.rigs.data import Data
from bayesfric.rigs.opening import baseline_of, chosen_rigs, open_rigs, rigs_with_trials

PAPER = "paper"


@dataclass(frozen=True)
class Entered:
    """The used data of a recording, as a whole and by pulley size, and the law.

    Parameters
    ----------
    data : mapping of str to Data
        By the name of a rig, in the order of :func:`bayesfric.rigs.all_rigs`; by that of
        a rig and a size as in ``RIG/small``; and by those of two rigs as in ``RIG+OTHER``,
        the second with the sizes that it shares with the first.
    left_out : tuple of str
        Rigs of the recording that were not requested.
    law : str
        The friction law that claims are about, a name in
        :data:`bayesfric.physics.laws.BASELINES`.
    """

    data: Mapping[str, Data]
    left_out: tuple[str, ...] = ()
    law: str = PAPER

    @classmethod
    def of(
        cls, recording: Recording, rigs: Sequence[str] | None = None, law: str = PAPER
    ) -> "Entered":
        """Return the data of all rigs of a recording, or of the named ones.

        Raises
        ------
        InputError
            A rig or the law is unknown, or a named rig has no data.
        """
        there = rigs_with_trials(recording)
        baseline_of(law, tuple(there.values()))
        chosen = tuple(there) if rigs is None else chosen_rigs(recording, rigs)
        opened = dict(zip(chosen, open_rigs(recording, chosen), strict=True))
        data = {name: Data((trials,)) for name, trials in opened.items()}
        for name in list(data):
            for size in data[name].sizes:
                data[f"{name}/{size}"] = data[name].of_size(size)
        for first, second in permutations(chosen, 2):
            shared_sizes = opened[second].table["pulley_size"].isin(data[first].sizes)
            if (shared := opened[second].select(shared_sizes)) is not None:
                data[f"{first}+{second}"] = Data((opened[first], shared))
        return cls(data, tuple(name for name in there if name not in data), law)

    @property
    def claimed(self) -> LawWithEffects:
        """The law without effects."""
        return LawWithEffects(self.law)

    @property
    def rigs(self) -> tuple[str, ...]:
        """Names of the rigs."""
        return tuple(name for name in self.data if "/" not in name and "+" not in name)

    def trials(self, name: str) -> RigTrials:
        """Return the trials of a rig."""
        (trials,) = self.data[name].rigs
        return trials

    def first(self, regime: Regime) -> str | None:
        """Return the name of the first rig with trials of this motion, or None."""
        moving = (
            name
            for name in self.rigs
            if self.trials(name).rig.words.regime == regime and self.trials(name).has_pulleys
        )
        return next(moving, None)

    @property
    def has_pulleys(self) -> bool:
        """Whether any data are of a cable over pulleys."""
        return any(self.trials(name).has_pulleys for name in self.rigs)

    def lack(self, regime: Regime) -> str:
        """Return a sentence on why no rig has trials of this motion."""
        kinds = [rig for rig in all_rigs().values() if rig.words.regime == regime]
        without = [rig for rig in kinds if rig.name in self.left_out]
        if without:
            return f"The {' and the '.join(rig.words.rig for rig in without)} was left out."
        return f"The recording has no {' or '.join(rig.words.rig for rig in kinds)}."
