"""Specs of a loop on page one: what is allowed, missed and borderline."""

from margins.loops import loop, write_draws
from report.told import plain as words

from bayesfric.margins import compute_margins
from bayesfric.report.chapters.gain import gain_lines
from bayesfric.report.chapters.specs import spec_table
from bayesfric.report.content import Strong, Table


def test_page_one_has_what_is_allowed_beside_how_probably_it_is_missed(computed):
    """Without it nobody can check what is bold."""
    bench = computed.summary.loops[0]
    metrics = [
        metric.model_copy(update={"note": "simulated in 20 draws"})
        if metric.name == "gamma_hunting"
        else metric
        for metric in bench.metrics
    ]
    bench = bench.model_copy(
        update={
            "limit_cycle_probability_max": 0.02,
            "violation_probability_max": 0.1,
            "metrics": tuple(metrics),
        }
    )
    lines = gain_lines(computed.summary.model_copy(update={"loops": (bench,)}), alone=True)
    (specs,) = [line for line in lines if isinstance(line, Table)]
    assert [column.title for column in specs.head[:3]] == [
        "metric", "P(missed)", "allowed",
    ]  # fmt: skip
    allowed = {words(row[0]): words(row[2]) for row in specs.rows}
    assert allowed.pop("γ from which it hunts") == "0.02"
    assert set(allowed.values()) == {"0.1"}
    assert "“γ from which it hunts” must be at least the γ that is set; its own" in specs.note
    assert "A simulated γ may be off by 0.01 or 5\u202f%, whichever is more;" in specs.note
    assert "do not show hunting" not in specs.note


def test_specs_of_linear_margins_say_that_these_do_not_show_hunting(computed):
    bench = computed.summary.loops[0]
    with_spec = tuple(
        metric.model_copy(update={"spec": 2.0}) if metric.name == "gain_margin" else metric
        for metric in bench.metrics
    )
    changed = bench.model_copy(update={"metrics": with_spec})
    (specs,) = spec_table(computed.summary.model_copy(update={"loops": (changed,)}), "")
    assert specs.note.endswith("delay margins leave friction out: they do not show hunting.")


def test_specs_at_the_safe_gain_stand_beside_those_at_the_gain_of_the_file(tmp_path):
    draws = write_draws(tmp_path / "draws.nc", n=200)
    over = loop({"compensation.gain": 3.0, "spec.steady_error_max_m": 1e-9})
    summary = compute_margins([over], draws).summary
    _, box, specs, *_ = gain_lines(summary, alone=True)
    gamma = f"{summary.loops[0].at_safe_gain.gamma:.2f}"
    assert box.text.endswith(
        f"At γ = {gamma} it still misses steady error of the servo, and meets its other specs."
    )
    assert [column.title for column in specs.head[1:3]] == ["missed at γ = 3", f"at γ = {gamma}"]
    at_safe = {words(row[0]): row[2] for row in specs.rows}
    assert at_safe["γ from which it hunts"] == "≤ 0.05"
    (hunts,) = [row for row in specs.rows if words(row[0]) == "γ from which it hunts"]
    assert words(hunts[4]) == "at least the γ set"  # 3 in one column, the safe one in the other
    assert "which differs between the two columns" in specs.note
    assert isinstance(at_safe["steady error of the servo"], Strong)
    assert "5 % to 95 % of the draws: at γ = 3." in specs.note


def test_a_probability_beside_what_is_allowed_stands_with_its_error(computed):
    """0.052 ± 0.0046 is no clear miss of 0.05; 0.07 is."""
    bench = computed.summary.loops[0]
    (metric,) = [of_loop for of_loop in bench.metrics if of_loop.name == "steady_error_servo"]

    def shown(p):
        only = metric.model_copy(
            update={"probability_of_violation": p, "monte_carlo_se": 0.0046, "spec": 1e-3}
        )
        loop = bench.model_copy(
            update={"metrics": (only,), "missed_specs": ("steady_error_servo",),
                    "violation_probability_max": 0.05}
        )  # fmt: skip
        some = computed.summary.model_copy(update={"loops": (loop,)})
        _, box, specs, *_ = gain_lines(some, alone=True)
        return words(box.text), words(specs.rows[0][1]), specs.note

    said, cell, note = shown(0.052)
    assert "steady error of the servo (borderline)." in said
    assert cell == "0.0520 ± 0.0046"
    assert "With an error (±): within two Monte Carlo errors of what is allowed." in note
    said, cell, note = shown(0.07)
    assert "borderline" not in said
    assert cell == "0.070"
    assert "With an error" not in note
