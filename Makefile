# make demo       install, run the four tasks with four methods in physics, print the table, write records and videos
# make test       install, lint, type-check and run the fast tests
# make test-all   the same with the long tests
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: demo test test-all tables tables-check lint install clean

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

test-all: lint
	$(BIN)/pytest -n 2

clean:
	rm -rf $(VENV) demo_output .pytest_cache .mypy_cache .ruff_cache
