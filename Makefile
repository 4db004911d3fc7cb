# Every target sets up what it needs; recipes quote everything, so that a path may hold spaces.

# Whatever the environment says, Python keeps what it compiles: tests start many processes, and
# each would compile all libraries anew.
unexport PYTHONDONTWRITEBYTECODE

VENV ?= .venv
python = "$(VENV)/bin/python"

.PHONY: help setup report docs test tests quality coverage fingerprint fingerprint-mutation \
	test-nightly evidence-check release-evidence fuzz mutation bench clean

help:
	@echo 'make report            the bundled recording to posteriors and a PDF, in reports/latest/'
	@echo 'make docs              the documentation as HTML, with example reports, in docs/_build/; minutes'
	@echo 'make test              what CI runs: quality, and beside it the tests; minutes'
	@echo 'make quality           lint, formatting and types'
	@echo 'make fingerprint       the numbers of all rooms anew, and which of them moved; seconds'
	@echo 'make fingerprint-mutation  altered formulas that the fingerprint has to notice; minutes'
	@echo 'make coverage          the tests again, with the branches that they take; 90 % or it fails'
	@echo 'make test-nightly      cases of the campaigns again, compared with reports/evidence/; an hour'
	@echo 'make evidence-check    those of the campaigns alone whose numbers have moved; PARTS=… of others'
	@echo 'make release-evidence  the campaigns, hours, from where they stopped; CAMPAIGNS=--list for what is left'
	@echo 'make fuzz              altered files for ten minutes, from where it stopped'
	@echo 'make mutation          altered formulas that the tests have to notice, from where it stopped; half an hour'
	@echo 'make bench             speed, held against what the project promises and beside other samplers;'
	@echo '                       PEERS= without these, and nothing is written'
	@echo 'make clean             remove caches, builds and reports/latest/ (and keep $(VENV)/)'
	@echo
	@echo 'All of them set up $(VENV)/ first (VENV=… for another), with the first of python3.13,'
	@echo 'python3.12, python3.11, python3 that is 3.11 or newer (PYTHON=… for another).'

setup:
	@sh .ci/setup "$(VENV)"

report: setup
	@"$(VENV)/bin/bayesfric" run -o reports/latest

docs: setup
	$(python) docs/examples.py
	$(python) -m sphinx -W --keep-going -q docs docs/_build
	@mkdir -p docs/_build/examples
	@cd docs/_examples && cp -R *.html *.svg board joint margins ../_build/examples/

# Types are checked on one core, beside the tests on two: what either leaves idle the other takes.
test: setup
	@$(MAKE) --no-print-directory -j 2 quality tests

tests: setup
	$(python) -m pytest -n 2 --dist loadfile --no-loadscope-reorder

# Options of mypy.
TYPES ?=

quality: setup
	$(python) -m ruff check .
	$(python) -m ruff format --check .
	$(python) -m mypy $(TYPES)
	@PYTHONPATH=tests $(python) -m campaigns.evidence

# MOVE="part ..." WHY="reason" writes the numbers of these parts, and a line in CHANGELOG.md.
fingerprint: setup
	@PYTHONPATH=tests $(python) -m fingerprint $(if $(MOVE),--move $(MOVE) --why "$(WHY)")

fingerprint-mutation: setup
	PYTHONPATH=tests $(python) -m fingerprint.mutation

# Processes of their own, which xdist's workers are too, leave data that are put together here.
coverage: setup
	@mkdir -p build
	$(python) -m pytest -n 2 --dist loadfile --no-loadscope-reorder --cov --cov-report=term

# Campaigns start two processes of their own.
test-nightly: setup
	$(python) -m pytest -m nightly --timeout=3600
	BAYESFRIC_HYPOTHESIS_EXAMPLES=2000 $(python) -m pytest -n 2 tests/recording/test_recording_fuzz.py

# Names of campaigns, or --list.
CAMPAIGNS ?=

release-evidence: setup
	@PYTHONPATH=tests $(python) -m campaigns.release $(CAMPAIGNS)

# Names of parts of the fingerprint; those that have moved, where none is named.
PARTS ?=

evidence-check: setup
	@PYTHONPATH=tests $(python) -m campaigns.check $(PARTS)

MINUTES ?= 10

fuzz: setup
	PYTHONPATH=tests $(python) -m fuzzing.campaign --minutes $(MINUTES)

# As peers do, the tool that alters formulas lives in an environment of its own.
MUTATING ?= build/mutating

mutation: setup
	@test -x "$(MUTATING)/bin/python" || $(python) -m venv "$(MUTATING)"
	"$(MUTATING)/bin/python" -m pip install -q -r tests/mutation/tools.txt
	PYTHONPATH=tests $(python) -m mutation.campaign "$(MUTATING)/bin/python"

# Peers live in an environment of their own, and never in the project's; PEERS= runs none of them,
# prints the targets that need none, and writes nothing.
PEERS ?= build/peers
REPEATS ?= 3

bench: setup
ifneq ($(PEERS),)
	@test -x "$(PEERS)/bin/python" || $(python) -m venv "$(PEERS)"
	"$(PEERS)/bin/python" -m pip install -q -r tests/benchmark/peers.txt
endif
	@$(python) -m compileall -q bayesfric
	PYTHONPATH=tests REPEATS="$(REPEATS)" $(python) -m benchmark $(if $(PEERS),"$(PEERS)/bin/python")

clean:
	rm -rf build dist docs/_build docs/_examples reports/latest .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find bayesfric tests -name __pycache__ -prune -exec rm -rf {} +
