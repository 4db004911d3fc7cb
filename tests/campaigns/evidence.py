"""The results of the campaigns of a release, kept under ``reports/evidence/NAME.json``.

A file has the figures, the seeds, the command and a few fixed cases that the nightly job
repeats; of all raw cases, which stay in ``reports/evidence/cases/``, it has a SHA-256. It names
the version that it was made for and the parts of the fingerprint (``tests/fingerprint/``) that
its numbers rest on: it is valid as long as these are the stored ones, and stale when one moved.

``python -m campaigns.evidence``, with ``tests`` on the path, prints one line where some is stale.
"""

import argparse
import hashlib
import importlib
import json
import subprocess
import sys
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fingerprint import stored

from bayesfric.campaign import run_on_processes

ROOT = Path(__file__).resolve().parents[2]
EVIDENCE = ROOT / "reports" / "evidence"
CASES = EVIDENCE / "cases"  # raw cases, of campaigns that are done or under way; not tracked
COMMAND = "make release-evidence"
ELSEWHERE = {
    "benchmark": ("benchmark.__main__", "make bench"),
    "fuzz": ("fuzzing.campaign", "make fuzz MINUTES=600"),
    "mutation": ("mutation.campaign", "make mutation"),
}
"""Campaigns that are no module of this folder, and what runs each."""
DIGITS = 16  # of a SHA-256, in hexadecimal


@dataclass(frozen=True)
class Gathered:
    """What a campaign found, in plain JSON types.

    Parameters
    ----------
    seeds : list of int
        First and last.
    figures : dict
        What is reported.
    cases : dict or list
        All raw cases, of which a digest is kept.
    fixed : dict or list
        The cases that the nightly job repeats and compares.
    command : str
        That repeats the campaign.
    complete : bool
        Whether all cases were run that were asked for.
    """

    seeds: list[int]
    figures: dict[str, Any]
    cases: Any
    fixed: Any = field(default_factory=list)
    command: str = COMMAND
    complete: bool = True


def gathered_over_seeds(
    case: Callable[[int], Any],
    seeds: range,
    figures: Callable[[list[Any]], dict[str, Any]],
    fixed_seeds: range,
    folder: Path,
) -> Gathered:
    """Run a case of each seed on two processes, and gather their figures."""
    cases = {f"{seed:04d}": seed for seed in seeds}
    done = list(run_on_processes(case, cases, folder, workers=2).values())
    fixed = [record for record in done if record["seed"] in fixed_seeds]
    return Gathered([seeds.start, seeds.stop - 1], figures(done), done, fixed)


def version():
    """Return the version that campaigns are run for."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return settings["project"]["version"]


def commit():
    """Return the commit that is checked out, marked where code differs from it."""
    head = _git("rev-parse", "--short=12", "HEAD")
    changed = _git("status", "--porcelain", "--", ".", ":!reports/evidence")
    return f"{head}-dirty" if head and changed else head or None


def _git(*arguments):
    command = ["git", *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    return done.stdout.strip()


def campaign_of(name):
    """Return the module of a campaign."""
    module, _ = ELSEWHERE.get(name, (f"campaigns.{name}", COMMAND))
    return importlib.import_module(module)


def fingerprint_of(campaign):
    """Return the digest of each part of the fingerprint that a campaign's numbers rest on."""
    return {part: stored.digest(part) for part in campaign.FINGERPRINT}


def work(name, campaign):
    """Return the folder of the raw cases of a campaign under way.

    Cases of another version, or of numbers that have moved since, are no cases of it. Whoever
    changes what a campaign does to a case removes the folder.
    """
    key = json.dumps([version(), fingerprint_of(campaign)], sort_keys=True)
    return CASES / f"{name}-{hashlib.sha256(key.encode()).hexdigest()[:DIGITS]}"


def write(name, campaign, gathered):
    """Write the evidence of a campaign, and its raw cases beside it.

    Parameters
    ----------
    name : str
        Of its file.
    campaign : module
        The module that has its cases.
    gathered : Gathered
        What was found.
    """
    raw = _json(gathered.cases)
    record = {
        "name": name,
        "version": version(),
        "commit": commit(),
        "fingerprint": fingerprint_of(campaign),
        "command": gathered.command,
        "complete": gathered.complete,
        "seeds": gathered.seeds,
        "figures": gathered.figures,
        "fixed": gathered.fixed,
        "cases_sha256": hashlib.sha256(raw.encode()).hexdigest(),
    }
    CASES.mkdir(parents=True, exist_ok=True)
    (CASES / f"{name}.json").write_text(raw, encoding="utf-8")
    (EVIDENCE / f"{name}.json").write_text(_json(record), encoding="utf-8")


def _json(contents):
    return json.dumps(contents, indent=1, allow_nan=False) + "\n"


def read(name):
    """Return the evidence of a campaign."""
    path = EVIDENCE / f"{name}.json"
    assert path.is_file(), f"no evidence of {name}: `{COMMAND}` makes it"
    return json.loads(path.read_text(encoding="utf-8"))


def names():
    """Return the names of the campaigns that have evidence."""
    return sorted(path.stem for path in EVIDENCE.glob("*.json"))


def moved(record):
    """Return the parts of the fingerprint that are no longer those that a record was made with."""
    there = stored.parts()
    return [
        part
        for part, digest in record["fingerprint"].items()
        if part not in there or stored.digest(part) != digest
    ]


def stale_line():
    """Return one line that names the evidence to be made again, or nothing."""
    by_name = {name: moved(read(name)) for name in names()}
    stale = [name for name, parts in by_name.items() if parts]
    if not stale:
        return ""
    parts = sorted({part for moved_parts in by_name.values() for part in moved_parts})
    return (
        f"Evidence to be made again at the next release: {', '.join(stale)}"
        f" (fingerprint moved: {', '.join(parts)})\n"
    )


def adopt():
    """Write the fingerprint of now into all evidence.

    For the day on which the fingerprint is introduced, or gains a number without any number of
    the package having moved: the evidence was made by code that has this fingerprint.
    """
    for name in names():
        record = read(name)
        record["fingerprint"] = fingerprint_of(campaign_of(name))
        (EVIDENCE / f"{name}.json").write_text(_json(record), encoding="utf-8")


def main():
    """Print what is stale; with ``--adopt``, write the fingerprint of now into the evidence."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--adopt", action="store_true", help=adopt.__doc__.splitlines()[0])
    if parser.parse_args().adopt:
        adopt()
    sys.stdout.write(stale_line())


if __name__ == "__main__":
    main()
