"""The one place that knows where the bundled files are.

They stand beside the package in the source tree, and inside it, under
``_data/``, in an installed wheel.
"""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def data_folder() -> Path:
    """Return the bundled ``data/``: recordings, example loops, the paper's tables."""
    return _folder("data")


def bundled_recording() -> Path:
    """Return the bundled synthetic recording of the paper's protocol."""
    return data_folder() / "recordings" / "synthetic-paper"


def bundled_loops() -> dict[str, Path]:
    """Return the bundled loop files by the names that they are asked for with."""
    files = sorted((data_folder() / "loops").glob("*.toml"))
    return {path.stem: path for path in files if path != loop_template()}


def loop_template() -> Path:
    """Return the loop file with every key and a comment on each."""
    return data_folder() / "loops" / "template.toml"


def reference_folder() -> Path:
    """Return the bundled ``reports/reference/``: the reference run, read-only."""
    return _folder("reports/reference")


def _folder(name: str) -> Path:
    bundled = _PACKAGE / "_data" / name
    if bundled.is_dir():
        return bundled
    root = _PACKAGE.parent
    # Without this, a wheel that lost its files would take a stranger's `data`
    # in site-packages for ours.
    if (root / "pyproject.toml").is_file() and (root / name).is_dir():
        return root / name
    raise FileNotFoundError(
        f"bayesfric's bundled folder {name!r} is neither at {bundled} nor at {root / name}: "
        "the installation is incomplete, reinstall bayesfric"
    )
