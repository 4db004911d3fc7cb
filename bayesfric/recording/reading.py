"""A folder → a :class:`~bayesfric.recording.tables.Recording`, or all of its faults."""

from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path

import numpy as np

from bayesfric.errors import Fault, InputError, near
from bayesfric.files import file_bytes
from bayesfric.recording.axis_notes import notes_on_axis
from bayesfric.recording.cells import Table, check_cells
from bayesfric.recording.columns import BUILT_IN, RIG_KEYS_NEEDED, TABLES
from bayesfric.recording.consistency import check_across
from bayesfric.recording.copies import without_copies
from bayesfric.recording.csv_text import parse_csv
from bayesfric.recording.digest import tables_sha256
from bayesfric.recording.frames import no_events, sorted_events, typed, with_setup
from bayesfric.recording.package import PACKAGE_FILE, Package, Resource, fault_of_key, parse_package
from bayesfric.recording.plausibility import implausible
from bayesfric.recording.robot_file import faults_of_model, files_of_model
from bayesfric.recording.steady_signs import notes_on_signs
from bayesfric.recording.tables import Axis, Gravity, Motor, Recording
from bayesfric.recording.tested_range import notes_on_range

Load = Callable[[str], bytes]  # a file of the recording, by its path in the folder

LARGEST_FILE = 512 * 1024**2  # bytes; ten times a table of a million rows
WHAT_IT_IS = (
    "it lists the tables and describes the rig; `bayesfric simulate example` writes one to copy"
)

# A table and the table that it requires.
WEIGHED = ("gravity_trials.csv", "motor_runs.csv")
"""Tables with masses that hang on a cable."""
NEEDS = {
    "gravity_events.csv": "gravity_trials.csv",
    "motor_runs.csv": "motor_idle.csv",
    "motor_idle.csv": "motor_runs.csv",
    "axis_runs.csv": "axis_samples.csv",
    "axis_samples.csv": "axis_runs.csv",
}


def read_recording(path: str | PathLike[str]) -> Recording:
    """Read and check a recording.

    Parameters
    ----------
    path : str or path-like
        The folder that holds ``datapackage.json``.

    Returns
    -------
    Recording
        Frozen tables in SI units (angles in degrees), as in ``docs/recording.md``.

    Raises
    ------
    InputError
        With every fault of the recording: file, row, column, value and what was expected.
    """
    folder = Path(path)

    try:
        is_folder, is_file = folder.is_dir(), folder.is_file()
        in_folder = [file for file in TABLES if (folder / file).exists()]
    except (OSError, ValueError):
        is_folder = is_file = False
    if not is_folder:
        expected = f"a folder that holds {PACKAGE_FILE}"
        expected += " (this is a file: is its folder meant?)" if is_file else ""
        raise InputError([Fault(str(folder), expected)])
    return assemble(partial(_read_inside, folder), in_folder)


def assemble(load: Load, in_folder: Collection[str] = ()) -> Recording:
    """Build a recording from its files, which may be anywhere.

    Parameters
    ----------
    load : callable
        From a path inside the recording to the bytes of that file; raises InputError.
    in_folder : collection of str
        Files with the name of a table; a note is made if one is not listed.
    """
    package = parse_package(load(PACKAGE_FILE))
    faults = list(package.faults)
    notes = list(package.notes)
    package = _with_robot(package, load, faults)
    listed = _known_tables(package, faults, notes)
    contents: dict[str, bytes] = {}
    tables: dict[str, Table] = {}
    for file, resource in listed.items():
        if not resource.sound:
            continue
        try:
            contents[resource.path] = load(resource.path)
            tables[file] = check_cells(
                parse_csv(resource.path, contents[resource.path]), TABLES[file]
            )
        except InputError as error:
            faults += error.faults
            continue
        faults += tables[file].faults
        notes += tables[file].notes
    paths = [resource.path for resource in package.resources]
    notes += [
        f"{file} is in the folder but is no resource of {PACKAGE_FILE}: not read"
        for file in in_folder
        if file not in paths
    ]
    faults += _missing_parts(package, listed)
    with np.errstate(all="ignore"):  # numbers may be as large as a float can be
        faults += check_across(tables, package.rig, frozenset(listed) - frozenset(tables))
        faults += implausible(tables, package.rig, {fault.file for fault in faults})
        if faults:
            raise InputError(_in_file_order(faults, listed))
        recording = _recording(package, tables, tables_sha256(contents))
        recording, copied = without_copies(recording, tables)
        notes += copied
        if recording.steady is not None:
            notes += notes_on_signs(recording.steady)
        if recording.axis is not None:
            notes += notes_on_axis(recording.axis, recording.rig)
        return replace(recording, notes=(*notes, *notes_on_range(recording)))


def _with_robot(package: Package, load: Load, faults: list[Fault]) -> Package:
    """Return a package with the content of the robot's model and its files, if it names one."""
    robot = package.rig.robot
    if robot is None:
        return package
    try:
        robot = replace(robot, content=load(robot.model))
        robot = replace(robot, files=files_of_model(robot, load))
    except InputError as error:
        faults += error.faults
        return package
    faults += faults_of_model(robot)
    return replace(package, rig=replace(package.rig, robot=robot))


def _read_inside(folder: Path, name: str) -> bytes:
    try:
        file = (folder / name).resolve()
        if not file.is_relative_to(folder.resolve()):
            raise InputError([Fault(name, "a file inside the recording's folder", value=name)])
        if not file.is_file():  # a pipe or a device might never end
            kind = "a folder" if file.is_dir() else None
            expected = "a file of this name in the folder" + _beside(file)
            if name == PACKAGE_FILE:
                expected += f" ({WHAT_IT_IS})"
            raise InputError([Fault(name, expected, value=kind)])
        return file_bytes(file, name, LARGEST_FILE)
    except (OSError, RuntimeError) as error:  # RuntimeError: a loop of symbolic links
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError([Fault(name, "a file that can be read", value=reason)]) from None


def _beside(file: Path) -> str:
    """Return a hint at files in the folder with nearly this name."""
    spreadsheets = [file.with_suffix(end) for end in (".xlsx", ".xls", ".ods", ".txt")]
    hints = [f" (is {path.name} meant? save it as CSV)" for path in spreadsheets if path.is_file()]
    folder = sorted(file.parent.iterdir()) if file.parent.is_dir() else []
    small = [path.name for path in folder if path.name.lower() == file.name.lower()]
    return "".join(hints + [f" (is {name} meant? capital letters matter)" for name in small])


def _known_tables(package: Package, faults: list[Fault], notes: list[str]) -> dict[str, Resource]:
    """Return the resources of the tables of the format, by canonical file name."""
    by_name = {table.resource: file for file, table in TABLES.items()}
    listed: dict[str, Resource] = {}
    for resource in package.resources:
        base = resource.path.rpartition("/")[2]
        file = base if base in TABLES else by_name.get(resource.name)
        if file is None and base.lower() in TABLES:
            expected = f"{base.lower()}, in lower case, here and as the file's name"
            faults.append(fault_of_key(f"{resource.place}.path", expected, resource.path))
        elif file is None:
            notes.append(f"{PACKAGE_FILE}: resource {resource.name!r} is no known table, not read")
        elif file in listed:
            expected = f"no second resource for {file}"
            faults.append(fault_of_key(f"{resource.place}.path", expected, resource.path))
        else:
            listed[file] = resource
    return {file: listed[file] for file in TABLES if file in listed}


def _missing_parts(package: Package, listed: dict[str, Resource]) -> list[Fault]:
    faults = []
    resources_at_fault = any("resources" in (fault.column or "") for fault in package.faults)
    if not listed and not resources_at_fault:
        faults.append(fault_of_key("resources", f"at least one of {', '.join(TABLES)}"))
    for file in listed:
        needed = NEEDS.get(file)
        if needed and needed not in listed:
            faults.append(Fault(needed, f"this table, listed as a resource, because of {file}"))
        for key in RIG_KEYS_NEEDED.get(file, ()):
            if key not in package.rig_keys:
                expected = f"this key, because of {file}{near(key, package.rig_keys)}"
                faults.append(fault_of_key(f"rig.{key}", expected))
    return faults + _lacking_gravity(package, listed)


def _lacking_gravity(package: Package, listed: Collection[str]) -> list[Fault]:
    """Return faults of data that need gravity: masses on a cable, or a payload on an arm."""
    if package.rig.gravity_m_s2 > 0:
        return []
    weighed = [file for file in WEIGHED if file in listed]
    if package.rig.payload_arm_m is not None:
        weighed.append("rig.payload_arm_m")
    return [
        fault_of_key("rig.gravity_m_s2", f"a number above 0, because of {what}", "0")
        for what in weighed
    ]


def _in_file_order(faults: list[Fault], listed: dict[str, Resource]) -> list[Fault]:
    files = [PACKAGE_FILE, *(resource.path for resource in listed.values())]
    place = {file: index for index, file in enumerate(files)}
    return sorted(faults, key=lambda fault: (place.get(fault.file, len(files)), fault.row or 0))


def _recording(package: Package, tables: dict[str, Table], sha256: str) -> Recording:
    frames = {file: table.frame for file, table in tables.items()}
    if "gravity_events.csv" in frames:
        events, trials = frames["gravity_events.csv"], frames["gravity_trials.csv"]
        # First, since categories are sorted faster.
        frames["gravity_events.csv"] = sorted_events(events, trials, package.rig.hall_spacing_m)
    frames = {file: typed(frame, tables[file].format) for file, frame in frames.items()}
    gravity = motor = axis = None
    if "gravity_trials.csv" in frames:
        events = frames.get("gravity_events.csv", no_events())
        gravity = Gravity(with_setup(frames["gravity_trials.csv"]), events)
    if "motor_runs.csv" in frames:
        motor = Motor(with_setup(frames["motor_runs.csv"]), frames["motor_idle.csv"])
    if "axis_runs.csv" in frames:
        axis = Axis(frames["axis_runs.csv"], frames["axis_samples.csv"])
    return Recording(
        name=package.name,
        title=package.title,
        rig=package.rig,
        gravity=gravity,
        motor=motor,
        steady=frames.get("steady_friction.csv"),
        axis=axis,
        further={file: frames[file] for file in frames if file not in BUILT_IN},
        created=package.created,
        metadata=package.metadata,
        sha256=sha256,
    )
