"""Held-out runs in MuJoCo, with the user's values and with those that are proposed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pandas as pd
import scipy
import xarray as xr

from bayesfric.arrays import Array, Flags, Whole
from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.errors import Fault, InputError
from bayesfric.export.joints import ExportedJoint
from bayesfric.export.joints import joints_of as joints_to_enter
from bayesfric.recording.joints import joints_of
from bayesfric.recording.tables import Recording
from bayesfric.results import identified
from bayesfric.robots import JointSettings, Robot, robot_of_bytes
from bayesfric.robots.replaying import Motion, inverse_torques, replayed
from bayesfric.schemas import DiagnosisFile
from bayesfric.schemas.base import Interval
from bayesfric.schemas.diagnosis import Replay, ReplayedError

HELD_OUT = 1 / 3  # of each run, at its end, where no run has the role test
SHOWN_S = 4.0  # of the traces that are kept
WINDOW_S = 0.2  # of a replayed trajectory
FEWEST = 8  # samples of it
SMOOTHED_S, DEGREE = 0.04, 3  # on either side of a sample, and of the polynomial through them
GAP = 3.0  # intervals without a sample, over which nothing is replayed
SLOW = 0.05  # of the top speed: below it nobody knows which way friction acts
BLOCK_S = 2.0  # of stretches that are drawn anew together
MOST_SAMPLES, MOST_WINDOWS = 6000, 400
RESAMPLED = 2000
LEAST_GAIN = 0.05  # of the error as it is: what a proposal gains at the least, to be promoted
FEWEST_BLOCKS = 5
NO_MODEL = "a robot's model (rig.robot), to replay runs in"
NO_FORCE = "a drive force (force_n): runs are replayed from it, and a log of commands has none"
SPLIT = "the unseen last third of each run"
BY_ROLE = "the runs of role test"


@dataclass(frozen=True)
class _Piece:
    """A stretch of a run without gaps."""

    motion: Motion
    blocks: Whole  # (N,), of each sample


def held_out_parts(recording: Recording) -> tuple[Recording, Recording, str]:
    """Return what is diagnosed, what is held out, and which that is in words.

    Parameters
    ----------
    recording : Recording
        With a robot's model.

    Raises
    ------
    InputError
        It has no model, or no samples of driven joints.
    """
    axis = recording.axis
    if axis is None or recording.rig.robot is None:
        raise InputError([Fault("--replay", NO_MODEL)])
    if "force_n" not in axis.samples:
        raise InputError([Fault("--replay", NO_FORCE)])
    if "role" in axis.runs and (axis.runs["role"] == "test").any():
        tested = axis.runs[axis.runs["role"] == "test"]
        return recording, _with(recording, tested, axis.samples), BY_ROLE
    spans = axis.samples.groupby("run", sort=False)["time_s"].agg(["min", "max"])
    cut = spans["max"] - HELD_OUT * (spans["max"] - spans["min"])
    late = axis.samples["time_s"] > axis.samples["run"].map(cut)
    early = _with(recording, axis.runs, axis.samples[~late])
    return early, _with(recording, axis.runs, axis.samples[late]), SPLIT


def with_replay(diagnosed: Diagnosed, held_out: Recording, what: str, seed: int) -> Diagnosed:
    """Return a diagnosis with what its numbers to enter do on runs that it has not seen.

    Parameters
    ----------
    diagnosed : Diagnosed
        Of joints.
    held_out, what, seed
        As of :func:`replay`.
    """
    summary = diagnosed.summary
    done = replay(held_out, what, joints_to_enter(summary, diagnosed.curves), seed)

    def block(own: DiagnosisFile) -> DiagnosisFile:
        replayed_joint = done.joints.get(own.joint or "")
        if replayed_joint is None:
            return own
        return own.model_copy(update={"replay": replayed_joint, "replay_why": None})

    joints = tuple(block(own) for own in summary.joints)
    summary = block(summary).model_copy(update={"joints": joints})
    curves = xr.DataTree(
        children={**diagnosed.curves.children, "replay": xr.DataTree(dataset=done.traces)}
    )
    return replace(diagnosed, summary=identified(summary), curves=curves)


class Replayed(NamedTuple):
    """What came of a replay.

    Parameters
    ----------
    joints : dict of str to Replay
        By name in the log.
    traces : Dataset
        A stretch of the drive forces, (joint, time): ``measured_n``, and what the model asks for
        with the user's values, ``as_is_n``, and with the proposed ones, ``proposed_n``.
    """

    joints: dict[str, Replay]
    traces: xr.Dataset


def replay(held_out: Recording, what: str, joints: Sequence[ExportedJoint], seed: int) -> Replayed:
    """Replay runs with the user's values and with those that are proposed.

    Parameters
    ----------
    held_out : Recording
        Runs that the values were not made with.
    what : str
        Which these are, in words.
    joints : sequence of ExportedJoint
        With the values; other joints keep those of the model.
    seed : int
        For the intervals.

    Raises
    ------
    InputError
        The model cannot be used, or too little was held out.
    """
    robot = _robot(held_out)
    given = {joint.name or robot.joints[0]: joint for joint in joints}
    before = robot.settings
    after = tuple(
        _proposed(given[name], own) if name in given else own
        for name, own in zip(robot.joints, before, strict=True)
    )
    pieces = _pieces(held_out, robot)
    late = [_delay(given.get(name)) for name in robot.joints]
    torque = _torque_errors(robot, before, after, pieces, late)
    path = _path_errors(robot, before, after, pieces, late)
    rng = np.random.default_rng(seed)
    judged = {}
    for place, name in enumerate(robot.joints):
        if name in given:
            errors = [_error(of, place, rng) for of in (torque, path)]
            judged[given[name].name] = _judged(what, len(path.blocks), *errors)
    return Replayed(judged, _traces(robot, before, after, pieces[0].motion))


@dataclass(frozen=True)
class _Errors:
    """Squared errors of rows with both values, and the squares that they are shares of."""

    blocks: Whole  # (R,)
    before: Array  # (R, J)
    after: Array
    whole: Array


def _with(recording: Recording, runs: pd.DataFrame, samples: pd.DataFrame) -> Recording:
    assert recording.axis is not None
    kept = samples[samples["run"].isin(runs["run"])].reset_index(drop=True)
    axis = replace(recording.axis, runs=runs.reset_index(drop=True), samples=kept)
    return replace(recording, axis=axis)


def _robot(recording: Recording) -> Robot:
    model, names = recording.rig.robot, joints_of(recording.axis)
    assert model is not None
    logged = {name: model.joints[name] for name in names or tuple(model.joints)[:1]}
    return robot_of_bytes(
        model.model, model.content, logged, recording.rig.gravity_m_s2, model.files
    )


def _proposed(joint: ExportedJoint, own: JointSettings) -> JointSettings:
    def value(name: str, otherwise: float, least: float = 0.0) -> float:
        return max(joint.numbers[name].value.mean, least) if name in joint.numbers else otherwise

    powers = ("viscous", "air-drag.coefficient", "cubic-drag.coefficient")
    damping = tuple(value(name, old) for name, old in zip(powers, own.damping, strict=True))
    return JointSettings(
        frictionloss=value("coulomb", own.frictionloss),
        armature=value(joint.inertia or "", own.armature),
        damping=(damping[0], damping[1], damping[2]),
        stiffness=value("spring.stiffness", own.stiffness),
        spring_rest=value("spring.rest", own.spring_rest, -np.inf),
    )


def _delay(joint: ExportedJoint | None) -> float:
    number = None if joint is None else joint.numbers.get("delay.time")
    return 0.0 if number is None else max(number.value.mean, 0.0)


def _pieces(recording: Recording, robot: Robot) -> list[_Piece]:
    """Return runs on even grids, smoothed, without stretches in which nothing was logged."""
    assert recording.axis is not None
    samples, pieces, block = recording.axis.samples, [], 0
    for _, run in samples.groupby("run", sort=False):
        by_joint = dict(iter(run.groupby("joint", sort=False))) if "joint" in run else None
        if by_joint is not None and not set(robot.joints) <= set(by_joint):
            continue  # where the others are, nobody knows
        logs = [run if by_joint is None else by_joint[name] for name in robot.joints]
        time = logs[0]["time_s"].to_numpy()
        if time.size < 2 * FEWEST:
            continue
        interval = float(np.median(np.diff(time)))
        for first, last in _stretches(logs, interval):
            grid = np.arange(first, last, interval)
            half = max(DEGREE + 2, round(SMOOTHED_S / interval))
            if grid.size < 4 * max(half, FEWEST):
                continue
            motion = _motion(logs, grid, interval, half)
            since = interval * np.arange(len(motion.position))
            blocks = block + (since / BLOCK_S).astype(np.intp)
            block = int(blocks[-1]) + 1
            pieces.append(_Piece(motion, blocks))
    if not pieces or block < FEWEST_BLOCKS:
        expected = f"at least {FEWEST_BLOCKS * BLOCK_S:.0f} s of all joints that are held out"
        raise InputError([Fault("--replay", expected, value=f"{block * BLOCK_S:.0f} s")])
    return pieces


def _stretches(logs: Sequence[pd.DataFrame], interval: float) -> list[tuple[float, float]]:
    """Return from when to when all joints are logged without a gap."""
    first = max(float(log["time_s"].iloc[0]) for log in logs)
    last = min(float(log["time_s"].iloc[-1]) for log in logs)
    time = logs[0]["time_s"].to_numpy()
    gaps = np.flatnonzero(np.diff(time) > GAP * interval)
    edges = [first, *(float(t) for gap in gaps for t in (time[gap], time[gap + 1])), last]
    pairs = zip(edges[::2], edges[1::2], strict=True)
    return [(begin, end) for begin, end in pairs if end > begin]


def _motion(logs: Sequence[pd.DataFrame], grid: Array, interval: float, half: int) -> Motion:
    read = np.stack([np.interp(grid, log["time_s"], log["position_m"]) for log in logs], axis=1)
    force = np.stack([np.interp(grid, log["time_s"], log["force_n"]) for log in logs], axis=1)
    smooth = [
        scipy.signal.savgol_filter(read, 2 * half + 1, DEGREE, deriv=order, delta=interval, axis=0)
        for order in (0, 1, 2)
    ]
    inside = slice(half, len(grid) - half)  # at the ends a polynomial is extrapolated
    position, velocity, acceleration = (values[inside] for values in smooth)
    return Motion(interval, position, velocity, acceleration, force[inside])


def _late(motion: Motion, delays: Sequence[float]) -> Motion:
    """Return a motion whose forces act so much later than they were logged."""
    if not any(delays):
        return motion
    time = np.arange(len(motion.force)) * motion.interval_s
    columns = [
        np.interp(time - delay, time, force)
        for delay, force in zip(delays, motion.force.T, strict=True)
    ]
    return replace(motion, force=np.stack(columns, axis=1))


def _traces(
    robot: Robot,
    before: Sequence[JointSettings],
    after: Sequence[JointSettings],
    motion: Motion,
) -> xr.Dataset:
    count = min(len(motion.position), round(SHOWN_S / motion.interval_s))
    shown = motion.some(slice(count))
    forces = {
        "measured_n": shown.force,
        "as_is_n": inverse_torques(robot, before, shown),
        "proposed_n": inverse_torques(robot, after, shown),
    }
    return xr.Dataset(
        {name: (("joint", "time_s"), values.T) for name, values in forces.items()},
        {"joint": list(robot.joints), "time_s": motion.interval_s * np.arange(count)},
    )


def _torque_errors(
    robot: Robot,
    before: Sequence[JointSettings],
    after: Sequence[JointSettings],
    pieces: Sequence[_Piece],
    late: Sequence[float],
) -> _Errors:
    every = max(1, -(-sum(len(piece.blocks) for piece in pieces) // MOST_SAMPLES))
    top = np.max([np.abs(piece.motion.velocity).max(axis=0) for piece in pieces], axis=0)
    parts = []
    for piece in pieces:
        drawn = piece.motion.some(slice(None, None, every))
        moves: Flags = np.abs(drawn.velocity) > SLOW * top
        delayed = _late(piece.motion, late).some(slice(None, None, every))
        off = [
            np.where(moves, inverse_torques(robot, joints, drawn) - motion.force, 0.0)
            for joints, motion in ((before, drawn), (after, delayed))
        ]
        parts.append((*off, np.where(moves, drawn.force, 0.0)))
    blocks = np.concatenate([piece.blocks[::every] for piece in pieces])
    squares = [np.concatenate([part[k] for part in parts]) ** 2 for k in range(3)]
    return _Errors(blocks, *squares)


def _path_errors(
    robot: Robot,
    before: Sequence[JointSettings],
    after: Sequence[JointSettings],
    pieces: Sequence[_Piece],
    late: Sequence[float],
) -> _Errors:
    total = sum(len(piece.motion.position) * piece.motion.interval_s for piece in pieces)
    apart_s = max(WINDOW_S, total / MOST_WINDOWS)
    parts, blocks = [], []
    for piece in pieces:
        motion = piece.motion
        samples = max(FEWEST, round(WINDOW_S / motion.interval_s))
        hop = max(samples, round(apart_s / motion.interval_s))
        starts = np.arange(0, len(motion.position) - samples - 1, hop)
        measured = np.stack([motion.position[start : start + samples] for start in starts])
        off = [
            ((replayed(robot, joints, driven, starts.tolist(), samples) - measured) ** 2).mean(1)
            for joints, driven in ((before, motion), (after, _late(motion, late)))
        ]
        moved = ((measured - measured[:, :1]) ** 2).mean(axis=1)
        parts.append((*off, moved))
        blocks.append(piece.blocks[starts])
    squares = [np.concatenate([part[k] for part in parts]) for k in range(3)]
    return _Errors(np.concatenate(blocks), *squares)


def _error(errors: _Errors, place: int, rng: np.random.Generator) -> ReplayedError:
    """Return both errors as shares, and their difference with its interval by blocks."""
    _, block = np.unique(errors.blocks, return_inverse=True)
    sums = [
        np.bincount(block, values[:, place])
        for values in (errors.before, errors.after, errors.whole)
    ]
    count = len(sums[0])
    drawn = rng.multinomial(count, np.full(count, 1 / count), RESAMPLED)
    before, after, whole = (np.append(drawn, np.ones((1, count)), axis=0) @ total for total in sums)
    whole = np.where(whole > 0, whole, 1.0)
    shares = np.sqrt(before / whole), np.sqrt(after / whole)
    difference = (shares[1] - shares[0])[:-1]
    return ReplayedError(
        as_is=float(shares[0][-1]),
        proposed=float(shares[1][-1]),
        difference=Interval.of_draws(difference, ddof=1),
    )


def _judged(what: str, windows: int, torque: ReplayedError, path: ReplayedError) -> Replay:
    """Promote values that surely take a twentieth of the torque's error away, and harm no path."""
    gains = torque.difference.q95 < -LEAST_GAIN * torque.as_is
    worse = path.difference.q05 > 0
    promoted = gains and not worse
    interval = torque.difference
    moved = (
        f"the torque error on {what} goes from {torque.as_is:.1%} to {torque.proposed:.1%} "
        f"(difference {interval.mean:+.1%}, 90 % interval {interval.q05:+.1%} to "
        f"{interval.q95:+.1%}), the error of trajectories over {WINDOW_S:g} s from "
        f"{path.as_is:.1%} to {path.proposed:.1%}"
    )
    why = (
        "the proposed values are better"
        if promoted
        else "the trajectories become worse"
        if gains
        else f"the 90 % interval does not show a torque error smaller by {LEAST_GAIN:.0%} of itself"
    )
    return Replay(
        held_out=what,
        windows=windows,
        torque=torque,
        trajectory=path,
        promoted=promoted,
        sentence=f"{'Promoted' if promoted else 'Not promoted'}: {why}; {moved}.",
    )
