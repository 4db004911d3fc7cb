"""A result is whole: what a kill, damage or another run leaves is refused, or mended."""

import dataclasses
import json
import re
import signal
import zlib
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from bayesfric import results
from bayesfric.checkpoint import Checkpoint
from bayesfric.claims.checking import Checked
from bayesfric.claims.stored_fit import current_posterior
from bayesfric.comparing import compare
from bayesfric.diagnosis.diagnosed import Diagnosed
from bayesfric.diagnosis.shipped import fitted_numbers
from bayesfric.errors import InputError
from bayesfric.margins.posterior import read_posterior
from bayesfric.report.stored import read_stored
from bayesfric.resources import reference_folder
from bayesfric.results import (
    identified,
    read_json,
    read_tree,
    refuse_mixed,
    write_netcdf,
)
from bayesfric.schemas import ClaimsFile, DiagnosisFile


class Killed(BaseException):
    """What no one catches, as a kill."""


def claims_of(seed):
    claims = read_json(ClaimsFile, reference_folder() / "claims.json")
    tree = xr.DataTree.from_dict({"curves": xr.Dataset({"x": ("w", np.full(3, float(seed)))})})
    return Checked(identified(claims.model_copy(update={"seed": seed})), tree, 0.0)


def diagnosis_of(seed):
    diagnosis = read_json(DiagnosisFile, reference_folder() / "diagnosis.json")
    tree = xr.DataTree.from_dict({"residuals": xr.Dataset({"x": ("w", np.full(3, float(seed)))})})
    return Diagnosed(identified(diagnosis.model_copy(update={"seed": seed})), tree, 0.0)


@pytest.fixture
def pairs(small_fit):
    """Of each verb with several files: two results that differ, and the files of one."""

    few = small_fit.draws.isel(chain=slice(0, 4), draw=slice(0, 3))
    group = xr.Dataset({"x": ("w", np.arange(3.0))}, attrs={"rig": "gravity"})
    predictive = xr.DataTree.from_dict(dict.fromkeys(("coefficients", "densities", "ranks"), group))

    def fit_of(seed):
        summary = identified(small_fit.summary.model_copy(update={"seed": seed}))
        return dataclasses.replace(small_fit, summary=summary, draws=few, predictive=predictive)

    return {
        "fit": (fit_of(1), fit_of(2), ("draws.nc", "predictive.nc", "fit.json")),
        "claims": (claims_of(1), claims_of(2), ("claims.nc", "claims.json")),
        "diagnosis": (diagnosis_of(1), diagnosis_of(2), ("diagnosis.nc", "diagnosis.json")),
    }


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def killed_at(monkeypatch, place):
    """Kill at the rename of this number."""
    replace, calls = Path.replace, []

    def counted(self, target):
        if len(calls) == place:
            raise Killed
        calls.append(target)
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", counted)


@pytest.mark.parametrize("verb", ["fit", "claims", "diagnosis"])
@pytest.mark.parametrize("place", [0, 1, 2, 3])
def test_a_kill_at_any_rename_leaves_the_old_the_new_or_what_is_refused(
    pairs, verb, place, tmp_path, monkeypatch
):
    old, new, names = pairs[verb]
    new.write(tmp_path / "new")
    old.write(tmp_path / "out")
    before = {name: (tmp_path / "out" / name).read_bytes() for name in names}
    with monkeypatch.context() as patched:
        killed_at(patched, place)
        try:
            new.write(tmp_path / "out")
        except Killed:
            pass
        else:
            assert place >= len(names)
    after = {name: (tmp_path / "out" / name).read_bytes() for name in names}
    fresh = {name: (tmp_path / "new" / name).read_bytes() for name in names}
    if after in (before, fresh):
        read_stored(tmp_path / "out")
    else:
        with pytest.raises(InputError, match="same run"):
            read_stored(tmp_path / "out")
        with pytest.raises(InputError, match="same run"):
            compare(tmp_path / "out", tmp_path / "new")
    # Whatever a kill left, the next run puts right.
    new.write(tmp_path / "out")
    assert {name: (tmp_path / "out" / name).read_bytes() for name in names} == fresh


def test_every_reader_of_a_fit_refuses_draws_of_another(pairs, small_recording, tmp_path):
    old, new, _ = pairs["fit"]
    old.write(tmp_path)
    other = tmp_path / "other"
    new.write(other)
    (other / "draws.nc").replace(tmp_path / "draws.nc")
    analysis = old.summary.analysis
    with pytest.raises(InputError, match="same run"):
        read_stored(tmp_path)
    with pytest.raises(InputError, match="same run"):
        fitted_numbers(tmp_path)
    with pytest.raises(InputError, match="same run"):
        read_posterior(tmp_path / "draws.nc")
    from bayesfric.analysis import Analysis

    if old.summary.converged:
        with pytest.raises(InputError, match="same run"):
            current_posterior(tmp_path, small_recording, Analysis.model_validate(analysis))


def test_the_same_result_has_the_same_id_and_any_other_another(pairs):
    checked, other, _ = pairs["claims"]
    assert checked.summary.run_id == claims_of(1).summary.run_id != other.summary.run_id


def test_a_folder_in_the_place_of_a_file_leaves_the_old_result(pairs, tmp_path):
    old, new, _ = pairs["claims"]
    old.write(tmp_path)
    before = files(tmp_path)
    (tmp_path / "diagnosis.json").mkdir()
    with pytest.raises(InputError, match=r"diagnosis\.json"):
        pairs["diagnosis"][0].write(tmp_path)
    assert files(tmp_path) == before
    (tmp_path / "claims.nc").unlink()
    (tmp_path / "claims.nc").mkdir()
    with pytest.raises(InputError, match=r"claims\.nc"):
        new.write(tmp_path)
    assert (tmp_path / "claims.json").read_bytes() == before["claims.json"]


def test_damaged_netcdf_is_refused_wherever_it_is_damaged(pairs, tmp_path):
    """Cut at 20 places and altered at 200, each is refused; with its mark altered, it is read."""
    pairs["claims"][0].write(tmp_path)
    path = tmp_path / "claims.nc"
    whole = path.read_bytes()
    expected = read_tree(path)
    mark = whole.rindex(b"bayesfric sha256 ")
    for cut in np.linspace(0, mark - 1, 20).astype(int):
        path.write_bytes(whole[:cut])
        with pytest.raises(InputError, match=r"claims\.nc"):
            read_tree(path)
    random = np.random.default_rng(11)
    for _ in range(200):
        damaged = bytearray(whole)
        damaged[random.integers(mark)] ^= 1 << int(random.integers(8))
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"claims\.nc"):
            read_tree(path)
    path.write_bytes(whole[:mark] + b"B" + whole[mark + 1 :])
    xr.testing.assert_identical(read_tree(path), expected)


def test_an_array_of_more_bytes_than_any_result_has_is_refused(pairs, tmp_path, monkeypatch):
    pairs["claims"][0].write(tmp_path)
    monkeypatch.setattr(results, "LARGEST_ARRAY", 7)  # of a single number
    with pytest.raises(InputError, match=r"claims\.nc"):
        read_tree(tmp_path / "claims.nc")


def test_arrays_that_another_library_changed_are_read_as_they_are(pairs, tmp_path):
    """HDF5 cuts the checksum off: the file is read like one without."""
    pairs["claims"][0].write(tmp_path)
    path = tmp_path / "claims.nc"
    expected = read_tree(path)
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr("note", "seen")
    tree = read_tree(path)
    assert tree.attrs == expected.attrs | {"note": "seen"}
    del tree.attrs["note"]
    xr.testing.assert_identical(tree, expected)


def test_a_damaged_array_is_refused_where_the_checksum_of_the_file_is_lost(pairs, tmp_path):
    """By the array's own, whichever of its bytes is altered, of every reader."""
    pairs["claims"][0].write(tmp_path)
    path = tmp_path / "claims.nc"
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr("note", "seen")
    record = read_json(ClaimsFile, tmp_path / "claims.json")
    refuse_mixed(record, tmp_path / "claims.json")
    whole = path.read_bytes()
    for place in compressed(whole, 3 * 8 + 4):  # three numbers and their checksum
        damaged = bytearray(whole)
        damaged[place] ^= 8
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=r"claims\.nc"):
            read_tree(path)
        with pytest.raises(InputError, match=r"claims\.nc"):
            refuse_mixed(record, tmp_path / "claims.json")


def compressed(whole, size):
    """Return the places of the bytes of a file that zlib makes into so many."""
    for start in (match.start() for match in re.finditer(b"x", whole)):
        stream = zlib.decompressobj()
        try:
            content = stream.decompress(whole[start:])
        except zlib.error:
            continue
        if len(content) == size:
            return range(start, len(whole) - len(stream.unused_data))
    raise AssertionError("no array is compressed")


def test_arrays_without_a_group_that_was_written_are_refused(pairs, tmp_path):
    pairs["diagnosis"][0].write(tmp_path)
    path = tmp_path / "diagnosis.nc"
    tree = read_tree(path)
    xr.DataTree(xr.Dataset(attrs=tree.attrs)).to_netcdf(path, engine="netcdf4")
    with pytest.raises(InputError, match="a part of it is missing"):
        read_stored(tmp_path)


def test_damaged_json_says_which_file_and_where(pairs, tmp_path):
    pairs["claims"][0].write(tmp_path)
    path = tmp_path / "claims.json"
    content = json.loads(path.read_text())
    content["claims"][2]["verdict"] = "perhaps"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=r"claims\.json, claims\.2\.verdict"):
        read_json(ClaimsFile, path)
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(InputError, match=r"claims\.json.*line 1 column 500"):
        read_json(ClaimsFile, path)


DAMAGE = {
    "cut": lambda path: path.write_bytes(path.read_bytes()[:100]),
    "empty": lambda path: path.write_bytes(b""),
    "no zip": lambda path: path.write_bytes(b"x" * 300),
    "altered": lambda path: path.write_bytes(
        path.read_bytes().replace(b"\x00\x00\xf0?", b"\1\1\1\1")
    ),
    "a folder": lambda path: (path.unlink(), path.mkdir()),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_piece_is_computed_again(tmp_path, damage):
    Checkpoint(tmp_path / "c", "key").piece("a", lambda: {"x": np.array([1.0, 2.0])})
    DAMAGE[damage](tmp_path / "c" / "a.npz")
    again = Checkpoint(tmp_path / "c", "key").piece("a", lambda: {"x": np.array([1.0, 2.0])})
    assert again["x"].tolist() == [1.0, 2.0]
    kept = Checkpoint(tmp_path / "c", "key").piece("a", lambda: pytest.fail("it is kept"))
    assert kept["x"].tolist() == [1.0, 2.0]


@pytest.mark.parametrize("damage", ["a file", "a key that is no text"])
def test_a_checkpoint_that_is_none_is_thrown_away(tmp_path, damage):
    folder = tmp_path / "c"
    if damage == "a file":
        folder.write_text("mine")
    else:
        folder.mkdir()
        (folder / "key").write_bytes(b"\xff\xfe")
    piece = Checkpoint(folder, "key").piece("a", lambda: {"x": np.array(1.0)})
    assert piece["x"] == 1.0


def test_a_checkpoint_that_cannot_be_written_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="can be written"):
        Checkpoint(tmp_path / "file" / "c", "key")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_waits_until_a_file_is_written(tmp_path, monkeypatch, number):
    """An interrupt between two locks of xarray left the second taken: a wait without end."""
    tree = xr.DataTree(xr.Dataset({"x": ("draw", np.arange(3.0))}))
    whole = xr.DataTree.to_netcdf

    def interrupted(*given, **options):
        signal.raise_signal(number)
        whole(*given, **options)

    def interrupt(number, frame):
        raise KeyboardInterrupt

    before = signal.signal(number, interrupt)
    monkeypatch.setattr(xr.DataTree, "to_netcdf", interrupted)
    try:
        with pytest.raises(KeyboardInterrupt):
            write_netcdf(tree, tmp_path / "a.nc")
        assert signal.getsignal(number) is interrupt
    finally:
        signal.signal(number, before)
    assert xr.open_dataset(tmp_path / "a.nc")["x"].to_numpy().tolist() == [0.0, 1.0, 2.0]
