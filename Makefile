# Shortcuts for people who work on AOS; CONTRIBUTING.md says when to use which.
VENV := .venv
BIN := $(VENV)/bin
LOCK := deploy/lock
UPGRADE :=
CHAOS :=
COMPILE := $(BIN)/uv pip compile --quiet --universal --python-version 3.11
RESOLVE := $(COMPILE) $(UPGRADE) --no-annotate --no-header --output-file

.PHONY: help setup check quick test format page promote docs lock newcomer chaos hostile clean

help:  ## list the targets
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 16

setup:  ## set up .venv with everything for development
	./setup.sh --dev

check:  ## lint, types, layers, documents and all tests: what CI runs
	tests/check.sh

quick:  ## the same without the tests that start whole systems and engines
	tests/check.sh --quick

test:  ## the tests alone
	$(BIN)/pytest

format:  ## put the sources into the house's form
	$(BIN)/ruff check --fix
	$(BIN)/ruff format

docs:  ## write the generated parts of docs/ anew
	$(BIN)/python docs/write_reference.py

page:  ## make the page that `aos serve` shows out of its sources; needs node
	cd services/gateway/page && npm ci --silent && node build.mjs

promote:  ## accept the emitted code as it is now as the golden files
	AOS_PROMOTE=1 $(BIN)/pytest tests/golden

lock:  ## resolve the dependencies anew and pin them with hashes; needs uv (.venv/bin/pip install uv)
	$(RESOLVE) $(LOCK)/build.txt $(LOCK)/build.in
	$(RESOLVE) $(LOCK)/runtime.txt --extra sim --extra page --constraint $(LOCK)/build.txt pyproject.toml
	$(RESOLVE) $(LOCK)/dev.txt --extra sim --extra page --extra dev --constraint $(LOCK)/runtime.txt pyproject.toml
	printf 'ziglang>=0.15\n' | $(RESOLVE) $(LOCK)/compiler.txt -
	scratch=$$(mktemp -d) && for name in build runtime dev compiler; do \
		$(COMPILE) --no-deps --format pylock.toml --output-file $$scratch/pylock.$$name.toml $(LOCK)/$$name.txt && \
		$(BIN)/python deploy/lock_files.py $$scratch/pylock.$$name.toml >$(LOCK)/$$name.txt \
			$$([ $$name != dev ] || echo --without $(LOCK)/runtime.txt) || exit 1; \
	done && rm -r "$$scratch"

chaos:  ## kill, freeze and fail processes of missions, and print what became of them
	$(BIN)/python -m tests.chaos $(CHAOS)

hostile:  ## play hostile documents and strangers on the bus, and print what they were kept from
	$(BIN)/python -m tests.hostile --times 17
	$(BIN)/python -m tests.hostile.placed user $(BIN)/python -m tests.hostile --times 17
	$(BIN)/python -m tests.hostile.placed closed $(BIN)/python -m tests.hostile --times 17
	$(BIN)/python -m tests.hostile.unit
	$(BIN)/python -m tests.hostile.bus

newcomer:  ## run README's two commands in a fresh clone, an empty home and without a compiler
	tests/newcomer.sh

clean:  ## remove what set-up, tests and runs have left
	rm -rf $(VENV) build runs .compiled *.egg-info .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
