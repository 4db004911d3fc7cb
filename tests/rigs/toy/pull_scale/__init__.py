"""A toy rig: a spring scale pulls the cable slowly over pulleys, under a known tension.

It reads ``steady_friction.csv`` and shows what a new rig takes: one folder. A reading is the
law's friction, times 1 + η + ε of its assembly and its own, with a stated standard error.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bayesfric.effects import State
from bayesfric.effects.terms import parameters_of, rough_values, total
from bayesfric.inference.grouped_normal import GroupedNormal, Groups
from bayesfric.inference.priors import Parameter
from bayesfric.physics.friction import coulomb_friction
from bayesfric.physics.laws import BASELINES
from bayesfric.rigs.bands import QUANTILES, bands
from bayesfric.rigs.base import Simulated, Unsupported, Words
from bayesfric.rigs.coefficients import SizeIndex, coefficient_parameters
from bayesfric.rigs.residuals import check_residuals, measuring_order
from bayesfric.rigs.truth import laws_of

SD_N = 0.01
SCATTER = ("tau", "omega")


@dataclass(frozen=True)
class PullScale:
    name: str = "scale"
    motion: str = "steady"
    words: Words = field(default=Words("pull scale", "reading", "readings"))
    tables: tuple[str, ...] = ("steady_friction.csv",)
    paper: bool = False

    def trials(self, recording, *, exclude=True):
        if recording.steady is None:
            return None
        table = recording.steady.rename(columns={"run": "trial"})
        table = table.sort_values("setup", kind="stable").reset_index(drop=True)
        return Readings(self, recording.rig, table, table)

    def change(self, effect, design, constants, truth):
        return None

    def simulate(self, design, constants, truth, seed):
        rng = np.random.default_rng([seed, 15])
        cells = [(s, n, t) for s in ("small", "large") for n in (5, 9, 15) for t in (60.0, 120.0)]
        rows = [(*cell, tension) for cell in cells for tension in (6.0, 14.0, 22.0, 30.0)]
        names = ["pulley_size", "n_pulleys", "wrap_angle_deg", "tension_n"]
        table = pd.DataFrame(rows, columns=names)
        table["setup"] = [f"a{place // 4:02d}" for place in range(len(table))]
        table["run"] = [f"p{place:03d}" for place in range(len(table))]
        law = laws_of(truth, table["pulley_size"])
        fc = coulomb_friction(law, *(table[name].to_numpy() for name in names[1:]))
        eta = truth.omega * rng.standard_normal(len(cells)).repeat(4)
        factor = 1 + eta + truth.tau * rng.standard_normal(len(table))
        table["friction_n"] = (fc * factor + SD_N * rng.standard_normal(len(table))).round(5)
        return Simulated({"steady": table}, len(table))


RIG = PullScale()


@dataclass(frozen=True)
class Readings:
    rig: PullScale
    constants: Any
    table: pd.DataFrame
    recorded: pd.DataFrame
    loads: tuple[str, ...] = ("tension_n",)
    excluded: None = None
    slowest_speed_m_s: float = float("inf")

    def levels(self, name):
        return int(self.table[{"tension": "tension_n"}.get(name, name)].nunique())

    def select(self, keep):
        table = self.table[keep].reset_index(drop=True)
        return replace(self, table=table) if len(table) else None

    def supports(self, effect):
        if effect.acts_on == "friction" and not (effect.along_path or effect.components):
            return None
        return Unsupported("A reading of a spring scale has no speed, no path and no motor.")

    def likelihood(self, analysis, law=BASELINES["paper"], effects=()):
        return ReadingsLikelihood(self.table, analysis, law, effects)

    def quality(self):
        return {}

    def paper_estimates(self):
        return {}

    def stretch_ratios(self, cable, theta):
        return Unsupported("A cable that is pulled slowly does not ring.")

    def resting(self, conditions):
        return None

    def figures(self, view):
        return {}

    def predicted(self, view):
        table, observed = self.table, self.table["friction_n"].to_numpy()
        law = view.likelihood.law(view.named)
        kept = ("pulley_size", "setup", "n_pulleys", "wrap_angle_deg", "tension_n", "friction_n")
        return xr.Dataset(
            {name: ("reading", table[name].to_numpy()) for name in kept}
            | {
                "law_n": (("reading", "quantile"), bands(law)),
                "predicted_n": (("reading", "quantile"), bands(law * view.factor)),
                "order": ("reading", measuring_order(self.recorded, table)),
                **check_residuals("reading", view.remade, observed),
            },
            coords={"reading": table["trial"].to_numpy(), "quantile": list(QUANTILES)},
        )


class ReadingsLikelihood:
    def __init__(self, table, analysis, law, effects: Sequence = ()) -> None:
        self.trials, self._law, self._effects = table, law, tuple(effects)
        codes, setups = pd.factorize(table["setup"])
        self.setups = tuple(setups)
        self._groups = Groups(np.flatnonzero(np.diff(codes, prepend=-1)), codes.size)
        self._size = SizeIndex.of(table["pulley_size"])
        self.sizes = self._size.sizes
        names = ("n_pulleys", "wrap_angle_deg", "tension_n")
        self._condition = [table[name].to_numpy(dtype=float) for name in names]
        self.parameters = (
            *coefficient_parameters(self.sizes, analysis),
            *(Parameter(n, "1", getattr(analysis.priors, n), "scatter") for n in SCATTER),
            *(one for active in self._effects for one in parameters_of(active)),
        )

    def law(self, theta: Mapping[str, Any]):
        law = self._size.coefficients(theta)
        friction = self._law.at_tension(law, *self._condition)
        state = State.of(law, *self._condition, 0.0, steady=True)
        return friction + (total(self._effects, theta, state) if self._effects else 0.0)

    def _normal(self, theta):
        law, tau, omega = self.law(theta), *(theta[name][:, None] for name in SCATTER)
        observed = self.trials["friction_n"].to_numpy()
        variance = (tau * law) ** 2 + SD_N**2
        return GroupedNormal(self._groups, observed - law, variance, (omega * law)[None])

    def draw_scatter(self, theta, rng, *, together=False):
        tau, omega = (theta[name][:, None] for name in SCATTER)
        shape = (len(tau), len(self.trials))
        if not together:
            return np.hypot(tau, omega) * rng.standard_normal(shape)
        eta = omega * rng.standard_normal((len(tau), len(self.setups)))
        return eta[:, self._groups.of_each] + tau * rng.standard_normal(shape)

    def draw_observed(self, theta, deviation, rng):
        return self.law(theta) * (1 + deviation) + SD_N * rng.standard_normal(deviation.shape)

    def log_likelihood(self, theta):
        return self._normal(theta).log_density()

    def setup_log_likelihood(self, theta):
        return self._normal(theta).group_log_density()

    def trial_log_likelihood(self, theta):
        return self._normal(theta).single_log_density()

    def trial_cdf(self, theta):
        return self._normal(theta).single_cdf()

    def draw_trial_cdf(self, theta, rng):
        return self._normal(theta).drawn(rng).single_cdf()

    def start(self):
        friction = self.trials["friction_n"].to_numpy()
        rough = self._size.rough_coefficients(*self._condition, friction)
        return rough | dict.fromkeys(SCATTER, 0.02) | rough_values(self._effects)
