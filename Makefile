# Every target works from a bare clone on a machine with Python 3.11 or later and make.
# Another interpreter:  make test PYTHON=python3.12      More arguments to pytest:  make test ARGS="-k bank"

PYTHON ?= python3
VENV   ?= .venv
ARGS   ?=
DEMO   ?= rotatum-demo

BIN     := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --constraint constraints.txt --editable

.PHONY: help demo test test-all check static documented bench docs clean
.DELETE_ON_ERROR:

help:
	@echo "make demo    a log with known truth through every method; the report goes to $(DEMO)/"
	@echo "make test    the tests"
	@echo "make test-all  with the paper's larger cases, some minutes more"
	@echo "make check   formatting, lint, types, import contracts, kernel subset, house rules, docs"
	@echo "make bench   the benchmarks (needs a C compiler)"
	@echo "make docs    the documentation, into docs/_build/html/"
	@echo "make clean   back to a bare clone"

demo: $(VENV)/.core
	$(BIN)/rotatum demo -o $(DEMO)

test: $(VENV)/.test
	$(BIN)/python -m pytest --numprocesses auto --dist loadfile $(ARGS)

test-all: export ROTATUM_SLOW = 1
test-all: test

check: static documented

static: $(VENV)/.dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m rotatum.export.subset
	$(BIN)/python -m checks.house_rules

documented: docs
	$(BIN)/python -m checks.docs_coverage docs/_build/html/objects.inv

bench: $(VENV)/.test
	$(BIN)/python -m benchmarks $(ARGS)

docs: $(VENV)/.dev
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet -b html docs docs/_build/html

clean:
	rm -rf $(VENV) $(DEMO) build dist docs/_build docs/reference/api docs/reference/references.md .import_linter_cache .mypy_cache .pytest_cache .ruff_cache .hypothesis
	find src tests checks docs benchmarks examples -name __pycache__ -type d -prune -exec rm -rf {} + 2>/dev/null || true

# The environment. Each stamp is older than the files that decide what is installed, or remade.

$(VENV)/.made:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "rotatum needs Python 3.11 or later; name one, as in: make demo PYTHON=python3.12" >&2; exit 1; }
	@$(PYTHON) -m venv --clear $(VENV) || { rm -rf $(VENV); \
	  echo "$(PYTHON) cannot make virtual environments; on Debian and Ubuntu install python3-venv" >&2; exit 1; }
	@touch $@

$(VENV)/.core: pyproject.toml constraints.txt | $(VENV)/.made
	$(INSTALL) .
	@touch $@

$(VENV)/.test: pyproject.toml constraints.txt | $(VENV)/.made
	$(INSTALL) '.[test]'
	@touch $(VENV)/.core $@

$(VENV)/.dev: pyproject.toml constraints.txt | $(VENV)/.made
	$(INSTALL) '.[dev]'
	@touch $(VENV)/.core $(VENV)/.test $@
