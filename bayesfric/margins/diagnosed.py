"""A loop with the law that a diagnosis refitted, and with the effects on friction.

Coefficients and amplitudes are drawn together over all hypotheses. No part of an effect is then
included twice, and each hypothesis has draws in proportion to its probability. Only effects on
friction are transferred to another machine. Effects on the drive, the sensors or the currents of a
board are not; the law was fitted together with them, so it contains no part of them.

Effects become friction of the loop. The part that is present at every speed is Coulomb friction,
the part that grows with speed is viscous, and the part that falls is extra friction at rest that
decays with speed.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from bayesfric.arrays import Array
from bayesfric.diagnosis.drawn_effect import DrawnEffect, drawn_effect
from bayesfric.effects import all_effects
from bayesfric.effects.base import State
from bayesfric.errors import Fault, InputError
from bayesfric.margins.assembly import Assembly
from bayesfric.margins.cable_stage import lost_motion
from bayesfric.margins.loop_at_shaft import LoopAtShaft
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.posterior import Posterior
from bayesfric.margins.reflecting import at_shaft
from bayesfric.physics.friction import Coefficients
from bayesfric.results import read_beside, read_json
from bayesfric.schemas import DiagnosisFile
from bayesfric.stored_names import variable_of

LEAST_SPEED = 0.1
"""Cable speed up to which an effect is evaluated if the file has no peak speed [m/s]."""
SPEEDS = 60


@dataclass(frozen=True)
class Diagnosed:
    """The law that a diagnosis refitted and the effects that may act, for a loop.

    Parameters
    ----------
    posterior : Posterior
        The refitted law with the effects on friction, with as many draws as the fit has.
    left_out : tuple of str
        Effects that are left out, with the reason.
    """

    posterior: Posterior
    left_out: tuple[str, ...]

    @property
    def finds_something(self) -> bool:
        """Whether any effect is named, or may act."""
        return bool(self.posterior.acting or self.left_out)


def read_diagnosed(path: Path, fitted: Posterior, seed: int) -> Diagnosed:
    """Read the law that a diagnosis refitted.

    Parameters
    ----------
    path : Path
        ``diagnosis.json``, with ``diagnosis.nc`` beside it.
    fitted : Posterior
        The fit: it sets the number of draws, and the conditions that were measured.
    seed : int
        Of the analysis.

    Raises
    ------
    InputError
        A file is missing, the files are of two runs, or have no refitted law.
    """
    record = read_json(DiagnosisFile, path)
    tree = read_beside(record, path.with_suffix(".nc"))
    if "law" not in tree.children:
        expected = "the refitted law: run `bayesfric diagnose` again"
        raise InputError([Fault(str(path.with_suffix(".nc")), expected)])
    table = tree["law"].to_dataset()
    of_sizes = {variable_of(f"omega[{size}]") for size in table["pulley"].to_numpy()}
    if not {*SCATTER, *of_sizes} & set(table):
        raise InputError([Fault(str(path), "a diagnosis of a gravity or a motor board")])
    order = np.random.default_rng([seed, 9]).permutation(
        np.resize(np.arange(table.sizes["draw"]), fitted.count)
    )
    table = table.isel(draw=order)
    named = [entry.effect for entry in (*record.causes, *record.present, *record.possible)]
    acting, left_out = [], []
    for name in named:
        effect = drawn_effect(table, name, all_effects())
        if isinstance(effect, str):
            left_out.append(f"{name}: {effect}")
        else:
            acting.append(effect)
    posterior = replace(_refitted(table, fitted), acting=tuple(acting), refitted=True)
    return Diagnosed(posterior, tuple(left_out))


def _refitted(table: xr.Dataset, fitted: Posterior) -> Posterior:
    sizes = [str(size) for size in table["pulley"].to_numpy()]
    scatter = next((name for name in SCATTER if name in table), "")
    return replace(
        fitted,
        coefficients={
            size: Coefficients(*(_values(table[name].sel(pulley=size)) for name in COLUMNS))
            for size in sizes
        },
        omega={
            size: _values(
                table[own if (own := variable_of(f"omega[{size}]")) in table else scatter]
            )
            for size in sizes
        },
        effective_draws=min(fitted.effective_draws, float(np.unique(_values(table["c1"])).size)),
    )


COLUMNS = Coefficients._fields
SCATTER = ("omega", "omega_motor")  # scatter of assemblies, by board


def _values(column: xr.DataArray) -> Array:
    return np.asarray(column.to_numpy(), dtype=np.float64)


def reflected(loop: Loop, given: Assembly, estimate: float | None = None) -> LoopAtShaft:
    """Reflect a loop to the motor's shaft, with the effects on friction of its assembly.

    Parameters
    ----------
    loop : Loop
        The file.
    given : Assembly
        Its numbers, the friction law, and the effects beside it.
    estimate : float or None
        As for :func:`bayesfric.margins.reflecting.at_shaft`.
    """
    shaft = at_shaft(loop, given, estimate=estimate)
    if not given.acting:
        return shaft
    after = with_effects(shaft, given)
    return after if estimate is None else replace(after, estimate=shaft.estimate)


def with_effects(shaft: LoopAtShaft, given: Assembly) -> LoopAtShaft:
    """Return a loop with the effects of its assembly added to its friction.

    If a compensator takes its estimate from the law, it is the law with the effects.

    Parameters
    ----------
    shaft : LoopAtShaft
        The loop with the refitted law.
    given : Assembly
        The numbers from which it was made, and the effects.
    """
    rho, rest = shaft.cable_per_rad, np.zeros(given.draws)
    top = np.maximum(shaft.peak_velocity * rho, LEAST_SPEED)
    rising, falling, slope = np.zeros((3, given.draws))
    for effect in given.acting:
        low, high, fallen_at = _curve(partial(_force, effect, shaft, given), top)
        rest += np.minimum(low, high)
        rising += np.maximum(high - low, 0.0) / (top / rho)
        fall = np.maximum(low - high, 0.0)
        falling += fall
        slope += fall / (fallen_at / rho)
    ends = shaft.drive_friction + shaft.joint_friction + shaft.shaft_friction
    cable = np.maximum(shaft.cable_friction + rho * rest, 0.0)
    friction = cable + ends
    falling = rho * falling
    before = np.divide(cable, shaft.cable_friction, out=np.ones_like(cable),
                       where=shaft.cable_friction > 0.0)  # fmt: skip
    stages = tuple(
        replace(stage, friction=stage.friction * before, lost=stage.lost * before)
        for stage in shaft.stages
    )
    after = replace(
        shaft,
        friction=friction,
        falling=falling,
        falling_speed=np.divide(falling, rho * slope, out=np.ones_like(falling), where=slope > 0),
        motor_viscous=shaft.motor_viscous + rho * rising,
        stages=stages,
        lost_motion=lost_motion(stages, shaft.shaft_friction, shaft.joint_friction),
        estimate=shaft.estimate
        if shaft.loop.compensation.estimate_n_m is not None
        else np.full(given.draws, float(friction.mean())),
    )
    return replace(after, kick=shaft.kick * after.breakaway / shaft.breakaway)


def _curve(force: Callable[[Array], Array], top: Array) -> tuple[Array, Array, Array]:
    """Return a force at rest and at top speed, and the speed at 1 − 1/e of the way between.

    Parameters
    ----------
    force : callable
        Cable speeds, shape (draws,), to forces [N].
    top : ndarray, shape (draws,)
        Top speed of the cable [m/s].
    """
    low, high = force(np.zeros_like(top)), force(top)
    left = low - (low - high) * (1 - np.exp(-1.0))
    fallen_at = top.copy()
    for share in np.geomspace(1.0, 1e-4, SPEEDS):
        fallen_at = np.where(force(share * top) <= left, share * top, fallen_at)
    return low, high, fallen_at


def _force(effect: DrawnEffect, shaft: LoopAtShaft, given: Assembly, speed: Array) -> Array:
    """Return the friction that an effect adds at a speed of the motor's cable [N]."""
    total = np.zeros(given.draws)
    per_rad = {key: stage.per_rad for stage in shaft.stages for key in stage.keys}
    for key, run in shaft.loop.every_run:
        ratio = per_rad[key] / shaft.cable_per_rad
        sides = 2 if run.topology == "antagonist-pair" else 1
        c1, c2, c3 = map(np.asarray, given.coefficients[run.pulley_size])
        factor = given.factor[key]
        state = State.of(
            Coefficients(c1 * factor, c2 * given.factor_of_c2[key], c3 * factor),
            run.count,
            float(np.mean(run.angles_deg)),
            given[f"{key}.tension_n"],
            ratio * speed,
            steady=True,
        )
        total += ratio * sides * effect.force(state)
    return total
