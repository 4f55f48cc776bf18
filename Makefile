# MOVE, reproduced. `make` alone prints the targets; `make figures` and `make test` do all the set-up themselves.
PROFILE ?= laptop
PYTHON ?= python3 python3.11 python3.12 python3.13
BIN := .venv/bin
READY := .venv/ready
LEROBOT := build/lerobot-venv
ENVIRONMENTS := build/environments-venv
CLUSTER_OPTION := $(if $(CLUSTER),--cluster $(CLUSTER))
NOTEBOOKS := $(basename $(notdir $(wildcard notebooks/*.ipynb)))
NUMBERED := $(filter $(foreach n,1 2 3 4 5 6 7 8 9,fig$(n)_% table$(n)_%),$(NOTEBOOKS))
AS_ROOT := $(if $(filter 0,$(shell id -u)),--allow-root)
SHORT := $(foreach name,$(NUMBERED),$(firstword $(subst _, ,$(name))))

# whether the profile's results are those in git: its figures are drawn from them, and `make runs` computes the rest
STORED_ONLY := $(if $(shell grep -l '^shipped: true' profiles/$(PROFILE).yaml 2>/dev/null),--stored-only)

.DEFAULT_GOAL := help
.PHONY: help setup figures runs test test-slow test-lerobot test-environments test-browser plan verify lab slides site bench doctor lock clean $(NOTEBOOKS) $(SHORT)

help:  ## print this list
	@echo "usage: make TARGET [PROFILE=smoke|laptop|...] [CLUSTER=tcp://host:8786] [TORCH_INDEX=url]"
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  %-17s %s\n", $$1, $$2}'
	@echo "one figure or table by its name:"
	@echo $(SHORT) $(NOTEBOOKS) | fold -sw 96 | sed 's/^/  /'

setup: $(READY)  ## build .venv from environment.lock, with Python 3.11, 3.12 or 3.13

$(READY): environment.lock environment-cuda.lock pyproject.toml tools/install.py
	@for python in $(PYTHON); do \
	  $$python -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' 2>/dev/null || continue; \
	  exec $$python -m venv --clear .venv; \
	done; \
	if command -v uv >/dev/null; then rm -rf .venv && exec uv venv --quiet --seed --python 3.11 .venv; fi; \
	echo "make: Python 3.11, 3.12 or 3.13 is needed; name one with make PYTHON=..., or install uv, which fetches it" >&2; exit 2
	$(BIN)/python tools/install.py
	@$(BIN)/python -c 'from move.machine import gl_problem as g; p = g(); p and print(p)'
	@touch $@

figures: $(READY)  ## every figure and table: laptop's from stored results, other profiles' runs are computed first
	$(if $(STORED_ONLY),,-$(BIN)/move run --profile $(PROFILE) $(CLUSTER_OPTION))  # what fails is shown as missing
	$(BIN)/move figure --profile $(PROFILE) $(STORED_ONLY)

runs: $(READY)  ## compute what is missing of the profile's results (make plan says how long)
	$(BIN)/move run --profile $(PROFILE) $(CLUSTER_OPTION)

$(NOTEBOOKS): $(READY)
	$(BIN)/move figure $@ --profile $(PROFILE) $(STORED_ONLY)

define short_name
$(firstword $(subst _, ,$(1))): $(1)
endef
$(foreach name,$(NUMBERED),$(eval $(call short_name,$(name))))

test: $(READY)  ## run every test
	$(BIN)/python -m ruff check move tests tools
	$(BIN)/python -m mypy
	$(BIN)/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder -m "not slow and not browser"

test-slow: $(READY)  ## run the tests that take minutes: the paper's own batch
	$(BIN)/python -m pytest -q -m slow

$(LEROBOT)/ready: | $(READY)
	$(BIN)/python -m venv --clear $(LEROBOT)
	$(LEROBOT)/bin/pip install --quiet 'lerobot>=0.4,<0.5'
	@touch $@

test-lerobot: $(READY) $(LEROBOT)/ready  ## LeRobot itself reads exports and trains on them (downloads 8 GB)
	$(BIN)/python tools/test_lerobot.py $(LEROBOT)/bin/python

$(ENVIRONMENTS)/ready: $(READY) tests/environments/requirements.txt
	$(BIN)/python -m venv --clear $(ENVIRONMENTS)
	$(BIN)/python -c 'import site; print(site.getsitepackages()[0])' > $$($(ENVIRONMENTS)/bin/python -c "import site; print(site.getsitepackages()[0])")/locked.pth
	$(ENVIRONMENTS)/bin/pip install --quiet --no-deps --only-binary :all: --require-hashes -r tests/environments/requirements.txt
	@touch $@

test-environments: $(ENVIRONMENTS)/ready  ## put environments of seven packages in motion (downloads 0.3 GB)
	PYTHONPATH=. $(ENVIRONMENTS)/bin/python -m pytest -q tests/environments

test-browser: $(READY)  ## run the tests that need Chromium: the site, and a notebook in JupyterLab
	@command -v chromium >/dev/null || apt-get install -y chromium
	$(BIN)/python -m pytest -q -m browser

plan: $(READY)  ## what would run, how long it takes, and why
	$(BIN)/move plan --profile $(PROFILE)

verify: $(READY)  ## check every shipped result, recompute a fresh sample of them and compare
	$(BIN)/move verify --profile $(PROFILE) --all
	$(BIN)/move verify --profile $(PROFILE)

lab: $(READY)  ## open JupyterLab on its start page: what to read in which order
	$(BIN)/jupyter lab $(AS_ROOT) --config=docs/lab/config.py --ServerApp.root_dir=. \
		--LabApp.app_settings_dir=docs/lab --LabApp.default_url=/lab/tree/notebooks/start.md

slides: $(READY)  ## the tutorials as slides, executed, into build/slides
	$(BIN)/jupyter nbconvert --to slides --execute --output-dir build/slides notebooks/tutorial/*.ipynb

site: $(READY)  ## web pages of all results, a page a figure and an atlas of episodes, from what is stored
	$(BIN)/python tools/make_site.py

bench: $(READY)  ## the speed figures, each against a reference measured in the same run
	$(BIN)/python tools/bench.py

doctor: $(READY)  ## what this machine has and lacks
	$(BIN)/move doctor

lock:  ## write the lock files anew from pyproject.toml (needs uv)
	$(firstword $(PYTHON)) tools/lock.py

clean:  ## remove build/ (not .venv, not results)
	rm -rf build
