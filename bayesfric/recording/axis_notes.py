"""Notes on data of driven joints that are read and not used, or not used as recorded."""

from bayesfric.recording.csv_text import LISTED
from bayesfric.recording.held import released
from bayesfric.recording.tables import Axis, RigConstants

OF_COMMANDS = ("command_gain", "latency_s", "payload_arm_m")
"""Keys of ``rig`` that describe a log of commands without a force."""
UNUSED_KEYS = ("sample_hold_s",)
"""Keys of ``rig`` that no model uses."""


def notes_on_axis(axis: Axis, rig: RigConstants) -> tuple[str, ...]:
    """Return a sentence for data that no command uses, and for readings that are held."""
    notes = [
        f"axis_samples.csv: run {run}: {held}; repeated readings are left out"
        for run, samples in axis.samples.groupby("run", sort=False)
        if "force_n" in samples and (held := released(samples, rig.force_is)[1]) is not None
    ]
    if len(notes) > LISTED:
        notes = [*notes[:LISTED], f"axis_samples.csv: and {len(notes) - LISTED:,} runs like these"]
    has_force = "force_n" in axis.samples
    if has_force and "command_time_s" in axis.samples:
        notes.append("axis_samples.csv: command_time_s is read and checked, and not used")
    unused = (*UNUSED_KEYS, *(OF_COMMANDS if has_force else ()))
    if keys := [f"rig.{name}" for name in unused if getattr(rig, name) is not None]:
        notes.append(f"datapackage.json: {_listed(keys)} read and checked, and not used")
    if "sim_position_m" in axis.samples and rig.moving_mass_kg is None:
        notes.append(
            "axis_samples.csv: sim_position_m is checked and not used: it takes "
            "rig.moving_mass_kg, the mass that your simulator moves, to make a force of a path"
        )
    return tuple(notes)


def _listed(names: list[str]) -> str:
    return f"{', '.join(names)} {'is' if len(names) == 1 else 'are'}"
