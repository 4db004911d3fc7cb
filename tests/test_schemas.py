"""What every result file keeps: nothing is missing without a reason."""

import json
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_origin

import pytest
from pydantic import BaseModel

from bayesfric import schemas

ROOT = Path(__file__).parents[1]
MODELS = [
    one
    for one in vars(schemas).values()
    if isinstance(one, type) and issubclass(one, BaseModel) and one is not BaseModel
]
RESULTS = sorted((ROOT / "reports" / "reference").glob("*.json"))


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_a_reason_stands_beside_what_may_be_missing(model: type[BaseModel]) -> None:
    for name, field in model.model_fields.items():
        if name.endswith("_why"):
            of = model.model_fields[name.removesuffix("_why")]
            may_be_empty = get_origin(of.annotation) is tuple
            assert may_be_empty or NoneType in get_args(of.annotation), name
            assert NoneType in get_args(field.annotation), name


def unexplained(value: Any, place: str = "") -> list[str]:
    """Return what is missing without a reason, and what has a reason without being missing."""
    if isinstance(value, list):
        return [w for k, one in enumerate(value) for w in unexplained(one, f"{place}/{k}")]
    if not isinstance(value, dict):
        return []
    wrong = [w for key, one in value.items() for w in unexplained(one, f"{place}/{key}")]
    for key, why in value.items():
        of = key.removesuffix("_why")
        if of != key and of in value and (value[of] in (None, [])) != (why is not None):
            wrong.append(f"{place}/{of}")
    return wrong


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.name)
def test_the_reference_run_gives_a_reason_for_all_that_is_missing(path: Path) -> None:
    assert unexplained(json.loads(path.read_text("utf-8"))) == []


def test_what_is_missing_without_a_reason_is_found() -> None:
    bad = {"a": [{"x": None, "x_why": None}, {"x": 0, "x_why": "none"}, {"x": 0, "x_why": None}]}
    assert unexplained(bad) == ["/a/0/x", "/a/1/x"]
