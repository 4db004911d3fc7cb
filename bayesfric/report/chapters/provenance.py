"""Where the numbers come from and how to make them again."""

from collections.abc import Iterator

from bayesfric.report.content import Block, Code, Heading, Listing, Paragraph, Table, Text
from bayesfric.report.quantities import MISSING, format_count
from bayesfric.report.stored import StoredResults

__all__ = ["provenance"]


def provenance(stored: StoredResults) -> Iterator[Block]:
    """Yield data quality, versions, hashes and the command."""
    fit = stored.fit
    quality = fit.data_quality
    versions: list[list[Text]] = [[name, Code(text)] for name, text in fit.versions.items()]
    yield Heading(1, "Data and provenance")
    yield Table(
        "The recording as it entered.",
        ["", "value"],
        [
            ["name", Code(fit.recording.name)],
            ["title", fit.recording.title],
            ["rigs", ", ".join(fit.rigs)],
            ["friction law", fit.baseline],
            ["motor runs", format_count(quality.motor_runs)],
            ["trials recorded", format_count(quality.trials)],
            ["trials that enter", format_count(quality.trials_used)],
            ["assemblies", format_count(quality.setups)],
            ["Hall events", format_count(quality.events)],
            ["cells assembled more than once", format_count(quality.replicated_cells)],
        ],
        label="data",
    )
    if quality.excluded:
        yield Table(
            "Trials left out.",
            ["trial", "rule", "reason"],
            [[entry.trial, entry.rule, entry.reason] for entry in quality.excluded],
            label="excluded",
        )
    for note in quality.notes:
        yield Paragraph(note)
    yield Table(
        "What makes the same result again.",
        ["", "value"],
        [
            ["seed", Code(str(fit.seed))],
            ["recording, SHA-256", Code(fit.recording.sha256)],
            ["analysis, SHA-256", Code(fit.analysis_sha256)],
            ["date", fit.created or MISSING],
            *versions,
        ],
        label="provenance",
    )
    yield Listing(f"bayesfric run {fit.recording.name} --seed {fit.seed}")
    yield Paragraph(
        "With the same recording, settings and versions on one machine, this writes the same bytes."
    )
