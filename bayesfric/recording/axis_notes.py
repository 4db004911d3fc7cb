"""What of a single axis' log is read and then not used."""

from bayesfric.recording.tables import Axis

__all__ = ["notes_on_axis"]


def notes_on_axis(axis: Axis) -> tuple[str, ...]:
    """Return a sentence for each column that no verb uses."""
    if "sim_position_m" not in axis.samples or "sim_force_n" in axis.samples:
        return ()
    return (
        "axis_samples.csv: sim_position_m is checked and not used: the baseline is the law of the "
        "package, unless sim_force_n has the force that your simulator needs for the same motion",
    )
