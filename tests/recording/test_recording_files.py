"""Anything may lie on disk: each oddity is one clear fault, or none at all."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from recording.mini import Mini

from bayesfric.errors import Fault, InputError
from bayesfric.recording import read_recording

STEADY, PACKAGE = "steady_friction.csv", "datapackage.json"


def steady_only(tmp_path: Path) -> Path:
    return Mini().keep(STEADY).write(tmp_path / "recording")


def only_fault(path: Path | str) -> Fault:
    with pytest.raises(InputError) as caught:
        read_recording(path)
    (fault,) = caught.value.faults
    return fault


GOOD = b"run,friction_n\ns1,0.7\ns2,0.8\n"

BYTES: list[tuple[str, bytes, tuple[int | None, str | None, str | None], str]] = [
    ("empty", b"", (None, None, None), "a header in line 1"),
    ("blank lines", b"\n\r\n  \n", (None, None, None), "a header in line 1"),
    ("header below line 1", b"\n" + GOOD, (None, None, None), "a header in line 1"),
    ("header only", b"run,friction_n\n", (1, None, None), "at least one row"),
    ("latin-1", b"run,friction_n\ns1,0.7\ns\xe9,0.8\n", (3, None, "byte 0xe9"), "UTF-8"),
    ("utf-16", GOOD.decode().encode("utf-16"), (1, None, "byte 0xff"), "UTF-8"),
    ("bad byte behind a BOM", b"\xef\xbb\xbfrun\n\xff", (2, None, "byte 0xff"), "UTF-8"),
    ("NUL", b"run,friction_n\ns1,0\x00.7\n", (2, None, "byte 0x00"), "without NUL"),
    ("row too long", GOOD + b"s3,0.7,1\n", (4, None, "3 cells"), "2 cells, as in the header"),
    ("row too short", GOOD + b"s3\n", (4, None, "1 cells"), "2 cells, as in the header"),
    ("open quote", GOOD + b'"s3,0.7\n', (4, None, None), "quoted with pairs"),
    ("text behind a quote", GOOD + b'"s3"x,0.7\n', (4, None, None), "quoted with pairs"),
    ("giant cell", GOOD + b"s" * 200_000 + b",0.7\n", (4, None, None), "field larger"),
    (
        "column twice",
        b"run,friction_n,x,x\ns1,0.7,1,2\n",
        (1, "x", "x"),
        "a column name once only",
    ),
]


@pytest.mark.parametrize(
    ("content", "place", "rule"), [case[1:] for case in BYTES], ids=[case[0] for case in BYTES]
)
def test_bytes_that_are_no_table(
    tmp_path: Path, content: bytes, place: tuple[Any, ...], rule: str
) -> None:
    folder = steady_only(tmp_path)
    (folder / STEADY).write_bytes(content)
    fault = only_fault(folder)
    assert (fault.file, fault.row, fault.column, fault.value) == (STEADY, *place)
    assert rule in fault.expected


@pytest.mark.parametrize(
    "content",
    [
        GOOD,
        b"\xef\xbb\xbf" + GOOD,
        GOOD.replace(b"\n", b"\r\n"),
        GOOD.rstrip(),
        GOOD.replace(b",", b" , "),
        GOOD + b"\n\n,\n",
        b'"run","friction_n"\n"s1","0.7"\n"s2","0.8"\n',
        b"friction_n,run\n0.7,s1\n0.8,s2\n",
        b"run,friction_n,,\ns1,0.7,,\ns2,0.8,,\n",
    ],
    ids=["lf", "bom", "crlf", "no last newline", "spaces", "blank rows", "quotes", "order", "tail"],
)
def test_ways_of_writing_the_same_table(tmp_path: Path, content: bytes) -> None:
    folder = steady_only(tmp_path)
    (folder / STEADY).write_bytes(content)
    steady = read_recording(folder).steady
    expected = pd.DataFrame({"run": ["s1", "s2"], "friction_n": [0.7, 0.8]})
    pd.testing.assert_frame_equal(steady, expected, check_column_type=False)


def test_rows_are_lines_of_the_file(tmp_path: Path) -> None:
    """Blank lines and line breaks inside quotes count as lines."""
    folder = steady_only(tmp_path)
    (folder / STEADY).write_bytes(b'run,friction_n,x\n\ns1,0.7,"a\nb"\n\ns2,fast,1\n')
    fault = only_fault(folder)
    assert (fault.row, fault.column, fault.value) == (6, "friction_n", "fast")


def test_wrong_length_does_not_hide_the_other_faults(tmp_path: Path) -> None:
    folder = steady_only(tmp_path)
    (folder / STEADY).write_bytes(b"run,friction_n\ns1\ns2,x\n")
    with pytest.raises(InputError) as caught:
        read_recording(folder)
    assert [(f.row, f.value) for f in caught.value.faults] == [(2, "1 cells"), (3, "x")]


def delete(folder: Path, name: str) -> None:
    (folder / name).unlink()


def make_folder(folder: Path, name: str) -> None:
    delete(folder, name)
    (folder / name).mkdir()


def make_pipe(folder: Path, name: str) -> None:
    delete(folder, name)
    os.mkfifo(folder / name)


def link_outside(folder: Path, name: str) -> None:
    (folder / name).rename(folder.parent / name)
    (folder / name).symlink_to(folder.parent / name)


def link_to_itself(folder: Path, name: str) -> None:
    delete(folder, name)
    (folder / name).symlink_to(folder / name)


@pytest.mark.parametrize("name", [STEADY, PACKAGE])
@pytest.mark.parametrize(
    ("spoil", "value", "rule"),
    [
        (delete, None, "a file of this name"),
        (make_folder, "a folder", "a file of this name"),
        (make_pipe, None, "a file of this name"),
        (link_outside, "itself", "a file inside the recording's folder"),
        (link_to_itself, "any", "a file"),
    ],
)
def test_file_that_is_none(
    tmp_path: Path, name: str, spoil: Callable[[Path, str], None], value: str | None, rule: str
) -> None:
    folder = steady_only(tmp_path)
    spoil(folder, name)
    fault = only_fault(folder)
    assert fault.file == name
    assert rule in fault.expected
    assert value == "any" or fault.value == (name if value == "itself" else value)


@pytest.mark.parametrize("name", [STEADY, PACKAGE])
def test_file_that_cannot_be_read(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = steady_only(tmp_path)
    read = Path.read_bytes

    def refuse(path: Path) -> bytes:
        if path.name == name:
            raise PermissionError(13, "Permission denied")
        return read(path)

    monkeypatch.setattr(Path, "read_bytes", refuse)
    fault = only_fault(folder)
    assert (fault.file, fault.expected) == (name, "a readable file (Permission denied)")


def test_link_inside_the_folder_is_followed(tmp_path: Path) -> None:
    folder = steady_only(tmp_path)
    (folder / STEADY).rename(folder / "kept.csv")
    (folder / STEADY).symlink_to("kept.csv")
    assert read_recording(folder).steady is not None


@pytest.mark.parametrize("path", ["nowhere", "file", "\0", "x" * 5000])
def test_no_folder_at_all(tmp_path: Path, path: str) -> None:
    (tmp_path / "file").write_text("")
    fault = only_fault(f"{tmp_path}/{path}")
    assert "a folder that holds datapackage.json" in fault.expected
    assert fault.file == f"{tmp_path}/{path}"


@pytest.mark.parametrize(
    "path",
    [
        "../steady_friction.csv",
        "tables/../../steady_friction.csv",
        "/etc/steady_friction.csv",
        "C:/steady_friction.csv",
        "..\\steady_friction.csv",
        "https://example.org/steady_friction.csv",
        "a\0b/steady_friction.csv",
    ],
)
def test_path_that_leaves_the_folder(tmp_path: Path, path: str) -> None:
    mini = Mini().keep(STEADY)
    folder = mini.write(tmp_path / "recording")
    (tmp_path / STEADY).write_bytes(GOOD)
    mini.package["resources"][0]["path"] = path
    mini.write(folder)
    fault = only_fault(folder)
    place = (fault.file, fault.column, fault.value)
    assert place == (PACKAGE, "resources[0].path", path)
    assert "stays in the folder" in fault.expected


def test_table_known_by_its_resource_name_in_a_subfolder(tmp_path: Path) -> None:
    mini = Mini().keep(STEADY)
    mini.package["resources"][0]["path"] = "./tables/my bench.csv"
    folder = mini.write(tmp_path)
    (folder / "tables").mkdir()
    (folder / STEADY).rename(folder / "tables" / "my bench.csv")
    assert read_recording(folder).steady is not None
    (folder / "tables" / "my bench.csv").write_bytes(b"run,friction_n\ns1,x\n")
    assert only_fault(folder).file == "tables/my bench.csv"
