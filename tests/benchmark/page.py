"""The evidence of the benchmark as a page of the documentation."""

from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "benchmark.md"
INTRODUCTION = """\
# Benchmark

`make bench` runs samplers side by side on the same marginal posteriors of the bundled recording,
each in a process of its own, and writes this page from `reports/evidence/benchmark.json`. All
times are processor time of one thread; ratios within one run are what counts, since times differ
from machine to machine. Draws are effective draws of the worst coefficient of the law. "From
cold" is the time to 4,000 of these, imports, compilation and tuning included. The limit is
independent draws from the Laplace fit, weighted. Peers get the same sufficient statistics, and
their settings are those that they come with, not tuned by their authors; a peer whose chains have
an R-hat above 1.05 is shown, and not compared with. Ours takes `walkers = 1024`, `burn = 10`,
`steps = 50` and `thin = 1`, where `fit` by default has 40 walkers that go on for longer. The
peers' density is written in JAX by this project and is not optimised: a ratio above 1 says what
was measured with it, and not what the peer can do. Of what has a limit, the limit stands under
"peer" and the ratio is the share of it: 1 at most. Each repeat has a seed of its own; event level
is run once. Means and standard deviations of all parameters, of the draws of all repeats together,
are compared with each peer's and with the limit's; the largest difference stands for all. Commands
are timed cold, by the wall. Kernels are timed by pytest-benchmark: the median.
"""


def line(row):
    """Return a target in one line."""
    met = "met" if row["met"] else "missed"
    figure = "" if row["ours"] is None else f"{_number(row['ours'])} to {_number(row['peer'])}, "
    return f"{row['name']}: {figure}ratio {row['ratio']:.3g} (goal {row['goal']:g}, {met})"


def text(record):
    """Return the page of a record."""
    parts = [INTRODUCTION, "## Targets", "", "| target | ours | peer | ratio | goal | |"]
    parts.append("|---|---|---|---|---|---|")
    for row in record["figures"]["targets"]:
        ours, peer = (_number(row[key]) for key in ("ours", "peer"))
        met = "met" if row["met"] else "missed"
        parts.append(
            f"| {row['name']} | {ours} | {peer} | {_number(row['ratio'])} | {row['goal']:g} "
            f"| {met} |"
        )
    parts += ["", "## Samplers", "", "Median of the repeats, with their range.", ""]
    parts += ["| posterior | sampler | draws a second | seconds from cold | R-hat |"]
    parts += ["|---|---|---|---|---|"]
    for problem, samplers in record["figures"]["samplers"].items():
        for sampler, figures in samplers.items():
            rate, cold = _range(figures["per_second"]), _range(figures["cold_s"])
            r_hat = f"{figures['r_hat']['highest']:.3f}"
            parts.append(f"| {problem} | {sampler} | {rate} | {cold} | {r_hat} |")
    return "\n".join([*parts, ""])


def write(record):
    """Write the page."""
    PAGE.write_text(text(record), encoding="utf-8")


def _number(value):
    if value is None:
        return "–"
    return f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def _range(figure):
    median, lowest, highest = (_number(figure[key]) for key in ("median", "lowest", "highest"))
    return f"{median} ({lowest} to {highest})"
