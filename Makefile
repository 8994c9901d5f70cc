# make demo   set everything up and run the demonstration, into out/
# make test   set everything up and run the tests, compiled, and those that call kernels themselves interpreted too
#             (one thread for each of the processes that run side by side; tests of threads take more; each process takes
#             tests that stand together, for what is made or compiled once for many, and in the end some of another's)
# make check  lint, format and types
# make docs   build the site, into out/site (open out/site/index.html); the first time all of the gallery is made
# make release
#             wheel, source and site, into dist, tried in a fresh environment of each Python that is there
# make test-lowest, make test-newest
#             the tests with the lowest versions that pyproject.toml allows, and with the newest that there are
# make fuzz   28,000 harmed files of all kinds, of which the tests take a few hundred
# make kills  commands killed at every event of the file system and at 300 moments, of which the tests take a few
# Use another Python with: make demo PYTHON=python3.12

PYTHON ?= python3
INTERPRETED := kernels laws/test_engine.py laws/test_solver.py projection scene solids solvers drawing/test_room.py \
  forward/test_casting.py optics/test_law.py planning/test_order.py
EXTRAS ?= dev,docs,heif,plot,notebook,remote,cluster,studio
BIN := .venv/bin
PIP := PIP_CONSTRAINT=constraints.txt PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install -qq
PYTEST := -m pytest -q -n auto --dist worksteal
# Several threads of several programs wait for each other: scipy's minimizer took 100 times as long.
ALONE := NUMBA_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

# Tests start hundreds of programs: each would compile the package anew, and each worker of the suite all tests.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test test-compiled test-interpreted test-lowest test-newest check docs release coverage fuzz kills clean

demo: .venv/.ready
	$(BIN)/lightcube demo

test: test-compiled test-interpreted

test-compiled: .venv/.ready-$(EXTRAS)
	$(ALONE) $(BIN)/python $(PYTEST)

test-interpreted: .venv/.ready-$(EXTRAS)
	$(ALONE) NUMBA_DISABLE_JIT=1 $(BIN)/python $(PYTEST) $(addprefix tests/,$(INTERPRETED))

test-lowest test-newest: test-%: .venv-%
	$(ALONE) NUMBA_CACHE_DIR=.venv-$*/numba .venv-$*/bin/python $(PYTEST) $(TESTS)

check: .venv/.ready-$(EXTRAS)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

docs: .venv/.ready-$(EXTRAS)
	$(BIN)/python -m sphinx -q -W --keep-going -d out/.doctrees $(SITE) docs out/site
	$(BIN)/python examples/slides.py out/site/slides

release: docs
	.ci/release $(BIN)/python

kills: .venv/.ready-$(EXTRAS)
	LIGHTCUBE_KILLS=all $(BIN)/python $(PYTEST) tests/hostile/test_kills.py

coverage: .venv/.ready-$(EXTRAS)
	NUMBA_DISABLE_JIT=1 $(BIN)/coverage run -m pytest -q
	$(BIN)/coverage report --skip-covered --show-missing

fuzz: .venv/.ready-$(EXTRAS)
	LIGHTCUBE_FUZZ=2000 $(BIN)/python $(PYTEST) tests/hostile

clean:
	rm -rf .venv .venv-lowest .venv-newest out .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +

.venv/.made:
	@command -v $(PYTHON) >/dev/null || { echo "there is no $(PYTHON): install Python 3.11 or newer"; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "lightcube needs Python 3.11 or newer: install one and name it, as in: make demo PYTHON=python3.12"; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "this Python cannot make virtual environments: install its venv package (on Debian and Ubuntu: apt install python3-venv)"; exit 1; }
	@echo "setting up .venv, once; this takes a minute or two"
	@$(PYTHON) -m venv .venv
	@touch $@

.venv/.ready: .venv/.made pyproject.toml constraints.txt
	@$(PIP) --editable .
	@touch $@

.venv/.ready-$(EXTRAS): .venv/.made pyproject.toml constraints.txt
	@$(PIP) --editable '.[$(EXTRAS)]'
	@touch $@

.venv-lowest .venv-newest: .venv-%: pyproject.toml
	$(PYTHON) -m venv --clear $@
	$(if $(filter lowest,$*),.ci/lowest >$@/constraints.txt,touch $@/constraints.txt)
	PIP_CONSTRAINT=$(CURDIR)/$@/constraints.txt $@/bin/python -m pip install -q --editable '.[$(EXTRAS)]' || { rm -r $@; exit 1; }
