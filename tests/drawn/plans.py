"""Recordings drawn at random: plans of a few numbers, which print when a test fails.

A plan says what there is (which tables and columns, how many trials and assemblies, which names,
how odd the motion), and makes the same recording each time. What the reader refuses it may refuse;
what it takes has to come to an answer or to a refusal with its reason.
"""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pandas as pd
from hypothesis import strategies as st

from bayesfric.recording import Axis, Gravity, Motor, Recording, RigConstants
from bayesfric.simulate import simulate_recording

BOARDS = 3  # recordings of which boards' trials are taken
COVARIATES = ("payload_kg", "flow l/min", "température", "a/b", "µ")


@dataclass(frozen=True)
class Names:
    """Texts in the place of ids: the first of them, with a number where there is one already."""

    texts: tuple = ("a",)

    def of(self, count, prefix=""):
        """Return that many names, all different."""
        own = dict.fromkeys(f"{prefix}{text}" for text in self.texts)
        return [*own, *(f"{prefix}n{place}" for place in range(count))][:count]


@dataclass(frozen=True)
class Board:
    """Trials of the gravity board and runs of the motor board, some of a simulated recording."""

    trials: int = 5
    runs: int = 0
    setups: int = 60
    dropped: tuple = ()
    tested: float = 0.0
    slower: float = 1.0
    jitter_s: float = 0.0
    by_acceleration: bool = False
    names: Names = Names()
    seed: int = 0

    def tables(self):
        """Return fields of a recording."""
        rng, whole = np.random.default_rng(self.seed), simulated(self.seed % BOARDS)
        parts = {"rig": whole.rig}
        if self.trials:
            parts["gravity"] = self._gravity(whole.gravity, rng)
        if self.runs:
            parts["motor"] = Motor(self._some(whole.motor.runs, self.runs, rng), whole.motor.idle)
        return parts

    def _some(self, table, count, rng):
        """Return rows of a table, with names, roles and columns as planned."""
        setups = table["setup"].unique()
        kept = table["setup"].isin(rng.permutation(setups)[: self.setups])
        rows = np.flatnonzero(kept)
        rows = np.sort(rng.permutation(rows)[:count])
        rows_taken = table.iloc[rows].reset_index(drop=True)
        if self.tested:
            role = np.where(rng.random(len(rows_taken)) < self.tested, "test", "calibrate")
            rows_taken["role"] = role
        again = dict(
            zip(rows_taken["setup"].unique(), self.names.of(len(setups), "s"), strict=False)
        )
        rows_taken["setup"] = rows_taken["setup"].map(again)
        return rows_taken.drop(columns=[name for name in self.dropped if name in rows_taken])

    def _gravity(self, gravity, rng):
        trials = self._some(gravity.trials, self.trials, rng)
        events = gravity.events[gravity.events["trial"].isin(trials["trial"])].copy()
        if self.by_acceleration:
            trials["acceleration_m_s2"] = rng.uniform(0.2, 3.0, len(trials))
            events = events.iloc[:0]
        events["time_s"] = self.slower * events["time_s"]
        events["time_s"] += self.jitter_s * rng.standard_normal(len(events))
        events = events.sort_values(["trial", "sensor", "time_s"], ignore_index=True)
        again = dict(zip(trials["trial"], self.names.of(len(trials)), strict=True))
        return Gravity(
            trials.assign(trial=trials["trial"].map(again)),
            events.assign(trial=events["trial"].map(again)),
        )


@cache
def simulated(seed):
    """Return a recording of both boards."""
    return simulate_recording("quick", seed=seed)


@dataclass(frozen=True)
class Points:
    """Steady friction on anybody's bench."""

    points: int = 12
    setups: int = 3
    columns: tuple = ("tension_n", "velocity_m_s")
    covariates: tuple = ()
    size: float = 1.0  # of friction [N]
    scatter: float = 0.02
    intercept: float = 0.3
    same: bool = False  # all conditions alike
    both_ways: bool = False
    tested: float = 0.0
    names: Names = Names()
    seed: int = 0

    def tables(self):
        """Return fields of a recording."""
        rng, count = np.random.default_rng(self.seed), self.points
        spread = 0.0 if self.same else 1.0
        tension = 10.0 + 9.0 * spread * rng.uniform(-1, 1, count)
        speed = 0.5 + 0.4 * spread * rng.uniform(-1, 1, count)
        if self.both_ways:
            speed *= rng.choice([-1.0, 1.0], count)
        friction = self.intercept + (1 - self.intercept) * tension / 10
        friction = self.size * friction * (1 + self.scatter * rng.standard_normal(count))
        whole = {
            "order": np.arange(1, count + 1),
            "setup": np.array(self.names.of(max(self.setups, 1), "s"))[
                rng.integers(0, max(self.setups, 1), count)
            ],
            "pulley_size": rng.choice(["medium", "own"], count) if spread else "medium",
            "n_pulleys": rng.integers(1, 9, count) if spread else 5,
            "wrap_angle_deg": rng.choice([50.0, 85.0, 135.0], count) if spread else 85.0,
            "tension_n": tension,
            "velocity_m_s": speed,
            "friction_sd_n": self.size * rng.uniform(0.005, 0.02, count),
            "role": np.where(rng.random(count) < self.tested, "test", "calibrate"),
        }
        table = pd.DataFrame({"run": self.names.of(count)})
        for name in self.columns:
            table[name] = whole[name]
        for name in self.covariates:
            table[name] = spread * rng.uniform(0, 2, count)
        if "setup" in table:  # an assembly has one condition
            size = [
                column
                for column in ("pulley_size", "n_pulleys", "wrap_angle_deg")
                if column in table
            ]
            for name in size:
                table[name] = table.groupby("setup")[name].transform("first")
        return {"steady": table.assign(friction_n=friction), "rig": RigConstants()}


@dataclass(frozen=True)
class Drive:
    """Runs of a driven axis, whatever its motion."""

    runs: int = 1
    samples: int = 400
    sampled_hz: float = 200.0
    motion: str = "swing"
    force: str = "acts"
    stroke: float = 0.5
    offset: float = 0.0
    passes: float = 8.0  # over a run
    resolution: float = 1e-5
    noise: float = 0.01
    size: float = 1.0  # of the forces
    gravity: float = 0.0
    held: int = 1
    jitter: float = 0.0  # of an interval
    lost: float = 0.0  # of all rows
    late_s: float = 0.0  # the force stands in the log before it acts
    columns: tuple = ()
    covariates: tuple = ()
    constants: dict = field(default_factory=dict)
    names: Names = Names()
    seed: int = 0

    def tables(self):
        """Return fields of a recording."""
        rng, names = np.random.default_rng(self.seed), self.names.of(self.runs)
        samples = [self._run(name, rng) for name in names]
        runs = pd.DataFrame({"run": names, "order": np.arange(1, self.runs + 1)})
        if "role" in self.columns:
            runs["role"] = ["test" if place % 2 else "calibrate" for place in range(self.runs)]
        if "setup" in self.columns:
            runs["setup"] = [f"s{place // 2}" for place in range(self.runs)]
        if "order" not in self.columns:
            runs = runs.drop(columns="order")
        for name in self.covariates:
            runs[name] = rng.uniform(0, 2, self.runs)
        return {
            "axis": Axis(runs, pd.concat(samples, ignore_index=True)),
            "rig": RigConstants(**self.constants),
        }

    def _run(self, name, rng):
        time = np.arange(self.samples) / self.sampled_hz
        level = rng.uniform(0.5, 1.5)  # of the force of a run that spins the joint up
        position, speed, acceleration = self._path(time, level, rng)
        force = 0.3 * np.sign(speed) + 0.1 * speed / max(np.abs(speed).max(), 1e-300)
        force += 0.5 * acceleration / max(np.abs(acceleration).max(), 1e-300)
        force += self.gravity * np.sin(position)
        force = self.size * (force + self.noise * rng.standard_normal(time.size))
        if self.force == "constant":
            force = np.full(time.size, self.size)
        elif self.motion == "spins up":
            force = np.full(time.size, level * self.size)
        elif self.force == "none":
            force = np.zeros(time.size)
        place = self.offset + self.resolution * np.round(position / self.resolution)
        last = np.arange(time.size) // self.held * self.held
        force = np.interp(time + self.late_s, time, force)
        table = {"run": name, "time_s": time, "position_m": place[last], "force_n": force[last]}
        if self.jitter:
            early = self.jitter / self.sampled_hz * rng.uniform(0, 0.5, time.size)
            table["time_s"] = time - early + early[0]
        if "force_time_s" in self.columns:
            table["force_time_s"] = 5.0 + time + 0.3 / self.sampled_hz
        if "command_m" in self.columns:
            table["command_m"] = self.offset + position
        if "temperature_c" in self.columns:
            table["temperature_c"] = 20 + 5 * time / max(time.max(initial=0.0), 1e-9)
        if "sim_force_n" in self.columns:
            table["sim_force_n"] = 0.8 * force
        if "sim_position_m" in self.columns:
            table["sim_position_m"] = place + 0.01 * self.stroke * np.sin(3 * time)
        kept = rng.random(time.size) >= self.lost
        kept[: min(2, time.size)] = True
        return pd.DataFrame(table)[kept]

    def _path(self, time, level, rng):
        if self.motion == "still":
            return np.zeros((3, time.size))
        if self.motion == "noise":
            return self.stroke * rng.standard_normal((3, time.size))
        whole = max(time[-1], 1e-9) if time.size else 1.0
        rate = np.pi * self.passes / whole
        if self.motion == "spins up":
            final, decay = self.stroke * (level - 0.3), np.exp(-rate * time)
            return final * (time - (1 - decay) / rate), final * (1 - decay), final * rate * decay
        if self.motion == "one way":
            speed = self.stroke / whole * (1 + 0.3 * np.sin(rate * time))
            return (
                self.stroke / whole * (time - 0.3 * (np.cos(rate * time) - 1) / rate),
                speed,
                0.3 * self.stroke / whole * rate * np.cos(rate * time),
            )
        if self.motion == "steps":  # stops for half of the time
            phase = np.minimum(rate * time % np.pi, np.pi / 2) + np.pi * (rate * time // np.pi)
            moving = rate * time % np.pi < np.pi / 2
            turn = 2 * phase
            return (
                self.stroke * np.cos(turn),
                -2 * rate * self.stroke * np.sin(turn) * moving,
                -4 * rate**2 * self.stroke * np.cos(turn) * moving,
            )
        phase = rate * time + rng.uniform(0, 6)
        other = 0.37 * phase
        return (
            self.stroke * (np.sin(phase) + 0.3 * np.sin(other)),
            self.stroke * rate * (np.cos(phase) + 0.111 * np.cos(other)),
            -self.stroke * rate**2 * (np.sin(phase) + 0.041 * np.sin(other)),
        )


def recording_of(*plans):
    """Return the recording that plans of several kinds of table make together."""
    tables, rig = {}, RigConstants()
    for plan in plans:
        more = plan.tables()
        own = more.pop("rig")
        rig = own if rig == RigConstants() else rig
        tables |= more
    return Recording(name="drawn", title="Drawn at random", rig=rig, **tables)


def some_of(names):
    """Draw a subset, as a tuple."""
    return st.lists(st.sampled_from(names), unique=True).map(tuple)


def mostly(usual, *odd):
    """Draw a usual value in three of four, else an odd one: all odd at once tells little."""
    return st.sampled_from([*usual * (3 * len(odd) // len(usual) + 1), *odd])


PRINTED = st.characters(exclude_categories=["C", "Z"])  # no control characters, no blanks
TEXTS = st.lists(
    st.text(PRINTED, min_size=1, max_size=8) | st.text(PRINTED | st.just(" "), min_size=1),
    max_size=3,
    unique=True,
).map(tuple)
NAMES = st.just(Names()) | st.builds(Names, TEXTS)
FEW = st.integers(1, 12)
SEEDS = st.integers(0, 9999)
ROLES = st.sampled_from([0.0, 0.0, 0.3, 1.0])

BOARD_PLANS = st.builds(
    Board,
    trials=FEW | st.integers(0, 200),
    runs=st.just(0) | FEW | st.integers(0, 60),
    setups=FEW | st.integers(1, 60),
    dropped=some_of(["setup", "order", "drive_end", "role"]),
    tested=ROLES,
    slower=mostly([1.0], 1.1, 3.0),
    jitter_s=mostly([0.0], 1e-5, 1e-3),
    by_acceleration=mostly([False], True),
    names=NAMES,
    seed=SEEDS,
).filter(lambda plan: plan.trials or plan.runs)
POINT_PLANS = st.builds(
    Points,
    points=FEW | st.integers(1, 200),
    setups=FEW | st.integers(1, 60),
    columns=some_of(
        "order setup pulley_size n_pulleys wrap_angle_deg tension_n velocity_m_s friction_sd_n "
        "role".split()
    ),
    covariates=some_of(COVARIATES),
    size=mostly([1.0], 0.0, 1e-9, 1e6, -1.0),
    scatter=mostly([0.02], 0.0, 1.0),
    intercept=st.sampled_from([0.0, 0.3, 1.0]),
    same=st.booleans(),
    both_ways=st.booleans(),
    tested=ROLES,
    names=NAMES,
    seed=SEEDS,
)
CONSTANTS = st.fixed_dictionaries(
    {},
    optional={
        "rotary": st.booleans(),
        "force_is": st.sampled_from(["commanded", "motor", "link", "measured"]),
        "moving_mass_kg": st.sampled_from([1e-6, 0.5, 1e4]),
        "encoder_resolution": st.sampled_from([1e-9, 1e-4, 1e-4]),
    },
)
DRIVE_PLANS = st.builds(
    Drive,
    runs=mostly([1, 2, 3], 60),
    samples=mostly([300, 400], 10, 60, 1500),
    sampled_hz=mostly([200.0], 20.0, 50.0, 1000.0, 10000.0),
    motion=mostly(["swing"], "one way", "steps", "still", "noise"),
    force=mostly(["acts"], "constant", "none"),
    stroke=mostly([0.5], 1e-6, 10.0),
    offset=mostly([0.0], -3.0, 1e4),
    passes=mostly([4.0, 8.0], 0.5, 2.0, 30.0),
    resolution=mostly([1e-5], 1e-12, 1e-2),
    noise=mostly([0.01], 0.0, 0.3),
    size=mostly([1.0], 1e-9, 1e6),
    gravity=mostly([0.0], 2.0, 40.0),
    held=mostly([1], 4),
    jitter=mostly([0.0], 0.1, 0.9),
    lost=mostly([0.0], 0.02, 0.5),
    late_s=mostly([0.0], -0.3, 0.02, 0.5),
    columns=some_of(
        "order role setup sim_force_n sim_position_m force_time_s command_m temperature_c".split()
    ),
    covariates=some_of(COVARIATES),
    constants=CONSTANTS,
    names=NAMES,
    seed=SEEDS,
)
PLANS = st.one_of(
    st.tuples(DRIVE_PLANS),
    st.tuples(POINT_PLANS),
    st.tuples(BOARD_PLANS),
    st.tuples(BOARD_PLANS, POINT_PLANS),
    st.tuples(DRIVE_PLANS, POINT_PLANS),
)
