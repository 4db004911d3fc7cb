"""The claims in the report: stored numbers, refuted ones first, never another recording's."""

import numpy as np
import pytest
import xarray as xr

from bayesfric.errors import InputError
from bayesfric.plots.claims import against_rivals, over_prior_width, smallest_found
from bayesfric.report.chapters.claims import claims, fallen
from bayesfric.report.content import Heading, Paragraph, Table
from bayesfric.report.stored import StoredClaims, read_stored
from bayesfric.results import json_bytes, write_netcdf
from bayesfric.schemas import ClaimsFile
from bayesfric.schemas.claims import ClaimResult, SelfContradiction

RULES = {
    "support_log10_bayes_factor": 0.5,
    "refute_log10_bayes_factor": -1.0,
    "region_of_equivalence": 0.05,
    "refute_effect_probability": 0.95,
    "refute_elpd_errors": 2.0,
    "support_probability": 0.95,
    "refute_probability": 0.05,
    "refute_tail_probability": 0.01,
}


def words(text):
    return "".join(str(getattr(part, "text", part)) for part in text)


def result(name, verdict, log10, **more):
    return ClaimResult(
        id=name,
        statement="A statement.",
        paper="A place.",
        verdict=verdict,
        reason=f"The reason of {name}.",
        log10_bayes_factor=log10,
        log10_bayes_factor_why="no rival" if log10 is None else None,
        log10_bayes_factor_se=None if log10 is None else 0.0312,
        elpd_difference=None if log10 is None else -3.14,
        elpd_difference_why="no rival" if log10 is None else None,
        elpd_difference_se=None if log10 is None else 1.26,
        figures=more,
        by_pulley={},
    )


@pytest.fixture
def stored(small_fit):
    claims_file = ClaimsFile(
        **small_fit.summary.model_dump(
            include={"seed", "versions", "recording", "analysis_sha256", "created"}
        ),
        rules=RULES,
        claims=(
            result(
                "linear-in-tension",
                "refuted",
                -2.345,
                elpd_reliable=False,
                log10_bayes_factor_against={"tension-curvature/power": -2.6, "far": 99.0},
            ),
            result("rigs-agree", "undecided", None),
        ),
        self_contradictions=(
            SelfContradiction(topic="speed", statement="12 against 1.3.", figures={}),
        ),
    )
    curves = xr.Dataset(
        {"log10_bayes_factor": (("claim", "width"), [[-2.0, -2.345, -1.5]])},
        coords={"claim": ["linear-in-tension"], "width": [0.1, 1.0, 10.0]},
    )
    return StoredClaims(claims_file, xr.DataTree.from_dict({"curves": curves}))


def test_page_one_says_which_claims_fell(stored):
    notice = fallen(stored.record)
    assert notice.kind == "attention"
    assert words(notice.text).startswith("1 refuted, 1 undecided")
    refuted, open_still = (words(point) for point in notice.points)
    assert refuted.startswith("Refuted: A statement. ")
    assert refuted.endswith("The reason of linear-in-tension.")
    assert open_still == "Undecided: a statement."
    several = [claim.model_copy(update={"verdict": "undecided"}) for claim in stored.record.claims]
    listed = fallen(stored.record.model_copy(update={"claims": tuple((several * 5)[:5])}))
    assert words(listed.points[0]).startswith("Undecided: linear-in-tension, ")
    lacking = fallen(stored.record, "viscous")
    assert "These verdicts rest on laws without viscous" in words(lacking.text)
    assert "The reason of" not in words(lacking.points[0])


def test_claims_that_no_data_can_test_are_told_on_page_one_alone(stored):
    untested = result("rigs-agree", "not-testable", None)
    untestable = stored.record.model_copy(update={"claims": (untested,)})
    assert fallen(untestable).text.startswith("None of the 1 claims is testable here")
    assert list(claims(StoredClaims(untestable, stored.curves))) == []


def test_page_one_is_green_only_where_every_claim_holds(stored):
    def kind(*verdicts):
        claims = tuple(result(f"claim-{k}", v, 1.0) for k, v in enumerate(verdicts))
        return fallen(stored.record.model_copy(update={"claims": claims})).kind

    assert kind("supported", "supported") == "good"
    assert kind("supported", "undecided") == "info"
    assert kind("supported", "refuted") == "attention"


def test_the_table_has_the_stored_verdicts(stored):
    (table,) = [b for b in claims(stored) if isinstance(b, Table)]
    rows = [[str(getattr(cell, "text", cell)) for cell in row] for row in table.rows]
    assert rows[0] == ["linear-in-tension", "− refuted", "−2.345", "0.031", "−3.1", "(1.3)"]
    assert rows[1] == ["rigs-agree", "? undecided", *["—"] * 4]


def test_the_chapter_tells_each_claim_and_the_rules(stored):
    blocks = list(claims(stored))
    words = " ".join(str(b.text) for b in blocks if isinstance(b, Paragraph))
    assert "The reason of linear-in-tension." in words
    assert "The reason of rigs-agree." in words
    assert "at most −1" in words
    assert "at least 0.5" in words
    headings = [b.text for b in blocks if isinstance(b, Heading)]
    assert "The paper against itself" in headings


def test_claims_of_another_recording_are_refused(stored, small_fit, tmp_path):
    small_fit.write(tmp_path)
    write_netcdf(stored.curves, tmp_path / "claims.nc")
    (tmp_path / "claims.json").write_bytes(json_bytes(stored.record))
    assert read_stored(tmp_path).claims.record == stored.record
    other = stored.record.recording.model_copy(update={"sha256": "0" * 64})
    stale = stored.record.model_copy(update={"recording": other})
    (tmp_path / "claims.json").write_bytes(json_bytes(stale))
    with pytest.raises(InputError, match=r"claims\.json"):
        read_stored(tmp_path)
    (tmp_path / "claims.json").write_bytes(json_bytes(stored.record))
    (tmp_path / "claims.nc").unlink()
    with pytest.raises(InputError, match=r"claims\.nc.*bayesfric claims"):
        read_stored(tmp_path)


def test_the_curve_is_the_stored_one(stored):
    (axes,) = over_prior_width(stored.curves, 0.5, -1.0).axes
    curve, support, refute = axes.lines
    np.testing.assert_array_equal(curve.get_xdata(), [0.1, 1.0, 10.0])
    np.testing.assert_array_equal(curve.get_ydata(), [-2.0, -2.345, -1.5])
    assert (support.get_ydata()[0], refute.get_ydata()[0]) == (0.5, -1.0)


def test_what_is_beyond_the_axis_is_written(stored):
    rivals = stored.record.claims[0].figures["log10_bayes_factor_against"]
    (axes,) = against_rivals({"linear-in-tension": rivals}).axes
    dots = [line.get_xdata()[0] for line in axes.lines if len(line.get_xdata()) == 1]
    assert dots == [-2.6, 8.0]
    assert "99" in [text.get_text() for text in axes.texts]


def test_the_smallest_effects_are_drawn_in_per_cent():
    shares = {"linear-in-tension": {"a/b": 0.02}, "no-stribeck": {"c/d": 0.2, "e/f": 0.01}}
    (axes,) = smallest_found(shares, 0.05).axes
    *dots, line = axes.lines
    assert [dot.get_xdata()[0] for dot in dots] == pytest.approx([2.0, 20.0, 1.0])
    assert line.get_xdata()[0] == pytest.approx(5.0)
    assert [text.get_text() for text in axes.get_yticklabels()][1] == "no-stribeck: c/d"
