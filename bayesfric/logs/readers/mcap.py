"""MCAP files with messages of ROS 2; what its chunks unpack to is checked before they are."""

from pathlib import Path
from typing import IO

from bayesfric.errors import Fault, InputError
from bayesfric.logs.readers.ros2 import read_bag
from bayesfric.logs.table import LARGEST_FILE, Log, damaged_is_told

__all__ = ["read"]

MAGIC = b"\x89MCAP0\r\n"
CHUNK = 6
OF_CHUNK = 28  # bytes before the name of its compression: two times, its size and a checksum


def read(path: Path) -> Log:
    """Return the columns of an MCAP file, as :func:`bayesfric.logs.readers.ros2.read` does.

    Raises
    ------
    InputError
        It is damaged, or a chunk of it is too large when it is unpacked.
    """
    with damaged_is_told(path, "an MCAP file"), path.open("rb") as stream:
        _check_chunks(path.name, stream, path.stat().st_size)
    return read_bag(path)


def _check_chunks(name: str, stream: IO[bytes], size: int) -> None:
    if stream.read(len(MAGIC)) != MAGIC:
        raise InputError([Fault(name, "an MCAP file, which begins with its name")])
    while stream.tell() + 9 <= size - len(MAGIC):
        code = stream.read(1)[0]
        length = int.from_bytes(stream.read(8), "little")
        begin = stream.tell()
        if begin + length > size:
            raise InputError([Fault(name, "records that end before the file does")])
        if code == CHUNK:
            head = stream.read(OF_CHUNK + 4)
            unpacked = int.from_bytes(head[16:24], "little")
            kind = stream.read(min(int.from_bytes(head[OF_CHUNK:], "little"), 16))
            there = int.from_bytes(stream.read(8), "little")
            packed = stream.read(min(there, max(begin + length - stream.tell(), 0)))
            if unpacked > LARGEST_FILE or _is_larger(kind, packed, unpacked):
                expected = f"chunks of at most {LARGEST_FILE:,} bytes, and as large as they say"
                raise InputError([Fault(name, expected)])
        stream.seek(begin + length)


def _is_larger(kind: bytes, packed: bytes, unpacked: int) -> bool:
    """Return whether a chunk unpacks to more than it says, without unpacking that."""
    if kind == b"zstd":
        try:
            from compression import zstd
        except ImportError:
            from backports import zstd
        return len(zstd.ZstdDecompressor().decompress(packed, max_length=unpacked + 1)) > unpacked
    if kind == b"lz4":
        from lz4.frame import LZ4FrameDecompressor

        return len(LZ4FrameDecompressor().decompress(packed, max_length=unpacked + 1)) > unpacked
    return False
