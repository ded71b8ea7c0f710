# Everything runs from a fresh checkout with Python 3.11+, make and access to a package registry.
PYTHON ?= python3
BIN := .venv/bin
# One stamp per set of packages, renewed only when what it depends on has changed.
BASE := .venv/.installed
TEST := .venv/.installed-test
NOTEBOOK := .venv/.installed-notebook
DOCS := .venv/.installed-docs
PIP := $(BIN)/python -m pip --disable-pip-version-check -qq install -c constraints.txt

.PHONY: run test slow faults figures notebook notebooks docs bench bench-quick coverage clean

run: $(BASE)
	@$(BIN)/uq run studies/beam-lifetime.toml
	@$(BIN)/uq plot results/beam-lifetime.nc > /dev/null
	@$(BIN)/uq run studies/beam-sensitivity.toml
	@$(BIN)/uq sensitivity results/beam-sensitivity.nc
	@$(BIN)/uq plot results/beam-sensitivity.nc > /dev/null
	@echo
	@echo "Results: results/beam-lifetime.nc and results/beam-sensitivity.nc, figures in folders"
	@echo "         results/beam-lifetime and results/beam-sensitivity."
	@echo "Next:    $(BIN)/uq report results/beam-lifetime.nc --open    everything in your browser"
	@echo "         $(BIN)/uq init beam > studies/mine.toml             a study of your own to edit"
	@echo "         make notebook                                      open JupyterLab"

test: $(TEST)
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/python -m pytest -n logical --maxprocesses 8 --dist loadfile -m "not slow"

# Statistics at scale, exact propagators, every notebook and fault: half an hour to an hour.
slow: $(TEST)
	@$(BIN)/python -m pytest -n logical --maxprocesses 8 --dist loadfile -m slow

# Kills, full disks and damaged files in real runs; "make test" has a shorter selection.
faults: $(TEST)
	@$(BIN)/python -m pytest tests/faults -m "slow or not slow"

# The figures of the machines' papers from our data, docs/papers.md and docs/papers/*.svg, and the
# gallery, pictures of the machines and of the house, and what the pages quote of commands.
figures: $(BASE)
	@$(BIN)/python docs/papers
	@cd docs && ../$(BIN)/python -m sketches && ../$(BIN)/python -m gallery
	@$(BIN)/python docs/house.py
	@$(BIN)/python docs/quoted.py

notebook: $(NOTEBOOK)
	@$(BIN)/jupyter lab notebooks

# Always from scratch: Sphinx does not notice changes of the declarations behind a table.
docs: $(DOCS)
	@$(BIN)/python -m sphinx -E -a -q -W --keep-going docs site
	@echo "Documentation: site/index.html"

# Run every notebook at full size and keep its outputs: about ten minutes.
notebooks: $(TEST)
	@$(BIN)/python notebooks/execute.py

bench: $(TEST)
	@$(BIN)/python -m benchmarks.startup
	@$(BIN)/python -m benchmarks.beam
	@$(BIN)/python -m benchmarks.beam_study
	@$(BIN)/python -m benchmarks.beam_lives
	@$(BIN)/python -m benchmarks.beam_mesh
	@$(BIN)/python -m benchmarks.vibrator
	@$(BIN)/python -m benchmarks.mole
	@$(BIN)/python -m benchmarks.ports
	@$(BIN)/python -m benchmarks.outside
	@$(BIN)/python -m benchmarks.store
	@$(BIN)/python -m benchmarks.large
	@$(BIN)/python -m benchmarks.campaigns
	@$(BIN)/python -m benchmarks.scaling
	@$(BIN)/python -m benchmarks.cluster
	@$(BIN)/python -m benchmarks.table

# What has become slower by more than a tenth on this kind of processor, in less than 90 seconds.
bench-quick: $(BASE)
	@$(BIN)/python -m benchmarks.quick

# Coverage of every reported interval: writes docs/coverage.md, in about an hour and a half.
coverage: $(TEST)
	@$(BIN)/python -m benchmarks.coverage

clean:
	rm -rf .venv

$(BASE): pyproject.toml constraints.txt
	@echo "Creating .venv and installing pinned packages (about two minutes, once) ..."
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "Python 3.11 or newer is required; try: make PYTHON=python3.11 $(MAKECMDGOALS)"; exit 1; }
	@$(PYTHON) -m venv .venv
	@$(PIP) -e .
	@touch $@

$(TEST): $(BASE)
	@echo "Installing the packages for the tests (a few minutes, once) ..."
	@$(PIP) -e ".[test]"
	@touch $@

$(NOTEBOOK): $(BASE)
	@echo "Installing the packages for the notebooks (a few minutes, once) ..."
	@$(PIP) -e ".[notebook]"
	@$(BIN)/python -m ipykernel install --prefix .venv --name vibrolife --display-name vibrolife >/dev/null
	@touch $@

$(DOCS): $(BASE)
	@echo "Installing the packages for the documentation (a few minutes, once) ..."
	@$(PIP) -e ".[docs]"
	@touch $@
