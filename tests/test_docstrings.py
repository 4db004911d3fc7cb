"""Keys of a model are described in its docstring, from which schemas and documents are made."""

import pytest

from bayesfric.docstrings import Documented, fields_of


class Bench(Documented):
    """A bench.

    It is made up.

    Fields
    ------
    length_m: Of the bench,
        over all.
    name: How it is called.
    """

    length_m: float = 1.0
    name: str


def test_words_of_the_docstring_describe_the_keys():
    schema = Bench.model_json_schema()
    assert schema["description"] == "A bench.\n\nIt is made up."
    assert schema["properties"]["length_m"]["description"] == "Of the bench, over all."
    assert schema["properties"]["name"]["description"] == "How it is called."
    assert schema["required"] == ["name"]


def test_a_key_that_is_described_exists():
    with pytest.raises(KeyError, match="width_m"):

        class _Other(Documented):
            """A bench.

            Fields
            ------
            width_m: Across.
            """

            length_m: float


def test_without_docstrings_nothing_is_described():
    assert fields_of(None) == {}
