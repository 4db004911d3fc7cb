"""The hierarchical model of boards from one population: its density, and draws."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bayesfric.analysis import Analysis
from bayesfric.arrays import Array
from bayesfric.fitting.drawing import draw_posterior
from bayesfric.inference.hierarchy import NormalBoard, second_stage
from bayesfric.inference.model import Model
from bayesfric.inference.pareto import smooth_weights
from bayesfric.inference.priors import Parameter, quantile
from bayesfric.inference.sampling import Progress

BETWEEN = "between_"
MOST_DRAWS = 4000
TRIES = 4  # boards for each draw of the population
STREAM = 11  # number of this random stream among those of a fit


class Population(Model):
    """The posterior of a population's means and scatter, with the boards integrated out.

    Parameters
    ----------
    boards : sequence of NormalBoard
        Normal approximations of the boards' likelihoods of the same K coefficients.
    coefficients : sequence of Parameter
        Means of the population, each with the prior of a single board.
    analysis : Analysis
        Contains the prior of the scatter between boards.
    """

    def __init__(
        self,
        boards: Sequence[NormalBoard],
        coefficients: Sequence[Parameter],
        analysis: Analysis,
    ) -> None:
        scatter = [
            Parameter(BETWEEN + parameter.name, "1", analysis.priors.boards, "scatter")
            for parameter in coefficients
        ]
        super().__init__((), [*coefficients, *scatter])
        self.boards = tuple(boards)

    def split(self, theta: Array) -> tuple[Array, Array]:
        """Return the means and the standard deviations, each in the coefficients' units."""
        mean, share = np.split(theta, 2, axis=-1)
        return mean, share * np.abs(mean)

    def log_likelihood(self, theta: Array) -> Array:
        """Return the log density of the boards by their approximations, shape (W,)."""
        mean, sd = self.split(theta)
        return np.asarray(sum(board.log_marginal(mean, sd) for board in self.boards))

    def start(self) -> Array:
        """Return a starting point in the sampling space, shape (D,)."""
        count = len(self.parameters) // 2
        mean = np.mean([board.centre[:count] for board in self.boards], axis=0)
        share = [float(quantile(parameter.prior, 0.5)) for parameter in self.parameters[count:]]
        return self.sampling(np.concatenate([mean, share]))


@dataclass(frozen=True)
class PooledDraws:
    """Draws of a population and its boards.

    Parameters
    ----------
    population : Population
        The model of the population's parameters.
    theta : ndarray, shape (chains, draws, 2 K)
        Means, and scatter between boards over the mean.
    boards : mapping of str to ndarray, shape (chains, draws, D)
        All parameters of each board, in the units and the order of its model.
    acceptance : float
        Share of proposals that the boards' own densities accepted.
    pareto_k : float
        Tail index of the weights of the proposals.
    """

    population: Population
    theta: Array
    boards: Mapping[str, Array]
    acceptance: float
    pareto_k: float


def draw_pooled(
    models: Mapping[str, Model],
    draws: Mapping[str, Array],
    analysis: Analysis,
    progress: Progress | None = None,
) -> PooledDraws:
    """Draw the population, and the parameters of each board given all boards.

    Parameters
    ----------
    models : mapping of str to Model
        The model of each board, with the same coefficients and priors.
    draws : mapping of str to ndarray, shape (S, D)
        Posterior draws of each board alone, in the units and the order of its model.
    analysis : Analysis
        Sampler, seed, and the prior of the scatter between boards.
    progress : callable or None
        Called with the sampler's steps done and steps in all.
    """
    first = next(iter(models.values()))
    coefficients = [parameter for parameter in first.parameters if parameter.kind == "coefficient"]
    names = [parameter.name for parameter in coefficients]
    boards = {name: NormalBoard.of(models[name], draws[name], names) for name in models}
    population = Population(list(boards.values()), coefficients, analysis)
    drawn = draw_posterior(population, analysis, progress)
    theta = population.natural(drawn.z)
    chains, kept, walkers, size = theta.shape
    stride = max(1, -(-chains * kept * walkers // MOST_DRAWS))
    # Walkers of a step follow one another, so that neighbouring draws are nearly independent.
    theta = theta.reshape(chains, kept * walkers, size)[:, ::stride]
    flat = theta.reshape(-1, size)
    mean, sd = population.split(flat)
    rng = np.random.default_rng(np.random.SeedSequence([analysis.seed, STREAM]))
    log_weight = -population.log_likelihood(flat)
    tried: dict[str, Array] = {}
    for name, board in boards.items():
        points, weights = board.draw(mean, sd, TRIES, rng)
        total = np.logaddexp.reduce(weights, axis=1)
        log_weight = log_weight + total
        with np.errstate(invalid="ignore"):  # all proposed boards may have density 0
            share = np.nan_to_num(np.exp(weights - total[:, None]), nan=1 / TRIES)
        # Choose a proposed board with probabilities by weight.
        chosen = (share.cumsum(axis=1) < rng.uniform(size=(len(share), 1))).sum(axis=1)
        tried[name] = points[np.arange(len(points)), np.minimum(chosen, TRIES - 1)]
    _, pareto_k = smooth_weights(log_weight)
    at = second_stage(log_weight.reshape(chains, -1), rng)
    rows = np.arange(chains)[:, None]
    return PooledDraws(
        population,
        theta[rows, at],
        {
            name: values.reshape(chains, -1, values.shape[1])[rows, at]
            for name, values in tried.items()
        },
        float((np.diff(at, axis=1) != 0).mean()),
        pareto_k,
    )
