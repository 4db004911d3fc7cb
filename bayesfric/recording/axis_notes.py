"""What of a single axis' log is read and then not used."""

from bayesfric.recording.tables import Axis, RigConstants

__all__ = ["notes_on_axis"]


def notes_on_axis(axis: Axis, rig: RigConstants) -> tuple[str, ...]:
    """Return a sentence for each column that no verb uses."""
    if "sim_position_m" not in axis.samples or rig.moving_mass_kg is not None:
        return ()
    return (
        "axis_samples.csv: sim_position_m is checked and not used: it takes rig.moving_mass_kg, "
        "the mass that your simulator moves, to make a force of a path",
    )
