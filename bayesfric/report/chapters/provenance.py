"""Where the numbers come from and how to make them again."""

from collections.abc import Iterator

from bayesfric.plots.rig_tables import rig_tables
from bayesfric.report.content import Block, Code, Heading, Listing, Paragraph, Table, Text, prose
from bayesfric.report.quantities import MISSING, format_count
from bayesfric.report.rig_words import law_words, rig_words
from bayesfric.report.stored import StoredFit
from bayesfric.schemas import CalibrationFile, ScorecardFile
from bayesfric.schemas.base import Provenance


def provenance(stored: StoredFit) -> Iterator[Block]:
    """Yield what entered, versions, hashes and the command."""
    fit = stored.fit
    yield Heading(1, "Data and provenance")
    yield Table(
        "The recording and the data used.",
        ["", "value"],
        [
            ["name", Code(fit.recording.name)],
            ["title", fit.recording.title or MISSING],
            ["rigs", ", ".join(rig_words(name).rig for name in fit.rigs)],
            ["friction law", law_words(fit.baseline, fit.rigs)],
            *_counts(stored),
        ],
        label="data",
    )
    yield made_from(fit)
    baseline = "" if fit.baseline == "paper" else f" --baseline {fit.baseline}"
    yield Listing(
        f"bayesfric run RECORDING --rigs {','.join(fit.rigs)}{baseline} --seed {fit.seed}"
    )
    yield Paragraph(
        prose(
            "`RECORDING` is the folder of the recording; add settings other than the default ones "
            "with `--config analysis.toml`. On the same machine and with the versions above, this "
            "reproduces the results byte for byte."
        )
    )


def made_from(record: Provenance) -> Table:
    """Return the table of seed, hashes and versions of what one recording gave."""
    sha256 = record.recording.sha256
    return _made(
        record, "seed", "provenance", ["recording, SHA-256", Code(sha256) if sha256 else MISSING]
    )


def made_again(record: CalibrationFile | ScorecardFile, *, seed: str, label: str) -> Table:
    """Return the table of seed, hash and versions of a campaign."""
    return _made(record, seed, label)


def _made(
    record: Provenance | CalibrationFile | ScorecardFile, seed: str, label: str, *more: list[Text]
) -> Table:
    return Table(
        "Settings and versions that reproduce this result.",
        ["", "value"],
        [
            [seed, Code(str(record.seed))],
            *more,
            ["analysis, SHA-256", Code(record.analysis_sha256)],
            *([["date", record.created]] if record.created else []),
            ["versions", ", ".join(f"{name} {text}" for name, text in record.versions.items())],
        ],
        label=label,
    )


def _counts(stored: StoredFit) -> Iterator[tuple[str, str]]:
    """Yield what each rig brought."""
    for rig in rig_tables(stored.predictive):
        yield f"{rig.trials} of the {rig.title} used", format_count(rig.count)
    quality = stored.fit.data_quality
    if quality.trials:
        yield "trials recorded", format_count(quality.trials)
        yield "assemblies", format_count(quality.setups)
        yield "Hall events", format_count(quality.events)
        yield (
            "cells (size, n, angle) assembled more than once",
            format_count(quality.replicated_cells),
        )
