# Needs make and a Python of version 3.11 or later with its venv module. Everything else goes into .venv.

VENV := .venv
BIN := $(VENV)/bin
OUT := out
ARGS :=
WORKERS := 2

# the first interpreter that is young enough and can make environments; name another with make PYTHON=...
PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11 python3.14 python; do \
	"$$p" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && { echo "$$p"; break; }; done)

.PHONY: help demo test coverage bench bench-compare bench-error bench-heat bench-lightmap bench-pictures gallery bench-meshes bench-bases validate docs check ci clean

help:
	@echo 'make demo    solve a furnished room in colour and write a picture, a mesh and the numbers into $(OUT)/'
	@echo 'make test    run the tests (make test ARGS="-k name" for some of them; WORKERS=0 in one process)'
	@echo 'make coverage  run the tests, and say which lines none of them reached'
	@echo 'make bench   print lines per second against the bare ray caster, and add the figures to benchmarks/history.jsonl'
	@echo 'make bench-compare  ratios of the last two runs of make bench'
	@echo 'make bench-error  seconds to 1 % and 0.3 % of error against long references (ARGS=--quick: minutes)'
	@echo 'make bench-heat  CPU seconds of view factors to the error of other programs: half an hour (ARGS=--quick: minutes)'
	@echo 'make bench-pictures  RMS errors of pictures for CPU seconds, beside a path tracer'
	@echo 'make bench-meshes  discretisation errors of meshes that follow the light, beside even ones'
	@echo 'make bench-bases  errors of constant, linear and quadratic light on patches'
	@echo 'make bench-lightmap  CPU seconds of lightmaps to 1 % of error, beside Cycles (ARGS="--blender PYTHON", one that has bpy)'
	@echo 'make gallery  take the pictures of docs/gallery.md anew, beside a path tracer'
	@echo 'make validate  compare with exact solutions, Mitsuba and Radiance, and write docs/validation (ARGS=--quick: a minute)'
	@echo 'make docs    build the documentation site into build/docs'
	@echo 'make check   lint and types'
	@echo 'make ci      what the continuous integration runs: check, test and every command of the README'
	@echo 'make clean   remove what these made, except $(VENV)'

demo: $(VENV)/.user
	$(BIN)/radiosity solve studio --rays 20M -o $(OUT)/studio.png $(OUT)/studio.glb $(OUT)/studio.npz

# what Python compiles is kept: each of the many processes that tests start takes a quarter less time so
test: export PYTHONDONTWRITEBYTECODE :=
test: $(VENV)/.developer
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile $(ARGS)

coverage: $(VENV)/.developer
	$(BIN)/coverage erase
	$(BIN)/coverage run -m pytest $(ARGS)
	$(BIN)/coverage combine --quiet
	$(BIN)/coverage report
	$(BIN)/coverage html --quiet

bench: $(VENV)/.developer
	$(BIN)/python benchmarks/bench.py $(ARGS)

bench-compare: $(VENV)/.developer
	$(BIN)/python benchmarks/history.py $(ARGS)

bench-error: $(VENV)/.developer
	$(BIN)/python benchmarks/error.py $(ARGS)

bench-lightmap: $(VENV)/.developer
	$(BIN)/python benchmarks/lightmap.py $(ARGS)

gallery: $(VENV)/.developer
	$(BIN)/python benchmarks/gallery.py $(ARGS)

bench-pictures: $(VENV)/.developer
	$(BIN)/python benchmarks/pictures.py $(ARGS)

bench-meshes: $(VENV)/.developer
	$(BIN)/python benchmarks/meshes.py $(ARGS)

bench-bases: $(VENV)/.developer
	$(BIN)/python benchmarks/bases.py $(ARGS)

bench-heat: $(VENV)/.peers
	$(BIN)/python benchmarks/heat.py $(ARGS)

validate: $(VENV)/.developer
	$(BIN)/python -m validation $(ARGS)

docs: $(VENV)/.writer
	$(BIN)/python -m sphinx -W --keep-going --nitpicky -q -b html -d build/doctrees docs build/docs
	@echo 'open build/docs/index.html'

check: $(VENV)/.developer
	$(BIN)/ruff check
	$(BIN)/pyright

ci:
	.ci/run

clean:
	rm -rf $(OUT) build dist htmlcov .coverage* .pytest_cache .ruff_cache .hypothesis
	find src tests -name __pycache__ -type d -prune -exec rm -rf {} +

# an environment that is there already is used; one that is broken or too old is made anew
$(VENV)/.made:
	@$(BIN)/python -c 'import pip, sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 || { \
		python='$(PYTHON)'; \
		test -n "$$python" || { echo 'No Python 3.11 or later with venv was found: install one, or name it: make PYTHON=/path/to/python3' >&2; exit 1; }; \
		echo "making $(VENV) with $$python"; "$$python" -m venv --clear $(VENV); }
	@touch $@

$(VENV)/.user: pyproject.toml $(VENV)/.made
	@echo 'installing radiosity into $(VENV)'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[all]'
	@touch $@

$(VENV)/.developer: pyproject.toml $(VENV)/.made
	@echo 'installing radiosity and the tools of its developers into $(VENV)'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[all,dev]'
	@touch $@

$(VENV)/.peers: pyproject.toml $(VENV)/.developer
	@echo 'installing the peers of make bench-heat into $(VENV)'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[all,dev,heat-peers]'
	@touch $@

$(VENV)/.writer: pyproject.toml $(VENV)/.made
	@echo 'installing radiosity and what builds its documentation into $(VENV)'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[all,docs]'
	@touch $@
