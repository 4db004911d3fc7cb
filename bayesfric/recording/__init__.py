"""A recording: a folder of tables ⇄ one frozen, checked :class:`Recording`.

``docs/recording.md`` describes the folder. Reading collects every fault of a
recording before it complains; writing is whole or not at all.
"""

from bayesfric.recording.conditions import read_conditions
from bayesfric.recording.describing import describe_recording
from bayesfric.recording.digest import tables_sha256
from bayesfric.recording.reading import read_recording
from bayesfric.recording.tables import Axis, Gravity, Motor, Pulley, Recording, RigConstants, Robot
from bayesfric.recording.writing import check_free, write_recording

__all__ = [
    "Axis",
    "Gravity",
    "Motor",
    "Pulley",
    "Recording",
    "RigConstants",
    "Robot",
    "check_free",
    "describe_recording",
    "read_conditions",
    "read_recording",
    "tables_sha256",
    "write_recording",
]
