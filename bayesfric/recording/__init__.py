"""A recording: a folder of tables ⇄ one frozen, checked :class:`Recording`.

``docs/recording.md`` describes the folder. Reading collects every fault of a
recording before it raises. Writing is atomic: the whole folder or nothing.
"""

from bayesfric.recording.conditions import read_conditions as read_conditions
from bayesfric.recording.describing import describe_recording as describe_recording
from bayesfric.recording.digest import rig_sha256 as rig_sha256
from bayesfric.recording.digest import tables_sha256 as tables_sha256
from bayesfric.recording.reading import read_recording as read_recording
from bayesfric.recording.tables import Axis as Axis
from bayesfric.recording.tables import Gravity as Gravity
from bayesfric.recording.tables import Motor as Motor
from bayesfric.recording.tables import Pulley as Pulley
from bayesfric.recording.tables import Recording as Recording
from bayesfric.recording.tables import RigConstants as RigConstants
from bayesfric.recording.tables import Robot as Robot
from bayesfric.recording.writing import check_free as check_free
from bayesfric.recording.writing import write_recording as write_recording
