"""Margins of a cable-driven control loop under the uncertainty of its friction."""

from bayesfric.margins.computing import Margins, compute_margins
from bayesfric.margins.loop_file import Loop
from bayesfric.margins.loop_reading import loop_path, read_loop

__all__ = ["Loop", "Margins", "compute_margins", "loop_path", "read_loop"]
