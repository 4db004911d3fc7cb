"""No result depends on the environment that the command is started in, nor trips over it."""

import ctypes
import os
import pty
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from altered import by_acceleration

from bayesfric.recording import write_recording

ROOT = Path(__file__).parents[2]
SETTINGS = "seed = 5\n[sampler]\nburn = 10\nsteps = 50\nthin = 2\nextensions = 0\n"
SHORTEST = ("--config", "analysis.toml")
MAY_DIFFER = {"timings.json", ".stages.json"}  # seconds, and places
BEGIN = "import sys; sys.argv[0] = 'bayesfric'; from bayesfric.cli import main; main()"
CAPABILITY_TO_WRITE_ANYWHERE = 1  # CAP_DAC_OVERRIDE of Linux
DROP_FROM_BOUNDS = 24  # PR_CAPBSET_DROP of prctl


def without_the_power_of_root():
    """A folder that nobody may write is closed to root as well, as to a user of a container."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(DROP_FROM_BOUNDS, CAPABILITY_TO_WRITE_ANYWHERE, 0, 0, 0)


def bayesfric(folder, *arguments, drop=(), code=BEGIN, **environment):
    """Run a verb; a variable of the environment may be dropped, or set."""
    dropped = {"SOURCE_DATE_EPOCH", "MPLCONFIGDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", *drop}
    kept = {name: value for name, value in os.environ.items() if name not in dropped}
    return subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        cwd=folder,
        env=kept | {"PYTHONPATH": str(ROOT)} | environment,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        encoding="utf-8",
        preexec_fn=without_the_power_of_root,
        check=False,
    )


@pytest.fixture(scope="module")
def board(small_recording, tmp_path_factory):
    folder = tmp_path_factory.mktemp("environment")
    write_recording(by_acceleration(small_recording), folder / "board")
    (folder / "analysis.toml").write_text(SETTINGS)
    (folder / "home").mkdir()
    (folder / "home").chmod(0o555)
    yield folder
    (folder / "home").chmod(0o755)


def results(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.name not in MAY_DIFFER}


def hostile(board):
    """What most of the nine say at once, without the one that has no home."""
    return {
        "HOME": str(board / "home"),
        "MPLBACKEND": "module://matplotlib_inline.backend_inline",
        "SOURCE_DATE_EPOCH": "",
        "LANG": "C",
        "LC_ALL": "C",
        "TZ": "Pacific/Kiritimati",
    }


LIBRARIES = (
    "from bayesfric.cli.surroundings import prepare; prepare()\n"
    "import warnings; warnings.simplefilter('ignore', FutureWarning)\n"
    "import scipy.stats, arviz_base, arviz_stats, matplotlib.pyplot, netCDF4, typst, corner\n"
)


def test_what_is_imported_below_trips_over_nothing_in_an_environment_that_is_hostile(board):
    done = bayesfric(board, code=LIBRARIES, **hostile(board))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list((board / "home").iterdir()) == []


@pytest.mark.parametrize("given", ["yesterday", "1e9", "٣٠", "999999999999"])
def test_a_date_that_is_none_is_one_clear_error_before_any_work(board, tmp_path, given):
    done = bayesfric(board, "fit", "board", "-o", tmp_path / "out", SOURCE_DATE_EPOCH=given)
    assert done.returncode == 2
    assert done.stderr == (
        f"error: environment, SOURCE_DATE_EPOCH: found '{given}', expected whole seconds since "
        "1970, or nothing\n"
    )
    assert not (tmp_path / "out").exists()


def test_a_user_without_home_and_name_has_a_place_for_caches(board):
    """As of `docker --user 12345`: no variable, and no entry among the users."""
    code = "import pwd\ndef nobody(uid): raise KeyError(uid)\npwd.getpwuid = nobody\n" + BEGIN
    done = bayesfric(board, "info", drop=("HOME",), code=code)
    assert (done.returncode, done.stderr) == (0, "")


LANGUAGE_C = {"LANG": "C", "LC_ALL": "C"}
ODD = {
    "read-only home": lambda board: {"HOME": str(board / "home")},
    "no home": lambda board: {"drop": ("HOME",)},
    "a notebook's figures": lambda board: {
        "MPLBACKEND": "module://matplotlib_inline.backend_inline"
    },
    "an empty date": lambda board: {"SOURCE_DATE_EPOCH": ""},
    "language C": lambda board: dict(LANGUAGE_C, PYTHONCOERCECLOCALE="0", PYTHONUTF8="0"),
    "a time zone": lambda board: {"TZ": "Pacific/Kiritimati"},
    "files for the user alone": lambda board: {"code": "import os; os.umask(0o077)\n" + BEGIN},
    "read-only packages": lambda board: {"PYTHONPATH": str(read_only_package(board))},
    "all at once": hostile,
}


def read_only_package(board):
    """A copy of the package that cannot be written, where no bytecode is kept."""
    place = board / "site"
    if not place.exists():
        shutil.copytree(
            ROOT / "bayesfric", place / "bayesfric", ignore=shutil.ignore_patterns("__pycache__")
        )
        (place / "bayesfric" / "_data").mkdir()  # as in a wheel
        for name in ("data", "reports"):
            (place / "bayesfric" / "_data" / name).symlink_to(ROOT / name)
        for path in (*place.rglob("*"), place):
            if not path.is_symlink():
                path.chmod(0o555 if path.is_dir() else 0o444)
    return place


@pytest.fixture(scope="module")
def plain_run(board):
    """A run on a terminal, which all that follow have not."""
    ours, theirs = pty.openpty()
    command = [
        sys.executable,
        "-c",
        BEGIN,
        "run",
        "board",
        *SHORTEST,
        "-o",
        "run",
        "--workers",
        "1",
    ]
    kept = {name: value for name, value in os.environ.items() if name != "SOURCE_DATE_EPOCH"}
    with (board / "shown").open("wb") as shown:
        process = subprocess.Popen(
            command, cwd=board, env=kept | {"PYTHONPATH": str(ROOT)}, stdout=theirs, stderr=theirs
        )
        os.close(theirs)
        try:
            while data := os.read(ours, 4096):
                shown.write(data)
        except OSError:  # the other end is closed: the command is done
            pass
    assert process.wait() == 0, (board / "shown").read_text()
    return results(board / "run")


@pytest.mark.nightly
@pytest.mark.parametrize("odd", ODD)
def test_a_run_has_the_same_bytes_in_each_environment(board, plain_run, odd, tmp_path):
    out = tmp_path / "out"
    arguments = ("run", "board", *SHORTEST, "-o", out, "--workers", "1", "--quiet")
    done = bayesfric(board, *arguments, **ODD[odd](board))
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    assert results(out) == plain_run
