"""How much a rig says: the members of what it fills, and those that no base fills for it.

The counts may only shrink. A rig whose trials are one reading each writes 10 members, as
docs/decisions/observation.md has it.
"""

from bayesfric.observation.exact import ExactModel
from bayesfric.observation.linear import LinearRig, LinearRows
from bayesfric.rigs.base import Rig, RigTrials
from bayesfric.rigs.machine import MachineTrials
from bayesfric.rigs.readings import ReadingTrials

# What a rig fills, and how many members that has.
SEAM = {Rig: 9, MachineTrials: 10, RigTrials: 35, ExactModel: 10, LinearRows: 15, LinearRig: 10}
MOST = 10  # that a rig of readings writes in all
FIELDS = {  # of which only a type checker knows
    RigTrials: {"rig", "table", "recorded", "loads"},
    LinearRows: {"name", "table", "loads", "friction_n", "state", "trial_axes"},
}


def members(kind):
    """Return the public members that a class names itself."""
    named = {*vars(kind), *kind.__annotations__, *FIELDS.get(kind, ())}
    return {name for name in named if not name.startswith("_")}


def unfilled(kind):
    """Return the public members that a base leaves to its rigs: abstract ones, and fields."""
    return {
        name
        for name in members(kind)
        if getattr(getattr(kind, name, None), "__isabstractmethod__", not hasattr(kind, name))
    }


def test_the_seam_does_not_grow():
    assert {kind: len(members(kind)) for kind in SEAM} == SEAM


def test_a_rig_of_readings_writes_few_of_them():
    written = {*unfilled(Rig), *FIELDS[RigTrials], *ReadingTrials.__abstractmethods__}
    assert len(written) <= MOST, sorted(written)
