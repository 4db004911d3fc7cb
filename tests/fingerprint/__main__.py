"""``make fingerprint``: compute the numbers anew and compare; ``--move PART... --why TEXT``.

Without options a table says what moved, by how much and what its bound is; the exit status is
then 1. ``--move`` writes the numbers of these parts that moved, the move in ``moves.json`` and
its line in CHANGELOG.md. ``--anew`` writes all parts and begins ``moves.json`` anew, as is done
where CHANGELOG begins anew.
"""

import argparse
import math
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor

from fingerprint import stored
from fingerprint.numbers import RELATIVE, Number, moved
from fingerprint.parts import PARTS
from threadpoolctl import threadpool_limits

WORKERS = 2


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="fingerprint", description=__doc__)
    parser.add_argument("part", nargs="*", help="parts to compare; all by default")
    parser.add_argument("--move", nargs="+", default=[], metavar="PART", help="write these parts")
    parser.add_argument("--why", help="why they moved, as CHANGELOG.md is to say it")
    parser.add_argument("--anew", action="store_true", help="write all, and forget the moves")
    parser.add_argument("--times", action="store_true", help="print what each part takes")
    given = parser.parse_args(words)
    chosen = given.move or given.part or list(PARTS)
    if unknown := sorted(set(chosen) - set(PARTS)):
        parser.error(f"no such part: {', '.join(unknown)}; parts are {', '.join(PARTS)}")
    if given.move and not given.why and set(given.move) & set(stored.parts()):
        parser.error("--move needs --why")
    computed = {}
    with ProcessPoolExecutor(WORKERS) as executor:
        for part, (numbers, seconds) in zip(chosen, executor.map(timed, chosen), strict=True):
            computed[part] = numbers
            if given.times:
                sys.stdout.write(f"{part:22} {seconds:6.2f} s\n")
    if given.anew or given.move:
        return write(computed, given.why, anew=given.anew)
    return compare(computed)


def timed(part: str) -> tuple[dict[str, Number], float]:
    """Return the numbers of a part, and the processor's seconds that they take."""
    start = time.process_time()
    with threadpool_limits(limits=1):
        return PARTS[part](), time.process_time() - start


def first_moved(chosen: Sequence[str]) -> str:
    """Return the first part of which a number has moved; nothing where all hold."""
    parts = (part for part in chosen if moved(stored.numbers_of(part), timed(part)[0]))
    return next(parts, "")


def compare(computed: dict[str, dict[str, Number]]) -> int:
    """Print what moved; return 1 if anything has."""
    rows = []
    for part, numbers in computed.items():
        kept = stored.numbers_of(part)
        for name, share in moved(kept, numbers).items():
            rows.append((part, name, *described(kept.get(name), numbers.get(name), share)))
    count = sum(map(len, computed.values()))
    if not rows:
        sys.stdout.write(f"fingerprint: {count} numbers in {len(computed)} parts hold\n")
        return 0
    heads = ("part", "number", "was", "is", "moved by", "bound")
    widths = [max(len(row[place]) for row in (heads, *rows)) for place in range(len(heads))]
    for row in (heads, *rows):
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        sys.stdout.write(line.rstrip() + "\n")
    gone = len({row[0] for row in rows})
    sys.stdout.write(f"fingerprint: {len(rows)} of {count} numbers moved, in {gone} parts\n")
    return 1


def described(kept: Number | None, new: Number | None, share: float) -> tuple[str, str, str, str]:
    """Return a number before and after, the largest move and its bound, in words."""
    number = kept or new
    assert number is not None
    if isinstance(number.value, str):
        bound = "the same text"
    elif number.error is not None:
        bound = f"4 × {number.error:.2g}"
    else:
        bound = f"{RELATIVE[number.bound]:g} of it"
    if kept is None or new is None:
        by = "new" if kept is None else "gone"
    elif math.isinf(share):
        by = "another kind" if kept.bound != new.bound else "another value"
    else:
        by = f"{share:.3g} × bound"
    return _shown(kept), _shown(new), by, bound


def _shown(number: Number | None) -> str:
    if number is None:
        return "–"
    if isinstance(number.value, tuple):
        return f"[{len(number.value)} numbers]"
    return number.value if isinstance(number.value, str) else f"{number.value:.10g}"


def write(computed: dict[str, dict[str, Number]], why: str | None, *, anew: bool) -> int:
    """Write what moved of some parts, and why."""
    kept = {} if anew else {part: stored.numbers_of(part) for part in stored.parts()}
    before = {part: stored.digest(part) for part in kept}
    for part, numbers in computed.items():
        old = kept.get(part, {})
        changed = moved(old, numbers)
        kept[part] = {
            name: numbers[name] if name in changed or name not in old else old[name]
            for name in numbers
        }
    stored.write({part: numbers for part, numbers in kept.items() if part in PARTS})
    entries = [] if anew else stored.moves()
    moved_parts = []
    for part in stored.parts() if anew else computed:
        new = stored.digest(part)
        if anew or part not in before:
            entries.append({"part": part, "digest": new, "why": None})
        elif new != before[part]:
            assert why is not None
            entries.append({"part": part, "digest": new, "why": why})
            moved_parts.append(part)
    if moved_parts and why is not None:
        stored.write_reason(moved_parts, why)
        sys.stdout.write(f"{stored.changelog_line(moved_parts, why)}\n")
    stored.write_moves(entries)
    return 0


if __name__ == "__main__":
    sys.exit(main())
