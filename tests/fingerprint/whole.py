"""Not yet."""

from fingerprint.numbers import Number


def of_fit(rig: str) -> dict[str, Number]:
    return {}


def of_diagnosis(rig: str) -> dict[str, Number]:
    return {}
