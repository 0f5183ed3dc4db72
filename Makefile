# Needs make and Python 3.10 or newer with venv; everything else is installed into .venv, pinned in constraints.txt. The engine
# is built as C by gcc or clang, and where there is neither by the compiler of the Python package ziglang.

SHELL := /bin/bash
BIN := .venv/bin
CODE := $(wildcard scenario_compiler tests maps examples tools)
FRESH := $(wildcard tests/test_layers.py tests/forms/test_translation.py tests/test_schemas.py tests/test_public_names.py \
	tests/roads/test_unread.py)
# Three processes on two cores: tests of pages and servers wait for them a sixth of their time.
PYTEST := $(BIN)/pytest -n 3 --dist worksteal

# Byte code is kept, also where the environment says otherwise: the tests start hundreds of processes.
export PYTHONDONTWRITEBYTECODE =

# The package, in place. Pip builds a package before it installs what the package needs, so the sweeps that guide the
# engine's compiler could not run yet: the build's hook is left out, and `setup` makes the engine afterwards, once.
INSTALL := HATCH_BUILD_NO_HOOKS=true $(BIN)/python -m pip install --quiet --constraint constraints.txt \
	--no-build-isolation --editable

# The first Python that starts, is new enough and can make environments.
FIND_PYTHON = for python in python3.12 python3.11 python3.10 python3; do \
	if $$python -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then echo $$python; break; fi; done
PYTHON ?= $(shell $(FIND_PYTHON))

.PHONY: setup demo test test-all test-carla test-vscode fuzz check format generate library-table studies site wheel-test clean moved

# The installation in .venv names the folder of the checkout; in one that was moved or copied, it is made again.
INSTALLED_FROM := $(shell cat .venv/lib/python*/site-packages/_scenario_compiler.pth 2>/dev/null)
ifneq ($(INSTALLED_FROM),)
ifneq ($(INSTALLED_FROM),$(CURDIR))
.venv/.stamp: moved
endif
endif

moved:
	rm -rf .venv

setup: .venv/.stamp
	@$(BIN)/python -m scenario_compiler.forms.making scenario_compiler.batch.typical_sweeps

.venv/.stamp: pyproject.toml constraints.txt
	@if [ -z "$(PYTHON)" ]; then \
		echo "Python 3.10 or newer with venv is needed (found: $$(python3 --version 2>&1)); set PYTHON=/path/to/python" >&2; exit 1; fi
	@[ -x $(BIN)/python ] || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --constraint constraints.txt hatchling build
	@command -v "$${CC:-gcc}" clang >/dev/null || $(BIN)/python -m pip install --quiet --constraint constraints.txt ziglang
	$(INSTALL) '.[test,dev,maps]'
	@touch $@

demo: setup
	$(BIN)/python examples/demo.py

test: setup
	$(PYTEST) -m "not slow"

test-all: setup
	$(PYTEST)

# Mutants of real files through validate and compile, short runs, and the hostile files: `make fuzz SLICE=3/10` does the
# third of ten equal parts. With SCENARIO_COMPILER_CORPUS the corpus is mutated too.
SLICE ?= 1/1
fuzz: setup
	$(BIN)/python -m tests.fuzz --slice $(SLICE) --mutants 20000 --runs 3000
	$(BIN)/pytest -q tests/hostile

# Our CARLA server and the CARLA world with CARLA's own client, the slow tests too.
test-carla: setup
	$(BIN)/pytest tests/carla_server $(wildcard tests/worlds/test_carla.py tests/live/test_carla.py tests/contracts/test_worlds.py)

# The VS Code extension against the language server of this checkout; needs Node.js with npm.
test-vscode: setup
	cd editors/vscode && npm ci --no-audit --no-fund --silent && SCENARIO_COMPILER=$(CURDIR)/$(BIN)/scenario-compiler npm test --silent

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy $(CODE)
	$(BIN)/pytest -q tests/test_python_api.py tests/test_camera_page.py -k has_types
	$(BIN)/pytest -q -m "not slow" $(FRESH)

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# Rewrites what is made from the code: the maps from their descriptions, the schemas and the stub of public names from the
# models, and of docs/ the pages
# carla-calls, commands, controllers, coverage, language, names, opendrive, run-folder and study-language.
generate: setup
	for build in $(wildcard maps/*/build.py); do $(BIN)/python $$build || exit 1; done
	$(BIN)/pytest -q --update -m "not slow" $(wildcard tests/test_schemas.py tests/roads/test_unread.py)

# Rewrites docs/separation.md: every conflict of the library with an attentive, a slow, an absent and a reference driver.
library-table: setup
	$(BIN)/scenario-compiler library library/conflicts --separation docs/separation.md

# Rewrites docs/validity.md and its figure: published takeover studies, run again.
studies: setup
	$(BIN)/python -m tests.studies.page

# Builds the documentation site into build/site; a link or an anchor that leads nowhere is an error.
site: setup
	@$(INSTALL) '.[docs]'
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# Builds the source archive and from it the wheel, and runs the wheel from an empty environment and another folder.
wheel-test: setup
	rm -rf build/dist build/wheel
	$(BIN)/python -m build --no-isolation --outdir build/dist .
	$(BIN)/python -m venv build/wheel
	build/wheel/bin/python -m pip install --quiet --constraint constraints.txt build/dist/*.whl
	tests/wheel_test.sh "$(CURDIR)/build/wheel"

clean:
	rm -rf .venv build dist editors/vscode/node_modules editors/vscode/dist .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
