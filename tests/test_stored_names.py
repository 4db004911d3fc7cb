"""Names of any text go into a netCDF file and come back."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from report.hostile import IN_CELLS

from bayesfric.results import read_tree, write_netcdf
from bayesfric.stored_names import name_of, variable_of

NAMES = tuple(
    dict.fromkeys(
        [
            *IN_CELLS,
            *(
                "flow_l/min",
                "/",
                "//",
                "%2F",
                "%",
                "%25",
                "%2525/",
                "e\u0301",
                "\u2126",
                "∕",
                "a b",
                "row",
            ),
            "中" * 100,
            "x" * 100,
        ]
    )
)


@given(st.text(min_size=1), st.sets(st.sampled_from(["row", "trial", "a"])))
def test_a_name_comes_back_and_holds_no_slash(name, taken):
    variable = variable_of(name, taken)
    assert name_of(variable) == name
    assert "/" not in variable
    assert variable not in taken


@given(st.text("%2F5/a", max_size=6), st.text("%2F5/a", max_size=6))
def test_two_names_are_two_variables(name, other):
    assert (variable_of(name) == variable_of(other)) == (name == other)


def test_variables_and_attributes_of_any_name_are_stored(tmp_path):
    table = xr.Dataset({variable_of(name): ("row", np.arange(3.0) + i)
                        for i, name in enumerate(NAMES)})  # fmt: skip
    table.attrs = {name: i for i, name in enumerate(NAMES)}
    tree = xr.DataTree.from_dict({"/": xr.Dataset(attrs=dict(table.attrs)), "/group": table})
    write_netcdf(tree, tmp_path / "a.nc")
    stored = read_tree(tmp_path / "a.nc")
    there = stored["group"].to_dataset()
    assert sorted(map(str, there.data_vars)) == sorted(map(str, table.data_vars))
    for i, name in enumerate(NAMES):
        assert there[variable_of(name)].to_numpy() == pytest.approx(np.arange(3.0) + i)
        assert stored.attrs[name] == there.attrs[name] == i
