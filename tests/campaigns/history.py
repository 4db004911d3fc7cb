"""``reports/evidence/history.csv``: what each campaign of each release promised, and found.

A row a promise of a campaign of a release. ``python -m campaigns.history``, with ``tests`` on
the path, writes the rows of the evidence that stands, in place of those of the same version.
"""

import csv
import re
import sys

from campaigns import evidence
from scipy.stats import fisher_exact

HISTORY = evidence.EVIDENCE / "history.csv"
COLUMNS = "campaign version date promise least most value low high n met note".split()
BY_CHANCE = 0.01
"""Two shares that differ more rarely than this by chance have changed."""


def date_of(version):
    """Return the day of a release, from its heading in the changelog."""
    changes = (evidence.ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    heading = re.search(rf"^## {re.escape(version)} - (\S+)$", changes, flags=re.MULTILINE)
    if heading is None:
        raise ValueError(f"CHANGELOG.md has no line '## {version} - DATE': releases have a date")
    return heading[1]


def rows_of(name):
    """Return the rows of the evidence of a campaign, as they stand in the file."""
    record = evidence.read(name)
    outcomes = evidence.campaign_of(name).promises(record["figures"])
    return [
        {
            "campaign": name,
            "version": record["version"],
            "date": date_of(record["version"]),
            "promise": outcome.promise,
            **{
                column: number(getattr(outcome, column))
                for column in ("least", "most", "value", "low", "high", "n")
            },
            "met": str(outcome.met).lower(),
            "note": "",
        }
        for outcome in outcomes
    ]


def number(value):
    """Return a number with six digits, or nothing where there is none."""
    return "" if value is None else f"{value:.6g}"


def read():
    """Return all rows, the oldest release first."""
    with HISTORY.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(names):
    """Write the rows of some campaigns, in place of those of the same version.

    Notes are a person's, and stay with their promise.
    """
    old = read() if HISTORY.exists() else []
    notes = {key_of(row): row["note"] for row in old}
    new = [row for name in names for row in rows_of(name)]
    new = [row | {"note": notes.get(key_of(row), "")} for row in new]
    replaced = {(row["campaign"], row["version"]) for row in new}
    kept = [row for row in old if (row["campaign"], row["version"]) not in replaced]
    rows = sorted(kept + new, key=lambda row: (release(row), row["campaign"]))
    with HISTORY.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def key_of(row):
    """Return what tells a row from every other."""
    return row["campaign"], row["version"], row["promise"]


def release(row):
    """Return a version by which rows are put in order."""
    return tuple(int(part) for part in row["version"].split("."))


def is_met(row):
    """Return whether the value of a row lies where it was promised to lie."""
    value = float(row["value"])
    above = not row["least"] or value >= float(row["least"])
    return above and (not row["most"] or value <= float(row["most"]))


def newest(rows):
    """Return by campaign and promise the row of its last release, and the one before or nothing."""
    pairs = {}
    for row in sorted(rows, key=release):
        key = row["campaign"], row["promise"]
        pairs[key] = (row, pairs[key][0] if key in pairs else None)
    return pairs


def changes(rows):
    """Return a line for each figure that changed beyond chance since the release before.

    Shares are compared by Fisher's exact test, other figures that have intervals by whether
    these overlap. A figure without an interval is held to its promise alone.
    """
    return [
        f"{now['campaign']}: {now['promise']}: {before['value']} in {before['version']},"
        f" {now['value']} in {now['version']}"
        for now, before in newest(rows).values()
        if before and not now["note"] and differ(now, before)
    ]


def differ(now, before):
    """Return whether two rows differ by more than chance."""
    if now["n"] and before["n"]:
        table = []
        for row in (now, before):
            of = int(row["n"])
            hits = round(float(row["value"]) * of)
            table.append([hits, of - hits])
        return bool(fisher_exact(table).pvalue < BY_CHANCE)
    if now["low"] and before["low"]:
        apart = float(now["low"]) > float(before["high"])
        return apart or float(now["high"]) < float(before["low"])
    return False


if __name__ == "__main__":
    write(evidence.names())
    for line in changes(read()):
        sys.stdout.write(f"changed beyond chance: {line}\n")
