"""A toy rig: a spring scale pulls the cable slowly over pulleys, under a known tension.

It brings a table of its own, ``pull_scale.csv``, and shows what a new rig takes: one folder.
A reading is the law's friction, times 1 + η + ε of its assembly and its own, with a known
standard error.
"""

from dataclasses import dataclass, field
from functools import partial

import numpy as np
import pandas as pd

from bayesfric.effects import State
from bayesfric.observation.linear import rank
from bayesfric.observation.readings import Readings
from bayesfric.physics.friction import coulomb_friction
from bayesfric.physics.laws import BASELINES, FrictionLaw
from bayesfric.recording.columns import COUNT, RUN, SETUP, SIZE, TABLES, WRAP, Column, TableFormat
from bayesfric.rigs.base import CONDITION, Rig, Unsupported, Words
from bayesfric.rigs.own_design import Simulated
from bayesfric.rigs.readings import ReadingTrials
from bayesfric.rigs.truth import laws_of

OWN = tuple(Column(name, "number", name, "N") for name in ("tension_n", "friction_n"))
FILE = "pull_scale.csv"
TABLES[FILE] = TableFormat(FILE, (RUN, SETUP, SIZE, COUNT, WRAP, *OWN))
SD_N = 0.01


def steady(law, table):
    condition = (table[name].to_numpy(float) for name in CONDITION)
    return State.of(law, *condition, 0.0, order=rank(table), steady=True)


@dataclass(frozen=True)
class PullScale(Rig):
    name: str = "scale"
    words: Words = field(default=Words("pull scale", "reading", "readings"))
    tables: tuple[str, ...] = (FILE,)

    def trials(self, recording, *, exclude=True):
        if FILE not in recording.further:
            return None
        table = recording.further[FILE].rename(columns={"run": "trial"})
        return Pulls(self, table.sort_values("setup", kind="stable", ignore_index=True), table)

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
class Pulls(ReadingTrials):
    rig: PullScale
    table: pd.DataFrame
    recorded: pd.DataFrame
    loads: tuple[str, ...] = ("tension_n",)
    law: FrictionLaw = BASELINES["paper"]

    def supports(self, effect):
        if effect.acts_on == "friction" and not (effect.along_path or effect.components):
            return None
        return Unsupported("A reading of a spring scale has no speed, no path and no motor.")

    def readings(self, law):
        where, known_sd = partial(steady, table=self.table), np.full(len(self.table), SD_N)
        return Readings("scale", self.table, self.loads, law, where, known_sd, friction_scale=0.2)
