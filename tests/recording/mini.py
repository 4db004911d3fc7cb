"""A small recording with all four kinds of table, to be spoilt by the tests."""

import copy
import json
from pathlib import Path
from typing import Any

PACKAGE: dict[str, Any] = {
    "name": "mini",
    "title": "A small recording",
    "created": "2026-11-01T00:00:00Z",
    "licenses": [{"name": "CC0-1.0"}],
    "rig": {
        "gravity_m_s2": 9.81,
        "hall_spacing_m": 0.0098,
        "magnets_per_revolution": 5,
        "timer_resolution_s": 4e-06,
        "motor_torque_constant_n_m_per_a": 0.0259,
        "capstan_radius_m": 0.0065,
        "pulleys": {"wide": {"radius_m": 0.02, "mass_kg": 0.01}},
        "limits": {"travel_m": [0, 1.2], "n_pulleys": [1, 19], "masses_kg": [0.5, 1.0]},
        "moving_mass_kg": 0.4,
        "force_is": "measured",
    },
    "resources": [
        {"name": "gravity-trials", "path": "gravity_trials.csv"},
        {"name": "gravity-events", "path": "gravity_events.csv"},
        {"name": "motor-runs", "path": "motor_runs.csv"},
        {"name": "motor-idle", "path": "motor_idle.csv"},
        {"name": "steady-friction", "path": "steady_friction.csv"},
        {"name": "axis-runs", "path": "axis_runs.csv"},
        {"name": "axis-samples", "path": "axis_samples.csv"},
    ],
}

TABLES = {
    "gravity_trials.csv": """\
trial,order,setup,pulley_size,n_pulleys,wrap_angle_deg,mass_drive_kg,mass_load_kg,drive_end,role,did_not_move,wrap_angles_deg,acceleration_m_s2,acceleration_sd_m_s2
g1,1,a,medium,9,85,1.60,1.30,left,calibrate,,,,
g2,2,a,medium,9,85,2.10,1.80,right,test,,,,
g3,3,b,small,5,110,0.90,0.60,,,false,,0.52,0.01
""",
    "gravity_events.csv": """\
trial,sensor,displacement_m,time_s
g1,drive,0.0000,0.100000
g1,drive,0.0098,0.150000
g1,drive,0.0196,0.190000
g1,drive,0.0294,0.225000
g1,drive,0.0392,0.255000
g1,load,0.0000,0.110000
g1,load,0.0098,0.160000
g1,load,0.0196,0.200000
g1,load,0.0294,0.235000
g1,load,0.0392,0.265000
g2,load,0.0000,0.300000
g2,load,0.0098,0.350000
g2,load,0.0196,0.390000
g2,load,0.0294,0.425000
g2,load,0.0392,0.455000
""",
    "motor_runs.csv": """\
run,order,setup,pulley_size,n_pulleys,wrap_angle_deg,hanging_mass_kg,velocity_m_s,current_a,role
m1,1,x,medium,9,85,1.5,0.5,4.1,test
m2,2,x,medium,9,85,1.5,-0.5,3.4,
""",
    "motor_idle.csv": """\
velocity_m_s,current_a
0.5,0.061
-0.5,-0.060
""",
    "steady_friction.csv": """\
run,order,setup,pulley_size,n_pulleys,wrap_angle_deg,tension_n,velocity_m_s,friction_n,friction_sd_n,role
s1,1,p,medium,9,85,15.5,0.3,0.74,0.01,calibrate
s2,2,p,medium,9,85,20.5,-0.3,-0.94,,
""",
    "axis_runs.csv": """\
run,order,setup,role,payload_kg
r1,1,z,calibrate,0.0
r2,2,z,test,1.5
""",
    "axis_samples.csv": """\
run,joint,time_s,position_m,force_n,force_time_s,known_force_n,command_m,command_time_s,temperature_c,sim_force_n,sim_position_m
r1,q1,0.00,0.000,1.1,5.00,0.4,0.000,0.00,21.5,1.0,0.000
r1,q1,0.01,0.001,1.2,5.01,0.4,0.002,0.01,21.5,1.1,0.001
r1,q1,0.02,0.003,1.2,5.01,0.4,0.004,0.02,21.5,1.1,0.003
r2,q1,0.00,0.000,2.1,5.00,0.8,0.000,0.00,22.0,2.0,0.000
r2,q1,0.01,0.001,2.2,5.01,0.8,0.002,0.01,22.0,2.1,0.001
""",
}

UNUSED = "axis_samples.csv: command_time_s is read and checked, and not used"
"""What is noted of it."""


class Mini:
    """The files of the small recording; `rows[file][line - 1]` is a list of cells."""

    def __init__(self) -> None:
        self.package = copy.deepcopy(PACKAGE)
        self.rows = {
            file: [line.split(",") for line in text.splitlines()] for file, text in TABLES.items()
        }

    def keep(self, *files: str) -> "Mini":
        """Keep these tables only."""
        self.rows = {file: self.rows[file] for file in files}
        resources = self.package["resources"]
        self.package["resources"] = [entry for entry in resources if entry["path"] in files]
        return self

    def kind(self, file: str) -> "Mini":
        """Keep the tables of the same kind as this one; of datapackage.json, all."""
        if file == "datapackage.json":
            return self
        stem = file.partition("_")[0]
        return self.keep(*(other for other in self.rows if other.startswith(stem)))

    def without(self, *files: str) -> "Mini":
        """Drop these tables."""
        return self.keep(*(file for file in self.rows if file not in files))

    def set(self, file: str, row: int, column: str, value: str) -> "Mini":
        """Write a cell; `row` is the line of the file, the header being line 1."""
        self.rows[file][row - 1][self.rows[file][0].index(column)] = value
        return self

    def drop(self, file: str, *columns: str) -> "Mini":
        """Drop columns."""
        header = self.rows[file][0]
        kept = [i for i, name in enumerate(header) if name not in columns]
        self.rows[file] = [[cells[i] for i in kept] for cells in self.rows[file]]
        return self

    def add(self, file: str, column: str, cells: list[str]) -> "Mini":
        """Add a column."""
        for row, cell in zip(self.rows[file], [column, *cells], strict=True):
            row.append(cell)
        return self

    def contents(self) -> dict[str, bytes]:
        """File name → bytes."""
        files = {"datapackage.json": json.dumps(self.package).encode()}
        for file, rows in self.rows.items():
            files[file] = "".join(",".join(row) + "\n" for row in rows).encode()
        return files

    def write(self, folder: Path) -> Path:
        """Write the files and return the folder."""
        return write_files(folder, self.contents())


def write_files(folder: Path, contents: dict[str, bytes]) -> Path:
    """Write files into a folder, and return it."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return folder
