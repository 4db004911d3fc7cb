"""Names of what users look for among effects and what is no effect of its own, and why not."""

from types import MappingProxyType

IN_THE_MODEL = MappingProxyType(
    {
        "coupling": "other joints that are logged are in every hypothesis, with amounts of their "
        "own; of those that are not nothing can be told (rig.other_joints)",
        "model-error": "errors of the machine's model are in every hypothesis that has one "
        "(rig.robot), and stand under model_error",
        "torque-gain": "an error of the force's scale is one of all numbers of the law together: "
        "it shows beside a mass that is declared, in the first line of attention",
    }
)
"""By name, of a driven joint."""
