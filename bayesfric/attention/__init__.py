"""The attention list: a sentence for every check of a result that failed.

Each kind of result has a file of rules here. What they yield stands under ``attention`` in the
JSON file, in the terminal, on page one of the report, and is what ``--fail-on attention`` means.
"""

from bayesfric.attention.claims import of_claims as of_claims
from bayesfric.attention.diagnosis import biased_numbers as biased_numbers
from bayesfric.attention.diagnosis import of_diagnosis as of_diagnosis
from bayesfric.attention.diagnosis import why_untrusted as why_untrusted
from bayesfric.attention.fit import Coverage as Coverage
from bayesfric.attention.fit import contradicted as contradicted
from bayesfric.attention.fit import of_fit as of_fit
from bayesfric.attention.fit import of_pooled as of_pooled
from bayesfric.attention.fit import unsettled as unsettled
from bayesfric.attention.margins import of_margins as of_margins
from bayesfric.attention.together import attention_of_all as attention_of_all
