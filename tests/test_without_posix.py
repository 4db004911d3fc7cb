"""A fit where the standard library has no module of POSIX alone, as on Windows."""

import subprocess
import sys

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
