"""The MuJoCo engine of joints: logs of driven joints as their controllers have them.

One to three joints follow a smooth path by a digital controller. What is withheld is put into one
joint, at a share of its friction, rms over the recording; what somebody knows of the machine
differs from world to world: nothing, the force that its rigid bodies take, or a model of it
whose masses are off.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from joint_worlds.arm import Moved, mjcf, moved
from joint_worlds.drive import Acting
from joint_worlds.forms import MECHANISMS, OUTSIDERS, Mechanism
from joint_worlds.world import (
    DRIVE,
    LOG,
    PERFECT,
    REAL,
    SHAPE,
    SIGN,
    World,
    drawn_world,
    friction_of,
    path_of,
    warmth_of,
    weight_is_unknown,
)

from bayesfric.blind.engines.reference import Made, Withheld, stream
from bayesfric.blind.engines.state import Array
from bayesfric.recording import Recording, read_recording

FULL = 0.1  # rms share of friction at strength 1
LITTLE = 1e-6  # of friction: an amplitude that moves nothing
MODEL_ERROR = 0.1  # of masses, sd
PLAIN_SHARE = 0.05  # s, over which torques are averaged where a gap is measured
SEARCHES = 3  # of the length of a play or a spring that makes a gap as large as asked for
BY_NAME = {mechanism.name: mechanism for mechanism in (*MECHANISMS, *OUTSIDERS)}


def effect_names() -> tuple[str, ...]:
    """Return the effects that may be withheld."""
    return tuple(mechanism.name for mechanism in MECHANISMS)


def outsider_names() -> tuple[str, ...]:
    """Return what may be withheld and is no effect of the package's."""
    return tuple(outsider.name for outsider in OUTSIDERS)


def make(
    withheld: Withheld,
    seed: int,
    *,
    design: str = PERFECT,
    background: bool = True,
    noise: bool = True,
    beside: bool = True,
) -> Made:
    """Make a recording with something withheld; see :func:`.reference.make`.

    Parameters
    ----------
    withheld : Withheld
        What; strength 1 is 10 % of the joint's friction, rms over the recording.
    seed : int
        Of everything.
    design : str
        ``perfect`` signals, or ``real`` ones: counts, ripple, jitter, holds.
    background, noise, beside : bool
        Of boards; a joint has all or nothing.
    """
    del background, noise, beside
    if any(name not in BY_NAME for name, _ in withheld.effects) or design not in (PERFECT, REAL):
        raise ValueError(f"no design {design!r}, or no effects {withheld.effects!r}")
    chosen = [(BY_NAME[name], strength) for name, strength in withheld.effects]
    needs = frozenset[str]().union(*(mechanism.needs for mechanism, _ in chosen))
    world = drawn_world(seed, needs, design)
    acting = [
        scaled(world, mechanism, strength, seed, place)
        for place, (mechanism, strength) in enumerate(chosen)
    ]
    runs = [moved_run(world, acting, run, seed) for run in range(world.runs)]
    joint = world.target
    truth: dict[str, Any] = {
        "kind": withheld.kind,
        "joint": f"joint{joint + 1}",
        "withheld": [
            {
                "name": mechanism.name,
                "form": mechanism.name,
                "own": mechanism.own,
                "strength": strength,
                "parameters": {"amplitude": acting_form.amplitude, **acting_form.numbers},
                "axes": list(mechanism.axes),
            }
            for (mechanism, strength), acting_form in zip(chosen, acting, strict=True)
        ],
        "noise_free_gap": _gap_by(acting, world, runs, seed),
        "beside": ["gravity-torque"] if weight_is_unknown(world) else [],
        "law": {
            "coulomb": world.arm.coulomb[joint],
            "viscous": world.arm.viscous[joint],
            "armature": world.arm.armature[joint],
            "offset": world.arm.offset[joint],
        },
        "world": asdict(world),
    }
    return Made(recorded(world, runs, seed), truth)


def _gap_by(acting: Sequence[Acting], world: World, runs: Sequence[Moved], seed: int) -> float:
    """Return the gap of runs beyond that of runs without what acts: ripple, friction's scatter."""
    if not acting:
        return 0.0
    without = [moved_run(world, (), run, seed) for run in range(world.runs)]
    return float(np.sqrt(max(0.0, gap_of(world, runs) ** 2 - gap_of(world, without) ** 2)))


def moved_run(world: World, acting: Sequence[Acting], run: int, seed: int) -> Moved:
    """Return one run of a world, with what acts in its joint."""
    goals, rates = path_of(world, run, seed)
    rng = stream(seed, DRIVE, run)
    rough = 1 + world.scatter * rng.standard_normal(world.arm.joints)
    half = world.runs / 2
    if world.tested and run < half:
        acting = [form for form in acting if form.mechanism.part != "payload"]
    arm = world.arm
    if world.loads and run >= half:
        arm = replace(arm, masses=(*arm.masses[:-1], (1 + PAYLOAD) * arm.masses[-1]))
    two_bodies = any(form.mechanism.part in ("gap", "wound") for form in acting)
    return moved(
        arm,
        replace(world.control, step_s=2.5e-4 if two_bodies else 5e-4),
        goals,
        rates,
        acting=acting,
        target=world.target,
        rough=rough,
        warmth=warmth_of(world, run),
        order=run / max(world.runs - 1, 1) - 0.5,
        seed=int(rng.integers(2**31)),
    )


PAYLOAD = 0.6  # of the last link's mass, that a payload has


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def scaled(world: World, mechanism: Mechanism, strength: float, seed: int, place: int) -> Acting:
    """Return a mechanism of a strength: 1 is 10 % of friction, rms over the first runs.

    Where that is no plausible amplitude, it has the largest that is.
    """
    numbers = mechanism.draw(stream(seed, SHAPE, place), world.scales)
    sign = -1.0 if mechanism.signed and stream(seed, SIGN, place).random() < 0.5 else 1.0
    share = FULL * strength
    at = (0, world.runs - 1)
    plain = [moved_run(world, (), run, seed) for run in at]
    friction = _rms(np.concatenate([friction_of(world, run) for run in plain]))
    wanted = share * friction
    if mechanism.part in ("gap", "wound"):
        amplitude = _length(world, mechanism, share, seed)
    elif mechanism.part == "limit":
        amplitude = _limit(world, mechanism, plain[0], wanted, seed)
    elif mechanism.part == "payload":
        moving = np.concatenate([run.acceleration[:, world.target] for run in plain])
        amplitude = wanted / _rms(np.clip(moving, *np.quantile(moving, (0.02, 0.98))))
    elif mechanism.part in ("delay_s", "lag_s"):
        command = np.concatenate([np.diff(run.command[:, world.target]) for run in plain])
        amplitude = wanted / (_rms(command) * world.control.rate_hz)
    else:
        little = Acting(mechanism, LITTLE * friction, numbers)
        runs = [moved_run(world, [little], run, seed) for run in at]
        acts = np.concatenate([run.further[friction_of(world, run) > 0] for run in runs])
        amplitude = LITTLE * friction * wanted / _rms(acts)
    if mechanism.largest is not None:
        amplitude = min(amplitude, mechanism.largest(world.scales))
    return Acting(mechanism, sign * float(amplitude), numbers)


def _limit(world: World, mechanism: Mechanism, plain: Moved, wanted: float, seed: int) -> float:
    """Return the limit beyond which as much is lost as is wanted, rms, while the loop goes on."""
    size = np.abs(plain.command[:, world.target])
    limits = np.quantile(size, np.linspace(0.5, 1.0, 200))
    would = np.array([_rms(np.maximum(size - limit, 0.0)) for limit in limits])
    asked = wanted
    for _ in range(SEARCHES):
        limit = float(limits[np.argmin(np.abs(would - asked))])
        run = moved_run(world, [Acting(mechanism, limit)], 0, seed)
        lost = _rms(run.command[:, world.target] - run.given[:, world.target])
        asked *= float(np.clip(wanted / max(lost, 1e-3 * wanted), 0.2, 5.0))
    return limit


def _length(world: World, mechanism: Mechanism, share: float, seed: int) -> float:
    """Return the play or the travel of a spring that leaves a gap of a share of friction."""
    length = 0.005 * world.stroke
    for _ in range(SEARCHES):
        run = moved_run(world, [Acting(mechanism, length)], 0, seed)
        gap = gap_of(world, [run])
        length *= float(np.clip(share / max(gap, 1e-4), 0.2, 5.0))
    return length


def gap_of(world: World, runs: Sequence[Moved]) -> float:
    """Return what the law leaves of the torque, once it is fitted again, over friction.

    The law has inertia, Coulomb and viscous friction, an offset and, where nobody knows it,
    gravity; all is averaged over some hundredths of a second, and what passes a rest is left out.
    """
    joint, width = world.target, round(PLAIN_SHARE * world.control.rate_hz)
    columns, torques, friction = [], [], []
    for number, run in enumerate(runs):
        place, speed = run.place[:, joint], run.speed[:, joint]
        of_law = [run.acceleration[:, joint], np.sign(speed), speed, np.ones(place.size)]
        if weight_is_unknown(world):
            of_law += [np.sin(place), np.cos(place)]
        if world.loads:
            carries = number >= len(runs) / 2
            pull = [np.sin(place), np.cos(place), run.acceleration[:, joint]]
            of_law += [part * carries for part in pull]
        torque = run.command[:, joint] - run.carried[:, joint] * (not weight_is_unknown(world))
        every = np.stack([*of_law, torque, friction_of(world, run)], axis=1)
        cut = every[: every.shape[0] // width * width].reshape(-1, width, every.shape[1])
        moves = (cut[:, :, -1] > 0).all(axis=1) & (np.abs(cut[:, :, 1].sum(axis=1)) == width)
        mean = cut[moves].mean(axis=1)
        columns.append(mean[:, :-2])
        torques.append(mean[:, -2])
        friction.append(mean[:, -1])
    x, y = np.concatenate(columns), np.concatenate(torques)
    left = y - x @ np.linalg.lstsq(x, y, rcond=None)[0]
    return _rms(left) / _rms(np.concatenate(friction))


def recorded(world: World, runs: Sequence[Moved], seed: int) -> Recording:
    """Return a recording of runs as the telemetry has them."""
    rig: dict[str, Any] = {"rotary": True, "force_is": world.force_is}
    rig["encoder_resolution"] = world.control.count
    several = world.knows in ("model", "others") and world.arm.joints > 1
    logged = range(world.arm.joints) if several else [world.target]
    rig["other_joints"] = "logged" if several else "still"
    if world.knows == "known-force":
        rig["known_force_sd"] = 0.005 * world.arm.coulomb[world.target]
    files: dict[str, str] = {}
    if world.knows == "model":
        rng = stream(seed, LOG)
        off = 1 + MODEL_ERROR * rng.standard_normal(world.arm.joints)
        files["arm.xml"] = mjcf(
            world.arm, masses=[m * f for m, f in zip(world.arm.masses, off, strict=True)]
        )
        names = {f"joint{j + 1}": f"joint{j + 1}" for j in logged}
        rig["robot"] = {"model": "arm.xml", "joints": names}
    header: dict[str, list[Any]] = {"run": [], "order": []}
    if world.tested:
        header["role"] = []
    if world.loads:
        header["payload_kg"] = []
    blocks: list[dict[str, Any]] = []
    for run, log in enumerate(runs):
        header["run"].append(f"r{run}")
        header["order"].append(run + 1)
        late = run >= world.runs / 2
        if world.tested:
            header["role"].append("test" if late else "calibrate")
        if world.loads:
            header["payload_kg"].append(PAYLOAD * world.arm.masses[-1] * late)
        blocks += [_rows(world, log, run, joint, several, seed) for joint in logged]
    files["axis_runs.csv"] = _text(header)
    files["axis_samples.csv"] = "".join(
        _text(block, header=place == 0) for place, block in enumerate(blocks)
    )
    return _read(files, rig)


def _rows(
    world: World, log: Moved, run: int, joint: int, several: bool, seed: int
) -> dict[str, Any]:
    """Return what the telemetry has of one joint in one run."""
    telemetry = world.telemetry
    rng = stream(seed, LOG, run, joint)
    rows = np.arange(0, log.time_s.size, telemetry.every)
    held = rows[np.arange(rows.size) // telemetry.held * telemetry.held]
    interval = telemetry.every / world.control.rate_hz
    times = log.time_s[rows] + telemetry.jitter * interval * rng.uniform(-0.5, 0.5, rows.size)
    force = (log.command if world.force_is == "commanded" else log.given)[held, joint]
    if world.force_is == "motor":
        noise = telemetry.noise * world.arm.coulomb[joint]
        force = force + noise * rng.standard_normal(rows.size)
    block: dict[str, Any] = {"run": [f"r{run}"] * rows.size}
    if several:
        block["joint"] = [f"joint{joint + 1}"] * rows.size
    block |= {"time_s": times, "position_m": log.read[held, joint], "force_n": force}
    if world.knows == "known-force":
        block["known_force_n"] = log.carried[held, joint]
    if world.warming:
        block["temperature_c"] = 30.0 + 15.0 * warmth_of(world, run)[rows]
    return block


def _text(table: Mapping[str, Sequence[Any] | Array], header: bool = True) -> str:
    cells = [
        [f"{value:.9g}" for value in values.tolist()]
        if isinstance(values, np.ndarray)
        else [str(value) for value in values]
        for values in table.values()
    ]
    lines = [",".join(row) for row in zip(*cells, strict=True)]
    return "\n".join(([",".join(table)] if header else []) + lines) + "\n"


def _read(files: Mapping[str, str], rig: Mapping[str, Any]) -> Recording:
    package = {
        "name": "joint",
        "title": "A driven joint",
        "resources": [
            {"name": "axis-runs", "path": "axis_runs.csv"},
            {"name": "axis-samples", "path": "axis_samples.csv"},
        ],
        "rig": rig,
    }
    with TemporaryDirectory() as folder:
        for name, text in {**files, "datapackage.json": json.dumps(package)}.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        return read_recording(folder)
