"""Stages of one run, listed as they end, so that a run that was interrupted goes on after them."""

import hashlib
import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from pydantic import BaseModel, ValidationError

from bayesfric.cli.printing import say
from bayesfric.results import json_bytes

__all__ = ["Stages", "digest"]

LIST = ".stages.json"


class Stage(BaseModel):
    """A stage that is done: what happened, how long it took, and the digests of its files."""

    happened: list[str]
    seconds: float
    files: dict[str, str]


class Listed(BaseModel):
    """What is kept in the folder of the results until the whole run is done."""

    key: str
    stages: dict[str, Stage] = {}


class Stages:
    """The stages of one run.

    Parameters
    ----------
    folder : Path
        Of the run's results.
    key : dict
        Everything on which they depend, as plain JSON types. Stages of a run with another key,
        and of a list that does not read, count as not done.
    quiet : bool
        Do not say that a stage is kept.
    """

    def __init__(self, folder: Path, key: dict[str, object], *, quiet: bool) -> None:
        self._folder, self._quiet = folder, quiet
        whole = hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()
        self._listed = Listed(key=whole)
        try:
            listed = Listed.model_validate_json((folder / LIST).read_bytes())
        except (OSError, ValidationError):
            return
        if listed.key == whole:
            self._listed = listed

    @property
    def seconds(self) -> dict[str, float]:
        """Of each stage that is done, by its name."""
        return {name: stage.seconds for name, stage in self._listed.stages.items()}

    def stands(self, name: str) -> bool:
        """Return whether a stage is done and its files are as it wrote them."""
        known = self._listed.stages.get(name)
        return known is not None and all(
            digest(Path(path)) == kept for path, kept in known.files.items()
        )

    def after(
        self,
        name: str,
        work: Callable[[], set[str]],
        *also: Path,
        elsewhere: Mapping[str, float] = MappingProxyType({}),
    ) -> set[str]:
        """Return what happened in a stage: it is run, unless it is done and its files stand.

        Parameters
        ----------
        name : str
            Of the stage.
        work : callable
            Writes files of the folder, and returns what happened.
        *also : Path
            Further files that it writes, outside the folder.
        elsewhere : mapping of str to float
            Seconds that a stage took in another process, whatever `work` waited; read when the
            work is done.
        """
        if self.stands(name):
            if not self._quiet:
                say(f"{name}: done before this run was interrupted, and kept", err=True)
            return set(self._listed.stages[name].happened)
        before = self._written()
        began = time.perf_counter()
        happened = work()
        seconds = elsewhere.get(name, time.perf_counter() - began)
        new = [path for path, state in self._written().items() if before.get(path) != state]
        self._listed.stages[name] = Stage(
            happened=sorted(happened),
            seconds=seconds,
            files={str(path.resolve()): digest(path) for path in [*new, *also]},
        )
        partial = self._folder / f"{LIST}.partial"
        partial.write_bytes(json_bytes(self._listed))
        partial.replace(self._folder / LIST)
        return happened

    def forget(self) -> None:
        """Remove the list: the run is whole, and the next one begins anew."""
        (self._folder / LIST).unlink(missing_ok=True)

    def _written(self) -> dict[Path, tuple[int, int]]:
        """Return when the folder's files were written, and their sizes."""
        files = [path for path in self._folder.iterdir() if path.is_file()]
        states = {path: path.stat() for path in files if not path.name.startswith(".")}
        return {path: (state.st_mtime_ns, state.st_size) for path, state in states.items()}


def digest(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits; nothing where there is no file."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
