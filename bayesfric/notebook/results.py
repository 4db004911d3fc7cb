"""Results that show themselves: in ten lines, as a table, as figures."""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, fields
from html import escape
from typing import TYPE_CHECKING, Any, Self

import pandas as pd

from bayesfric.claims.checking import Checked
from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.fitting.result import Fit
from bayesfric.margins.computing import Margins
from bayesfric.report.stored import StoredResults
from bayesfric.schemas import FitFile, ScorecardFile
from bayesfric.schemas.base import Interval

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LINES_SHOWN = 9  # lines below the first


class _AtPrompt(ABC):
    """A result that shows itself."""

    @classmethod
    def of(cls, result: Any) -> Self:
        """Return the same result as one that shows itself."""
        return cls(**{field.name: getattr(result, field.name) for field in fields(result)})

    @abstractmethod
    def to_dataframe(self) -> pd.DataFrame:
        """Return its numbers as a table."""

    @property
    def _title(self) -> str:
        return repr(self).splitlines()[0]

    def _repr_html_(self) -> str:
        return f"<p>{escape(self._title)}</p>{self.to_dataframe().to_html()}"


@dataclass(frozen=True, repr=False)
class FitResult(_AtPrompt, Fit):
    """A fit, at a prompt."""

    def to_dataframe(self) -> pd.DataFrame:
        """Return the coefficients: a row for each pulley size and coefficient."""
        rows = {
            (size, name): {**_numbers(entry), "unit": entry.unit, "informed": entry.informed}
            for size, entries in self.summary.pulleys.items()
            for name, entry in entries.items()
        }
        table = pd.DataFrame.from_dict(rows, orient="index")
        table.index.names = ["pulley_size", "coefficient"]
        return table

    def plot_coefficients(self) -> "Figure":
        """Draw each coefficient over the paper's."""
        from bayesfric.plots.posterior import coefficients_relative_to_paper

        return coefficients_relative_to_paper(self.predictive)

    def plot_densities(self) -> "Figure":
        """Draw prior and posterior of each parameter."""
        from bayesfric.plots.densities import prior_and_posterior

        return prior_and_posterior(self.predictive)

    def plot_residuals(self) -> "Figure":
        """Draw the residual of each trial from the law, in the order of measuring."""
        from bayesfric.plots.residuals_by_order import residuals_by_order

        return residuals_by_order(self.predictive)

    def __repr__(self) -> str:
        converged = "converged" if self.summary.converged else "not converged"
        lines = [
            f"{size:<8} {name}  {entry.mean:.4g} ± {entry.sd:.2g} "
            f"{'' if entry.unit == '1' else entry.unit}"
            for size, entries in self.summary.pulleys.items()
            for name, entry in entries.items()
        ]
        return _lines(f"Fit of {self.summary.recording.name}, {converged}", lines)


@dataclass(frozen=True, repr=False)
class ClaimsResult(_AtPrompt, Checked):
    """The paper's claims, judged, at a prompt."""

    def to_dataframe(self) -> pd.DataFrame:
        """Return the claims: a row each."""
        names = ("verdict", "reason", "log10_bayes_factor", "elpd_difference", "statement")
        rows = {
            claim.id: {name: getattr(claim, name) for name in names}
            for claim in self.summary.claims
        }
        return pd.DataFrame.from_dict(rows, orient="index").rename_axis("claim")

    def plot_rivals(self) -> "Figure":
        """Draw the Bayes factor of each claim against each of its rivals."""
        from bayesfric.plots.claims import against_rivals

        return against_rivals(self._by_rival("log10_bayes_factor_against"))

    def plot_smallest_found(self) -> "Figure":
        """Draw the smallest effect of each rival that these data would have shown."""
        from bayesfric.plots.claims import smallest_found

        matters = self.summary.rules["region_of_equivalence"]
        return smallest_found(self._by_rival("smallest_found"), matters)

    def _by_rival(self, figure: str) -> dict[str, dict[str, float]]:
        figures = {claim.id: claim.figures.get(figure) for claim in self.summary.claims}
        there = {name: dict(rivals) for name, rivals in figures.items() if isinstance(rivals, dict)}
        if not any(there.values()):
            raise ValueError(f"no claim on this recording has {figure}: none was compared")
        return there

    def __repr__(self) -> str:
        lines = [f"{claim.id:<24} {claim.verdict}" for claim in self.summary.claims]
        return _lines(f"Claims on {self.summary.recording.name}", lines)


@dataclass(frozen=True, repr=False)
class DiagnosisResult(_AtPrompt, Diagnosed):
    """A diagnosis, at a prompt."""

    def to_dataframe(self) -> pd.DataFrame:
        """Return the effects: a row each, the most probable first."""
        rows = {
            effect.effect: {
                "probability": effect.probability,
                "strength": None if effect.strength is None else effect.strength.q50,
                "makes_a_gap": effect.makes_a_gap,
            }
            for effect in self.summary.inclusion
        }
        return pd.DataFrame.from_dict(rows, orient="index").rename_axis("effect")

    def to_enter(self) -> pd.DataFrame:
        """Return the numbers to enter in a simulator, a row each; empty of boards."""
        rows = [
            {
                "joint": block.joint,
                "parameter": number.parameter,
                "in_your_simulator": number.in_your_simulator,
                "value": number.value.mean,
                "sd": number.value.sd,
                "q05": number.value.q05,
                "q95": number.value.q95,
                "unit": number.unit,
                "lost_without": number.lost_without,
                **{name: field and field.field for name, field in number.fields.items()},
            }
            for block in self.summary.joints or (self.summary,)
            for number in block.enter
        ]
        return pd.DataFrame(rows)

    def plot_effects(self) -> "Figure":
        """Draw how probable each effect is, and how strong."""
        from bayesfric.plots.diagnosis import what_acts

        return what_acts(self.summary.inclusion, self.summary.practical_share)

    def plot_where(self) -> "Figure":
        """Draw the residual force along each axis."""
        from bayesfric.plots.diagnosis import where_it_lies
        from bayesfric.plots.labels import sizes_of

        residuals = self.curves["residuals"].to_dataset()
        summary = self.summary
        return where_it_lies(
            summary.where,
            residuals,
            summary.gap.unit,
            sizes_of(summary.law),
            summary.unexplained,
        )

    def __repr__(self) -> str:
        lines = [
            self.summary.sentence,
            *(f"{name:<28} {p:.3f}" for name, p in self.summary.probabilities.items()),
        ]
        return _lines(f"Diagnosis of {self.summary.recording.name}: {self.summary.verdict}", lines)

    @property
    def _title(self) -> str:
        return " ".join(repr(self).splitlines()[:2])


@dataclass(frozen=True, repr=False)
class MarginsResult(_AtPrompt, Margins):
    """Margins of loops, at a prompt."""

    def to_dataframe(self) -> pd.DataFrame:
        """Return the metrics: a row for each loop and metric."""
        return pd.DataFrame(
            [
                {
                    "loop": loop.name,
                    "metric": metric.name,
                    "direction": metric.direction,
                    **({} if metric.interval is None else _numbers(metric.interval)),
                    "unit": metric.unit,
                    "probability_of_violation": metric.probability_of_violation,
                }
                for loop in self.summary.loops
                for metric in loop.metrics
            ]
        )

    def plot_hunting(self) -> "Figure":
        """Draw how probably each loop hunts, over the compensation gain."""
        from bayesfric.plots.margins import limit_cycle_against_gain

        loops = [loop for loop in self.summary.loops if loop.limit_cycle_probability]
        if not loops:
            raise ValueError("no loop has a gain to draw hunting over: none compensates friction")
        return limit_cycle_against_gain(loops)

    def plot_errors(self) -> "Figure":
        """Draw the errors at the tool tip and the torque that is left, with their specs."""
        from bayesfric.plots.margins import error_and_headroom, has_error_or_headroom

        if not has_error_or_headroom(self.summary.loops):
            raise ValueError("no loop has an error at the tip or torque left to draw")
        return error_and_headroom(self.summary.loops)

    def __repr__(self) -> str:
        lines = [f"{loop.name}: {loop.answer}" for loop in self.summary.loops]
        return _lines("Margins", lines)

    @property
    def _title(self) -> str:
        return repr(self)


@dataclass(frozen=True, repr=False)
class Results:
    """What is stored in a folder, None for what is not there.

    Parameters
    ----------
    fit : FitResult or None
        The posterior.
    claims : ClaimsResult or None
        The paper's claims, judged.
    diagnosis : DiagnosisResult or None
        Where the simulation misses.
    margins : MarginsResult or None
        Of controllers.
    scorecard : ScorecardFile or None
        How well the diagnosis does where it is not told.
    pooled : FitFile or None
        A fit of several recordings, in the place of `fit`.
    """

    fit: FitResult | None
    claims: ClaimsResult | None
    diagnosis: DiagnosisResult | None
    margins: MarginsResult | None
    scorecard: ScorecardFile | None
    pooled: FitFile | None

    @classmethod
    def of(cls, stored: StoredResults) -> "Results":
        """Return stored results as ones that show themselves."""
        fitted, claims, diagnosis = stored.fitted, stored.claims, stored.diagnosis
        return cls(
            FitResult(fitted.fit, fitted.draws, fitted.predictive, {}) if fitted else None,
            ClaimsResult(claims.record, claims.curves, 0.0) if claims else None,
            DiagnosisResult(diagnosis.record, diagnosis.curves, 0.0) if diagnosis else None,
            MarginsResult(stored.margins) if stored.margins else None,
            stored.scorecard,
            stored.pooled,
        )

    def __repr__(self) -> str:
        there = [
            result for result in (self.fit, self.claims, self.diagnosis, self.margins) if result
        ]
        return _lines("Results", [repr(result).splitlines()[0] for result in there])

    def _repr_html_(self) -> str:
        there = (self.fit, self.claims, self.diagnosis, self.margins)
        return "".join(result._repr_html_() for result in there if result is not None)


def _numbers(interval: Interval) -> dict[str, float]:
    return {name: getattr(interval, name) for name in ("mean", "sd", "q05", "q50", "q95")}


def _lines(first: str, lines: Iterable[str]) -> str:
    rest = list(lines)
    if len(rest) > LINES_SHOWN:
        rest = [*rest[: LINES_SHOWN - 1], f"and {len(rest) - LINES_SHOWN + 1} more"]
    return "\n".join([first, *(f"  {line}".rstrip() for line in rest)])
