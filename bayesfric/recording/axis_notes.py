"""What of a single axis' log is read and then not used, or not as it stands."""

from bayesfric.recording.csv_text import LISTED
from bayesfric.recording.held import released
from bayesfric.recording.tables import Axis, RigConstants

__all__ = ["notes_on_axis"]


def notes_on_axis(axis: Axis, rig: RigConstants) -> tuple[str, ...]:
    """Return a sentence for each column that no verb uses, and for readings that are held."""
    notes = [
        f"axis_samples.csv: run {run}: {held}; repeated readings are left out"
        for run, samples in axis.samples.groupby("run", sort=False)
        if (held := released(samples, rig.force_is)[1]) is not None
    ]
    if len(notes) > LISTED:
        notes = [*notes[:LISTED], f"axis_samples.csv: and {len(notes) - LISTED:,} runs like these"]
    if "sim_position_m" in axis.samples and rig.moving_mass_kg is None:
        notes.append(
            "axis_samples.csv: sim_position_m is checked and not used: it takes "
            "rig.moving_mass_kg, the mass that your simulator moves, to make a force of a path"
        )
    return tuple(notes)
