"""Stored draws of the claims' law and of its rivals, in a form that ArviZ can compare."""

from collections.abc import Collection, Mapping

import numpy as np
import xarray as xr

from bayesfric.claims.studies import Studied, Task
from bayesfric.stored_names import variable_of

NOT_BEST = "of a claim's rivals only the draws of the best are kept"


def models_kept(studied: Mapping[Task, Studied], chosen: Collection[Task]) -> dict[str, xr.Dataset]:
    """Return the groups of ``claims.nc`` that contain draws.

    Parameters
    ----------
    studied : mapping of Task to Studied
        The studies of all hypotheses.
    chosen : collection of Task
        Tasks whose draws are stored, if there are any.

    Returns
    -------
    dict of str to Dataset
        By the path of the group. ``models``: by ``hypothesis``, such as ``gravity/paper``, why
        there are no draws of it, empty where there are. Below it, of each that has some,
        ``HYPOTHESIS/posterior``, the parameters over ``chain`` and ``draw``, and
        ``HYPOTHESIS/log_likelihood``, ``assembly`` over ``setup`` as in ``draws.nc``.
    """
    whole = {task: study for task, study in studied.items() if task.whole and not task.apart}
    if not whole:
        return {}
    names = {task: f"{task.data}/{task.hypothesis.label}" for task in whole}
    why = [study.why or ("" if task in chosen else NOT_BEST) for task, study in whole.items()]
    groups = {
        "models": xr.Dataset(
            {"why": ("hypothesis", np.array(why))}, coords={"hypothesis": list(names.values())}
        )
    }
    for task, study in whole.items():
        if study.kept is None or task not in chosen:
            continue
        chains, draws, _ = study.kept.log_likelihood.shape
        place = {"chain": np.arange(chains), "draw": np.arange(draws)}
        groups[f"models/{names[task]}/posterior"] = xr.Dataset(
            {
                variable_of(name): (("chain", "draw"), values)
                for name, values in study.kept.theta.items()
            },
            coords=place,
        )
        groups[f"models/{names[task]}/log_likelihood"] = xr.Dataset(
            {"assembly": (("chain", "draw", "setup"), study.kept.log_likelihood)},
            coords=place | {"setup": list(study.kept.setups)},
        )
    return groups
