"""What a hostile or damaged log may not do: run code, unpack to gigabytes, end in a trace."""

import io
import pickle
import struct
import zipfile
import zlib

import numpy as np
import pytest
from logs.written import ENDS, MAPPINGS, write
from typer.testing import CliRunner

from bayesfric.cli import app
from bayesfric.errors import InputError
from bayesfric.logs.readers import mat, mcap, npz, parquet, read_log
from bayesfric.logs.table import LARGEST_FILE, MOST_CELLS

HUGE = MOST_CELLS + 1


@pytest.mark.parametrize("end", ENDS)
def test_half_a_file_is_one_line_and_exit_2(tmp_path, end):
    log = write(tmp_path, end)
    file = log if log.is_file() else next(log.glob("*.db3"))
    content = file.read_bytes()
    half = content[: len(content) // 2] if end not in ("csv", "jsonl") else b"\xff" + content
    file.write_bytes(half)
    (tmp_path / "map.toml").write_text(MAPPINGS[end], encoding="utf-8")
    call = ["import", str(log), "-o", str(tmp_path / "made"), "--joint", "elbow"]
    for more in (["--map", str(tmp_path / "map.toml")], []):
        done = CliRunner().invoke(app, call + more)
        assert done.exit_code == 2, done.output
        assert len(done.stderr.strip().splitlines()) == 1, done.stderr
        assert log.name in done.stderr
    assert not (tmp_path / "made").exists()


class Runs:
    """Something whose unpickling would be noticed."""

    def __reduce__(self):
        return exec, ("raise SystemExit('a pickle was run')",)


def test_pickles_are_never_run(tmp_path):
    np.savez(tmp_path / "a.npz", q=np.arange(3.0), x=np.array([Runs()], dtype=object))
    log = read_log(tmp_path / "a.npz", None)
    assert list(log.columns) == ["q"]
    assert log.notes == ("Arrays of Python objects are never unpickled: x.",)
    np.save(tmp_path / "b.npy", np.array([Runs()], dtype=object))
    (tmp_path / "c.npy").write_bytes(pickle.dumps(Runs()))
    for name in ("b.npy", "c.npy"):
        with pytest.raises(InputError, match=name):
            read_log(tmp_path / name, None)


def header_of(shape):
    stream = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(stream, header)
    return stream.getvalue()


@pytest.mark.parametrize("shape", [(HUGE,), (2**62, 2**62), (3,), (-1, 4)])
def test_an_array_that_says_more_than_it_has_is_refused(tmp_path, shape):
    (tmp_path / "a.npy").write_bytes(header_of(shape) + bytes(16))
    with pytest.raises(InputError, match=r"cells|bytes of numbers"):
        npz.read(tmp_path / "a.npy")


def test_an_archive_is_measured_before_it_is_unpacked(tmp_path, monkeypatch):
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("q.npy", header_of((5_000_000,)) + bytes(40_000_000))
    assert (tmp_path / "a.npz").stat().st_size < 100_000
    monkeypatch.setattr(npz, "LARGEST_FILE", 39_000_000)
    monkeypatch.setattr(npz, "_array", None)  # nothing is unpacked
    with pytest.raises(InputError, match="found '40,000,128 bytes', expected at most 39,000,000"):
        npz.read(tmp_path / "a.npz")


def test_a_matlab_file_is_unpacked_to_its_bound_and_no_further(tmp_path, monkeypatch):
    packed = zlib.compress(bytes(40_000_000))
    head = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"
    content = head + struct.pack("<II", 15, len(packed)) + packed
    (tmp_path / "a.mat").write_bytes(content)
    monkeypatch.setattr(mat, "LARGEST_FILE", 39_000_000)
    with pytest.raises(InputError, match="expected at most 39,000,000 bytes when it is unpacked"):
        mat.read(tmp_path / "a.mat")


def test_a_matlab_file_with_huge_dimensions_is_refused(tmp_path):
    import h5py

    with h5py.File(tmp_path / "a.mat", "w") as file:  # a few bytes: nothing of it is allocated
        file.create_dataset("q", shape=(HUGE, 1), dtype="f8", chunks=(1 << 16, 1))
    with pytest.raises(InputError, match=f"expected at most {MOST_CELLS:,} cells"):
        mat.read(tmp_path / "a.mat")


def test_links_out_of_an_hdf5_file_are_not_followed(tmp_path):
    import h5py

    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["secret"] = np.arange(4.0)
    with h5py.File(tmp_path / "a.mat", "w") as file:
        file["q"] = np.arange(3.0)
        file["x"] = h5py.ExternalLink("other.h5", "/secret")
        file["y"] = h5py.SoftLink("/q")
    assert list(mat.read(tmp_path / "a.mat").columns) == ["q"]
    with h5py.File(tmp_path / "b.mat", "w") as file:
        layout = h5py.VirtualLayout(shape=(4,), dtype="f8")
        layout[:] = h5py.VirtualSource("other.h5", "secret", shape=(4,))
        file.create_virtual_dataset("q", layout)
    with pytest.raises(InputError, match=r"b\.mat, q: expected numbers that are in the file"):
        mat.read(tmp_path / "b.mat")


def test_a_parquet_file_is_measured_before_it_is_read(tmp_path, monkeypatch):
    import pyarrow as pa
    import pyarrow.parquet as pq

    pq.write_table(pa.table({"q": np.zeros(200_000)}), tmp_path / "a.parquet")
    assert (tmp_path / "a.parquet").stat().st_size < 10_000
    monkeypatch.setattr("bayesfric.logs.table.MOST_CELLS", 199_999)
    monkeypatch.setattr(pq.ParquetFile, "read", None)  # nothing is read
    with pytest.raises(InputError, match="found '200,000', expected at most 199,999 cells"):
        parquet.read(tmp_path / "a.parquet")


@pytest.mark.parametrize("says", [LARGEST_FILE + 1, 100])
def test_a_chunk_that_says_less_than_it_has_or_too_much_is_refused(tmp_path, says):
    from lz4.frame import compress

    packed = compress(bytes(40_000_000))
    chunk = struct.pack("<QQQI", 0, 0, says, 0) + struct.pack("<I", 3) + b"lz4"
    chunk += struct.pack("<Q", len(packed)) + packed
    content = mcap.MAGIC + bytes([mcap.CHUNK]) + struct.pack("<Q", len(chunk)) + chunk + mcap.MAGIC
    (tmp_path / "a.mcap").write_bytes(content)
    with pytest.raises(InputError, match=r"chunks of at most .* bytes, and as large as they say"):
        mcap.read(tmp_path / "a.mcap")


def test_a_compressed_bag_of_sqlite_is_refused(tmp_path):
    log = write(tmp_path, "bag")
    text = (log / "metadata.yaml").read_text("utf-8")
    assert "compression_mode: ''" in text
    (log / "metadata.yaml").write_text(
        text.replace("compression_mode: ''", "compression_mode: MESSAGE"), encoding="utf-8"
    )
    with pytest.raises(InputError, match="compression_mode: expected a bag whose files are not"):
        read_log(log, None)


@pytest.mark.parametrize("content", ["[" * 100_000, '{"t": {"a": 1}}', "3", "[]", "[3]", ""])
def test_json_that_is_no_table_is_refused(tmp_path, content):
    (tmp_path / "a.json").write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=r"a\.json"):
        read_log(tmp_path / "a.json", None)
