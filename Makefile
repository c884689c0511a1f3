# What a developer runs; .ci/run does the same from nothing.
.PHONY: check lint test nightly bench

BIN ?= .venv/bin
SHELL := /bin/bash
.SHELLFLAGS := -o pipefail -c

check: lint test

lint:
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

test:
	$(BIN)/pytest -n 2

# Every test, the slow ones too, and all figures; the log lies with the benchmarks.
nightly:
	WALKGEN_AS_SHIPPED=1 $(BIN)/pytest -n 2 -m "nightly or not nightly" 2>&1 | tee benchmarks/nightly.log
	$(MAKE) bench 2>&1 | tee -a benchmarks/nightly.log

bench:
	@for question in benchmarks/*.py; do echo "== $$question"; $(BIN)/python $$question || exit 1; done
