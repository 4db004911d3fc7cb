"""The evidence of the benchmark as a page of the documentation."""

from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "benchmark.md"
INTRODUCTION = """\
# Benchmark

`make bench` runs samplers on the same marginal posteriors of the bundled recording, each in a
process of its own. It writes this page from `reports/evidence/benchmark.json`.

- **Times** are processor time of one thread. Compare ratios within one run: times differ from
  machine to machine. Commands are timed by the wall clock, from a cold start. Kernels are timed
  by pytest-benchmark (median).
- **Draws** are effective draws, for the coefficient of the law with the smallest effective sample
  size. "From cold" is the time to 4,000 effective draws, including imports, compilation and
  tuning.
- **The limit** is importance sampling from the Laplace fit. We take its speed as an upper limit,
  because its draws are independent. In the rows "share of the limit", "peer" means importance
  sampling, and the ratio is the speed of `fit` over that of importance sampling.
- **Peers** are samplers of other packages, with the same sufficient statistics and their default
  settings. The authors of the peers did not tune them for this benchmark. The peers evaluate a
  log density that this project wrote in JAX and did not optimise, so a peer may be faster with a
  better implementation. A peer whose chains have an R-hat above 1.05 is shown but not compared.
- **Ours** is `fit` with `walkers = 1024`, `burn = 10`, `steps = 50` and `thin = 1`. By default,
  `fit` has fewer walkers (40) and keeps more steps of each (140).
- **Agreement** compares means and standard deviations of all parameters with those of each peer
  and of the limit, from the draws of all repeats together. The table has the largest difference.
  Each repeat has its own seed; the event-level posterior is run once.
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
