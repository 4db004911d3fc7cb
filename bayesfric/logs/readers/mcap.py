"""MCAP files with messages of ROS 2; what its chunks unpack to is checked before they are."""

import sys
from importlib import import_module
from pathlib import Path

from bayesfric.errors import Fault, InputError
from bayesfric.logs.readers.bag import read_bag
from bayesfric.logs.table import LARGEST_FILE, Log, damaged_is_told

MAGIC = b"\x89MCAP0\r\n"
HEAD = 9  # bytes of a record before its content: what it is, and its length
CHUNK = 6
OF_CHUNK = 28  # bytes before the name of its compression: two times, its size and a checksum


def read(path: Path) -> Log:
    """Return the columns of an MCAP file, as :func:`bayesfric.logs.readers.bag.read_bag` does.

    Raises
    ------
    InputError
        It is damaged, or a chunk of it is too large when it is unpacked.
    """
    check_chunks(path)
    return read_bag(path)


def check_chunks(path: Path) -> None:
    """Refuse a file with a chunk that unpacks to more than it says, or to too much.

    Raises
    ------
    InputError
        It has one, or is no MCAP file.
    """
    with damaged_is_told(path, "an MCAP file"), path.open("rb") as stream:
        size = path.stat().st_size
        if stream.read(len(MAGIC)) != MAGIC:
            raise InputError([Fault(path.name, "an MCAP file, which begins with its name")])
        while stream.tell() + HEAD <= size - len(MAGIC):
            code, length = stream.read(1)[0], int.from_bytes(stream.read(8), "little")
            begin = stream.tell()
            if begin + length > size:
                raise InputError([Fault(path.name, "records that end before the file does")])
            if code == CHUNK:
                _check_chunk(path.name, stream.read(min(length, LARGEST_FILE)))
            stream.seek(begin + length)


def _check_chunk(name: str, chunk: bytes) -> None:
    unpacked = int.from_bytes(chunk[16:24], "little")
    kind_ends = OF_CHUNK + 4 + int.from_bytes(chunk[OF_CHUNK : OF_CHUNK + 4], "little")
    kind, packed = chunk[OF_CHUNK + 4 : kind_ends], chunk[kind_ends + 8 :]
    there = int.from_bytes(chunk[kind_ends : kind_ends + 8], "little")
    if unpacked > LARGEST_FILE or _is_larger(kind, packed[:there], unpacked):
        expected = f"chunks of at most {LARGEST_FILE:,} bytes, and as large as they say"
        raise InputError([Fault(name, expected)])


def _is_larger(kind: bytes, packed: bytes, unpacked: int) -> bool:
    """Return whether a chunk unpacks to more than it says, without unpacking that."""
    if kind == b"zstd":
        ours = sys.version_info >= (3, 14)
        zstd = import_module("compression.zstd" if ours else "backports.zstd")
        unpacker = zstd.ZstdDecompressor()
    elif kind == b"lz4":
        unpacker = import_module("lz4.frame").LZ4FrameDecompressor()
    else:
        return False
    length = len(unpacker.decompress(packed, max_length=unpacked + 1))
    return length > unpacked or bool(unpacker.unused_data)
