"""The attention list: a sentence for every check of a result that failed.

Each kind of result has a file of rules here. What they yield stands under ``attention`` in the
JSON file, in the terminal, on page one of the report, and is what ``--fail-on attention`` means.
"""
