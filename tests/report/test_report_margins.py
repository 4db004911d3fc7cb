"""The chapter on controller margins, and its figures."""

import re
from dataclasses import replace

import numpy as np
import pytest
from report.told import plain as words
from report.told import told

from bayesfric.errors import InputError
from bayesfric.notebook.results import MarginsResult
from bayesfric.plots.margins import (
    bode_bands,
    errors_over_time,
    hunting_over_speed,
    limit_cycle_against_gain,
    nyquist_fan,
)
from bayesfric.report.assembly import build_document
from bayesfric.report.chapters.gain import gain_figures, gain_lines
from bayesfric.report.chapters.margins import margins
from bayesfric.report.content import Heading, Notice, Paragraph, Strong, Table
from bayesfric.report.stored import StoredResults, read_stored
from bayesfric.report.writing import write_report
from bayesfric.schemas.base import Interval
from bayesfric.schemas.loop_runs import FollowedWith, Following, Trajectory
from bayesfric.schemas.margins import Certificate


def test_what_is_assumed_stands_beside_the_answer_and_draws_are_counted_once(computed):
    bench = computed.summary.loops[0]
    hunts = "At γ = 1, as in the file, it hunts in 3 of 20 draws (at 95 % confidence)."
    warned = bench.model_copy(
        update={"warnings": ("Assumed: The wind is calm.", "It rings."), "answer": hunts}
    )
    summary = computed.summary.model_copy(update={"loops": (warned,)})
    lines = list(gain_lines(summary, alone=True))
    (assumed,) = [line for line in lines if getattr(line, "title", "").startswith("Assumed")]
    assert assumed.text == "The wind is calm."
    (specs,) = [line for line in lines if isinstance(line, Table)]
    assert specs.note.endswith("Hunting is simulated in 20 draws; all other metrics use 200 draws.")


def test_the_first_line_says_which_gain_to_set(computed):
    blocks = list(margins(computed.summary, alone=False))
    assert isinstance(blocks[0], Heading)
    first = blocks[1]
    assert isinstance(first, Paragraph)
    _, _, verdict = first.text
    assert isinstance(verdict, Strong)
    rest = blocks[2].items
    assert " ".join([verdict.text, *rest]) == computed.summary.loops[0].answer
    assert re.fullmatch(r"Meets its spec: each of \d metrics .* or more\.", verdict.text)
    assert any(line.startswith("Set γ to ") for line in rest)


def test_an_assumed_number_that_decides_the_answer_is_a_warning(computed):
    """At 98 % of the variance the reader is told to measure it; at 40 % nothing is orange."""
    loop = computed.summary.loops[0]
    for share, titles in (
        (0.98, ["An assumed number makes most of friction's variance"]),
        (0.4, []),
    ):
        shares = {"gamma_necessary": {"c1, c2, c3": 1 - share, "drive.friction_n_m": share}}
        decided = loop.model_copy(update={"variance_share": shares})
        alone = computed.summary.model_copy(update={"loops": (decided,)})
        warnings = [
            line
            for line in gain_lines(alone, alone=True)
            if isinstance(line, Notice) and "of the variance" in line.text
        ]
        assert [line.title for line in warnings] == titles
        if warnings:
            assert "drive friction (drive.friction_n_m) contributes 98" in warnings[0].text


def test_page_one_says_what_is_missed_and_which_gain_to_set(computed):
    loop = computed.summary.loops[0]
    hunting, box, _, specs, decided, _ = gain_lines(computed.summary, alone=True)
    gamma = np.floor(100 * loop.largest_safe_compensation_gain) / 100
    at = f"γ = {loop.compensation_gain:g}"
    assert box.title == f"bench: safe from hunting at {at}, and meets its spec"
    assert f" Up to γ = {gamma:.2f} it hunts in at most 5\u202f% of the draws." in box.text
    assert re.match(r"It hunts in \d[\d.]* (of \d+ draws|% .* of the draws)\. Up", box.text)
    assert len(box.text) < 100  # the answer and no more
    assert {row[0] for row in specs.rows} == {"bench", "second"}
    assert "c1, c2 and c3 contribute" in decided.text[1]
    assert hunting.text[0].startswith("A loop hunts if it oscillates")  # before it is used
    assert hunting.text[0].endswith(" For what was not examined, see ")
    assert [figure.label for figure in gain_figures(computed.summary)] == [
        "limit-cycle",
        "error-headroom",
    ]
    bad = loop.model_copy(
        update={"missed_specs": ("lost_motion", "limit_cycle_probability"),
                "largest_safe_compensation_gain": None,
                "largest_safe_compensation_gain_why": "all draws hunt"}
    )  # fmt: skip
    (line,) = gain_lines(computed.summary.model_copy(update={"loops": (bad,)}), alone=False)
    assert line.title == f"bench: not safe at γ = {loop.compensation_gain:g}"
    assert "No gain γ is safe: all draws hunt." in line.text
    assert "Misses its spec" not in line.text  # lost motion has no spec of a number
    lost = next(metric for metric in loop.metrics if metric.name == "lost_motion")
    tight = bad.model_copy(update={"metrics": (lost.model_copy(update={"spec": 1e-5}),)})
    (line,) = gain_lines(computed.summary.model_copy(update={"loops": (tight,)}), alone=False)
    assert f"Misses its spec: lost motion of the cable {1e3 * lost.interval.q50:.3g} [" in line.text
    assert "]\u202fmm (at most 0.01\u202fmm is asked for" in line.text


def test_a_band_is_promised_only_where_it_can_be_seen(computed):
    loop = computed.summary.loops[0]

    def caption(error):
        curve = tuple(
            point.model_copy(update={"mcse": error}) for point in loop.limit_cycle_probability
        )
        only = loop.model_copy(update={"limit_cycle_probability": curve})
        figure = next(gain_figures(computed.summary.model_copy(update={"loops": (only,)})))
        return words(figure.caption)

    assert "Shaded: twice its Monte Carlo error." in caption(0.03)
    # 200 draws: 0.0035 at 0 and 1, but 0.035 where half of them hunt.
    assert "Shaded: twice its Monte Carlo error." in caption(0.0035)
    assert "at most 0.01, is too thin to see. Dot:" in caption(0.0001)


def test_the_law_of_the_margins_is_told_without_file_names(computed):
    law = computed.summary.law.model_copy(update={"used": "refitted", "causes": ("viscous",)})
    lines = list(gain_lines(computed.summary.model_copy(update={"law": law}), alone=True))
    said = [words(line.text) for line in lines if isinstance(line, Paragraph)]
    assert any("Margins of the law refitted with viscous." in line for line in said)


def grid_of(curve):
    """Return P(limit cycle) of each stored γ."""
    return {point.gamma: point.p for point in curve}


def test_margins_at_a_prompt_are_drawn(computed):
    result = MarginsResult.of(computed)
    (axes,) = result.plot_hunting().axes
    curve = computed.summary.loops[0].limit_cycle_probability
    drawn = axes.lines[0].get_xydata().tolist()
    assert not axes.lines[1].get_clip_on()  # the γ of the file, which may lie on the edge
    assert grid_of(curve).keys() <= dict(drawn).keys()
    assert len(result.plot_errors().axes) == 2
    bare = [
        loop_summary.model_copy(update={"limit_cycle_probability": ()})
        for loop_summary in result.summary.loops
    ]
    summary = result.summary.model_copy(update={"loops": tuple(bare)})
    with pytest.raises(ValueError, match="no loop has a gain"):
        replace(result, summary=summary).plot_hunting()


def test_the_tables_hold_the_stored_figures(computed):
    tables = [block for block in margins(computed.summary, alone=False) if isinstance(block, Table)]
    (margins_table,) = [table for table in tables if table.label == "margins-bench"]
    rows = {row[0]: row for row in margins_table.rows}
    error = next(m for m in computed.summary.loops[0].metrics if m.name == "steady_error_servo")
    assert rows["steady error of the servo"][1] == "mm"
    shown = float(rows["steady error of the servo"][3])
    assert shown == pytest.approx(1e3 * error.interval.q50, abs=0.006)
    assert "headroom to continuous torque" not in rows  # which does not exist, and has no spec
    assert all(
        "—" not in row[6:] for row in margins_table.rows if not row[6]
    )  # without a spec, nothing
    (two,) = [table for table in tables if table.label == "margins-second"]
    gain = next(row for row in two.rows if row[0] == "gain margin")
    assert gain[6] == "≥ 2.00"
    assert gain[7] == "< 0.03"  # none of some hundred draws
    decibels = two.rows[two.rows.index(gain) + 1]
    assert decibels[1] == "dB"
    assert decibels[6] == "≥ 6.02"
    assert float(decibels[3]) == pytest.approx(20 * np.log10(float(gain[3])), abs=0.02)
    phase = next(row for row in two.rows if row[0] == "phase margin")
    degrees = two.rows[two.rows.index(phase) + 1]
    assert degrees[1] == "°"
    assert float(degrees[3]) == pytest.approx(np.rad2deg(float(phase[3])), abs=0.06)


def test_why_a_figure_is_missing_is_said(computed):
    text = told(build_document(StoredResults(margins=computed.summary)))
    assert "drive.continuous_current_a is not given" in text
    assert "Coulomb friction is not in the linear loop" in text
    assert re.search(r"steady error \| 2 \| 100\s% \| 33\s% to 100\s%", text)


def test_a_folder_with_margins_alone_becomes_a_report(computed, tmp_path):
    computed.write(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["margins.json"]
    write_report(tmp_path)
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
    assert "Up to γ\u00a0=\u00a0" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_margins_over_another_fit_are_refused(computed, small_fit, tmp_path):
    small_fit.write(tmp_path)
    computed.write(tmp_path)
    with pytest.raises(InputError, match=r"margins\.json"):
        read_stored(tmp_path)


def test_the_figures_draw_what_is_stored(computed):
    bench = computed.summary.loops[0]
    axes = limit_cycle_against_gain([bench]).axes[0]
    curve = axes.lines[0].get_xydata()
    # Between the stored points, of which one may stand on either side of a step, the quantiles.
    drawn, grid = dict(curve.tolist()), grid_of(bench.limit_cycle_probability)
    for gamma, p in grid.items():
        assert drawn[gamma] == pytest.approx(p, abs=0.05)
    (hunting,) = [metric for metric in bench.metrics if metric.name == "gamma_hunting"]
    assert drawn[hunting.quantiles[10]] == 0.5
    assert np.all(np.diff(curve, axis=0) >= 0)
    (safe,) = [line for line in axes.lines if line.get_alpha() == 0.6]
    assert safe.get_xdata()[0] == np.floor(100 * bench.largest_safe_compensation_gain) / 100
    chart = computed.summary.loops[1].hunting_map
    hunting = [[0.5] * len(row) for row in chart.probability]
    chart = chart.model_copy(update={"probability": hunting})
    drawn, errors = (panel.images[0].get_array() for panel in hunting_over_speed(chart).axes)
    assert drawn.tolist() == hunting
    assert errors[1, 0] == pytest.approx(1e3 * chart.rms_error_m[1][0])
    left, right = nyquist_fan(bench.nyquist).axes
    loops = [fan for fan in bench.nyquist if fan.what == "loop"]
    assert left.lines[0].get_xdata().tolist() == list(loops[0].real[0])
    assert len(right.lines) >= len(loops[0].real)


def test_the_bode_figure_has_the_margins_of_the_table(computed):
    bench = computed.summary.loops[0]
    above, below = bode_bands(bench.bode).axes
    frequency, gain = above.lines[0].get_data()
    phase = below.lines[0].get_ydata()
    # |L| falls through 0 dB once; there the phase is above −180° by the phase margin
    crossing = np.interp(0.0, -gain, np.log(frequency))
    margin = 180.0 + np.interp(crossing, np.log(frequency), phase)
    (stored,) = (metric for metric in bench.metrics if metric.name == "phase_margin")
    assert margin == pytest.approx(np.degrees(stored.interval.q50), abs=0.5)
    # rigid at low frequencies: kp/((J s + b) s), from −90° on
    assert -180.0 < phase[0] < -90.0
    assert frequency[-1] <= 500.0


def test_a_map_on_which_nothing_hunts_is_a_sentence_and_the_error(computed):
    chart = computed.summary.loops[1].hunting_map
    assert not np.any(chart.probability)
    (panel,) = hunting_over_speed(chart).axes
    assert panel.images[0].get_array().tolist() == (1e3 * np.array(chart.rms_error_m)).tolist()
    said = told(build_document(StoredResults(margins=computed.summary)))
    # 1 − 0.05^(1/30)
    assert f"any of {chart.draws} draws hunt (P <\u00a00.095 in each" in said


def test_references_that_move_are_drawn_and_tabled(computed):
    first = computed.summary.loops[0]
    steps = np.linspace(-1.0, 2.0, 4)

    def followed(name, rms, least):
        numbers = {"mean": rms, "sd": 0.0, "q05": rms / 2, "q50": rms, "q95": 2 * rms}
        bands = {key: rms * factor * steps for key, factor in
                 (("q05_m", 0.5), ("q50_m", 1.0), ("q95_m", 2.0))}  # fmt: skip
        return FollowedWith(compensator=name, rms_m=Interval(**numbers), least=least,
                            peak_m=Interval(**numbers), **bands)  # fmt: skip

    rows = tuple(
        followed(*numbers) for numbers in (("none", 4e-3, 0.0), ("reference", 1e-3, 0.9),
                                   ("measured", 2e-3, 0.0), ("error", 3e-3, 0.1),
                                   ("LuGre observer", 3.5e-3, 0.0),
                                   ("disturbance observer", 1.5e-3, 0.0))
    )  # fmt: skip
    following = Following(
        draws=20, settling_s=1.0, time_s=tuple(steps), answer="Reference.", error_band_rad=0.1,
        disturbance_cutoff_rad_s=12.5,
        trajectories=tuple(
            Trajectory(name=name, sentence="1 mm", best=("reference",), compensators=rows)
            for name in ("ramp", "reversal", "sine", "step")
        ),
    )  # fmt: skip
    moving = first.model_copy(update={"following": following, "following_why": None})
    blocks = list(margins(computed.summary.model_copy(update={"loops": (moving,)}), alone=False))
    (table,) = [block for block in blocks if getattr(block, "label", "") == "followed-bench"]
    assert len(table.rows) == 24
    assert "its corner at 12.5 rad/s" in str(table.note)
    assert table.rows[1][:3] == ["ramp", "reference", "1.0"]
    assert table.rows[1][-1].startswith("90")
    panels = errors_over_time(following).axes
    assert [panel.get_title() for panel in panels] == [
        "ramp: reference", "reversal: reference", "sine: reference", "step: reference",
    ]  # fmt: skip
    drawn = [np.asarray(line.get_ydata()).tolist() for line in panels[3].lines]
    assert (1e3 * 4e-3 * steps).tolist() in drawn
    bare = [
        block for block in margins(computed.summary, alone=False) if isinstance(block, Paragraph)
    ]
    assert any("it was not asked for (--ensembles)" in str(paragraph.text) for paragraph in bare)


def test_a_gain_that_is_not_certified_violates_no_spec(computed):
    """Its row has the largest certified γ, and no share of draws that miss."""
    certificate = Certificate(
        draws=20, probability=0.0, low=0.0, high=0.2, covers="", sentence="",
        gamma=Interval(mean=0.3, sd=0.1, q05=0.1, q50=0.25, q95=0.4),
    )  # fmt: skip
    uncertified = computed.summary.loops[0].model_copy(update={"certificate": certificate})
    summary = computed.summary.model_copy(update={"loops": (uncertified,)})
    tables = [block for block in margins(summary, alone=False) if isinstance(block, Table)]
    (row,) = [r for t in tables for r in t.rows if str(r[0]).startswith("certified γ")]
    assert float(row[3]) == 0.25
    assert row[6:] == ["", "", ""]


def test_a_title_names_the_assumed_number_that_the_answer_hangs_on(computed):
    loop = computed.summary.loops[0]

    def title(**shares):
        groups = {"c1, c2, c3": 0.0, **shares}
        on_it = loop.model_copy(update={"variance_share": {"gamma_necessary": groups}})
        _, box, *_ = gain_lines(computed.summary.model_copy(update={"loops": (on_it,)}), alone=True)
        return box.title

    assert title(**{"drive.friction_n_m": 0.9}).endswith(", if the assumed drive friction is right")
    assert title(**{"drive.friction_n_m": 0.4}).endswith("and meets its spec")
    assert title(**{"new assembly and rig": 0.9}).endswith("and meets its spec")
