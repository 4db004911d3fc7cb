"""The trials of each rig that was fitted, as ``predictive.nc`` holds them.

A rig's group is called what several of its trials are called and says so itself: ``rig``,
``title``, ``trial``, ``trials``, ``group`` and ``id`` are attributes of it.
"""

from dataclasses import dataclass

import xarray as xr


@dataclass(frozen=True)
class RigTable:
    """Trials of one rig: what was measured, and what is predicted of new ones.

    Parameters
    ----------
    rig, title : str
        Its name in files, and in sentences.
    trial, trials : str
        What one of its measurements is called, and several.
    group : str
        What its measurements of one ``setup`` are called together.
    id : str
        The dimension of ``table``, whose coordinate is the trials' ids.
    table : Dataset
        A trial a row.
    checks : Dataset or None
        Coverage and leave-one-out checks over all of them.
    assemblies : Dataset or None
        Assemblies that were left out one at a time.
    """

    rig: str
    title: str
    trial: str
    trials: str
    group: str
    id: str
    table: xr.Dataset
    checks: xr.Dataset | None
    assemblies: xr.Dataset | None = None

    @property
    def count(self) -> int:
        """How many trials there are."""
        return int(self.table.sizes[self.id])

    @property
    def sizes(self) -> list[str]:
        """Pulley size of each trial, one name for all where the rig has no pulleys."""
        if "pulley_size" not in self.table:
            return [self.title] * self.count
        return [str(size) for size in self.table["pulley_size"].to_numpy()]


def rig_tables(predictive: xr.DataTree) -> tuple[RigTable, ...]:
    """Return the trials of each rig, in the order in which they are stored.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc``.
    """
    tables = []
    for name in predictive.children:
        table = predictive[name].to_dataset()
        if "rig" not in table.attrs:
            continue
        words = {key: str(table.attrs[key]) for key in ("rig", "title", "trial", "trials", "id")}
        words["group"] = str(table.attrs.get("group", "assembly"))  # earlier files do not say
        checks, assemblies = (
            predictive[group].to_dataset() if group in predictive.children else None
            for group in (f"{words['trial']}_checks", f"{words['trial']}_assemblies")
        )
        tables.append(
            RigTable(
                **words,
                table=table,
                checks=checks,
                assemblies=assemblies,
            )
        )
    return tuple(tables)
