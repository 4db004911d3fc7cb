"""A hypothesis of a diagnosis: which effects act together, and how that is written."""

from collections.abc import Iterator, Mapping

TOGETHER, NOTHING = "+", "none"


class Hypothesis(frozenset[str]):
    """The names of the effects that act; none of them for the baseline alone.

    Names come in alphabetical order, whatever the order in which they were given. A set of
    effects is compared with another as sets are: ``effects <= hypothesis``.
    """

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(super().__iter__()))

    def __str__(self) -> str:
        return TOGETHER.join(self) or NOTHING

    @property
    def names(self) -> tuple[str, ...]:
        """The effects, sorted."""
        return tuple(self)

    def with_effects(self, *names: str) -> "Hypothesis":
        """Return the hypothesis that these effects act too."""
        return Hypothesis((*self, *names))

    @classmethod
    def parse(cls, text: str) -> "Hypothesis":
        """Return the hypothesis that is written so, as in ``slip+viscous`` or ``none``."""
        return cls() if text == NOTHING else cls(text.split(TOGETHER))


NONE = Hypothesis()
"""The baseline alone."""
UNKNOWN = Hypothesis(("unknown",))
"""A force that no effect makes."""


def parsed(chances: Mapping[str, float]) -> dict[Hypothesis, float]:
    """Return probabilities of hypotheses as they are read from a file, in its order."""
    return {Hypothesis.parse(text): chance for text, chance in chances.items()}


def printed(chances: Mapping[Hypothesis, float]) -> dict[str, float]:
    """Return probabilities of hypotheses as they are written to a file, in the same order."""
    return {str(hypothesis): chance for hypothesis, chance in chances.items()}
