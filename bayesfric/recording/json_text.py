"""Bytes of a JSON file → one object of finite numbers and clean text."""

import json
import math
import re
import reprlib
from collections import Counter
from typing import Any

from bayesfric.errors import Fault, InputError
from bayesfric.recording.csv_text import decode_utf8

CAPITALS = "; true, false and null are written in small letters"
MEANT = re.compile(r"(true|false|null|none)\b", re.IGNORECASE)
EMPTY_KEY = '""'  # so that its place can be reported


def parse_json_object(file: str, data: bytes) -> tuple[dict[str, Any], list[Fault]]:
    """Parse a JSON object.

    Returns
    -------
    dict
        The object.
    list of Fault
        Repeated keys, NaN and infinities, text that is not Unicode; parsing continues after
        them.

    Raises
    ------
    InputError
        If there is no JSON object.
    """
    text = decode_utf8(file, data)
    repeated: list[str] = []

    def unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        content_of_keys = dict(pairs)
        if len(content_of_keys) < len(pairs):
            counts = Counter(key for key, _ in pairs)
            repeated.extend(key for key, count in counts.items() if count > 1)
        return content_of_keys

    try:
        content = json.loads(text, object_pairs_hook=unique_keys)
    except json.JSONDecodeError as error:
        text_there = text[error.pos : error.pos + 20].split("\n")[0] or None
        why = error.msg + (CAPITALS if MEANT.match(text, error.pos) else "")
        raise InputError([Fault(file, f"JSON ({why})", error.lineno, None, text_there)]) from None
    except RecursionError:
        raise InputError([Fault(file, "JSON that is not nested so deeply")]) from None
    except ValueError:  # Python's limit of 4,300 digits
        raise InputError([Fault(file, "numbers of reasonable length")]) from None
    if not isinstance(content, dict):
        raise InputError([Fault(file, "a JSON object", value=shown(content))])
    faults = [
        Fault(file, "each key of an object once only", None, clean(key), clean(key))
        for key in repeated
    ]
    return content, faults + _unusable_values(file, content)


def dotted(location: tuple[str | int, ...]) -> str:
    """Place in a JSON file, such as ``resources[0].path``."""
    place = ""
    for key in location:
        place += f"[{key}]" if isinstance(key, int) else "." + (clean(key) or EMPTY_KEY)
    return place.removeprefix(".")


def shown(value: Any) -> str:
    """Print a JSON value, short enough for an error message."""
    if isinstance(value, str):
        return clean(value)
    if isinstance(value, dict | list):
        return clean(reprlib.repr(value))
    return json.dumps(value)


def clean(text: str) -> str:
    """Escape lone surrogates, which could not be printed."""
    return text.encode("utf-8", "backslashreplace").decode()


def _unusable_values(file: str, content: dict[str, Any]) -> list[Fault]:
    faults = []
    waiting: list[tuple[tuple[str | int, ...], Any]] = [((), content)]
    while waiting:  # an explicit stack, since the user's nesting may be deep
        place, value = waiting.pop()
        if isinstance(value, dict):
            waiting.extend(((*place, key), item) for key, item in reversed(value.items()))
            value = "".join(value)
        elif isinstance(value, list):
            waiting.extend(((*place, i), item) for i, item in reversed(list(enumerate(value))))
        if isinstance(value, float) and not math.isfinite(value):
            faults.append(Fault(file, "a finite number", None, dotted(place), shown(value)))
        if isinstance(value, str) and clean(value) != value:
            faults.append(Fault(file, "Unicode text", None, dotted(place) or None, clean(value)))
    return faults
