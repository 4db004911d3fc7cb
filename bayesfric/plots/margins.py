"""Controller margins: hunting against gain, Nyquist fans, errors, headroom, and following."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bayesfric.arrays import Array
from bayesfric.margins.terms import draws_behind, standard_error
from bayesfric.plots.labels import numbers, plain
from bayesfric.plots.style import COLORS, LINES, MARKERS, NEUTRAL, SHADES, figure, key
from bayesfric.schemas.loop_runs import Following, HuntingMap
from bayesfric.schemas.margins import QUANTILE_LEVELS, Bode, LoopMargins, Metric, NyquistFan

ERRORS = ("steady_error_servo", "lost_motion", "reversal_error")
RISEN = 0.99  # of a probability: beyond, a curve shows nothing new
PAST = 1.15  # of the last thing to be seen, how far an axis reaches
HEADROOMS = ("headroom_clip", "headroom_continuous")
WORDS = {
    "steady_error_servo": "steady error",
    "lost_motion": "lost motion",
    "reversal_error": "reversal",
    "headroom_clip": "clipped",
    "headroom_continuous": "continuous",
}


def limit_cycle_against_gain(loops: Sequence[LoopMargins]) -> Figure:
    """Draw P(limit cycle) over the compensation gain, a line a loop.

    Parameters
    ----------
    loops : sequence of LoopMargins
        Those with a curve; the spec of each is a thin line, its own γ a marker.
    """
    with figure(height=33.0) as fig:
        axes = fig.subplots()
        for place, loop in enumerate(loops):
            color = SHADES[place % len(SHADES)]
            gamma, p, error = hunting_curve(loop)
            low, high = np.clip(p - 2 * error, 0, 1), np.clip(p + 2 * error, 0, 1)
            axes.fill_between(gamma, low, high, color=color, alpha=0.3, linewidth=0)
            axes.plot(gamma, p, color=color, linestyle=LINES[place % len(LINES)],
                      label=plain(loop.name))  # fmt: skip
            axes.plot(
                loop.compensation_gain,
                np.interp(loop.compensation_gain, gamma, p),
                MARKERS[place % len(MARKERS)],
                color=color,
                markersize=5.0,
                zorder=4,
                clip_on=False,
            )
            axes.axhline(
                loop.limit_cycle_probability_max, color=NEUTRAL, linewidth=0.7, linestyle=":"
            )
            if loop.largest_safe_compensation_gain is not None:
                # Rounded down, as the text has it.
                safe = np.floor(100 * loop.largest_safe_compensation_gain) / 100
                axes.axvline(safe, color=color, linewidth=0.8, alpha=0.6)
        axes.set_xlabel("compensation gain γ")
        axes.set_ylabel("P(hunting)")
        axes.set_ylim(-0.02, 1.02)
        axes.set_xlim(0, max(map(_reach, loops)))
        if len(loops) > 1:
            key(fig, axes.get_legend_handles_labels()[0], ncols=3)
    return fig


def hunting_curve(loop: LoopMargins) -> tuple[Array, Array, Array]:
    """Return γ, P(limit cycle) and its error: of the stored curve, and of the quantiles of γ.

    The stored curve may step from 0 to 1 between two γ; the quantiles lie on that step, where
    the Monte Carlo error is largest.

    Parameters
    ----------
    loop : LoopMargins
        With a curve.
    """
    points = [(point.gamma, point.p, point.mcse) for point in loop.limit_cycle_probability]
    draws = draws_behind(loop.limit_cycle_probability)
    last = points[-1][0]
    for metric in loop.metrics:
        if metric.name == "gamma_hunting":
            points += [
                (value, p, standard_error(p, draws))
                for value, p in zip(metric.quantiles, QUANTILE_LEVELS, strict=False)
                if value <= last
            ]
    gamma, p, error = np.array(sorted(points)).T
    return gamma, np.maximum.accumulate(p), error


def _reach(loop: LoopMargins) -> float:
    """Return up to which γ a loop's curve is drawn: past its rise, and past the γ of its file."""
    last = max(point.gamma for point in loop.limit_cycle_probability)
    risen = [point.gamma for point in loop.limit_cycle_probability if point.p >= RISEN]
    return min(last, PAST * max(loop.compensation_gain, risen[0] if risen else last))


def hunting_over_speed(chart: HuntingMap) -> Figure:
    """Draw P(limit cycle) and the error at the tip over reference speed and gain.

    Where no draw hunts anywhere, the error alone.

    Parameters
    ----------
    chart : HuntingMap
        Cells in the order of the file, evenly spaced: neither axis is a scale.
    """
    speeds = [f"{1e3 * speed:.2g}" for speed in chart.speed_tip_m_s]
    gammas = [f"{gamma:g}" for gamma in chart.gamma]
    hunts, errors = np.array(chart.probability), 1e3 * np.array(chart.rms_error_m)
    panels = [(errors, "rms error at the tip [mm]", float(errors.max()))]
    if hunts.any():
        panels.insert(0, (hunts, "P(limit cycle)", 1.0))
    with figure(height=80.0) as fig:
        places = fig.subplots(1, len(panels), squeeze=False)[0]
        for axes, (values, title, top) in zip(places, panels, strict=True):
            axes.imshow(values, origin="lower", aspect="auto", cmap="Greys", vmin=0.0, vmax=top)
            for (row, column), value in np.ndenumerate(values):
                axes.text(column, row, f"{value:.2g}", fontsize=5.0, ha="center", va="center",
                          color="white" if value > 0.55 * top else "black")  # fmt: skip
            axes.set_xticks(range(len(speeds)), speeds)
            axes.set_yticks(range(len(gammas)), gammas)
            axes.grid(visible=False)  # lines through the middle of a cell strike its number out
            axes.set_xlabel("reference speed at the tip [mm/s]")
            axes.set_title(title)
        fig.axes[0].set_ylabel("compensation gain γ")
    return fig


def nyquist_fan(fans: Sequence[NyquistFan]) -> Figure:
    """Draw L(jω) of some draws, and what friction sees with −1/N(A).

    Parameters
    ----------
    fans : sequence of NyquistFan
        Of one loop; a direction each has its own colour.
    """
    with figure(height=68.0) as fig:
        left, right = fig.subplots(1, 2)
        for axes, what in ((left, "loop"), (right, "seen-by-friction")):
            for place, fan in enumerate(
                fan_of_kind for fan_of_kind in fans if fan_of_kind.what == what
            ):
                for number, (real, imag) in enumerate(zip(fan.real, fan.imag, strict=True)):
                    axes.plot(
                        real,
                        imag,
                        color=SHADES[place],
                        linestyle=LINES[place],
                        linewidth=0.6,
                        alpha=0.7,
                        label=fan.direction if number == 0 else None,
                    )
        turn = np.linspace(0, 2 * np.pi, 200)
        left.plot(np.cos(turn), np.sin(turn), color=NEUTRAL, linewidth=0.6, linestyle=":")
        left.plot(-1, 0, "P", color=COLORS["black"], markersize=5)
        left.set_xlim(-3.2, 1.4)
        left.set_ylim(-2.6, 2.0)
        left.set_aspect("equal")
        left.set_title("open loop L(jω)")
        _real_axis_of_friction(right)
        right.set_title("speed per friction torque × √(kp J)")
        for axes in (left, right):
            axes.axhline(0, color=NEUTRAL, linewidth=0.5, zorder=1)
            axes.axvline(0, color=NEUTRAL, linewidth=0.5, zorder=1)
            axes.set_xlabel("real")
        left.set_ylabel("imaginary")
        # The hat over F reaches out of the line that a legend reserves.
        key(fig, right.get_legend_handles_labels()[0], ncols=4, borderaxespad=1.0)
    return fig


def bode_bands(bands: Sequence[Bode]) -> Figure:
    """Draw gain [dB] and phase [°] of L(jω) over frequency: the median, and 5 to 95 % of draws.

    Parameters
    ----------
    bands : sequence of Bode
        Of one loop; a direction each has its own colour.
    """
    with figure(height=84.0) as fig:
        above, below = fig.subplots(2, 1, sharex=True)
        for place, band in enumerate(bands):
            style = {"color": SHADES[place], "linestyle": LINES[place], "label": band.direction}
            for axes, rows in ((above, band.gain_db), (below, band.phase_deg)):
                low, middle, high = rows
                axes.fill_between(band.frequency_hz, low, high, color=SHADES[place], alpha=0.25,
                                  linewidth=0)  # fmt: skip
                axes.plot(band.frequency_hz, middle, **style)
        above.axhline(0, color=NEUTRAL, linewidth=0.7, linestyle=":")
        below.axhline(-180, color=NEUTRAL, linewidth=0.7, linestyle=":")
        above.set_xscale("log")
        above.set_ylabel("|L| [dB]")
        below.set_ylabel("phase of L [°]")
        below.set_xlabel("frequency [Hz]")
        below.xaxis.set_major_formatter(numbers())
        if bands[0].direction is not None:
            key(fig, above.get_legend_handles_labels()[0], ncols=2)
    return fig


def _real_axis_of_friction(axes: Axes) -> None:
    """Draw −1/N(A): the left half for friction, the right for more compensation than friction."""
    low, high = axes.get_xlim()
    reach = 1.15 * max(abs(low), abs(high))
    axes.plot([-reach, 0], [0, 0], color=COLORS["black"], linewidth=1.6,
              label="−1/N(A), γF̂ < F")  # fmt: skip
    axes.plot([0, reach], [0, 0], color=COLORS["black"], linewidth=1.6, linestyle="--",
              label="−1/N(A), γF̂ > F")  # fmt: skip
    axes.set_xlim(-reach, reach)


def has_error_or_headroom(loops: Sequence[LoopMargins]) -> bool:
    """Tell whether there is anything for :func:`error_and_headroom` to draw."""
    return any(_picked(loop, ERRORS + HEADROOMS) for loop in loops)


def error_and_headroom(loops: Sequence[LoopMargins]) -> Figure:
    """Draw errors at the tool tip and torque headroom, with their specs.

    Parameters
    ----------
    loops : sequence of LoopMargins
        Median, and 5 to 95 %, of each; a spec is a black tick.
    """
    rows = max(sum(len(_picked(loop, names)) for loop in loops) for names in (ERRORS, HEADROOMS))
    with figure(height=24.0 + 5.0 * (rows + len(loops))) as fig:
        left, right = fig.subplots(1, 2)
        _bars(left, loops, ERRORS, 1e3)
        _bars(right, loops, HEADROOMS, 100.0)
        left.set_xlabel("at the tool tip [mm]")
        left.set_xscale("log")
        left.xaxis.set_major_formatter(numbers())
        right.set_xlabel("torque left [% of the limit]")
        right.axvline(0, color=COLORS["vermilion"], linewidth=0.8)
    return fig


def _picked(loop: LoopMargins, names: Sequence[str]) -> list[Metric]:
    return [
        metric for metric in loop.metrics if metric.name in names and metric.interval is not None
    ]


def _bars(axes: Axes, loops: Sequence[LoopMargins], names: Sequence[str], scale: float) -> None:
    row, ticks, labels = 0, [], []
    for place, loop in enumerate(loops):
        color = SHADES[place % len(SHADES)]
        axes.text(0.02, row, plain(loop.name), fontsize=7.5, fontweight="bold", va="center",
                  transform=axes.get_yaxis_transform())  # fmt: skip
        row += 1
        for metric in _picked(loop, names):
            interval = metric.interval
            assert interval is not None
            axes.plot([scale * interval.q05, scale * interval.q95], [row, row], color=color,
                      linewidth=3.0, alpha=0.5, solid_capstyle="butt")  # fmt: skip
            axes.plot(scale * interval.q50, row, MARKERS[place % len(MARKERS)], color=color)
            if metric.spec is not None:
                axes.plot(scale * metric.spec, row, "|", color=COLORS["black"], markersize=9,
                          markeredgewidth=1.6)  # fmt: skip
            ticks.append(row)
            labels.append(WORDS[metric.name])
            row += 1
    axes.set_yticks(ticks, labels)
    axes.set_ylim(row - 0.4, -0.8)


COMPENSATOR_SHADES = tuple(
    COLORS[name] for name in ("black", "blue", "vermilion", "green", "purple", "orange")
)

DASHES = (*LINES, (0, (8, 2)), (0, (4, 1, 1, 1, 1, 1)))


def errors_over_time(following: Following) -> Figure:
    """Draw the error at the tip over time: medians, and 5 to 95 % of none and of the best.

    Parameters
    ----------
    following : Following
        A panel a trajectory, a colour a compensator; what is judged is shaded.
    """
    time = np.array(following.time_s)
    with figure(height=120.0) as fig:
        fig.suptitle("Which compensator leaves least error at the tip?", fontsize=9.0)
        panels = fig.subplots(2, 2, sharex=True).ravel()
        for axes, trajectory in zip(panels, following.trajectories, strict=True):
            axes.axvspan(following.settling_s, time[-1], color=NEUTRAL, alpha=0.1, linewidth=0)
            axes.axhline(0, color=NEUTRAL, linewidth=0.5)
            for compensator, color, line in zip(
                trajectory.compensators, COMPENSATOR_SHADES, DASHES, strict=True
            ):
                low, middle, high = (
                    1e3 * np.array(band)
                    for band in (compensator.q05_m, compensator.q50_m, compensator.q95_m)
                )
                if compensator.compensator in (
                    "none",
                    *trajectory.best,
                ):  # more bands would hide each other
                    axes.fill_between(time, low, high, color=color, alpha=0.15, linewidth=0)
                    for edge in (low, high):
                        axes.plot(time, edge, color=color, linestyle=line, linewidth=0.4)
                axes.plot(time, middle, color=color, linestyle=line, linewidth=1.0,
                          label=compensator.compensator)  # fmt: skip
            axes.set_title(f"{trajectory.name}: {' or '.join(trajectory.best)}")
        for axes in panels[2:]:
            axes.set_xlabel("time since the reference set off [s]")
        for axes in panels[::2]:
            axes.set_ylabel("behind at the tip [mm]")
        key(fig, panels[0].get_legend_handles_labels()[0], ncols=3)
    return fig
