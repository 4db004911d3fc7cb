"""What every result file keeps: nothing is missing without a reason."""

import json
from pathlib import Path
from types import NoneType
from typing import get_args, get_origin

import pytest
from pydantic import BaseModel
from reasons import REASON, unexplained

from bayesfric import schemas
from bayesfric.schemas.parameter import ParameterSummary

ROOT = Path(__file__).parents[1]
MODELS = [
    schema
    for schema in vars(schemas).values()
    if isinstance(schema, type) and issubclass(schema, BaseModel) and schema is not BaseModel
]
RESULTS = sorted((ROOT / "reports" / "reference").glob("*.json"))


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_whatever_may_be_null_has_room_for_a_reason(model: type[BaseModel]) -> None:
    for name, field in model.model_fields.items():
        of_today = "earlier versions" not in str(field.description)
        if of_today and NoneType in get_args(field.annotation) and not REASON.search(name):
            assert f"{name}_why" in model.model_fields, name


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_a_reason_stands_beside_what_may_be_missing(model: type[BaseModel]) -> None:
    for name, field in model.model_fields.items():
        if name.endswith("_why"):
            of = model.model_fields[name.removesuffix("_why")]
            may_be_empty = get_origin(of.annotation) is tuple
            assert may_be_empty or NoneType in get_args(of.annotation), name
            assert NoneType in get_args(field.annotation), name


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.name)
def test_the_reference_run_gives_a_reason_for_all_that_is_missing(path: Path) -> None:
    assert unexplained(json.loads(path.read_text("utf-8"))) == []


def test_what_is_missing_without_a_reason_is_found() -> None:
    bad = {"a": [{"x": None, "x_why": None}, {"x": 0, "x_why": "none"}, {"x": 0, "x_why": None}]}
    assert unexplained(bad) == ["/a/0/x", "/a/1/x"]
    assert unexplained({"x": None, "y": [None], "z": [], "z_why": None}) == ["/x", "/y/0", "/z"]
    assert unexplained({"x": None, "x_why": "it rests", "why": None}) == []


def test_walkers_that_never_leave_their_places_can_be_written() -> None:
    """Their R-hat is infinite, which JSON has no number for."""
    fitted = schemas.FitFile.model_validate_json((RESULTS[0].parent / "fit.json").read_text())
    entry = fitted.scatter["tau"].model_dump() | {"r_hat_walkers": float("inf")}
    assert ParameterSummary.model_validate(entry).r_hat_walkers == 1000.0
