# Every target explains itself: `make help` prints the text behind its two hashes.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PLANT ?= plants/ce150.toml
OUT ?= build
# What is imported is compiled then, once; most of what is installed never is imported, and a suite is hundreds of processes.
INSTALL := install --quiet --disable-pip-version-check --no-compile
PIP := $(BIN)/python -m pip $(INSTALL)
# What builds this project is there then: for an environment of its own pip would call itself twice more. What it depends on comes
# afterwards, each with a builder of its own where its makers give sources alone.
EDITABLE := $(PIP) --no-build-isolation --no-deps --editable .
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help run test docs soak check lint types layers bench clean

help:  ## this list
	@grep -E '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## (.*)/  make \1\t\2/' | expand -t 18

run: $(VENV)/.run  ## design, generate, verify and fly PLANT (plants/ce150.toml) into OUT (build)
	$(BIN)/twinlaw run --plant $(PLANT) --out $(OUT)

test: $(VENV)/.test  ## the whole test suite, style and types included
	$(BIN)/python -m pytest

docs: $(VENV)/.docs  ## the documentation as a site that needs no network, build/site/index.html
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo build/site/index.html

soak: $(VENV)/.soak  ## the suite at full length: every case, byte and seed, whole notebooks and data sets, a million frames
	TWINLAW_SOAK=1 $(BIN)/python -m pytest

check: lint types layers  ## style, types and import order alone

lint: $(VENV)/.test  ## ruff over everything
	$(BIN)/ruff check . && $(BIN)/ruff format --check .

types: $(VENV)/.test  ## mypy --strict over the packages
	$(BIN)/mypy

layers: $(VENV)/.test  ## the stages import one way only
	$(BIN)/lint-imports

bench: $(VENV)/.run  ## simulated seconds per CPU second, as ratios to the peers that are installed
	$(BIN)/twinlaw bench

clean:  ## remove what can be made again; the virtual environment stays
	rm -rf $(OUT) .cache .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache

# A stamp is written last, so that a broken download is tried again; nothing is fetched while pyproject.toml stays as it is.
# The pip that comes with an old Python takes twice as long to choose among releases: it fetches the new one from within its wheel, and
# is installed, for as long as that takes, only where Python brings none.
BUNDLED := import ensurepip, pathlib; print(next(pathlib.Path(ensurepip.__file__).parent.glob("_bundled/pip-*.whl")))
$(VENV)/.tools:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "twinlaw needs Python 3.11 or newer, this is " + sys.version.split()[0] + "; set PYTHON=/path/to/python3")'
	test -x $(BIN)/python || $(PYTHON) -m venv --without-pip $(VENV)
	wheel="$$($(BIN)/python -c '$(BUNDLED)' 2>/dev/null)" && $(BIN)/python "$$wheel/pip" $(INSTALL) pip hatchling || { $(BIN)/python -m ensurepip && $(PIP) --upgrade pip hatchling; }
	touch $@

$(VENV)/.run: pyproject.toml | $(VENV)/.tools
	$(EDITABLE)
	$(PIP) twinlaw
	touch $@

$(VENV)/.test: pyproject.toml | $(VENV)/.tools
	$(EDITABLE)
	$(PIP) 'twinlaw[test]'
	touch $(VENV)/.run $@

$(VENV)/.soak: $(VENV)/.test
	$(PIP) 'twinlaw[soak]'
	touch $@

$(VENV)/.docs: $(VENV)/.run
	$(PIP) 'twinlaw[docs]'
	touch $@
