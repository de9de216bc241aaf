# Each target sets up what it needs: the environment is made when it is missing or stale.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STUDY := $(VENV)/.made-from-lock
DEV := $(VENV)/.made-from-dev-lock
KERNELS := $(VENV)/.kernels-compiled
PIP := $(BIN)/python -m pip
PIP_INSTALL := $(PIP) install -q --no-compile --disable-pip-version-check
UV_INSTALL := $(BIN)/uv pip install -q --system-certs --python $(BIN)/python
# uv takes a fifth of pip's CPU time but reads none of its settings: pip installs where it has an index of its own,
# or where uv fails
INSTALL = ! $(PIP) config list | grep -q '[.]index-url=' && $(UV_INSTALL) $(1) || $(PIP_INSTALL) $(1)
TESTS := $(BIN)/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder

# Where the surroundings forbid byte code (many containers do), each of hundreds of processes would compile
# again what it imports: a process of the tests for 10 s, a job in a new environment for 3 s.
unexport PYTHONDONTWRITEBYTECODE

# Snakemake and Matplotlib keep caches in the home folder; without one that can be written, here.
ifneq ($(shell test -w "$$HOME" && echo yes),yes)
export XDG_CACHE_HOME := $(CURDIR)/.snakemake/cache
export MPLCONFIGDIR := $(CURDIR)/.snakemake/cache/matplotlib
endif

.PHONY: reproduce help test test-release test-long test-processors cost bench env dev lock lint docs dictionary clean

reproduce: env  ## the whole study: datasets, figures, report
	$(BIN)/snakemake

help:  ## what can be made
	@awk -F ':[^#]*## ' '/^[a-z-]+:[^#]*## / { printf "make %-16s %s\n", $$1, $$2 }' Makefile

test: dev  ## the tests of each change, minutes; and what they cost beside an earlier commit
	$(TESTS) -p tests.cost

test-release: dev  ## the rest: whole studies, cluster, faults, browser, recipes, large samples; the study's cost
	# a sixth of their time two workers wait for files and for Snakemake
	$(TESTS) -n 3 -m "release and not long" --timeout 3000
	$(MAKE) cost

test-long: dev  ## samples that take minutes each, of which test-release has a part; outside .ci/run
	SQUEALPIPE_SAMPLES=all $(TESTS) -m long --timeout 3000

TINY := -q all --cores 2 --configfile workflow/config/tiny.yaml
# In .ci/run the first tier has made the study already.
HERE := $(if $(SQUEALPIPE_TINY),$(SQUEALPIPE_TINY)/study/squealpipe/results/tiny,results/tiny)
AVX2 := tests/processors avx2

cost: dev  ## the paper's study, as far as it is not made here yet, and its CPU time beside an earlier commit
	$(BIN)/snakemake -q all
	$(BIN)/python -m tests.cost .

# On any x86-64 the C library's fma is software, a hundred times slower: there tests/generic.txt: laws, models,
# orbits, series, linear maps and at least one test of every other folder.
test-processors: dev  ## numerics, and the tiny study, as on other processors
	# what the tests with AVX2 need is compiled beside the others
	$(AVX2) $(COMPILE_LOOPS) & \
	  tests/processors generic $(TESTS) @tests/generic.txt && wait $$!
	$(AVX2) $(TESTS) @tests/avx2.txt
	$(if $(SQUEALPIPE_TINY),,$(BIN)/snakemake $(TINY))
	$(AVX2) $(BIN)/snakemake $$(cd $(HERE) && find data -name '*.nc' | sed 's|^|results/avx2/|') \
	  $(TINY) --config results=results/avx2
	$(BIN)/squealpipe compare $(HERE) results/avx2

# One thread for linear algebra: with more, small solvers wait for one another.
bench: export OPENBLAS_NUM_THREADS := 1
bench: export OMP_NUM_THREADS := 1
bench: dev  ## speed beside other tools, as ratios; integrators with events beside one another
	$(call INSTALL,--require-hashes -r requirements-peers.lock)
	for script in tests/benchmarks/bench_*.py; do PYTHONPATH=. $(BIN)/python $$script || exit 1; done
	-$(BIN)/squealpipe benchmark --force -o build/benchmark.nc

lint: dev  ## style, types and which module may import which
	$(BIN)/ruff check . && $(BIN)/ruff format --check .
	$(BIN)/mypy && $(BIN)/lint-imports

docs: dev  ## pages and API reference as one site, build/site
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build

env: $(KERNELS)  ## what a study needs

dev: $(DEV) $(KERNELS)  ## and what tests, checks and docs need; make -j2 dev does both at once

$(STUDY): requirements.lock requirements-pip.lock pyproject.toml
	@case "$(CURDIR)" in *[[:space:]]*) echo "make env: the path '$(CURDIR)' has a space, which the first lines of installed scripts cannot hold; move the checkout" >&2; exit 1;; esac
	test -x $(BIN)/python || $(PYTHON) -m venv --without-pip $(VENV)
	# the pip of Python 3.11 looks through an index three times as slowly; where no other can be had, that one
	$(PYTHON) -m pip --python $(BIN)/python install -q --no-compile --disable-pip-version-check --require-hashes -r requirements-pip.lock \
	  || $(BIN)/python -m ensurepip
	# the one package without a wheel is built with the setuptools that is there, where it is: pip would fetch them
	# anew for an environment of their own, 1.5 s of CPU time
	$(call INSTALL,--no-build-isolation --require-hashes -r requirements.lock) \
	  || $(PIP_INSTALL) --require-hashes -r requirements.lock
	$(UV_INSTALL) --no-deps --no-build-isolation -e . || $(PIP_INSTALL) --no-deps --no-build-isolation -e .
	$(BIN)/python -m compileall -q squealpipe
	touch $@

# 20 s of CPU time, which several first jobs or tests would otherwise spend at once; and byte code of what jobs
# import, for those who may not write it. To look for cyclic garbage in what is imported would take 1 s more.
COMPILE_LOOPS := $(BIN)/python -c "import gc; gc.disable(); \
  import matplotlib.pyplot, netCDF4, snakemake.cli, squealpipe.cli; \
  from squealpipe.study.compiled_loops import compile_loops; compile_loops(); gc.freeze()"
$(KERNELS): $(STUDY)
	$(COMPILE_LOOPS)
	touch $@

$(DEV): requirements-dev.lock $(STUDY)
	$(call INSTALL,--require-hashes -r requirements-dev.lock)
	touch $@

COMPILE = $(BIN)/uv pip compile --universal --python-version 3.11 --generate-hashes \
  --no-emit-index-url --custom-compile-command "make lock" -q

lock: dev  ## the lock files anew, from what pyproject.toml allows
	printf 'pip>=25\nsetuptools>=77\nuv\n' | $(COMPILE) - -o requirements-pip.lock
	# Snakemake imports SQLAlchemy from 9.17 on, for a store of its records that no study uses: 1.3 s of a first study
	echo 'snakemake<9.17' | $(COMPILE) pyproject.toml --extra study -c - -o requirements.lock
	$(COMPILE) pyproject.toml --extra study --extra dev --extra export --extra fe --extra references --extra notebook --extra slurm -c requirements.lock -c requirements-pip.lock -o requirements-dev.lock
	$(COMPILE) pyproject.toml --extra peers -c requirements-dev.lock -o requirements-peers.lock

dictionary: dev  ## docs/datasets.md from the schemas
	$(BIN)/python docs/build_dictionary.py

clean:  ## results of the study; archives and the environment stay
	rm -rf results/data results/figures results/report results/quick .snakemake
