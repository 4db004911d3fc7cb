"""Predicts friction at a user's conditions, with and without the effects of a diagnosis.

The law and the effects are drawn jointly, so the prediction accounts for the part of an effect that
a recalibrated law absorbs. Effects on the board, rather than on friction, are omitted, and an
unknown force is known only at the recorded conditions. Motion is steady, and the order of measuring
is the middle one.
"""

from collections.abc import Collection, Mapping

import numpy as np
import pandas as pd

from bayesfric.arrays import Array
from bayesfric.diagnosis.drawn_effect import DrawnEffect, drawn_effect
from bayesfric.diagnosis.model import LinearModel
from bayesfric.diagnosis.systematic import Posterior
from bayesfric.diagnosis_rules import RULES
from bayesfric.effects.base import Effect
from bayesfric.errors import Fault, InputError
from bayesfric.observation.coefficients import coefficient_name
from bayesfric.physics.friction import Coefficients
from bayesfric.physics.laws import FrictionLaw
from bayesfric.rigs.base import RigTrials, Unsupported
from bayesfric.schemas.base import Interval
from bayesfric.schemas.causes import LawNumber
from bayesfric.schemas.diagnosis import ConditionAsked, FrictionAsked

RECORDED = {
    "n_pulleys": "n_pulleys",
    "wrap_angle_deg": "wrap_angle",
    "tension_n": "tension",
    "velocity_m_s": "velocity",
}
"""Covariates of rows by the column of a condition; others have their own names."""
SLACK = 1e-9  # relative tolerance at the ends of the recorded ranges


def check_target(target: pd.DataFrame, trials: RigTrials, sizes: Collection[str]) -> None:
    """Refuse conditions at which friction cannot be predicted.

    Parameters
    ----------
    target : DataFrame
        The conditions.
    trials : RigTrials
        Trials of the rig of these conditions.
    sizes : collection of str
        Pulley sizes with a law.

    Raises
    ------
    InputError
        The rig's friction is not a function of conditions, a column is missing, or a size is
        unknown.
    """
    nothing = Coefficients(*np.zeros((3, len(target))))
    if not trials.asked and isinstance(conditions := trials.at(target, nothing), Unsupported):
        raise InputError([Fault("--target", f"no conditions: {conditions.reason}")])
    faults = [
        Fault("--target", "this column, by which the recording says its conditions", column=name)
        for name in trials.asked
        if name not in target or target[name].isna().any()
    ]
    if not faults and "pulley_size" in trials.asked:
        names = ", ".join(sorted(sizes))
        faults = [
            Fault("--target", f"a pulley size of the recording: {names}", row, "pulley_size", size)
            for row, size in enumerate(target["pulley_size"], start=2)
            if size not in sizes
        ]
    if faults:
        raise InputError(faults)


def friction_at(
    target: pd.DataFrame,
    model: LinearModel,
    baseline: FrictionLaw,
    before: Mapping[str, LawNumber],
    posterior: Posterior,
    named: Collection[str],
    effects: Mapping[str, Effect],
    unknown: float,
) -> FrictionAsked:
    """Return friction at conditions, with the effects and with the law alone.

    Parameters
    ----------
    target : DataFrame
        Conditions, checked by :func:`check_target`.
    model : LinearModel
        The model in which the hypotheses were compared.
    baseline : FrictionLaw
        The friction law.
    before : mapping of str to LawNumber
        The law fitted without effects, by name of coefficient.
    posterior : Posterior
        Draws over all hypotheses.
    named : collection of str
        The causes.
    effects : mapping of str to Effect
        Examined effects by name.
    unknown : float
        Posterior probability of an unknown force.
    """
    table = posterior.law.dataset()
    forces = {name: drawn_effect(table, name, effects) for name in posterior.law.amplitude}
    drawn = {name: force for name, force in forces.items() if isinstance(force, DrawnEffect)}

    def row(condition: pd.DataFrame) -> ConditionAsked:
        size = model.layout.sizes[0]
        if "pulley_size" in model.data.rigs[0].asked:
            size = str(condition["pulley_size"].iloc[0])
        law = Coefficients(*posterior.law.coefficients[:, model.layout.sizes.index(size)].T)
        alone = _alone(model, before, size)
        return _at_condition(model, baseline, condition, law, alone, drawn, named)

    return FrictionAsked(
        unit=model.data.unit,
        rows=tuple(row(target.iloc[[place]]) for place in range(len(target))),
        stays_behind={
            name: why for name, why in forces.items() if isinstance(why, str) and name in named
        },
        unknown_probability=unknown,
    )


def _at_condition(
    model: LinearModel,
    baseline: FrictionLaw,
    condition: pd.DataFrame,
    law: Coefficients,
    alone: Coefficients,
    drawn: Mapping[str, DrawnEffect],
    named: Collection[str],
) -> ConditionAsked:
    """Return friction at one condition, from joint draws and from the law fitted alone."""
    trials = model.data.rigs[0]
    friction = _friction(trials, baseline, condition, law)
    state = trials.at(condition, law)
    assert not isinstance(state, Unsupported)
    force = {name: effect.force(state) for name, effect in drawn.items()}
    causes = sum((force[name] for name in named if name in force), np.zeros_like(friction))
    whole = friction + sum(force.values(), np.zeros_like(friction))
    shipped = float(_friction(trials, baseline, condition, alone)[0])
    return ConditionAsked(
        condition={
            str(name): value if isinstance(value, str) else float(value)
            for name, value in condition.iloc[0].items()
        },
        friction=Interval.of_draws(whole),
        gap_without_causes=Interval.of_draws(whole - shipped),
        gap_with_causes=Interval.of_draws(whole - float((friction + causes).mean())),
        outside=_outside(model, condition),
    )


def _friction(
    trials: RigTrials, baseline: FrictionLaw, condition: pd.DataFrame, law: Coefficients
) -> Array:
    """Return the friction of a law at a condition, (S,) [N]."""
    state = trials.at(condition, law)
    assert not isinstance(state, Unsupported)
    friction = baseline.at_tension(law, state.n_pulleys, state.wrap_angle_deg, state.tension_n)
    return np.atleast_1d(np.asarray(friction, dtype=np.float64))


def _alone(model: LinearModel, before: Mapping[str, LawNumber], size: str) -> Coefficients:
    """Return the law fitted alone; fixed or unidentified coefficients are as given."""
    values = []
    for name, value in zip(Coefficients._fields, model.laws[size], strict=True):
        number = before.get(coefficient_name(name, size)) or before.get(name)
        values.append(
            np.array([float(np.asarray(value)) if number is None else number.before.mean])
        )
    return Coefficients(*values)


def _outside(model: LinearModel, condition: pd.DataFrame) -> tuple[str, ...]:
    """Return the columns whose values are outside the recorded range."""
    ranges: dict[str, tuple[float, float]] = {}
    for rig in model.rigs:
        for name, values in rig.rows.covariates().items():
            low, high = ranges.get(name, (np.inf, -np.inf))
            ranges[name] = min(low, float(np.min(values))), max(high, float(np.max(values)))
    axes = []
    for column, value in condition.iloc[0].items():
        name = str(column)
        axis = RECORDED.get(name, name)
        if axis not in ranges:
            continue
        size = abs(float(value)) if axis == "velocity" else float(value)
        low, high = ranges[axis]
        slack = SLACK * max(abs(low), abs(high))
        if not low - slack <= size <= high + slack:
            axes.append(name)
    return tuple(axes)


def conditions_of(target: FrictionAsked) -> pd.DataFrame:
    """Return the conditions of a stored prediction, to repeat it."""
    return pd.DataFrame([row.condition for row in target.rows])


def target_lines(target: FrictionAsked) -> list[str]:
    """Return lines for the terminal: one for each condition, and the omitted effects."""
    lines = ["friction at the conditions of --target, and the error without and with the causes:"]
    for row in target.rows:
        where = ", ".join(f"{name} {value}" for name, value in row.condition.items())
        friction, without, with_ = row.friction, row.gap_without_causes, row.gap_with_causes
        outside = f"; outside of the recorded range: {', '.join(row.outside)}" * bool(row.outside)
        lines.append(
            f"  {where}: {row.written(friction.q50)} [{row.written(friction.q05)}, "
            f"{row.written(friction.q95)}] {target.unit}, error {row.written(without.q50)}, "
            f"with the causes {row.written(with_.q50)}{outside}"
        )
    lines += [f"  {name} does not carry over: {why}" for name, why in target.stays_behind.items()]
    if target.unknown_probability >= RULES.possible:
        lines.append(
            f"  an unknown force (probability {target.unknown_probability:.2f}) is not "
            "extrapolated to these conditions"
        )
    return lines
