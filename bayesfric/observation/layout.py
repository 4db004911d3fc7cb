"""The order of the numbers of the linear model.

First, for each pulley size, come the three coefficients of the law and smooth forces of the
discrepancy. Then follow numbers that all sizes share: an amplitude of each acting effect, and the
numbers of every hypothesis, which are further smooth forces, small amounts and other forms of
effects, and nuisances of each rig, such as the curve of an idle motor. A trial depends only on the
numbers of its size and the shared ones: its columns are *local*. All are in units of their scale.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bayesfric.analysis import Priors, Scatter
from bayesfric.arrays import Array, Whole
from bayesfric.effects.candidates import Candidate
from bayesfric.inference.smooths import Smooth
from bayesfric.observation.unsupported import Unsupported

COEFFICIENTS = 3  # c1, c2, c3


@dataclass(frozen=True)
class Layout:
    """Numbers of columns.

    Parameters
    ----------
    sizes : tuple of str
        Pulley sizes.
    smooths : int
        Smooth forces of each size.
    candidates : int
        Candidates, from which a hypothesis combines its effects.
    shared : int
        Columns of every hypothesis that all sizes share.
    nuisances : tuple of int
        Columns of nuisances, in the order of the rigs.
    """

    sizes: tuple[str, ...]
    smooths: int
    candidates: int
    shared: int
    nuisances: tuple[int, ...]

    @property
    def own(self) -> int:
        """Number of columns of one size."""
        return COEFFICIENTS + self.smooths

    @property
    def always(self) -> int:
        """Number of shared columns of every hypothesis."""
        return self.shared + sum(self.nuisances)

    @property
    def local(self) -> int:
        """Number of columns of a trial: own, candidates, always."""
        return self.own + self.candidates + self.always

    def nuisance(self, rig: int) -> slice:
        """Local columns of the nuisances of the rig with this index."""
        start = self.own + self.candidates + self.shared + sum(self.nuisances[:rig])
        return slice(start, start + self.nuisances[rig])

    def mixed(self, mixing: Array) -> Array:
        """Return the matrix from local columns to the columns of a hypothesis, (local, k).

        Parameters
        ----------
        mixing : ndarray, shape (candidates, effects)
            Column of each acting effect, as a combination of candidates.
        """
        acting = mixing.shape[1]
        mixed = np.zeros((self.local, self.own + acting + self.always))
        mixed[: self.own, : self.own] = np.eye(self.own)
        mixed[self.own : self.own + self.candidates, self.own : self.own + acting] = mixing
        mixed[self.own + self.candidates :, self.own + acting :] = np.eye(self.always)
        return mixed

    def spread(self, columns: int, size: int) -> Whole:
        """Return the positions of a size's columns of a hypothesis among all numbers.

        Sizes follow one another; shared numbers come last.
        """
        shared = np.arange(columns - self.own) + self.own * len(self.sizes)
        return np.concatenate([np.arange(self.own) + self.own * size, shared])

    def total(self, columns: int) -> int:
        """Return the total number of numbers, given the columns of a hypothesis."""
        return self.own * (len(self.sizes) - 1) + columns


@dataclass(frozen=True)
class ModelColumns:
    """The specification of a model's columns, the same for all rigs.

    Parameters
    ----------
    layout : Layout
        Order of the numbers.
    own : sequence of Smooth
        Smooth forces of each size.
    candidates : sequence of Candidate
        Candidates of effects.
    shared : sequence of Smooth or Candidate
        Columns of every hypothesis.
    scales : ndarray, shape (q,)
        Factor of each local column.
    friction_scale : mapping of str to float
        Unit of smooth forces of each size [N].
    scattering : sequence of (Candidate, float)
        Effects whose force scatters with friction, and errors of readings that differ from
        trial to trial, with their amplitudes.
    together : mapping of str to ndarray of int, shape (N,)
        By rig: the group of each trial; groups can be left out. Trials of rigs that are not in
        it cannot be left out.
    priors : Priors
        Priors of the noise.
    scatter : Scatter
        Whether friction of trials or of assemblies is Student-t.
    row_weights : mapping of str to ndarray
        By rig: factor of the precision of each row's own error; 1 for rigs that are not in it.
    """

    layout: Layout
    own: Sequence[Smooth]
    candidates: Sequence[Candidate]
    shared: Sequence[Smooth | Candidate]
    scales: Array
    friction_scale: Mapping[str, float]
    scattering: Sequence[tuple[Candidate, float]]
    together: Mapping[str, Whole]
    priors: Priors
    scatter: Scatter = field(default_factory=Scatter)
    row_weights: Mapping[str, Array] = field(default_factory=dict)

    def filled(
        self,
        rig: str,
        coefficients: Array,
        smooth: Callable[[Smooth], Array],
        effect: Callable[[Candidate], Array | Unsupported],
    ) -> Array:
        """Return the local columns of a rig without its own nuisances, not yet scaled.

        Parameters
        ----------
        rig : str
            Name of the rig; smooth forces of other rigs do not affect it.
        coefficients : ndarray, shape (N, 3)
            Derivatives of each row by c1, c2 and c3.
        smooth : callable
            Function that returns the (N, count) columns of a smooth force.
        effect : callable
            Function that returns the (N,) column of an effect; unsupported effects have none.

        Returns
        -------
        ndarray, shape (N, q)
        """
        columns = np.zeros((len(coefficients), self.layout.local), order="F")  # filled by column
        columns[:, :COEFFICIENTS] = coefficients
        place = COEFFICIENTS
        for column_of in (*self.own, *self.candidates, *self.shared):
            if isinstance(column_of, Smooth):
                if column_of.rig in (None, rig):
                    columns[:, place : place + column_of.count] = smooth(column_of)
                place += column_of.count
                continue
            column = effect(column_of)
            if not isinstance(column, Unsupported):
                columns[:, place] = column
            place += 1
        return columns
