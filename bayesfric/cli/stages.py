"""Stages of one run, listed as they end: a run that is started again computes none of them anew.

Whether it had been interrupted or was whole makes no difference; what a stage depends on does.
"""

import hashlib
import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from pydantic import BaseModel, ValidationError

from bayesfric.cli.printing import say
from bayesfric.files import write_whole
from bayesfric.results import json_bytes

LIST = ".stages.json"


class Stage(BaseModel):
    """A stage that is done: what happened, how long it took, and the digests of its files."""

    happened: list[str]
    seconds: float
    files: dict[str, str]
    read: str = ""  # digest of files that it read, where they are not those of the run's key


class Listed(BaseModel):
    """What is kept in the folder of the results."""

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

    Attributes
    ----------
    computed : bool
        Whether any stage was run, and not kept.
    """

    def __init__(self, folder: Path, key: dict[str, object], *, quiet: bool) -> None:
        self._folder, self._quiet = folder, quiet
        self.computed = False
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

    def stands(self, name: str, read: str = "") -> bool:
        """Return whether a stage is done, of what it would read now, and its files stand."""
        kept_stage = self._listed.stages.get(name)
        return (
            kept_stage is not None
            and kept_stage.read == read
            and all(digest(Path(path)) == kept for path, kept in kept_stage.files.items())
        )

    def after(
        self,
        name: str,
        work: Callable[[], set[str]],
        *,
        read: str = "",
        elsewhere: Mapping[str, float] = MappingProxyType({}),
    ) -> set[str]:
        """Return what happened in a stage: it is run, unless it is done and its files stand.

        Parameters
        ----------
        name : str
            Of the stage.
        work : callable
            Writes files of the folder, and returns what happened.
        read : str
            Digest of what it reads beside what is in the key of the run.
        elsewhere : mapping of str to float
            Seconds that a stage took in another process, whatever `work` waited; read when the
            work is done.
        """
        if self.stands(name, read):
            if not self._quiet:
                say(f"{name}: done before, and kept", err=True)
            return set(self._listed.stages[name].happened)
        before = self._written()
        began = time.perf_counter()
        happened = work()
        seconds = elsewhere.get(name, time.perf_counter() - began)
        new = [path for path, state in self._written().items() if before.get(path) != state]
        self._listed.stages[name] = Stage(
            happened=sorted(happened),
            seconds=seconds,
            files={str(path.resolve()): digest(path) for path in new},
            read=read,
        )
        self.computed = True
        self._keep()
        return happened

    def rewritten(self, path: Path) -> None:
        """Take note that a file of some stage has been written once more, outside of it."""
        place = str(path.resolve())
        for stage in self._listed.stages.values():
            if place in stage.files:
                stage.files[place] = digest(path)
        self._keep()

    def _keep(self) -> None:
        write_whole(self._folder / LIST, json_bytes(self._listed))

    def _written(self) -> dict[Path, tuple[int, int]]:
        """Return when the folder's files were written, and their sizes."""
        files = [path for path in self._folder.iterdir() if path.is_file()]
        states = {path: path.stat() for path in files if not path.name.startswith(".")}
        return {path: (state.st_mtime_ns, state.st_size) for path, state in states.items()}


def digest_of_results(folder: Path, *without: str) -> str:
    """Return the SHA-256 over names and bytes of the files in a folder, without some of them.

    Parameters
    ----------
    folder : Path
        Of results; hidden files do not count.
    *without : str
        Names of files that do not count either.
    """
    whole = hashlib.sha256()
    for path in sorted(folder.iterdir()):
        if path.is_file() and not path.name.startswith(".") and path.name not in without:
            whole.update(f"{path.name} {digest(path)}\n".encode())
    return whole.hexdigest()


def digest(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits; nothing where there is no file."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
