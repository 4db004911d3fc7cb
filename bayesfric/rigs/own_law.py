"""A user's simulator as the baseline of a diagnosis."""

from dataclasses import dataclass

from bayesfric.inference.priors import Parameter
from bayesfric.physics.laws import FrictionLaw


@dataclass(frozen=True)
class OwnLaw:
    """A user's simulator that replaces the law in a diagnosis.

    Parameters
    ----------
    law : FrictionLaw
        A law with the name of the simulator. It lacks one coefficient for each of c1, c2 and c3
        that no parameter of the simulator replaces.
    parameters : tuple of Parameter
        Parameters of the simulator, which replace c1, c2 and c3 in this order.
    calls : int
        Number of calls of the simulator; 0 if its results were stored with the recording.
    """

    law: FrictionLaw
    parameters: tuple[Parameter, ...]
    calls: int
