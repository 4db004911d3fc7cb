"""The attention list: a sentence for every check of a result that failed.

Each kind of result has a file of rules here. What they yield stands under ``attention`` in the
JSON file, in the terminal, on page one of the report, and is what ``--fail-on attention`` means.
"""

from bayesfric.attention.claims import of_claims
from bayesfric.attention.diagnosis import biased_numbers, of_diagnosis
from bayesfric.attention.fit import Coverage, contradicted, of_fit, of_pooled, unsettled
from bayesfric.attention.margins import of_margins
from bayesfric.attention.together import attention_of_all

__all__ = [
    "Coverage",
    "attention_of_all",
    "biased_numbers",
    "contradicted",
    "of_claims",
    "of_diagnosis",
    "of_fit",
    "of_margins",
    "of_pooled",
    "unsettled",
]
