"""The MuJoCo engine of joints: logs of driven joints as their controllers have them.

One to three joints follow a smooth path by a digital controller. What is withheld is put into one
joint, at a share of its friction, rms over the recording; what somebody knows of the machine
differs from world to world: nothing, the force that its rigid bodies take, or a model of it
whose masses are off.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.random import Generator

from bayesfric.blind.engines.joint_arm import Acting, Arm, Control, Moved, mjcf, moved
from bayesfric.blind.engines.joint_forms import MECHANISMS, OUTSIDERS, Mechanism, Scales
from bayesfric.blind.engines.reference import Made, Withheld, stream
from bayesfric.blind.engines.state import Array
from bayesfric.recording import Recording, read_recording

FULL = 0.1  # rms share of friction at strength 1
LITTLE = 1e-6  # of friction: an amplitude that moves nothing
NATURE, PATH, SHAPE, SIGN, DRIVE, LOG = range(30, 36)
KNOWLEDGE = ("nothing", "known-force", "model", "others")
MODEL_ERROR = 0.1  # of masses, sd
PLAIN_SHARE = 0.05  # s, over which torques are averaged where a gap is measured
SEARCHES = 3  # of the length of a play or a spring that makes a gap as large as asked for
KICK = 2.0  # of Coulomb friction, that a controller's damping makes of one count at the most
MOST_KEPT = 0.9  # of the speed before, by a filter that leaves the loop damped
PERFECT, REAL = "perfect", "real"
BY_NAME = {mechanism.name: mechanism for mechanism in (*MECHANISMS, *OUTSIDERS)}


@dataclass(frozen=True)
class Telemetry:
    """How a run is logged.

    Parameters
    ----------
    every : int
        Periods of the controller from one row to the next.
    jitter : float
        Of the times of rows, as a share of the interval.
    held : int
        Rows for which both readings are repeated.
    late_s : float
        How long after its logged time a force acts [s].
    noise : float
        Of the logged force, as a share of friction.
    """

    every: int = 1
    jitter: float = 0.0
    held: int = 1
    late_s: float = 0.0
    noise: float = 0.001


@dataclass(frozen=True)
class World:
    """A machine, how it is moved, how it is logged, and what is known of it.

    Parameters
    ----------
    arm, control, telemetry : Arm, Control, Telemetry
        See there.
    stroke, speed : float
        Of the path of each joint [rad], [rad/s].
    target : int
        Place of the joint in which something may act.
    runs, seconds : int, float
        How many, and how long each is.
    knows : str
        One of :data:`KNOWLEDGE`.
    force_is : str
        ``commanded`` or ``motor``.
    rests, loads, tested, warming : bool
        Whether the path has rests, half of the runs move a payload that is written down, half of
        them are of role ``test``, and a temperature is logged.
    scatter : float
        Of friction from run to run, relative.
    """

    arm: Arm
    control: Control
    telemetry: Telemetry
    stroke: float
    speed: float
    target: int
    runs: int
    seconds: float
    knows: str
    force_is: str
    rests: bool
    loads: bool
    tested: bool
    warming: bool
    scatter: float

    @property
    def scales(self) -> Scales:
        """Sizes of the joint looked at."""
        return Scales(self.arm.coulomb[self.target], self.speed, self.stroke)


def effect_names() -> tuple[str, ...]:
    """Return the effects that may be withheld."""
    return tuple(mechanism.name for mechanism in MECHANISMS)


def outsider_names() -> tuple[str, ...]:
    """Return what may be withheld and is no effect of the package's."""
    return tuple(outsider.name for outsider in OUTSIDERS)


def drawn_world(seed: int, needs: frozenset[str], design: str) -> World:
    """Draw a world that has what mechanisms need.

    Parameters
    ----------
    seed : int
        Of the world.
    needs : frozenset of str
        See :class:`.Mechanism`.
    design : str
        ``perfect`` or ``real`` signals.
    """
    rng = stream(seed, NATURE)
    knows = str(rng.choice(KNOWLEDGE, p=(0.5, 0.2, 0.2, 0.1)))
    several = int(rng.choice((2, 3), p=(0.75, 0.25)))
    joints = {"nothing": 1, "known-force": int(rng.integers(1, 4))}.get(knows, several)
    upright = bool(rng.random() < 0.5)
    target = int(rng.integers(joints))
    if needs & {"gravity", "known"}:
        knows, upright = ("known-force" if "known" in needs else "nothing"), False
        joints, target = 1, 0
    arm = _arm(rng, joints, upright)
    real = design == REAL
    bandwidth = rng.uniform(3.0, 6.0)
    rate = float(rng.choice([200.0, 500.0, 1000.0])) if real else 500.0
    control = Control(
        rate_hz=rate,
        bandwidth_hz=float(bandwidth),
        count=float(10 ** rng.uniform(-5, -2)) if real else 1e-6,
        ripple=float(arm.coulomb[target] * (rng.uniform(0.002, 0.02) if real else 0.002)),
        waits=int(rng.integers(0, 2)) if real else 0,
        kept=float(rng.uniform(0.3, 0.8)),
    )
    if real:
        control = _without_buzz(arm, control, target)
    telemetry = _telemetry(rng, rate) if real else Telemetry()
    force_is = "commanded" if "commanded" in needs or rng.random() < 0.5 else "motor"
    return World(
        arm=arm,
        control=control,
        telemetry=telemetry,
        stroke=float(rng.uniform(0.6, 1.1)),
        speed=float(rng.uniform(1.2, 2.5)),
        target=target,
        runs=4,
        seconds=9.0 if joints == 1 else 6.0,
        knows=knows,
        force_is=force_is,
        rests=bool(rng.random() < 0.3) or "rests" in needs,
        loads=("loads" in needs) or bool(joints == 1 and not upright and rng.random() < 0.2),
        tested="tested" in needs,
        warming=bool(rng.random() < 0.2) or "warming" in needs,
        scatter=0.005,
    )


def _arm(rng: Generator, joints: int, upright: bool) -> Arm:
    """Return an arm whose friction is some share of what its links weigh."""
    masses = tuple(float(m) for m in np.sort(rng.uniform(0.6, 2.5, joints))[::-1])
    lengths = tuple(float(length) for length in rng.uniform(0.2, 0.35, joints))
    reach = np.array([sum(lengths[k:]) for k in range(joints)])
    below = np.array([sum(masses[k:]) for k in range(joints)])
    inertia = below * reach**2 / 3
    coulomb = below * reach * rng.uniform(0.4, 1.5, joints)
    return Arm(
        masses,
        lengths,
        float(rng.uniform(-np.pi, np.pi)),
        upright,
        tuple(map(float, coulomb)),
        tuple(map(float, coulomb * rng.uniform(0.1, 0.6, joints))),
        tuple(map(float, inertia * rng.uniform(0.2, 0.6, joints))),
        tuple(map(float, coulomb * rng.uniform(-0.2, 0.2, joints))),
    )


def _without_buzz(arm: Arm, control: Control, target: int) -> Control:
    """Return a controller whose damping does not kick harder at a count than :data:`KICK`.

    As somebody who tunes it would, it filters speed more, and takes a finer encoder then.
    """
    reach = sum(arm.lengths[target:])
    inertia = sum(arm.masses[target:]) * reach**2 / 3 + arm.armature[target]
    damped = 1.4 * inertia * 2 * np.pi * control.bandwidth_hz
    share = KICK * arm.coulomb[target] / (damped * control.rate_hz * control.count)
    kept = float(np.clip(1 - share, control.kept, MOST_KEPT))
    finest = KICK * arm.coulomb[target] / (damped * control.rate_hz * (1 - kept))
    return replace(control, kept=kept, count=min(control.count, float(finest)))


def _telemetry(rng: Generator, rate_hz: float) -> Telemetry:
    slowest = max(1, round(rate_hz / 100.0))
    return Telemetry(
        every=int(rng.integers(1, slowest + 1)) if rng.random() < 0.5 else 1,
        jitter=float(rng.uniform(0.0, 0.3)) if rng.random() < 0.5 else 0.0,
        held=int(rng.integers(2, 4)) if rng.random() < 0.3 else 1,
        late_s=0.0,
        noise=float(rng.uniform(0.001, 0.02)),
    )


def path_of(world: World, run: int, seed: int) -> tuple[Array, Array]:
    """Return where the joints are to be in a run, and how fast, at the controller's clock.

    Returns
    -------
    goals, rates : ndarray, shape (N, joints)
        [rad], [rad/s].
    """
    rng = stream(seed, PATH, run)
    times = np.arange(round(world.seconds * world.control.rate_hz)) / world.control.rate_hz
    flow = np.ones(times.size)
    if world.rests:
        start = rng.uniform(0.5, 1.5)
        while start < world.seconds - 2:
            length = float(rng.choice([0.2, 0.6, 1.8]))
            edges = (times - start) / 0.1, (times - start - length) / 0.1
            flow *= 1 - (np.clip(edges[0], 0, 1) - np.clip(edges[1], 0, 1))
            start += length + rng.uniform(1.0, 2.0)
    flown = np.cumsum(flow) / world.control.rate_hz
    goals, rates = np.zeros((2, times.size, world.arm.joints))
    for joint in range(world.arm.joints):
        omega = 2 * np.pi * np.array([0.21, 0.53, 1.1]) * rng.uniform(0.8, 1.25, 3)
        size = world.stroke * np.array([0.7, 0.25, 0.05]) * rng.uniform(0.7, 1.3, 3)
        size *= min(1.0, world.speed * rng.uniform(0.7, 1.0) / float(np.abs(size * omega).sum()))
        phase = np.multiply.outer(flown, omega) + rng.uniform(0, 2 * np.pi, 3)
        goals[:, joint] = np.sin(phase) @ size
        rates[:, joint] = np.cos(phase) @ (size * omega) * flow
    return goals, rates


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
        "beside": ["gravity-torque"] if _weight_is_unknown(world) else [],
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


def _weight_is_unknown(world: World) -> bool:
    return world.knows == "nothing" and not world.arm.upright


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


def warmth_of(world: World, run: int) -> Array:
    """Return how warm the joint is in a run, −0.5 to 0.5: it warms up, and cools down again."""
    count = round(world.seconds * world.control.rate_hz)
    share = (run + np.arange(count) / count) / world.runs
    return np.asarray(4 * share * (1 - share) - 0.5)


def friction_of(world: World, run: Moved) -> Array:
    """Return friction of the law in the joint looked at, 0 where it rests [N·m]."""
    speed = run.speed[:, world.target]
    size = world.arm.coulomb[world.target] + world.arm.viscous[world.target] * np.abs(speed)
    return np.asarray(size * (np.abs(speed) > world.speed * 0.01))


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
        if _weight_is_unknown(world):
            of_law += [np.sin(place), np.cos(place)]
        if world.loads:
            carries = number >= len(runs) / 2
            pull = [np.sin(place), np.cos(place), run.acceleration[:, joint]]
            of_law += [part * carries for part in pull]
        torque = run.command[:, joint] - run.carried[:, joint] * (not _weight_is_unknown(world))
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
