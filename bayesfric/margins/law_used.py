"""The law of the margins: from the fit, or refitted with the causes of a diagnosis."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from bayesfric.attention.diagnosis import biased_numbers
from bayesfric.errors import Fault, InputError
from bayesfric.margins.diagnosed import Diagnosed, read_diagnosed
from bayesfric.margins.posterior import Posterior
from bayesfric.results import read_json
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.margins import LawUsed

LawAsked = Literal["fitted", "refitted"]
NUMBERS_SHOWN = 3  # most numbers of the law that are reported as wrong


@dataclass(frozen=True)
class ChosenLaw:
    """The law with which margins are computed.

    Parameters
    ----------
    posterior : Posterior
        Its draws; for the refitted law, with the effects on friction.
    used : LawUsed
        Which law it is, as stored.
    beside : Diagnosed or None
        Law with effects for the margins beside those of the law alone, if a diagnosis was given.
    """

    posterior: Posterior
    used: LawUsed
    beside: Diagnosed | None = None


def choose_law(
    draws: Path,
    posterior: Posterior,
    diagnosis: Path | str | None,
    asked: LawAsked | None,
    seed: int,
) -> ChosenLaw:
    """Return the law refitted with the causes if a diagnosis names any, else that of the fit.

    Parameters
    ----------
    draws : Path
        ``draws.nc``; a ``diagnosis.json`` beside it is used by default.
    posterior : Posterior
        Content of ``draws.nc``.
    diagnosis : Path, str or None
        A ``diagnosis.json`` that was given.
    asked : {"fitted", "refitted"} or None
        The law that was asked for.
    seed : int
        Seed of the analysis.

    Raises
    ------
    InputError
        The refitted law is requested without a diagnosis, or the diagnosis is damaged.
    """
    path = draws.parent / "diagnosis.json" if diagnosis is None else Path(diagnosis)
    if diagnosis is None and not path.is_file():
        if asked == "refitted":
            raise InputError([Fault(str(path), "a diagnosis, which --law refitted needs")])
        return _fitted(posterior, "no diagnosis lies beside the draws")
    record = read_json(DiagnosisFile, path)
    if diagnosis is None and not record.recording.same_data(posterior.recording):
        if asked == "refitted":
            raise InputError([Fault(str(path), "a diagnosis of the recording of the draws")])
        why = f"{path.name} beside the draws is of another recording, and is not used"
        return _fitted(posterior, why, warning=f"{why[:1].upper()}{why[1:]}")
    names = ", ".join(cause.effect for cause in record.causes)
    if asked == "refitted" or (names and asked is None):
        diagnosed = read_diagnosed(path, posterior, seed)
        return ChosenLaw(diagnosed.posterior, _refitted(path, record, diagnosed, names))
    beside = None if diagnosis is None else read_diagnosed(path, posterior, seed)
    if not names:
        return _fitted(posterior, f"{path.name} names no cause", beside)
    warning = (
        f"{path.name} names {names}, but you asked for margins of the law fitted without it"
        f"{_wrong(biased_numbers(record))}"
    )
    return _fitted(
        posterior, f"{path.name} names {names}, which you asked to leave out", beside, warning
    )


def _fitted(
    posterior: Posterior, why: str, beside: Diagnosed | None = None, warning: str | None = None
) -> ChosenLaw:
    used = LawUsed(
        used="fitted", sentence=f"Margins of the law as it was fitted: {why}.", warning=warning
    )
    return ChosenLaw(posterior, used, beside)


def _refitted(path: Path, record: DiagnosisFile, diagnosed: Diagnosed, names: str) -> LawUsed:
    what = f"{names}, which {path.name} names" if names else f"what {path.name} finds possible"
    left_out = (
        f" Not taken over to the machine: {'; '.join(diagnosed.left_out)}."
        if diagnosed.left_out
        else ""
    )
    return LawUsed(
        used="refitted",
        causes=tuple(cause.effect for cause in record.causes),
        effects=tuple(drawn.effect.name for drawn in diagnosed.posterior.acting),
        left_out=diagnosed.left_out,
        sentence=f"Margins of the law refitted with {what}.{left_out}",
    )


def _wrong(numbers: Mapping[str, LawNumber]) -> str:
    """Return the errors of the numbers of the law without causes, the worst first."""
    off = {
        name: number.before.mean / number.after.mean - 1
        for name, number in numbers.items()
        if number.after.mean
    }
    worst = sorted(off, key=lambda name: -abs(off[name]))[:NUMBERS_SHOWN]
    said = (
        f"{name} {abs(off[name]):.0%} too {'high' if off[name] > 0 else 'low'}" for name in worst
    )
    return f": {', '.join(said)}" if worst else ""
