"""The file that ``bayesfric effects new`` writes: an effect that its author then edits."""

TEXT = '''"""An effect of your own: say in a line what the law of friction leaves out."""

import numpy as np

from bayesfric.analysis import Normal
from bayesfric.effects import Effect, EffectParameter


def law(parameters, state):
    """Return the force against the motion [N] that this adds, for arrays of any shape.

    `state` has n_pulleys, wrap_angle_deg, tension_n, speed_m_s, friction_n, order and more, see
    bayesfric.effects.State; state.covariates has further columns of the recording by name.
    """
    return parameters["share"] * np.asarray(state.friction_n) * (np.asarray(state.order) - 0.5)


EFFECT = Effect(
    name="{name}",
    acts_on="friction",
    sentence="friction changes as nobody has described yet",
    amplitude=EffectParameter(
        name="share",
        unit="1",
        meaning="change of friction from the first trial to the last, as a share of it",
        prior=Normal(mean=0.0, sd=0.2),  # before these data: how large could it be?
        plausible=(-0.5, 0.5),
        reference="a guess, to be argued",
    ),
    laws={{"first-form": law}},
    axes=frozenset({{"order"}}),  # along which its force changes
    # needs=frozenset({{"oil_temperature_c"}}),  # columns that the law takes from state.covariates
    # along_path=True,  # where it changes with speed or travel within a trial
)
'''


def template(name: str) -> str:
    """Return the text of a Python file with an ``EFFECT``.

    Parameters
    ----------
    name : str
        Name of the effect: lower case letters, digits and hyphens.
    """
    return TEXT.format(name=name)
