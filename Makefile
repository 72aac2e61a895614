# Every target sets itself up in .venv; a fresh machine needs only Python 3.11+, venv and make.
PYTHON ?= python3
EXTRAS ?= test
VENV   ?= .venv
BIN    := $(VENV)/bin
UV     := $(shell command -v uv 2>/dev/null)

ifneq ($(UV),)
  MAKE_VENV = $(UV) venv -q --python $(PYTHON) $(VENV)
  INSTALL   = $(UV) pip install -q --python $(BIN)/python
else
  MAKE_VENV = $(PYTHON) -m venv $(VENV)
  INSTALL   = $(BIN)/python -m pip install -q --disable-pip-version-check $(PIP_FLAGS)
endif

# Bytecode of all that the commands import, once: each of the processes that come would make its own beside the others.
BYTECODE = $(BIN)/python -c "from spacerobot.cli import demo_run, diagnose_run, overlay_run, simulate_run; from spacerobot.view.demo import picture; from spacerobot.view.overlay import write; from spacerobot.view.report import save"

# Of the tests that are no long ones; those of a file share what they set up.
SHORT  := -n 3 --dist loadfile -m "not slow"

.PHONY: help setup demo test test-extras suite test-long test-all prove-quick proof-pages fuzz lint types check notebooks docs wheel picture real-table limits constraints clean

help:  ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "make %-12s %s\n", $$1, $$2}'

$(BIN)/python:
	$(MAKE_VENV)

$(VENV)/.core: $(BIN)/python pyproject.toml constraints.txt
	$(INSTALL) -c constraints.txt -e .
	@$(BYTECODE)
	@touch $@

$(VENV)/.test: $(BIN)/python pyproject.toml constraints.txt
	$(INSTALL) -c constraints.txt -e '.[$(EXTRAS)]'
	@$(BYTECODE)
	@touch $(VENV)/.core $@

setup: $(VENV)/.core  ## install the package and its libraries into .venv

demo: $(VENV)/.core  ## simulate a capture, then diagnose the bundled study
	$(BIN)/spacerobot demo --out demo-out --overwrite

test: lint types suite  ## lint, types and the test suite

suite: $(VENV)/.test  ## the test suite alone
	$(BIN)/python -m pytest $(SHORT)

test-extras: $(VENV)/.core  ## the test suite with every optional library: tables, proof, notebooks, browser
	$(INSTALL) -c constraints.txt -e '.[test,scale,tables,proof,notebooks,browser]'
	$(BIN)/python -m pytest $(SHORT)

test-long: $(VENV)/.test  ## the tests that take minutes
	$(BIN)/python -m pytest -m slow

test-all:  ## the test suite on every supported Python that is installed
	@for v in 3.11 3.12 3.13; do \
	  if command -v python$$v >/dev/null || [ -n "$(UV)" ]; then $(MAKE) suite PYTHON=$$( [ -n "$(UV)" ] && echo $$v || echo python$$v ) VENV=.venv-$$v || exit 1; \
	  else echo "python$$v is not installed: skipped"; fi; done

prove-quick: $(VENV)/.test  ## a few concealed campaigns of another engine, diagnosed blind and scored
	$(BIN)/spacerobot prove --quick --scenes rig --no-rivals $(PROVE) --out build/proof-quick --overwrite

fuzz: $(VENV)/.test  ## fuzz every reader with more than a million cases (an hour; goes on where it stopped)
	$(INSTALL) -c constraints.txt -e '.[fuzz]'
	$(BIN)/python -m fuzz

lint: $(VENV)/.test
	$(BIN)/ruff check .

types: $(VENV)/.test
	$(BIN)/mypy

check: test  ## what a contributor runs before a commit

$(VENV)/.docs: $(VENV)/.core
	$(INSTALL) -c constraints.txt -e '.[docs,notebooks]'
	@touch $@

notebooks: $(VENV)/.docs $(VENV)/.test  ## run every notebook from its first cell to its last
	$(BIN)/python -m pytest tests/notebooks

docs: $(VENV)/.docs  ## build the documentation into site/, warnings as errors (runs the notebooks)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict

wheel: $(VENV)/.test  ## build the wheel, install it in a fresh environment, run it from another folder
	PYTHON=$(PYTHON) bash .ci/check_wheel

bench: $(VENV)/.core  ## measure everything beside other engines; writes docs/benchmarks.md (half an hour)
	$(INSTALL) -c constraints.txt -e '.[bench,scale,proof]'
	$(BIN)/python -m benchmarks.run

proof-pages: $(VENV)/.test  ## write the pages of the proof again from their records; nothing is played
	$(BIN)/python docs/proof_pages.py

limits: $(VENV)/.core  ## effects at 0.5, 1 and 2 of their stated limits, 40 campaigns each; writes docs/limits.md (an hour or two)
	$(BIN)/python -m benchmarks.limits --out limits-out --campaigns 40 --page docs/limits.md

picture: demo  ## draw the README's pictures again (needs chromium)
	cp demo-out/demo.png docs/images/demo.png
	$(INSTALL) -c constraints.txt -e '.[browser]'
	$(BIN)/python docs/pictures.py

real-table: $(VENV)/.test  ## diagnose the public recordings that are present, and write docs/real-recordings.md again
	$(BIN)/spacerobot study table --out docs/real-recordings.md --overwrite

test-oldest:  ## the tests on the oldest direct dependencies that pyproject.toml admits (needs uv)
	$(UV) venv -q --allow-existing --python 3.11 .venv-oldest
	$(UV) pip install -q --upgrade --python .venv-oldest/bin/python --resolution lowest-direct -e '.[$(EXTRAS)]'
	.venv-oldest/bin/python -m pytest -m "not slow"

test-newest:  ## the tests on the newest dependencies, whatever constraints.txt says
	$(PYTHON) -m venv .venv-newest
	.venv-newest/bin/python -m pip install -q --upgrade --upgrade-strategy eager -e '.[$(EXTRAS)]'
	.venv-newest/bin/python -m pytest -m "not slow"

release-check: $(VENV)/.test  ## everything that is checked before a release: licences, vulnerabilities, builds, wheel, tests
	$(INSTALL) -c constraints.txt -e '.[release]'
	PYTHON=$(PYTHON) $(BIN)/python -m release

constraints:  ## pin the newest versions that fit together (needs uv)
	$(UV) pip compile -q --universal --upgrade --fork-strategy requires-python --extra test --extra browser --extra notebooks --extra docs --extra tables --no-header --no-annotate \
	  pyproject.toml -o constraints.txt

clean:
	rm -rf $(VENV) demo-out dist build site
