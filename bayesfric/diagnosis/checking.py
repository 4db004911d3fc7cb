"""Checks the invariants of a diagnosis before it is written."""

from bayesfric.analysis import Analysis
from bayesfric.diagnosis.model import LinearModel
from bayesfric.invariants import broken, check_record
from bayesfric.observation.linear import heavy_scatter
from bayesfric.observation.scatter import kept_normal
from bayesfric.schemas import DiagnosisFile


def checked_diagnosis(summary: DiagnosisFile) -> DiagnosisFile:
    """Return the diagnosis; if it violates an invariant, with the verdict `undecided`.

    A result that contradicts itself shows a fault of the computation. It is reported as such,
    and its causes are listed as considered.
    """
    checks = check_record(summary.model_dump(mode="json", by_alias=True))
    faults = broken(checks)
    looked = summary.model_copy(update={"checks": checks})
    if not faults:
        return looked
    above = summary.gap.probability_above_practical
    details = "; ".join(check.detail or check.check for check in checks if not check.holds)
    considered = (*summary.causes, *summary.considered)
    return looked.model_copy(
        update={
            "verdict": "undecided",
            "verdict_probability": max(above, 1 - above),
            "causes": (),
            "considered": considered,
            "considered_why": None if considered else "no effect was named",
            "sentence": f"The computation contradicts itself, so that nothing is concluded: "
            f"{details}.",
            "attention": (*summary.attention, *faults),
        }
    )


def ignored_scatter_settings(analysis: Analysis, model: LinearModel) -> tuple[str, ...]:
    """Return a sentence for each setting of scatter that a diagnosis ignores."""
    lines: list[str] = []
    for trials, rig in zip(model.data.rigs, model.rigs, strict=True):
        heavy = heavy_scatter(rig)
        levels = () if heavy is None else (heavy.level,)
        lines += kept_normal(analysis.scatter, trials.rig.words.rig, levels)
    if analysis.scatter.by_size and len(model.data.sizes) > 1:
        lines.append("All sizes share one scatter in a diagnosis: scatter.by_size is of fits.")
    return tuple(lines)
