"""The differences between the stored results of two runs."""

from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bayesfric.errors import Fault, InputError
from bayesfric.margins.metric_definitions import HUNTS
from bayesfric.results import read_json, refuse_mixed, replace_outputs
from bayesfric.schemas import ClaimsFile, ComparisonFile, DiagnosisFile, FitFile, MarginsFile
from bayesfric.schemas.base import Interval, Provenance
from bayesfric.schemas.comparison import Flip, Setting, Shift
from bayesfric.schemas.margins import LoopMargins, WithEffects

MODELS: dict[str, type[Provenance]] = {
    "fit.json": FitFile,
    "claims.json": ClaimsFile,
    "diagnosis.json": DiagnosisFile,
    "margins.json": MarginsFile,
}
WENT_IN = ("recording", "seed", "rigs", "baseline", "fixed", "fixed_at", "analysis", "versions")
SHIFTS_SHOWN = 12  # shifts in the text
FAR = 10  # standard deviations, beyond which a shift is told as that
BEYOND = 6  # decimal logarithm of odds, likewise


class Quantity(NamedTuple):
    """A number with its uncertainty."""

    centre: float
    sd: float
    unit: str


def compare(a: str | PathLike[str], b: str | PathLike[str]) -> ComparisonFile:
    """Compare two folders of results.

    Parameters
    ----------
    a, b : str or path-like
        Folders that the verbs wrote into.

    Returns
    -------
    ComparisonFile
        Settings that differ, verdicts that flipped, and how far numbers moved in their
        standard deviations.

    Raises
    ------
    InputError
        A result is damaged, or the folders have no result in common.
    """
    first, second = results_in(Path(a)), results_in(Path(b))
    common = [name for name in first if name in second]
    if not common:
        expected = f"a result that {a} has as well, one of {', '.join(MODELS)}"
        raise InputError([Fault(str(b), expected)])
    pairs = [(name, first[name], second[name]) for name in common]
    return ComparisonFile(
        run_ids={
            name: (first_result.run_id, second_result.run_id)
            for name, first_result, second_result in pairs
        },
        only_in_a=tuple(name for name in first if name not in second),
        only_in_b=tuple(name for name in second if name not in first),
        same=all(first_result == second_result for _, first_result, second_result in pairs),
        settings=tuple(setting for pair in pairs for setting in _settings(*pair)),
        flips=tuple(flip for pair in pairs for flip in _flips(*pair)),
        shifts=tuple(
            sorted(
                (shift for pair in pairs for shift in _shifts(*pair)),
                key=lambda shift: -abs(shift.shift or 0.0),
            )
        ),
        keys_only_in_a=tuple(key for name, a, b in pairs for key in _only_in_first(name, a, b)),
        keys_only_in_b=tuple(key for name, a, b in pairs for key in _only_in_first(name, b, a)),
    )


def write_comparison(comparison: ComparisonFile, folder: Path) -> None:
    """Write ``comparison.json``.

    Raises
    ------
    InputError
        The folder cannot be written.
    """
    replace_outputs(folder, {"comparison.json": comparison})


def comparison_text(comparison: ComparisonFile) -> list[str]:
    """Return a comparison in lines of text, the largest differences first."""
    if comparison.same and not comparison.only_in_a and not comparison.only_in_b:
        return ["no difference: " + ", ".join(comparison.run_ids)]
    lines = []
    for flip in comparison.flips:
        lines.append(f"{flip.file}  {flip.name}: {flip.a} -> {flip.b}")
    if not comparison.flips:
        lines.append("no verdict differs")
    moved = [shift for shift in comparison.shifts if shift.a != shift.b or shift.sd_a != shift.sd_b]
    if moved:
        lines.append(f"{len(moved)} of {len(comparison.shifts)} numbers moved, the furthest first:")
    for shift in moved[:SHIFTS_SHOWN]:
        unit = "" if shift.unit == "1" else f" {shift.unit}"
        lines.append(f"  {shift.file}  {shift.name}: {_moved(shift)}{unit}{_how_far(shift.shift)}")
    if not moved:
        lines.append(f"none of {len(comparison.shifts)} numbers moved")
    files: dict[str, list[str]] = {}
    for setting in comparison.settings:
        change = f"{setting.key}: {_or_none(setting.a)} -> {_or_none(setting.b)}"
        files.setdefault(change, []).append(setting.file)
    lines += [f"{', '.join(names)}  {change}" for change, names in files.items()]
    if not comparison.settings:
        lines.append("no setting differs")
    for which, keys in (
        ("first", comparison.keys_only_in_a),
        ("second", comparison.keys_only_in_b),
    ):
        if keys:
            lines.append(f"{len(keys)} numbers and verdicts are in the {which} folder alone:")
            lines += [f"  {key}" for key in keys[:SHIFTS_SHOWN]]
    lines += [f"{name} is in the first folder alone" for name in comparison.only_in_a]
    lines += [f"{name} is in the second folder alone" for name in comparison.only_in_b]
    return lines


def _moved(shift: Shift) -> str:
    """Return a number before and now; odds beyond a million to one are told as that."""
    if shift.name.endswith(".log10_bayes_factor") and min(abs(shift.a), abs(shift.b)) > BEYOND:
        return " -> ".join(f"{'>' if x > 0 else '< -'}{BEYOND}" for x in (shift.a, shift.b))
    return f"{shift.a:.4g} ± {shift.sd_a:.2g} -> {shift.b:.4g} ± {shift.sd_b:.2g}"


def _how_far(shift: float | None) -> str:
    """Return a shift in standard deviations; one beyond ten is told as that."""
    if shift is None:
        return ""
    return f"  ({shift:+.2f} sd)" if abs(shift) < FAR else f"  (more than {FAR} sd)"


def _or_none(text: str | None) -> str:
    return "none" if text is None else text


def results_in(folder: Path) -> dict[str, Provenance]:
    """Return the results in a folder by file, the fit first.

    Raises
    ------
    InputError
        There is none, or one is damaged.
    """
    results: dict[str, Provenance] = {}
    for name, model in MODELS.items():
        if (folder / name).is_file():
            results[name] = read_json(model, folder / name)
            refuse_mixed(results[name], folder / name)
    if not results:
        raise InputError([Fault(str(folder), f"a folder with one of {', '.join(MODELS)}")])
    return results


def _settings(name: str, a: Provenance, b: Provenance) -> Iterator[Setting]:
    """Yield the inputs and settings that differ."""
    first_settings, second_settings = (
        _flat(record.model_dump(mode="json", include=set(WENT_IN))) | _loop_files(record)
        for record in (a, b)
    )
    for key in dict.fromkeys([*first_settings, *second_settings]):
        if first_settings.get(key) != second_settings.get(key):
            yield Setting(file=name, key=key, a=first_settings.get(key), b=second_settings.get(key))


def _flat(value: Any, place: str = "") -> dict[str, str]:
    if isinstance(value, Mapping):
        before = f"{place}." if place else ""
        parts = [_flat(item, before + name) for name, item in value.items()]
        return {key: text for part in parts for key, text in part.items()}
    return {} if value is None else {place: str(value)}


def _loop_files(record: Provenance) -> dict[str, str]:
    """Return what identifies each loop file, where there are any."""
    if not isinstance(record, MarginsFile):
        return {}
    return {f"loops.{loop.name}.loop_sha256": loop.loop_sha256 for loop in record.loops}


def _only_in_first(name: str, a: Provenance, b: Provenance) -> Iterator[str]:
    """Yield the verdicts and numbers that the first of two results has and the second lacks."""
    for of in (_verdicts, _quantities):
        second_keys = of(b)
        yield from (f"{name}  {key}" for key in of(a) if key not in second_keys)


def _flips(name: str, a: Provenance, b: Provenance) -> Iterator[Flip]:
    first_verdicts, second_verdicts = _verdicts(a), _verdicts(b)
    for key in first_verdicts:
        if key in second_verdicts and first_verdicts[key] != second_verdicts[key]:
            yield Flip(file=name, name=key, a=first_verdicts[key], b=second_verdicts[key])


def _verdicts(record: Provenance) -> dict[str, str]:
    if isinstance(record, FitFile):
        return {"converged": "yes" if record.converged else "no"}
    if isinstance(record, ClaimsFile):
        return {claim.id: claim.verdict for claim in record.claims}
    if isinstance(record, DiagnosisFile):
        causes = ", ".join(sorted(cause.effect for cause in record.causes)) or "none"
        return {"verdict": record.verdict, "causes": causes}
    if isinstance(record, MarginsFile):
        return dict(verdict for loop in record.loops for verdict in _verdicts_on(loop))
    return {}


def _verdicts_on(loop: LoopMargins) -> Iterator[tuple[str, str]]:
    """Yield what is concluded of a loop: what it misses, whether it hunts, whether γ is safe."""
    for name, judged in _with_and_without_effects(loop):
        if judged.missed_specs is not None:  # null in files of earlier versions
            hunts = HUNTS in judged.missed_specs
            yield f"{name}.missed_specs", ", ".join(judged.missed_specs) or "none"
            yield f"{name}.hunts", "more often than allowed" if hunts else "as rarely as allowed"
        safe = judged.largest_safe_compensation_gain is not None
        yield f"{name}.safe_compensation_gain", "there is one" if safe else "there is none"


def _with_and_without_effects(loop: LoopMargins) -> Iterator[tuple[str, LoopMargins | WithEffects]]:
    yield loop.name, loop
    if loop.with_effects is not None:
        yield f"{loop.name}.with_effects", loop.with_effects


def _shifts(name: str, a: Provenance, b: Provenance) -> Iterator[Shift]:
    first_numbers, second_numbers = _quantities(a), _quantities(b)
    for key in first_numbers:
        if key not in second_numbers:
            continue
        (left, sd_left, unit), (right, sd_right, _) = first_numbers[key], second_numbers[key]
        sd = float(np.sqrt((sd_left**2 + sd_right**2) / 2))
        yield Shift(
            file=name,
            name=key,
            unit=unit,
            a=left,
            b=right,
            sd_a=sd_left,
            sd_b=sd_right,
            shift=(right - left) / sd if sd > 0 else None,
        )


def _quantities(record: Provenance) -> dict[str, Quantity]:
    """Return every number with an uncertainty that both runs of a verb may have."""
    quantities: dict[str, Quantity] = {}

    def add(key: str, interval: Interval | None, unit: str) -> None:
        if interval is not None:
            quantities[key] = Quantity(interval.mean, interval.sd, unit)

    if isinstance(record, FitFile):
        for size, entries in record.pulleys.items():
            for name, entry in entries.items():
                add(f"pulleys.{size}.{name}", entry, entry.unit)
        for group in ("scatter", "noise", "parameters"):
            for name, entry in getattr(record, group).items():
                add(f"{group}.{name}", entry, entry.unit)
    elif isinstance(record, ClaimsFile):
        for claim in record.claims:
            if claim.log10_bayes_factor is not None:
                error = claim.log10_bayes_factor_se or 0.0
                quantities[f"{claim.id}.log10_bayes_factor"] = Quantity(
                    claim.log10_bayes_factor, error, "1"
                )
    elif isinstance(record, DiagnosisFile):
        for effect in record.inclusion:
            add(f"inclusion.{effect.effect}.strength", effect.strength, "1")
        add("gap.systematic", record.gap.systematic, record.gap.unit)
    elif isinstance(record, MarginsFile):
        for loop in record.loops:
            for metric in loop.metrics:
                way = f".{metric.direction}" if metric.direction else ""
                add(f"{loop.name}.{metric.name}{way}", metric.interval, metric.unit)
            if loop.largest_safe_compensation_gain is not None:
                quantities[f"{loop.name}.largest_safe_compensation_gain"] = Quantity(
                    loop.largest_safe_compensation_gain,
                    loop.largest_safe_compensation_gain_se or 0.0,
                    "1",
                )
    return quantities
