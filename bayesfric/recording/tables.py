"""The frozen tables of a recording, as the rest of the package sees them.

A table is a :class:`pandas.DataFrame` with exactly the columns of the recording format
(``docs/recording.md``). A column that the user left out is absent if it has no default.
Units are in the names.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pandas as pd

STANDARD_GRAVITY = 9.80665  # m/s², the default of a recording


@dataclass(frozen=True)
class Pulley:
    """A pulley size described by the user.

    Parameters
    ----------
    radius_m : float or None
        Radius at the cable centre line [m].
    mass_kg : float or None
        Mass of one pulley [kg].
    """

    radius_m: float | None = None
    mass_kg: float | None = None


@dataclass(frozen=True)
class Robot:
    """The user's model of the machine: an URDF or MJCF file.

    Parameters
    ----------
    model : str
        Path of the file in the folder of the recording.
    joints : mapping of str to str
        Name in the model by joint of the recording.
    content : bytes
        Content of the file.
    files : mapping of str to bytes
        Further files that it includes or that give masses, by their path in that folder.
    """

    model: str
    joints: Mapping[str, str] = field(default_factory=dict)
    content: bytes = b""
    files: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class RigConstants:
    """The property ``rig`` of ``datapackage.json``; absent keys are None.

    Parameters
    ----------
    gravity_m_s2 : float
        Local acceleration of gravity [m/s²]; 0 if none acts along a joint.
    hall_spacing_m : float or None
        Cable travel between two Hall events [m].
    magnets_per_revolution : int or None
        Magnets on the sensor pulley.
    timer_resolution_s : float or None
        Resolution of the event clock [s].
    sensor_clock_sd_s : float or None
        Standard deviation of the normal prior, around 0, of the offset between the clocks of a
        trial's two sensors [s]; None: the offset that a cable explains.
    motor_torque_constant_n_m_per_a : float or None
        Specified torque constant of the motor [N·m/A].
    capstan_radius_m : float or None
        Capstan radius at the cable centre line [m].
    pulleys : mapping of str to Pulley
        Pulley sizes other than the paper's.
    limits : mapping
        Limits of the rig, as written.
    moving_mass_kg, mass_sd_kg, encoder_resolution : float or None
        For a driven joint, in kg and m, or kg·m² and rad if `rotary`.
    force_is : str or None
        ``"commanded"``, ``"motor"``, ``"link"``, ``"measured"`` or ``"unknown"``.
    robot : Robot or None
        The user's model of the machine.
    other_joints : str or None
        ``"still"``, ``"logged"``, ``"moving"`` or ``"unknown"``.
    force_gain_sd : float or None
        Standard error of the drive force's scale, relative.
    known_force_sd, force_limit_n : float or None
        Standard error of ``known_force_n``, and the largest drive force [N or N·m].
    command_gain : float or None
        Drive force per deviation of the joint from its command [N/m or N·m/rad].
    payload_arm_m : float or None
        Distance from the axis of a joint that turns to the payloads of ``axis_runs.csv`` [m].
    sample_hold_s, latency_s : float or None
        Time for which telemetry holds a value, and its delay [s].
    rotary : bool
        Whether radians, N·m and kg·m² replace m, N and kg in kinds 3 and 4.
    """

    gravity_m_s2: float = STANDARD_GRAVITY
    hall_spacing_m: float | None = None
    magnets_per_revolution: int | None = None
    timer_resolution_s: float | None = None
    sensor_clock_sd_s: float | None = None
    motor_torque_constant_n_m_per_a: float | None = None
    capstan_radius_m: float | None = None
    pulleys: Mapping[str, Pulley] = field(default_factory=dict)
    limits: Mapping[str, Any] = field(default_factory=dict)
    moving_mass_kg: float | None = None
    mass_sd_kg: float | None = None
    encoder_resolution: float | None = None
    force_is: str | None = None
    robot: Robot | None = None
    other_joints: str | None = None
    force_gain_sd: float | None = None
    known_force_sd: float | None = None
    command_gain: float | None = None
    force_limit_n: float | None = None
    payload_arm_m: float | None = None
    sample_hold_s: float | None = None
    latency_s: float | None = None
    rotary: bool = False


@dataclass(frozen=True)
class Gravity:
    """Gravity-board tables (kind 1).

    Parameters
    ----------
    trials : DataFrame
        One row for each trial, in the order of the file, index 0, 1, …. ``setup`` is always
        present: by default one setup for each (pulley_size, n_pulleys, wrap_angle_deg).
    events : DataFrame
        One row for each Hall event, sorted by trial (order of `trials`), sensor
        (``drive`` before ``load``) and time. May be empty.
    """

    trials: pd.DataFrame
    events: pd.DataFrame


@dataclass(frozen=True)
class Motor:
    """Motor-board tables (kind 2).

    Parameters
    ----------
    runs : DataFrame
        One row for each constant-speed run.
    idle : DataFrame
        ``velocity_m_s`` and ``current_a`` of the motor alone.
    """

    runs: pd.DataFrame
    idle: pd.DataFrame


@dataclass(frozen=True)
class Axis:
    """Tables of driven joints (kind 4).

    Parameters
    ----------
    runs, samples : DataFrame
        One row for each run; one row for each sample. ``force_n`` is absent if only commands
        were logged.
    joint : str or None
        The joint of `samples`, if the log had several joints and was split.
    others : mapping of str to DataFrame
        Samples of the other joints of that log, by joint, in the order of the log.
    place : int
        Index of `joint` among all joints of the log.
    """

    runs: pd.DataFrame
    samples: pd.DataFrame
    joint: str | None = None
    others: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    place: int = 0


@dataclass(frozen=True, eq=False)
class Recording:
    """A data set, recorded on one rig. It equals only itself, so results are cached by identity.

    Parameters
    ----------
    name, title : str
        As in ``datapackage.json``.
    rig : RigConstants
        The board's constants.
    gravity, motor, steady, axis : tables or None
        The four kinds; at least one is not None.
    further : mapping of str to DataFrame
        Tables that a rig added to :data:`bayesfric.recording.columns.TABLES`, by file.
    created : str or None
        As written in ``datapackage.json``.
    metadata : mapping
        Further properties of ``datapackage.json``, as written
        (``licenses``, ``sources``, ``simulation``).
    sha256 : str
        SHA-256 of the tables, sorted by name; see :func:`tables_sha256`.
    notes : tuple of str
        Remarks: columns that are ignored, kinds that are not used, conditions outside the
        paper's Table II.
    """

    name: str
    title: str
    rig: RigConstants
    gravity: Gravity | None = None
    motor: Motor | None = None
    steady: pd.DataFrame | None = None
    axis: Axis | None = None
    further: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    created: str | None = None
    metadata: Mapping[str, Any] = field(default_factory=dict)
    sha256: str = ""
    notes: tuple[str, ...] = ()
