"""A fit, locks and workers where the standard library has nothing of POSIX alone, as on Windows."""

import os
import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from bayesfric.campaign import processes
from bayesfric.cli.locks import hold
from bayesfric.errors import InputError

PROGRAM = """
import sys

for name in ("fcntl", "grp", "pwd", "pty", "resource", "termios", "tty"):
    sys.modules[name] = None  # an import of it fails

import bayesfric as bf
from bayesfric.analysis import Analysis, Sampler
from bayesfric.rigs.protocols import Protocol
from bayesfric.simulate import simulate_recording

design = Protocol({(9, 85.0): 1}, (6.0, 28.0), (6.0, 28.0), 2)
recording = simulate_recording(design, seed=4, rigs=("gravity",))
sampler = Sampler(burn=10, steps=50, thin=2, extensions=0)
result = bf.fit(recording, Analysis(seed=3, sampler=sampler))
result.write(sys.argv[1])
print(sorted(result.summary.pulleys))
"""


def test_a_fit_needs_no_module_of_posix(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path / "out")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    assert done.stdout == "['large', 'medium', 'small']\n"
    assert (tmp_path / "out" / "fit.json").is_file()
    assert (tmp_path / "out" / "draws.nc").is_file()


class Msvcrt(SimpleNamespace):
    """What Windows has for locks: a byte of a file that one descriptor alone may have."""

    LK_NBLCK = 2

    def locking(self, descriptor, mode, count):
        assert (mode, count) == (self.LK_NBLCK, 1)
        place = (os.fstat(descriptor).st_ino, os.lseek(descriptor, 0, os.SEEK_CUR))
        if place in self.held:
            raise PermissionError(13, "Permission denied")
        self.held.add(place)


def test_a_folder_is_locked_without_fcntl(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fcntl", None)
    windows = Msvcrt(held=set())
    monkeypatch.setitem(sys.modules, "msvcrt", windows)
    with hold(tmp_path / "out", "fit"):
        (tmp_path / "out" / "fit.json").write_text("{}", encoding="utf-8")
        with (
            pytest.raises(InputError, match="into which no other run writes"),
            hold(tmp_path / "out", "claims"),
        ):
            pass
    assert windows.held
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["fit.json"]


@pytest.mark.nightly
def test_workers_need_no_masks_of_signals(monkeypatch):
    monkeypatch.delattr(signal, "pthread_sigmask")
    with processes(1) as executor:
        assert executor.submit(abs, -3).result() == 3
