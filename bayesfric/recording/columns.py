"""The tables of a recording, column by column, as data.

The reader checks against this list, and the writer takes column order and units from it.
``docs/recording.md`` describes the same in prose.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

MOST_PULLEYS = 1000  # the paper has 19
LARGEST = 1e12  # largest absolute value in SI units: its square and cube do not overflow
LONGEST_NAME = 100  # characters of an id, a size or a column's name
LARGEST_INTEGER = 1_000_000_000  # far beyond any count or order, well inside int64


@dataclass(frozen=True)
class Column:
    """One column of a table, with the rules for its cells.

    Parameters
    ----------
    name : str
        Name in the header.
    kind : {"id", "text", "choice", "number", "integer"}
        An id is text; `unique` says whether it must not repeat.
    meaning : str
        Meaning in one line, for the Table Schema.
    unit : str
        SI unit, or ``deg``; empty for text and counts.
    required : bool
        Whether the table must have the column.
    may_be_empty : bool
        Whether single cells may be empty.
    above, least, most : float or None
        Exclusive lower, inclusive lower and inclusive upper bound.
    nonzero, unique : bool
        No cell may be 0; no two cells may be equal.
    choices : tuple of str
        Allowed values of a ``choice``.
    longest : int
        Largest number of characters of a text.
    """

    name: str
    kind: Literal["id", "text", "choice", "number", "integer"]
    meaning: str
    unit: str = ""
    required: bool = True
    may_be_empty: bool = False
    above: float | None = None
    least: float | None = None
    most: float | None = None
    nonzero: bool = False
    unique: bool = False
    choices: tuple[str, ...] = ()
    longest: int = LONGEST_NAME

    @property
    def is_numeric(self) -> bool:
        """Whether the cells are numbers."""
        return self.kind in ("number", "integer")

    @property
    def is_text(self) -> bool:
        """Whether any text is allowed."""
        return self.kind in ("id", "text")

    @property
    def repeats(self) -> bool:
        """Whether the cells repeat a few words."""
        return self.kind == "choice" or (self.kind == "id" and not self.unique)

    @property
    def expected(self) -> str:
        """The rule for a cell, as a sentence fragment."""
        if self.kind == "choice":
            rule = " or ".join(self.choices)
        elif self.kind == "integer":
            rule = f"an integer from 1 to {self.largest}"
        elif self.kind == "number":
            rule = "a finite number" + self._bounds()
            if self.unit:
                rule += f" in {self.unit}"
        else:
            rule = f"text of at most {self.longest} characters that can be seen"
        return rule + (", or nothing" if self.may_be_empty else "")

    @property
    def largest(self) -> int:
        """The largest integer that is allowed."""
        return LARGEST_INTEGER if self.most is None else int(self.most)

    def _bounds(self) -> str:
        if self.above is not None:
            return f" above {self.above:g}"
        if self.least is not None and self.most is not None:
            return f" from {self.least:g} to {self.most:g}"
        if self.least is not None:
            return f" of at least {self.least:g}"
        return " other than 0" if self.nonzero else ""


TAKEN = frozenset(
    {
        *("velocity", "tension", "wrap_angle", "displacement", "travel_since_reversal"),
        *("acceleration", "direction", "trial_in_setup", "rig", "trial"),
        *("pulley_size", "n_pulleys", "wrap_angle_deg", "tension_n", "drive_end"),
    }
)
"""Names that results use for conditions and places; no covariate may have one of them."""


@dataclass(frozen=True)
class TableFormat:
    """One table: its file name and its columns in canonical order.

    Parameters
    ----------
    file : str
        Canonical file name.
    columns : tuple of Column
        The columns, in the order in which they are written.
    keeps_covariates : bool
        Whether further numeric columns are kept as covariates.
    """

    file: str
    columns: tuple[Column, ...]
    keeps_covariates: bool = False

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        return [column.name for column in self.columns]

    @property
    def resource(self) -> str:
        """Resource name, such as ``gravity-trials``."""
        return self.file.removesuffix(".csv").replace("_", "-")


HOTTEST_C = 250.0  # above any running joint, and below any room temperature in kelvin

optional = partial(Column, required=False)
with_blanks = partial(Column, required=False, may_be_empty=True)

RUN = Column("run", "id", "unique id of the run", unique=True)
ORDER = optional("order", "integer", "place in the order of measuring", unique=True)
SETUP = optional("setup", "id", "id of one assembly of the rig")
ROLE = with_blanks(
    "role",
    "choice",
    "calibrate: fits the baseline; test: shows the gap; absent: both",
    choices=("calibrate", "test"),
)
SIZE = Column("pulley_size", "text", "pulley size")
COUNT = Column("n_pulleys", "integer", "number of pulleys", most=MOST_PULLEYS)
WRAP = Column("wrap_angle_deg", "number", "mean individual wrap angle", "deg", least=0, most=180)
TIME = Column("time_s", "number", "time", "s")
VELOCITY = Column("velocity_m_s", "number", "cable speed, signed", "m/s", nonzero=True)
CURRENT = Column("current_a", "number", "mean motor current", "A")

# Kind 3 has the same columns as kinds 1 and 2; none of them is required.
STEADY_CONDITION = (
    *(replace(column, required=False) for column in (SIZE, COUNT, WRAP)),
    optional("tension_n", "number", "nominal tension", "N", least=0),
    optional("velocity_m_s", "number", "speed, signed", "m/s"),
)

GRAVITY_TRIALS = TableFormat(
    "gravity_trials.csv",
    (
        Column("trial", "id", "unique id of the trial", unique=True),
        ORDER,
        SETUP,
        SIZE,
        COUNT,
        WRAP,
        Column("mass_drive_kg", "number", "falling mass m1", "kg", above=0),
        Column("mass_load_kg", "number", "rising mass m2 < m1", "kg", above=0),
        with_blanks(
            "drive_end",
            "choice",
            "physical end that carried the drive mass",
            choices=("left", "right"),
        ),
        ROLE,
        with_blanks(
            "did_not_move",
            "choice",
            "true: the heavier side stayed where it was, and there are no events",
            choices=("true", "false"),
        ),
        with_blanks(
            "wrap_angles_deg",
            "text",
            "individual wrap angles [deg], separated by blanks",
            longest=30 * MOST_PULLEYS,
        ),
        with_blanks(
            "acceleration_m_s2",
            "number",
            "measured acceleration, for a trial with no events",
            "m/s²",
        ),
        with_blanks(
            "acceleration_sd_m_s2",
            "number",
            "standard error of the acceleration",
            "m/s²",
            least=1e-6,
        ),
    ),
)
GRAVITY_EVENTS = TableFormat(
    "gravity_events.csv",
    (
        Column("trial", "id", "trial of the event"),
        Column("sensor", "choice", "end of the cable", choices=("drive", "load")),
        Column("displacement_m", "number", "travel since the sensor's first event", "m"),
        TIME,
    ),
)
MOTOR_RUNS = TableFormat(
    "motor_runs.csv",
    (
        RUN,
        ORDER,
        SETUP,
        SIZE,
        COUNT,
        WRAP,
        Column("hanging_mass_kg", "number", "hanging mass", "kg", above=0),
        VELOCITY,
        CURRENT,
        ROLE,
    ),
)
MOTOR_IDLE = TableFormat("motor_idle.csv", (VELOCITY, CURRENT))
STEADY_FRICTION = TableFormat(
    "steady_friction.csv",
    (
        RUN,
        ORDER,
        SETUP,
        *STEADY_CONDITION,
        Column("friction_n", "number", "friction", "N"),
        with_blanks("friction_sd_n", "number", "standard error of the friction", "N", above=0),
        ROLE,
    ),
    keeps_covariates=True,
)
AXIS_RUNS = TableFormat("axis_runs.csv", (RUN, ORDER, SETUP, ROLE), keeps_covariates=True)
AXIS_SAMPLES = TableFormat(
    "axis_samples.csv",
    (
        Column("run", "id", "run of the sample"),
        TIME,
        Column("position_m", "number", "position", "m"),
        optional("force_n", "number", "drive force", "N"),
        optional("joint", "id", "joint of the sample"),
        optional("force_time_s", "number", "time of the force", "s"),
        optional("known_force_n", "number", "drive force by the user's rigid-body model", "N"),
        optional("command_m", "number", "commanded position", "m"),
        optional("command_time_s", "number", "time of the command", "s"),
        optional(
            "temperature_c",
            "number",
            "temperature of the joint",
            "°C",
            least=-100.0,
            most=HOTTEST_C,
        ),
        optional("sim_force_n", "number", "force of the user's simulator", "N"),
        optional("sim_position_m", "number", "position of the user's simulator", "m"),
    ),
)

TABLES = {
    table.file: table
    for table in (
        GRAVITY_TRIALS,
        GRAVITY_EVENTS,
        MOTOR_RUNS,
        MOTOR_IDLE,
        STEADY_FRICTION,
        AXIS_RUNS,
        AXIS_SAMPLES,
    )
}

BUILT_IN = frozenset(TABLES)
"""Tables with a field of their own in a recording; additional rigs may add others."""

OTHER_NAMES = {"command_rad": "command_m"}
"""Alternative names of columns for a rotary axis, and their names in a recording."""

RIG_KEYS_NEEDED = {
    "gravity_events.csv": ("hall_spacing_m", "magnets_per_revolution", "timer_resolution_s"),
    "motor_runs.csv": ("motor_torque_constant_n_m_per_a", "capstan_radius_m"),
}
