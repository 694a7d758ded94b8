# Everything here sets up what it needs: .venv in this folder, from the locks in tools/.  Nothing is
# installed outside this folder except, for tests on a machine without a screen, Debian's packages.
#
#   PYTHON=/path/to/python3.12   which Python makes the environment (default: the first of 3.11 to 3.13 found)
#   ARGS="..."                   handed to the program, to pytest or to the benchmark

SHELL := /bin/bash
.DEFAULT_GOAL := help
PYTHON ?=
ARGS ?=
RUN := .venv/bin/python
PARALLEL := -n auto --maxprocesses 4 --dist worksteal
QUICK := tests/test_house.py tests/test_golden.py tests/scene tests/experiments/test_zoom.py \
    $(addprefix tests/viewer/,cli/test_cli.py cli/test_mistakes.py views/test_legend.py state services window) \
    $(addprefix tests/tracing/test_,culling.py modes.py pictures.py intersect.py traversal.py waves.py) \
    -m "not slow"

# Compiled kernels, Python's bytecode, Mesa's compiled shaders and matplotlib's list of fonts stay in the project's
# folder.  Bytecode is written even where that is switched off: without it, each start takes seconds longer.
export PYTHON
export SHADOWCULL_CACHE_DIR := $(CURDIR)/.cache/kernels
export MESA_SHADER_CACHE_DIR := $(CURDIR)/.cache/mesa
export MPLCONFIGDIR := $(CURDIR)/.cache/matplotlib
export PYTHONPYCACHEPREFIX := $(CURDIR)/.cache/bytecode
export PYTHONDONTWRITEBYTECODE :=
unexport PYTHONPATH PYTHONHOME PYTHONSTARTUP

.PHONY: files run kernels test quick test-all fuzz faults soak golden bench frames quickest lamps counters window table views motion memory large growth first first-start dist kernel-wheel docs notebooks linkcheck pictures lint format lock clean distclean help bounds methods grades results settings

run:  ## open the viewer; without a display, render the default scene to a file (ARGS="kitchen.aff")
	@tools/environment.sh run
	@$(RUN) tools/run.py $(ARGS)

kernels:  ## compile all that the tests use
	@tools/environment.sh dev
	@$(RUN) -m tests.compiled

test: kernels  ## run the tests; without a display, on a virtual one (ARGS="-k culling")
	@$(RUN) tools/with_screen.py $(RUN) -m pytest $(PARALLEL) $(ARGS)

quick:  ## run the tests that show soonest whether something is broken, one window among them
	@$(MAKE) --no-print-directory test ARGS='$(QUICK) $(ARGS)'

test-all:  ## run the tests with more random scenes and frames, all combinations, and what is checked seldom
	@SHADOWCULL_TESTS=all $(MAKE) --no-print-directory test

fuzz:  ## read damaged files of all kinds, and trace what is left of them (ARGS="--seconds 600 --seed 1000")
	@tools/environment.sh dev
	@$(RUN) -m tests.fuzz.readers $(ARGS)

faults:  ## kill what writes, fill its disk, and let several write at once (ARGS="--kills 1000 --only disk")
	@tools/environment.sh dev
	@$(RUN) -m tests.fuzz.faults $(ARGS)

bounds:  ## have kernels checked for reading or writing past an array's end (ARGS="--seconds 600 --seed 1000")
	@tools/environment.sh dev
	@$(RUN) -m tests.fuzz.bounds $(ARGS)

soak:  ## use the program for long, and watch memory, threads and files (ARGS="--seconds 3600 SCENE ...")
	@tools/environment.sh dev
	@$(RUN) -m tests.fuzz.soak $(ARGS)

golden:  ## render the golden pictures of the tests anew, and say what changed
	@tools/environment.sh dev
	@$(RUN) -m tests.golden.pictures

bench:  ## hold ray rates and frames against Embree's (ARGS="--quick SCENE ..."), then what counters cost
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.against_embree $(ARGS)
	@$(RUN) -m tests.bench.counters

frames:  ## time frames with and without culling, phase by phase (ARGS="--frames 10 SCENE ...")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.frame_times $(ARGS)

quickest:  ## hold frames by `auto` against those by `none`, fifty at a time (ARGS="--frames 100 SCENE ...")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.quickest $(ARGS)

methods:  ## hold all methods side by side, scene by scene (ARGS="--write" into their page, "--frames 4 SCENE ...")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.methods $(ARGS)

grades:  ## write a report card for each method, a line each (ARGS="--write" into the page of methods, "paper cells")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.grades $(ARGS)

results:  ## measure all tables of the pages of results and performance anew (ARGS="--write", "--only table-1", "--quick")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.results $(ARGS)

settings:  ## write the page of all settings from their declarations
	@tools/environment.sh dev
	@$(RUN) tools/settings_table.py

lamps:  ## hold frames by the light of lamps against those by `none` (ARGS="--radius 0.1 --frames 20 SCENE ...")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.lamps $(ARGS)

counters:  ## time frames with and without counters of steps and tests (ARGS="--frames 10 SCENE")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.counters $(ARGS)

window:  ## time how soon the window shows a picture, and its own frames while tracing (ARGS="--seconds 20 SCENE")
	@tools/environment.sh dev
	@$(RUN) tools/with_screen.py $(RUN) -m tests.bench.window_times $(ARGS)

table:  ## time the window with a table of 500,000 primitives, and how soon a click is seen (ARGS="--clicks 200")
	@tools/environment.sh dev
	@$(RUN) tools/with_screen.py $(RUN) -m tests.bench.table_times $(ARGS)

views:  ## how long each view takes to draw, beside what tracing a frame takes (ARGS="--sizes 1920x1080 SCENE")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.drawing $(ARGS)

motion:  ## how good pictures in motion are, and how soon they are whole (ARGS="--json motion.json SCENE")
	@tools/environment.sh dev
	@$(RUN) tools/with_screen.py $(RUN) -m tests.bench.motion $(ARGS)

memory:  ## measure the memory of Kitchen and of a million triangles, and build times (ARGS="--triangles 200000 SCENE")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.memory $(ARGS)

large:  ## measure how meshes of millions of triangles are opened (ARGS="--triangles 20000000 --kinds ply")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.large_scenes $(ARGS)

growth:  ## measure how the cost of a ray grows from 10,000 to 2,000,000 triangles (ARGS="--most 200000")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.growth $(ARGS)

first:  ## measure how soon a scene shows its first picture and a close-up, by each structure (ARGS="--triangles 200000 SCENE")
	@tools/environment.sh dev
	@$(RUN) -m tests.bench.first_pictures $(ARGS)

first-start:  ## measure the window's very first start: with nothing compiled, and with the wheel of kernels in dist
	@tools/environment.sh dev
	@$(RUN) tools/with_screen.py $(RUN) -m tests.bench.window_times --first-start $(ARGS)

dist:  ## build the wheel and the source distribution, and check them (ARGS="--newest --oldest": install and use them)
	@tools/environment.sh dev
	@$(RUN) tools/dist.py $(ARGS)

kernel-wheel:  ## build the wheel shadowcull-kernels: compiled kernels for this platform, Python and numba (minutes)
	@tools/environment.sh dev
	@$(RUN) tools/kernels.py

docs:  ## build the documentation in build/docs; every warning is an error
	@tools/environment.sh dev
	$(RUN) -m sphinx -W --keep-going -n -q -d .cache/docs -b html docs build/docs

notebooks:  ## run the notebooks of the documentation, and keep what their cells show
	@tools/environment.sh dev
	@$(RUN) tools/notebooks.py $(ARGS)

linkcheck:  ## check the documentation's links to other sites, which needs the network
	@tools/environment.sh dev
	$(RUN) -m sphinx -q -d .cache/docs -b linkcheck docs build/linkcheck

pictures:  ## make the pictures of the README and of the methods anew (ARGS="film", "still" or "methods": one of them)
	@tools/environment.sh dev
	@$(RUN) tools/with_screen.py $(RUN) tools/make_pictures.py $(ARGS)

lint:  ## check style, types and the direction of imports
	@tools/environment.sh dev
	$(RUN) -m ruff check .
	$(RUN) -m ruff format --check .
	$(RUN) -m mypy
	$(RUN) -c 'from importlinter.cli import lint_imports_command; lint_imports_command(["--no-cache"])'

format:  ## put the sources in the form that lint asks for
	@tools/environment.sh dev
	$(RUN) -m ruff check --fix .
	$(RUN) -m ruff format .

lock:  ## choose the newest versions within pyproject.toml's ranges (ARGS="numba numpy": only these)
	@tools/environment.sh dev
	@tools/lock.sh $(ARGS)

files:  ## print every file with the first line of what it says of itself
	@tools/environment.sh dev
	@$(RUN) tools/files.py

clean:  ## remove what was compiled, cached or built; the environment and pictures stay
	rm -rf .cache .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis dist build
	find tracer viewer tests tools assets -name __pycache__ -prune -exec rm -rf {} +

distclean: clean  ## remove the environment as well
	rm -rf .venv

help:  ## show this
	@echo "make run and make test are all that is needed; the first run sets everything up."
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## ?/  make \1|/' | column -t -s '|'
