# make demo       install, run the four tasks with four methods in physics, print the table, write records and videos
# make test       install, lint, type-check and run the fast tests
# make test-all   the same with the long tests, and robosuite's
# make robosuite  install robosuite apart, run the tests of our kitchens in it and print how fast they are
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
ROBOSUITE := .venv-robosuite

.PHONY: demo test test-all robosuite robosuite-test tables tables-check lint install clean

$(VENV)/.installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/.installed-dev: $(VENV)/.installed
	$(BIN)/pip install --quiet --disable-pip-version-check --editable ".[dev]"
	touch $@

install: $(VENV)/.installed

demo: $(VENV)/.installed
	$(BIN)/remac demo

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/mypy

test: lint tables-check
	$(BIN)/pytest -n 2 -m "not long"

# Every table of README and docs from the command that stands beside it; tables-check looks at those that take seconds.
tables: $(VENV)/.installed-dev
	$(BIN)/python docs/make_tables.py

tables-check: $(VENV)/.installed-dev
	$(BIN)/python docs/make_tables.py --check

test-all: lint robosuite-test
	$(BIN)/pytest -n 2

# Without robosuite's own pins, which force an old NumPy and a compiler: docs/robosuite.md.
$(ROBOSUITE)/.installed: pyproject.toml
	$(PYTHON) -m venv $(ROBOSUITE)
	$(ROBOSUITE)/bin/pip install --quiet --disable-pip-version-check --editable ".[for-robosuite]" pytest pytest-xdist hypothesis
	$(ROBOSUITE)/bin/pip install --quiet --disable-pip-version-check --no-deps robosuite==1.5.2
	touch $@

robosuite-test: $(ROBOSUITE)/.installed
	$(ROBOSUITE)/bin/python -m pytest -n 2 tests/integrations

robosuite: robosuite-test
	$(ROBOSUITE)/bin/python benchmarks/speed.py --only robosuite

clean:
	rm -rf $(VENV) $(ROBOSUITE) demo_output .pytest_cache .mypy_cache .ruff_cache
