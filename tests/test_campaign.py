"""A campaign saves each case, goes on after a stop, and keeps the order of its cases."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest

from bayesfric.campaign import run_campaign


def square(case):
    return {"square": case**2}


def test_results_are_in_the_order_of_the_cases(tmp_path):
    with ThreadPoolExecutor(2) as executor:
        found = run_campaign(square, {"b": 2, "a": 3}, tmp_path, executor)
    assert list(found.items()) == [("b", {"square": 4}), ("a", {"square": 9})]
    assert json.loads((tmp_path / "a.json").read_text()) == {"square": 9}


def test_finished_cases_are_not_run_again(tmp_path):
    ran, fatal = [], {2}

    def counted(case):
        ran.append(case)
        if case in fatal:
            raise RuntimeError("killed")
        return square(case)

    cases = {"one": 1, "two": 2, "three": 3}
    with ThreadPoolExecutor(1) as executor, pytest.raises(RuntimeError, match="killed"):
        run_campaign(counted, cases, tmp_path, executor)
    done = {path.stem for path in tmp_path.glob("*.json")}
    assert "two" not in done
    ran.clear()
    fatal.clear()
    with ThreadPoolExecutor(1) as executor:
        found = run_campaign(counted, cases, tmp_path, executor)
    assert sorted(ran) == sorted(cases[name] for name in set(cases) - done)
    assert found["three"] == {"square": 9}


def test_progress_starts_from_what_is_done(tmp_path):
    (tmp_path / "one.json").write_text('{"square": 1}')
    seen = []
    with ThreadPoolExecutor(1) as executor:
        run_campaign(
            square, {"one": 1, "two": 2}, tmp_path, executor, lambda *step: seen.append(step)
        )
    assert seen == [(2, 2)]


def test_a_result_that_is_not_json_is_refused(tmp_path):
    with ThreadPoolExecutor(1) as executor, pytest.raises(ValueError, match="not JSON compliant"):
        run_campaign(lambda _: {"x": float("nan")}, {"one": 1}, tmp_path, executor)
    assert not (tmp_path / "one.json").exists()
