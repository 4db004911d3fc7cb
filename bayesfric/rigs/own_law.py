"""A law of the user's own, by which a recording is diagnosed."""

from dataclasses import dataclass

from bayesfric.inference.priors import Parameter
from bayesfric.physics.laws import FrictionLaw


@dataclass(frozen=True)
class OwnLaw:
    """A user's simulator in the place of a law, in a diagnosis.

    Parameters
    ----------
    law : FrictionLaw
        By the simulator's name, without the coefficients that it has no parameter for.
    parameters : tuple of Parameter
        In the places of c1, c2 and c3.
    calls : int
        Of the simulator; 0 of what it left in a recording.
    """

    law: FrictionLaw
    parameters: tuple[Parameter, ...]
    calls: int
