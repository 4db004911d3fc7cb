"""Not yet."""

from fingerprint.numbers import Number


def numbers(rig: str) -> dict[str, Number]:
    return {}
