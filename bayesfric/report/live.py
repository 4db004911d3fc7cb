"""The scripts by which a page draws its charts: a library's, which is never imported, and ours."""

from functools import cache
from importlib import resources
from importlib.util import find_spec
from pathlib import Path

LIBRARY = "bokeh"
FILES = ("bokeh.min.js", "bokeh-api.min.js")


@cache
def live_scripts() -> tuple[str, ...]:
    """Return the scripts that draw charts in a page, in the order in which they run.

    Returns
    -------
    tuple of str
        The browser's part of Bokeh, and ``live.js``, which uses it. Empty where Bokeh is not
        installed: figures are still then.
    """
    library = find_spec(LIBRARY)
    if library is None or library.origin is None:
        return ()
    folder = Path(library.origin).parent / "server" / "static" / "js"
    ours = resources.files(__package__).joinpath("live.js").read_text(encoding="utf-8")
    return (*((folder / name).read_text(encoding="utf-8") for name in FILES), ours)
