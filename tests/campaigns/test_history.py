"""What was promised and found stands in ``history.csv`` as the evidence has it."""

import pytest
from campaigns import evidence, history
from campaigns.promises import Outcome, rate

ROW = dict.fromkeys(history.COLUMNS, "") | {"campaign": "a", "promise": "p", "version": "0.2.0"}


def share(hits, of, **changes):
    return ROW | {"value": str(hits / of), "n": str(of)} | changes


def interval(low, high, **changes):
    return ROW | {"value": "1", "low": low, "high": high} | changes


@pytest.mark.parametrize(
    ("bounds", "met"),
    [({"least": 0.9}, True), ({"least": 0.91}, False), ({"most": 0.9}, True), ({"most": 0}, False)],
)
def test_a_promise_is_met_up_to_its_bound(bounds, met):
    assert rate("p", 9, 10, **bounds).met is met


def test_a_rate_has_the_interval_of_clopper_and_pearson():
    """Of ten two: 2.5 to 55.6 %, by their tables; of nothing an upper bound."""
    two, none = rate("p", 2, 10), rate("p", 0, 10)
    assert (two.value, two.n) == (0.2, 10)
    assert (two.low, two.high) == pytest.approx((0.0252, 0.5561), abs=1e-4)
    assert (none.low, none.high) == (0.0, pytest.approx(0.3085, abs=1e-4))


@pytest.mark.parametrize(
    ("before", "now", "noticed"),
    [
        # Of Fisher's test: 48 of 50 and 40 of 50 differ with p = 0.028, and 35 of 50 with 0.0008.
        (share(48, 50), share(40, 50), False),
        (share(48, 50), share(35, 50), True),
        (share(35, 50), share(48, 50), True),
        (share(1, 1), share(0, 1), False),
        (interval("0.1", "0.3"), interval("0.2", "0.5"), False),
        (interval("0.1", "0.3"), interval("0.31", "0.5"), True),
        (ROW | {"value": "1"}, ROW | {"value": "9"}, False),
    ],
)
def test_a_change_beyond_chance_is_told_until_it_has_a_note(before, now, noticed):
    now = now | {"version": "0.10.0"}
    assert bool(history.changes([now, before])) is noticed
    assert history.changes([now | {"note": "another design"}, before]) == []


def test_the_newest_row_is_compared_with_the_one_before_it():
    """Versions are numbers: 0.10.0 comes after 0.9.0."""
    rows = [share(k, 50, version=v) for k, v in ((9, "0.10.0"), (48, "0.9.0"), (8, "0.2.0"))]
    ((now, before),) = history.newest(rows).values()
    assert (now["version"], before["version"]) == ("0.10.0", "0.9.0")


def test_rows_of_a_version_are_replaced_and_notes_stay(tmp_path, monkeypatch):
    class Campaign:
        @staticmethod
        def promises(figures):
            return [Outcome("a, b", figures["value"], most=2.0)]

    record = {"version": "0.1.0", "figures": {"value": 1.0}}
    monkeypatch.setattr(history, "HISTORY", tmp_path / "history.csv")
    monkeypatch.setattr(evidence, "read", lambda name: record)
    monkeypatch.setattr(evidence, "campaign_of", lambda name: Campaign)
    history.write(["it"])
    record |= {"version": "0.2.0"}
    history.write(["it"])
    text = history.HISTORY.read_text().replace("true,\n", "true,why\n")
    history.HISTORY.write_text(text)
    record |= {"figures": {"value": 3.0}}
    history.write(["it"])
    rows = [(r["version"], r["promise"], r["value"], r["met"], r["note"]) for r in history.read()]
    assert rows == [
        ("0.1.0", "a, b", "1", "true", "why"),
        ("0.2.0", "a, b", "3", "false", "why"),
    ]


# What is kept


def test_each_row_says_what_its_figures_say():
    rows = history.read()
    assert len({history.key_of(row) for row in rows}) == len(rows)
    for row in rows:
        assert row["met"] == str(history.is_met(row)).lower(), row
        if row["low"]:
            assert float(row["low"]) <= float(row["value"]) <= float(row["high"]), row
        assert row["date"] == history.date_of(row["version"]), row


@pytest.mark.parametrize("name", evidence.names())
def test_the_newest_rows_are_those_of_the_evidence(name):
    """`python -m campaigns.history`, with `tests` on the path, writes them."""
    there = [row for row in history.read() if row["campaign"] == name]
    last = max(map(history.release, there))
    newest = [row | {"note": ""} for row in there if history.release(row) == last]
    assert newest == history.rows_of(name)


def test_no_figure_has_changed_beyond_chance_without_a_note():
    assert history.changes(history.read()) == []
