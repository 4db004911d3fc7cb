"""What docstrings tell of fields, read where a reader of results or of docs is told it too."""

import re
from inspect import cleandoc
from typing import Any

from pydantic import BaseModel, ConfigDict

SECTION = "\n\nFields\n------\n"
ENTRY = re.compile(r"^(\w+): (.+(?:\n {4}.+)*)", re.MULTILINE)
"""A name and its words; a line that goes on is indented."""


def fields_of(docstring: str | None) -> dict[str, str]:
    """Return what the last section of a class's docstring, ``Fields``, tells of each.

    Parameters
    ----------
    docstring : str or None
        Of a class; None, as with ``python -OO``, tells nothing.
    """
    section = cleandoc(docstring or "").partition(SECTION)[2]
    return {name: " ".join(words.split()) for name, words in ENTRY.findall(section)}


class Documented(BaseModel):
    """A model whose fields are described in its docstring.

    The descriptions go to the fields, from which schemas and documents are made; what is left of
    the docstring describes the model.
    """

    # Built when first used, with the descriptions; all of them at once take a tenth of a second.
    model_config = ConfigDict(defer_build=True)

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        super().__pydantic_init_subclass__(**options)
        for name, words in fields_of(vars(cls).get("__doc__")).items():
            cls.__pydantic_fields__[name].description = words
        cls.__doc__ = cleandoc(cls.__doc__ or "").partition(SECTION)[0]
