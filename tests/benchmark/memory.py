"""The memory of a process as the kernel counts it; Linux alone."""

import re
from pathlib import Path


def peak_mib():
    """Return the peak of this process since it was started [MiB].

    ``getrusage`` would tell the parent's peak where that is larger, since a child begins as its
    copy.
    """
    return _mib("VmHWM")


def resident_mib():
    """Return what this process holds now [MiB]."""
    return _mib("VmRSS")


def _mib(name):
    status = Path("/proc/self/status").read_text()
    return int(re.search(rf"{name}:\s+(\d+) kB", status)[1]) / 1024
