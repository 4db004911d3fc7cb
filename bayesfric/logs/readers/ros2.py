"""Folders of ROS 2 bags, of SQLite or MCAP."""

import re
from pathlib import Path

from bayesfric.errors import Fault, InputError
from bayesfric.files import file_bytes
from bayesfric.logs.readers.bag import read_bag
from bayesfric.logs.readers.mcap import check_chunks
from bayesfric.logs.table import Log

METADATA = "metadata.yaml"
LARGEST_METADATA = 16 * 1024**2  # bytes
COMPRESSED = re.compile(rb"compression_mode:\s*['\"]?(file|message)", re.IGNORECASE)


def read(path: Path) -> Log:
    """Return the columns of a bag, as :func:`bayesfric.logs.readers.bag.read_bag` does.

    Raises
    ------
    InputError
        It is a bag's file without its folder, or its files or messages are compressed one by
        one, so that nothing says what they unpack to; or it is damaged.
    """
    if not path.is_dir():
        expected = f"the folder of the bag, in which {METADATA} is"
        raise InputError([Fault(path.name, expected, value="its file alone")])
    metadata = file_bytes(path / METADATA, METADATA, LARGEST_METADATA)
    if COMPRESSED.search(metadata):
        expected = "a bag whose files are not compressed; chunks of MCAP may be"
        raise InputError([Fault(METADATA, expected, column="compression_mode")])
    for file in sorted(path.glob("*.mcap")):
        check_chunks(file)
    return read_bag(path)
