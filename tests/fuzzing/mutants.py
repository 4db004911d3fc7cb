"""Files that users name, altered at random: each is read, or refused with InputError.

A mutant is its kind and its seed, so that any can be made again and a campaign goes on
where it stopped.
"""

import signal
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FrameType
from typing import TypeAlias

import numpy as np
import xarray as xr
from recording.mini import Mini, write_files

from bayesfric.analysis import read_analysis
from bayesfric.errors import InputError
from bayesfric.margins.loop_reading import read_loop
from bayesfric.recording import read_recording
from bayesfric.resources import data_folder, reference_folder
from bayesfric.results import read_json, read_tree, write_netcdf
from bayesfric.schemas import SCHEMAS

HANGS_S = 5
ODD = (
    b"",
    b"nan",
    b"-inf",
    b"1e999",
    b"9" * 5000,
    b"[" * 3000,
    b'{"a":' * 500,
    b"\x00",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b'"',
    b"\n",
    b"\r",
    b",",
    b";",
    b"\xe2\x80\xae",
    b"\x1b[31m",
    b"=1+1",
    b"../x",
    b"-0.0",
    b"1e-320",
    b"true",
    b"null",
    b"a." * 500,
)
SETTINGS = (
    b'seed = 7\n[priors]\nc1 = { family = "half-normal", scale = 0.1 }\n'
    b'[priors.pulleys.large]\nc2 = { family = "log-normal", median = 0.01, sd_log = 0.5 }\n'
    b"[sampler]\nsteps = 800\nwalkers = 40\n[scatter]\nby_size = true\n"
)


def altered(data: bytes, random: np.random.Generator) -> bytes:
    """Alter bytes in one to four places."""
    for _ in range(random.integers(1, 5)):
        at = int(random.integers(len(data) + 1))
        length = int(random.choice([0, 1, 2, 8, 64]))
        way = random.integers(5)
        if way == 0:
            data = data[:at] + ODD[random.integers(len(ODD))] + data[at + length :]
        elif way == 1:
            data = data[:at] + random.bytes(length) + data[at + length :]
        elif way == 2:
            data = data[:at] + data[at + length :]
        elif way == 3:
            data = data[:at] + data[max(0, at - length * 8) : at] + data[at:]
        else:
            data = data[:at]
    return data


def recording(random: np.random.Generator, folder: Path) -> None:
    files = dict(_recordings()[random.integers(len(_recordings()))])
    name = sorted(files)[random.integers(len(files))]
    read_recording(write_files(folder, files | {name: altered(files[name], random)}))


def toml(random: np.random.Generator, folder: Path) -> None:
    path = folder / "x.toml"
    if random.random() < 0.5:
        path.write_bytes(altered(SETTINGS, random))
        read_analysis(path)
    else:
        path.write_bytes(altered(_loop(), random))
        read_loop(path)


def json(random: np.random.Generator, folder: Path) -> None:
    name = ("fit", "claims", "diagnosis")[random.integers(3)]
    path = folder / "x.json"
    path.write_bytes(altered(_stored(name), random))
    read_json(SCHEMAS[name], path)


def netcdf(random: np.random.Generator, folder: Path) -> None:
    path = folder / "x.nc"
    path.write_bytes(altered(_arrays(), random))
    read_tree(path)


Alter: TypeAlias = Callable[[np.random.Generator, Path], None]
KINDS: dict[str, Alter] = {
    "recording": recording,
    "toml": toml,
    "json": json,
    "netcdf": netcdf,
}


def outcome(kind: str, seed: int, kinds: Mapping[str, Alter] = KINDS) -> str:
    """Make a mutant and read it.

    Returns
    -------
    str
        ``read`` or ``refused``; any other exception is a fault, and so is a hang.
    """
    random = np.random.default_rng([list(kinds).index(kind), seed])
    with tempfile.TemporaryDirectory() as folder, _no_longer_than(HANGS_S):
        try:
            kinds[kind](random, Path(folder))
        except InputError as error:
            said = str(error.faults[0])
        else:
            return "read"
    if "\n" in said:
        raise ValueError(f"a fault of several lines: {said}")
    return "refused"


@contextmanager
def _no_longer_than(seconds: int) -> Iterator[None]:
    def hang(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"no answer after {seconds} s")

    # Processor time, so that a busy machine does not count.
    before = signal.signal(signal.SIGPROF, hang)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


@cache
def _recordings() -> list[dict[str, bytes]]:
    files = ("gravity_trials.csv", "motor_runs.csv", "steady_friction.csv", "axis_runs.csv")
    return [Mini().kind(file).contents() for file in files]


@cache
def _loop() -> bytes:
    return (data_folder() / "loops" / "template.toml").read_bytes()


@cache
def _stored(name: str) -> bytes:
    return (reference_folder() / f"{name}.json").read_bytes()


@cache
def _arrays() -> bytes:
    group = xr.Dataset(
        {"c1": (("chain", "draw"), np.arange(12.0).reshape(3, 4)), "name": ("chain", list("abc"))}
    )
    tree = xr.DataTree.from_dict({"posterior": group, "log_prior": group})
    with tempfile.TemporaryDirectory() as folder:
        write_netcdf(tree, Path(folder) / "x.nc", "id")
        return (Path(folder) / "x.nc").read_bytes()
