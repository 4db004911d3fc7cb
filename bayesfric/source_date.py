"""The date that who builds a result gives it: ``SOURCE_DATE_EPOCH``, as reproducible builds do."""

import os
import re
from datetime import UTC, datetime

from bayesfric.errors import Fault, InputError

SOURCE_DATE_EPOCH = "SOURCE_DATE_EPOCH"


def source_date() -> datetime | None:
    """Return the date that the environment gives; None where the variable is empty or not set.

    Raises
    ------
    InputError
        It is set to something that is not a number of seconds, or beyond the year 9999.
    """
    given = os.environ.get(SOURCE_DATE_EPOCH, "").strip()
    if not given:
        return None
    try:
        if not re.fullmatch(r"-?[0-9]{1,12}", given):
            raise ValueError(given)
        return datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError) as error:
        expected = "whole seconds since 1970, or nothing"
        fault = Fault("environment", expected, column=SOURCE_DATE_EPOCH, value=given)
        raise InputError([fault]) from error
