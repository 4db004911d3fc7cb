"""The leave-one-out figures of ``fit.json``."""

import math
from collections.abc import Mapping

from bayesfric.fitting.predictive.assemblies import FAR_SD, Assemblies
from bayesfric.fitting.predictive.left_out import FromUniform, LeftOut, uniformity
from bayesfric.inference.evidence.leave_out import ELPD
from bayesfric.schemas.fit import AssemblyCheck, OutlyingAssembly, Prediction, Uniformity


def predictions(left_out: Mapping[str, LeftOut]) -> tuple[Prediction, ...]:
    """Return the leave-one-trial-out and leave-one-setup-out densities of each board.

    Parameters
    ----------
    left_out : mapping of str to LeftOut
        By rig.
    """
    return tuple(
        entry
        for rig, left in left_out.items()
        for entry in (
            _prediction(rig, "trial", left.trials, left.trial_log_likelihood.shape[1]),
            _prediction(rig, "setup", left.setups, left.setup_log_likelihood.shape[1]),
        )
    )


def _prediction(rig: str, kind: str, elpd: ELPD | None, groups: int) -> Prediction:
    fields: dict[str, object] = {"rig": rig, "left_out": kind, "groups": groups}
    if elpd is None:
        why = "the density of one given the others is not finite for some draw"
        nothing = dict.fromkeys(("elpd", "elpd_se", "pareto_k_limit"))
        reasons = {f"{key}_why": why for key in nothing}
        return Prediction.model_validate(fields | nothing | reasons | {"bad": 0, "refitted": 0})
    se = elpd.se if math.isfinite(elpd.se) else None
    return Prediction.model_validate(
        fields
        | {
            "elpd": elpd.total,
            "elpd_se": se,
            "elpd_se_why": None if se is not None else "there is only one",
            "pareto_k_limit": elpd.limit_k,
            "bad": int(elpd.bad.sum()),
            "refitted": int(elpd.refitted.sum()),
        }
    )


def assembly_checks(assemblies: Mapping[str, Assemblies | None]) -> tuple[AssemblyCheck, ...]:
    """Return the entries of ``fit.json`` on left-out assemblies.

    Parameters
    ----------
    assemblies : mapping of str to Assemblies or None
        By rig.
    """
    entries = []
    for rig, checked in assemblies.items():
        if checked is None:
            continue
        far = [
            OutlyingAssembly(
                setup=name,
                z=float(z),
                chance=checked.chance(float(z)),
                without={
                    coefficient: float(means[place])
                    for coefficient, means in checked.without.items()
                },
            )
            for place, (name, z) in enumerate(zip(checked.names, checked.z, strict=True))
            if abs(z) > FAR_SD
        ]
        entries.append(
            AssemblyCheck(
                rig=rig,
                assemblies=checked.pit.size,
                **_spread_of(checked.uniformity),
                outlying=tuple(sorted(far, key=lambda outlier: -abs(outlier.z))),
            )
        )
    return tuple(entries)


def uniformities(left_out: Mapping[str, LeftOut]) -> tuple[Uniformity, ...]:
    """Test for each rig whether leave-one-trial-out CDF values are uniform.

    Parameters
    ----------
    left_out : mapping of str to LeftOut
        By rig.
    """
    entries = []
    for rig, left in left_out.items():
        if left.trials is None:
            continue
        uniform = uniformity(left.pit, left.again)
        entries.append(
            Uniformity(
                rig=rig,
                trials=left.pit.size,
                **_spread_of(uniform),
            )
        )
    return tuple(entries)


def _spread_of(checked: FromUniform) -> dict[str, float]:
    """Return the deviation from a uniform distribution in the form that is stored."""
    low, _, high = map(float, checked.spread_expected)
    return {
        "p_value": checked.p_value,
        "spread": checked.spread,
        "spread_q05": low,
        "spread_q95": high,
    }
