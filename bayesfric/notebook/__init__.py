"""The package as a person at a prompt uses it: paths or objects go in, tables and figures out."""

from bayesfric.notebook.calls import (
    check_claims,
    compute_margins,
    diagnose,
    fit,
    load,
    power,
)

__all__ = ["check_claims", "compute_margins", "diagnose", "fit", "load", "power"]
