# All that users, pre-commit and CI call.  `make help` lists the targets.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory

# The interpreter that makes the environment: the first of these that is at least Python 3.11.
PYTHON ?= $(shell for python in python3 python3.13 python3.12 python3.11; do \
  "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
  && { echo "$$python"; break; }; done)
VENV ?= .venv
BIN := $(VENV)/bin
# The environment of the benchmark, with what it compares with.
BENCH ?= build/bench/venv
KATEX := tests/tools/katex
# The models that stand in generated/; `all` for the whole catalogue.
MODELS ?= all
DOCUMENTS = $(wildcard README.md docs/*.md generated/*/*.md)
# Two workers, a file each at a time and in their order, in which the long ones do not come last.
PYTEST_ARGS ?= -n 2 --dist loadfile --no-loadscope-reorder

# Mechanisms drawn at random by `make random`: how many, and the first seed.
RANDOM_COUNT ?= 600
RANDOM_SEED ?= 0

# Random mechanisms of `make named`.
NAMED_RANDOM ?= 60

# Hostile states for the generated C: how many, which draw, how compiled (tests/hostile/campaign.py).
HOSTILE_STATES ?= 1000000
HOSTILE_SEED ?= 0
HOSTILE_BUILDS ?= fast,float,memory,thread

# Faults planted by `make mutants`: how many at a time, and which (all; or names such as program lowering-3).
MUTANT_JOBS ?= 2
MUTANTS ?=

# Models whose C Frama-C analyses.
PROVED ?= fivebar_revolute planar_3rpr tripod_3rps stewart

# --- for users ----------------------------------------------------------------

.PHONY: help
help: ## List the targets
	@awk -F ':.*## ' '/^[a-z][a-z-]*:.*## / {printf "  make %-16s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

.PHONY: demo
demo: $(VENV)/core.stamp ## Generate the Stewart platform's model, then show it at work
	$(BIN)/pne-gen stewart --out generated/
	$(BIN)/pne-gen stewart --target ext --out build/demo
	$(BIN)/python bench/demo.py build/demo/stewart

.PHONY: test
test: $(VENV)/test.stamp ## Run the tests; of long lists of cases, a sample
	$(BIN)/python -m pytest $(PYTEST_ARGS)

.PHONY: test-all
test-all: $(VENV)/test.stamp ## Run the tests, every case
	$(BIN)/python -m pytest $(PYTEST_ARGS) -m ""

.PHONY: targets
targets: $(VENV)/targets.stamp ## Test all extension modules, array-API modules (NumPy, JAX, PyTorch, Dask) and Octave packages; MuJoCo
	$(BIN)/python -m pytest -n 0 -o norecursedirs=".*" tests/targets

.PHONY: printed
printed: $(VENV)/test.stamp ## Compute all models from the text of their reports, with other numbers too
	$(BIN)/python -m pytest $(PYTEST_ARGS) -m "" tests/printed

.PHONY: robots
robots: $(VENV)/test.stamp ## Generate the robots of docs/robots.md and test their published properties
	$(BIN)/python -m pytest -n 0 -m "" tests/robots

.PHONY: bench
bench: $(BENCH)/bench.stamp ## Measure all code and its peers (ten minutes), write docs/benchmark.md
	$(BENCH)/bin/python -m bench

.PHONY: bench-page
bench-page: $(BENCH)/bench.stamp ## Write docs/benchmark.md from bench/results.json
	$(BENCH)/bin/python -m bench page

.PHONY: stack
stack: ## Stack and code of stewart.c on a Cortex-M4F (arm-none-eabi-gcc): is it within bounds?
	$(or $(wildcard $(BIN)/python),$(PYTHON)) -m bench.stack generated/stewart

.PHONY: generate
generate: $(VENV)/core.stamp ## Write generated/
	$(BIN)/pne-gen $(MODELS) --out generated/

.PHONY: gallery
gallery: $(VENV)/test.stamp ## Write docs/gallery.md and its pictures, from generated/ and the catalogue
	$(BIN)/python docs/make_gallery.py

# --- checks: what CI runs -----------------------------------------------------

.PHONY: check
check: test check-rest ## Run all that CI runs

.PHONY: check-rest
check-rest: check-format check-lint check-types check-layers check-generated check-c check-analysers check-math wheel-test ## Run all of check but the tests
	@echo "check-rest: passed, but for what is reported as NOT RUN"

.PHONY: check-format
check-format: $(VENV)/dev.stamp ## Is the code formatted (make format does it)?
	$(BIN)/ruff format --check .

.PHONY: check-lint
check-lint: $(VENV)/dev.stamp ## Lint
	$(BIN)/ruff check .

.PHONY: check-types
check-types: $(VENV)/dev.stamp ## Check the types, strictly
	$(BIN)/mypy

.PHONY: check-layers
check-layers: $(VENV)/dev.stamp ## Check which layer imports which
	$(BIN)/lint-imports

.PHONY: check-generated
check-generated: $(VENV)/core.stamp ## Is generated/ what would be generated (make generate does it)?
	$(BIN)/pne-gen check $(MODELS) --out generated/

.PHONY: check-c
check-c: ## Compile the generated C with every warning on: gcc, clang, double, float, C++
	$(or $(wildcard $(BIN)/python),$(PYTHON)) tests/tools/compile_c.py generated

.PHONY: check-analysers
check-analysers: ## Read a sample of the generated C with gcc -fanalyzer, clang, clang-tidy, cppcheck
	$(or $(wildcard $(BIN)/python),$(PYTHON)) -m tests.tools.analyse_c generated --sample

.PHONY: check-math
check-math: ## Render every formula of the documents with KaTeX
	@if command -v node npm >/dev/null; then $(MAKE) $(KATEX)/node_modules/installed.stamp \
	  && node --test --test-reporter=spec $(KATEX)/check.test.mjs && node $(KATEX)/check.mjs $(DOCUMENTS); \
	else tests/tools/not-run.sh "check-math: node and npm are not installed"; fi

.PHONY: wheel-test
wheel-test: $(VENV)/dev.stamp ## Build sdist and wheel, use the wheel from an empty environment
	$(BIN)/python tests/tools/wheel.py

.PHONY: fuzz
fuzz: $(VENV)/test.stamp ## Give pne-gen 100,000 broken specifications (FUZZ_CASES, FUZZ_SEED)
	$(BIN)/python tests/fuzz/fuzz.py --cases $(or $(FUZZ_CASES),100000) --seed $(or $(FUZZ_SEED),0)

.PHONY: random
random: $(VENV)/test.stamp ## Derive RANDOM_COUNT (600) mechanisms drawn from RANDOM_SEED on, compare all
	$(BIN)/python -m tests.random.tally --count $(RANDOM_COUNT) --seed $(RANDOM_SEED) --jobs 2

.PHONY: named
named: $(VENV)/test.stamp ## Prove of all models and NAMED_RANDOM (60) random ones that values are what they are called
	$(BIN)/python -m tests.tools.named --random $(NAMED_RANDOM)

.PHONY: mutants
mutants: $(VENV)/test.stamp ## Plant about 100 faults, one at a time in a copy (MUTANTS, MUTANT_JOBS): tests must find each
	$(BIN)/python -m tests.mutants.run --jobs $(MUTANT_JOBS) --only $(MUTANTS)

.PHONY: analyse
analyse: ## Read all generated C with the analysers (check-analysers reads a sample)
	$(or $(wildcard $(BIN)/python),$(PYTHON)) -m tests.tools.analyse_c generated

.PHONY: hostile
hostile: ## Call the C with HOSTILE_STATES (1,000,000) hostile states a model and build, under MSan and TSan too
	$(or $(wildcard $(BIN)/python),$(PYTHON)) -m tests.hostile.campaign generated \
	  --states $(HOSTILE_STATES) --seed $(HOSTILE_SEED) --builds $(HOSTILE_BUILDS)

.PHONY: prove
prove: ## Prove with Frama-C that the C of PROVED has no run-time errors
	$(or $(wildcard $(BIN)/python),$(PYTHON)) -m tests.tools.prove generated $(PROVED)

.PHONY: architecture
architecture: $(VENV)/core.stamp ## Write the picture and the table of docs/architecture.md, from the code
	$(BIN)/python docs/make_architecture.py

.PHONY: schema
schema: $(VENV)/core.stamp ## Write docs/pne_sym.schema.json
	$(BIN)/python -c "from pne_sym.model.schema import schema_text; print(schema_text(), end='')" \
	  > docs/pne_sym.schema.json

.PHONY: format
format: $(VENV)/dev.stamp ## Format the code and sort its imports
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix --select I .

# --- environment ----------------------------------------------------------------

.PHONY: setup
setup: $(VENV)/dev.stamp ## Create the development environment

.PHONY: clean
clean: ## Remove the environment, caches and build products
	rm -rf $(VENV) build dist *.egg-info $(KATEX)/node_modules \
	  .mypy_cache .pytest_cache .ruff_cache .import_linter_cache
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed; name it: make PYTHON=/path/to/python3" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/core.stamp: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable .
	$(BIN)/python -m compileall -q pne_sym  # as pip does with what it copies
	touch $@

$(VENV)/test.stamp: $(VENV)/core.stamp
	$(BIN)/python -m pip install --quiet --editable '.[test]'
	touch $@

$(VENV)/targets.stamp: $(VENV)/test.stamp
	$(BIN)/python -m pip install --quiet --editable '.[test,targets]'
	touch $@

$(BENCH)/bench.stamp: pyproject.toml bench/requirements.txt
	@test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed; name it: make PYTHON=/path/to/python3" >&2; exit 1; }
	$(PYTHON) -m venv $(BENCH)
	$(BENCH)/bin/python -m pip install --quiet --editable . --requirement bench/requirements.txt
	touch $@

$(VENV)/dev.stamp: $(VENV)/test.stamp
	$(BIN)/python -m pip install --quiet --editable '.[test,dev]'
	touch $@

$(KATEX)/node_modules/installed.stamp: $(KATEX)/package.json $(KATEX)/package-lock.json
	npm ci --prefix $(KATEX) --silent --no-audit --no-fund
	touch $@
