"""A user's simulator as the law of a diagnosis."""

from dataclasses import dataclass

from bayesfric.inference.priors import Parameter
from bayesfric.physics.laws import FrictionLaw


@dataclass(frozen=True)
class OwnLaw:
    """A user's simulator that replaces the law in a diagnosis.

    Parameters
    ----------
    law : FrictionLaw
        Law with the simulator's name. It lacks the coefficients for which the simulator has no
        parameter.
    parameters : tuple of Parameter
        Parameters of the simulator, which replace c1, c2 and c3 in this order.
    calls : int
        Number of calls of the simulator; 0 if its forces are columns of the recording.
    """

    law: FrictionLaw
    parameters: tuple[Parameter, ...]
    calls: int
