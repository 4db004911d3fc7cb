"""What a campaign promises, and what came of it: the rows of ``reports/evidence/history.csv``."""

from dataclasses import dataclass

from scipy.stats import beta


@dataclass(frozen=True)
class Outcome:
    """One promise of a campaign beside the figure that was found.

    Parameters
    ----------
    promise : str
        In words.
    value : float
        What was found.
    least, most : float, optional
        The bound that was promised, both ends included.
    low, high : float, optional
        The 95 % interval of the value.
    n : int, optional
        Of how many the value is a share; absent where it is no share.
    """

    promise: str
    value: float
    least: float | None = None
    most: float | None = None
    low: float | None = None
    high: float | None = None
    n: int | None = None

    @property
    def met(self):
        """Whether the value lies where it was promised to lie."""
        above = self.least is None or self.value >= self.least
        return above and (self.most is None or self.value <= self.most)


def rate(promise, hits, number, *, least=None, most=None):
    """Return the outcome of a promised share, with the interval of Clopper and Pearson."""
    return Outcome(promise, hits / number, least, most, **bounds(hits, number), n=number)


def bounds(hits, number):
    """Return the 95 % interval of Clopper and Pearson."""
    return {
        "low": float(beta.ppf(0.025, hits, number - hits + 1)) if hits else 0.0,
        "high": float(beta.ppf(0.975, hits + 1, number - hits)) if hits < number else 1.0,
    }
