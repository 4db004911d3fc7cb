"""Prior and posterior density of each parameter."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullLocator

from bayesfric.plots.labels import CommonFactor, parameter_label, powers
from bayesfric.plots.style import COLORS, area_key, key, line_key, small_panels

FAINTEST = 1e-9  # of the highest density: a prior that is lower runs out of the panel


def prior_and_posterior(predictive: xr.DataTree) -> Figure:
    """Draw both densities of each parameter on one logarithmic axis, a panel a parameter.

    Parameters
    ----------
    predictive : DataTree
        ``predictive.nc`` with its group ``densities``.

    Returns
    -------
    Figure
        Over the range of the draws: the posterior as a filled histogram, the prior as a
        dashed line.
    """
    table = predictive["densities"].to_dataset()
    names = [str(name) for name in table["parameter"].to_numpy()]
    with small_panels(len(names), 12.0) as (fig, panels):
        for panel, name in zip(panels, names, strict=True):
            entry = table.sel(parameter=name)
            edge, prior = entry["value"].to_numpy(), entry["prior"].to_numpy()
            height = entry["posterior"].to_numpy()
            seen = np.concatenate([height, prior])
            least = seen[seen > FAINTEST * seen.max()].min()
            panel.set_yscale("log")
            panel.set_ylim(0.5 * least, 3 * seen.max())
            panel.stairs(height, edge, color=COLORS["sky"], fill=True, linewidth=0)
            panel.plot(edge, prior, color=COLORS["black"], linewidth=1.0, linestyle="--")
            unit = str(entry["unit"].item()).replace("1/deg", "deg⁻¹")
            panel.set_title(parameter_label(name) + (f" [{unit}]" if unit != "1" else ""))
            panel.xaxis.set_major_locator(MaxNLocator(2))
            panel.yaxis.set_major_formatter(powers())
            panel.yaxis.set_minor_locator(NullLocator())
            form = CommonFactor(useOffset=False)
            form.set_powerlimits((-2, 3))
            panel.xaxis.set_major_formatter(form)
            panel.xaxis.get_offset_text().set_fontsize(6.5)
            panel.tick_params(labelsize=6.5)
        fig.supylabel("density [1 / unit]", fontsize=8)
        keys = [
            area_key("posterior", color=COLORS["sky"]),
            line_key("prior", color=COLORS["black"], linewidth=1.0, linestyle="--"),
        ]
        key(fig, keys, side="above", ncols=2)
        return fig
