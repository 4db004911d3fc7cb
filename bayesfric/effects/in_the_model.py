"""Names that users may look for among the effects, and why they are no effects of their own."""

from types import MappingProxyType

IN_THE_MODEL = MappingProxyType(
    {
        "coupling": "every hypothesis includes the pull of other logged joints; joints "
        "that are not logged cannot be examined (rig.other_joints)",
        "model-error": "every hypothesis includes errors of the machine's model, if there is one "
        "(rig.robot); diagnosis.json has them under model_error",
        "torque-gain": "a wrong scale of the force changes all numbers of the law alike: it shows "
        "only beside a mass that is declared, in the first line of attention",
    }
)
"""Reasons by name, for a driven joint."""
