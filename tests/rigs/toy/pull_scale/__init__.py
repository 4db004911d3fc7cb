"""A toy rig: a spring scale pulls the cable slowly over pulleys, under a known tension.

It brings a table of its own, ``pull_scale.csv``, and shows what a new rig takes: one folder.
A reading is the law's friction, times 1 + η + ε of its assembly and its own, with a known
standard error.
"""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd

from bayesfric.analysis import HalfNormal
from bayesfric.effects import State
from bayesfric.effects.terms import parameters_of, rough_values, total
from bayesfric.observation.coefficients import SizeIndex, coefficient_parameters
from bayesfric.observation.exact import ExactLikelihood, ExactModel, Shown
from bayesfric.observation.linear import noise_parameter, rank
from bayesfric.observation.points import LinearReadings
from bayesfric.observation.scatter import ScatterLevels
from bayesfric.physics.friction import Coefficients, coulomb_friction
from bayesfric.physics.laws import BASELINES
from bayesfric.recording.columns import COUNT, RUN, SETUP, SIZE, TABLES, WRAP, Column, TableFormat
from bayesfric.rigs.base import Rig, RigTrials, Simulated, Unsupported, Words
from bayesfric.rigs.residuals import beside_predicted
from bayesfric.rigs.truth import laws_of

OWN = tuple(Column(name, "number", name, "N") for name in ("tension_n", "friction_n"))
CONDITION = ("n_pulleys", "wrap_angle_deg", "tension_n")
FILE = "pull_scale.csv"
TABLES[FILE] = TableFormat(FILE, (RUN, SETUP, SIZE, COUNT, WRAP, *OWN))
SD_N, LOOKED = 0.01, (1e-4, 1.0)


def steady(law, table):
    return State.of(law, *(table[c].to_numpy(float) for c in CONDITION), 0.0, steady=True)


@dataclass(frozen=True)
class PullScale(Rig):
    name: str = "scale"
    words: Words = field(default=Words("pull scale", "reading", "readings"))
    tables: tuple[str, ...] = (FILE,)

    def trials(self, recording, *, exclude=True):
        if FILE not in recording.further:
            return None
        table = recording.further[FILE].rename(columns={"run": "trial"})
        return Readings(self, table.sort_values("setup", kind="stable", ignore_index=True), table)

    def simulate(self, design, constants, truth, seed):
        rng = np.random.default_rng([seed, 15])
        cells = [(s, n, w) for s in ("small", "large") for n in (5, 9, 15) for w in (60.0, 120.0)]
        rows = [(*cell, tension) for cell in cells for tension in (6.0, 14.0, 22.0, 30.0)]
        table = pd.DataFrame(rows, columns=["pulley_size", *CONDITION])
        table["setup"] = [f"a{place // 4:02d}" for place in range(len(table))]
        table["run"] = [f"p{place:03d}" for place in range(len(table))]
        law = laws_of(truth, table["pulley_size"])
        fc = coulomb_friction(law, *(table[name].to_numpy() for name in CONDITION))
        for applied in truth.effects:
            fc = fc + applied(steady(law, table))
        eta = truth.omega * rng.standard_normal(len(cells)).repeat(4)
        factor = 1 + eta + truth.tau * rng.standard_normal(len(table))
        table["friction_n"] = (fc * factor + SD_N * rng.standard_normal(len(table))).round(5)
        return Simulated({"further": {FILE: table}}, len(table))


RIG = PullScale()


@dataclass(frozen=True)
class Readings(RigTrials):
    rig: PullScale
    table: pd.DataFrame
    recorded: pd.DataFrame
    loads: tuple[str, ...] = ("tension_n",)

    def supports(self, effect):
        if effect.acts_on == "friction" and not (effect.along_path or effect.components):
            return None
        return Unsupported("A reading of a spring scale has no speed, no path and no motor.")

    def likelihood(self, analysis, law=BASELINES["paper"], effects=()):
        return ExactLikelihood(ReadingsModel(self.table, analysis, law, effects))

    def predicted(self, view):
        table, law = self.table, view.likelihood.law(view.named)
        kept = ("pulley_size", "setup", *CONDITION, "friction_n")
        observed = {name: table[name].to_numpy() for name in kept}
        return beside_predicted("reading", table, observed, law, self.recorded, view)

    def under(self, law):
        return self

    def linear(self, laws, acting=()):
        rows = zip(*(laws[size] for size in self.table["pulley_size"]), strict=True)
        law, one = Coefficients(*map(np.array, rows)), np.ones(len(self.table))
        state = steady(law, self.table)._replace(order=rank(self.table))

        def noise(priors):
            of = {"tau_scale": priors.tau, "omega_pull": priors.omega, "omega_scale": priors.omega}
            of["sigma_scale"] = HalfNormal(scale=SD_N)
            return tuple(
                noise_parameter(name, prior, 0.01, LOOKED, 0.01) for name, prior in of.items()
            )

        reading, none = self.table["friction_n"].to_numpy() - state.friction_n, np.zeros((0, 0))
        about = ("scale", self.table, self.loads, state, state.friction_n, one)
        return LinearReadings(
            *about, reading, one, (one,), noise, one[:, None][:, :0], none, none.ravel()
        )


class ReadingsModel(ExactModel):
    def __init__(self, table, analysis, law, effects) -> None:
        self.trials, self._law, self._effects = table, law, tuple(effects)
        self._size, priors = SizeIndex.of(table["pulley_size"]), analysis.priors
        self.coefficients = coefficient_parameters(self._size.sizes, analysis)
        self.scatter = ScatterLevels(("tau", "omega"), (priors.tau, priors.omega), self._size)
        self.further = tuple(one for active in self._effects for one in parameters_of(active))

    def law(self, theta):
        law = self._size.coefficients(theta)
        state = steady(law, self.trials)
        friction = self._law.at_tension(law, state.n_pulleys, state.wrap_angle_deg, state.tension_n)
        return friction + (total(self._effects, theta, state) if self._effects else 0.0)

    def shown(self, theta):
        law = self.law(theta)
        return Shown(self.trials["friction_n"].to_numpy() - law, np.full_like(law, SD_N**2), law)

    def read(self, theta, deviation, rng):
        return self.law(theta) * (1 + deviation) + SD_N * rng.standard_normal(deviation.shape)

    def start(self):
        columns = (self.trials[name].to_numpy(float) for name in (*CONDITION, "friction_n"))
        return self._size.rough_coefficients(*columns) | rough_values(self._effects)
