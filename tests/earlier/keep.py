"""``python -m earlier.keep``, with ``tests`` on the path: a release keeps a run of its own.

The run of the newest archive of another release is repeated, with its recording, settings and
seed, and packed as ``VERSION.zip`` beside it. The numbers that it prints go into ``KEPT`` of
``tests/test_earlier_releases.py``.
"""

import json
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import bayesfric as bf

HERE = Path(__file__).parent
STORED = ("fit", "claims", "diagnosis")
FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of the format: an archive has no time of its own


def main():
    version = bf.__version__
    others = sorted(HERE.glob("*.zip"), key=lambda path: [int(n) for n in path.stem.split(".")])
    last = [path for path in others if path.stem != version][-1]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        with zipfile.ZipFile(last) as archive:
            archive.extractall(folder)
        (folder / "results").rename(folder / "before")
        command = [sys.executable, "-m", "bayesfric", "rerun", "before", "--recording", "bench"]
        command += ["-o", "results", "--quiet"]
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        pack(folder, HERE / f"{version}.zip")
        tell(folder / "results")


def pack(folder, path):
    """Pack results and recording, whose bytes alone decide those of the archive."""
    files = [file for part in ("results", "bench") for file in sorted((folder / part).iterdir())]
    with zipfile.ZipFile(path, "w") as archive:
        for file in files:
            name = zipfile.ZipInfo(file.relative_to(folder).as_posix(), FIRST_DAY)
            archive.writestr(name, file.read_bytes(), zipfile.ZIP_DEFLATED)


def tell(results):
    """Print the numbers that later releases are held to."""
    read = {name: json.loads((results / f"{name}.json").read_text("utf-8")) for name in STORED}
    for name in ("c1", "c2", "c3"):
        number = read["fit"]["pulleys"]["medium"][name]
        sys.stdout.write(f'"{name}": ({number["mean"]}, {number["sd"]}),\n')
    claims = [claim["id"] for claim in read["claims"]["claims"] if claim["verdict"] == "supported"]
    sys.stdout.write(f'"supported": {json.dumps(claims)},\n')


if __name__ == "__main__":
    main()
