"""``make fuzz``: mutants from where the last campaign stopped, for some minutes.

What was found stands in ``reports/evidence/fuzz.json``: mutants by kind, and the seed of each
that was neither read nor refused; beside them the most memory that the process ever held.
It begins anew for each version.
"""

import argparse
import resource
import sys
import time

from campaigns import evidence
from campaigns.promises import Outcome, rate
from fuzzing.mutants import KINDS, outcome

NAME = "fuzz"
FINGERPRINT = ()  # what is read or refused rests on no number
WHOLE = {"recording": 100_000, "toml": 20_000, "json": 5_000, "netcdf": 5_000}
PEAK_MIB = 1024  # of the whole process, so that no mutant takes more


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0, help="of processor time")
    minutes = parser.parse_args().minutes
    kept = evidence.read(NAME) if NAME in evidence.names() else {}
    kept = kept.get("figures", {}) if kept.get("version") == evidence.version() else {}
    mutants = kept.get("mutants") or {
        kind: {"read": 0, "refused": 0, "faults": {}} for kind in KINDS
    }
    before = kept.get("peak_mib", 0)
    ends = time.process_time() + 60 * minutes
    while time.process_time() < ends:
        # The kind that is furthest behind its share.
        kind = min(KINDS, key=lambda name: done(mutants[name]) / WHOLE[name])
        if done(mutants[kind]) >= WHOLE[kind]:
            break
        seed, held = done(mutants[kind]), peak_mib()
        try:
            said = outcome(kind, seed)
            if held <= PEAK_MIB < peak_mib():
                raise MemoryError(f"{peak_mib()} MiB")
            mutants[kind][said] += 1
        except Exception as error:
            mutants[kind]["faults"][str(seed)] = f"{type(error).__name__}: {error}"[:200]
            sys.stdout.write(f"{kind} {seed}: {error!r}\n")
        if seed % 500 == 0:
            save(mutants, before)
    save(mutants, before)
    for kind, counts in mutants.items():
        sys.stdout.write(
            f"{kind}: {done(counts)} of {WHOLE[kind]}, {len(counts['faults'])} faults\n"
        )
    return 1 if any(counts["faults"] for counts in mutants.values()) else 0


def done(counts: dict) -> int:
    return counts["read"] + counts["refused"] + len(counts["faults"])


def peak_mib() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024


def save(mutants: dict, before: int) -> None:
    gathered = evidence.Gathered(
        seeds=[0, max(done(counts) for counts in mutants.values()) - 1],
        figures={"mutants": mutants, "peak_mib": max(before, peak_mib())},
        cases={kind: counts["faults"] for kind, counts in mutants.items()},
        command="make fuzz",
        complete=all(done(counts) >= WHOLE[kind] for kind, counts in mutants.items()),
    )
    evidence.write(NAME, sys.modules[__name__], gathered)


def promises(figures: dict) -> list[Outcome]:
    """Return what was promised beside what was found."""
    mutants = figures["mutants"].values()
    faults, number = (
        sum(len(counts["faults"]) for counts in mutants),
        sum(done(counts) for counts in mutants),
    )
    return [
        rate("an altered file is neither read nor refused", faults, number, most=0),
        Outcome("most memory of the process, MiB", figures["peak_mib"], most=PEAK_MIB),
    ]


if __name__ == "__main__":
    sys.exit(main())
