# Thin rules over CMake, the programs in build/bin/ and scripts/. `make` without a target lists them.

MARCH = $(if $(NATIVE),-DPODM_MARCH=native,-UPODM_MARCH)
CMAKE_FLAGS ?=
CONFIGURE = cmake -S . -B build -G Ninja $(MARCH) -DPODM_UNITE=ON $(CMAKE_FLAGS)
FIGURES = results/runs/figures
INPUTS = --records results/runs results/submissions --verified $(FIGURES)/abdomen_verified.json \
  --schedule $(FIGURES)/abdomen_leaves.jsonl --mesh $(FIGURES)/abdomen.vtu \
  --experiment-verdicts $(FIGURES)/experiment_verdicts.json
# Each folder has rows of its own.
CORPUS = results/runs$(if $(FOLDER),/corpus$(subst /,-,$(abspath $(FOLDER))))
TIER ?= default
PREFIX ?= /usr/local
SECONDS ?= 600

.DEFAULT_GOAL := help
.PHONY: help setup build install python profiled wheel sdist deb peers test stress kill-matrix audit docs kick-tires \
  experiments figures corpus clean

help:
	@echo "make kick-tires    run every experiment at its smallest size, in a few minutes; tables and results/runs/"
	@echo "make experiments   run the experiments at laptop size (TIER=full: for the whole machine); a second call"
	@echo "                   continues where the first stopped"
	@echo "make test          run the tests; SLOW=1: also those that take too long for every commit"
	@echo "make stress        random runs with up to 256 workers on random images for SECONDS=600, each verified and"
	@echo "                   replayed; SEED=N repeats one of them"
	@echo "make kill-matrix   list every mutant of a mesh and the claim of podm-verify that rejects it"
	@echo "make audit         recompute every figure and table of the documentation from the rows in results/reference/"
	@echo "make docs          the documentation as a site that needs no network: build/docs/site/index.html"
	@echo "make figures       tables and figures of results/runs/ beside the paper's, a cut through a mesh: $(FIGURES)/,"
	@echo "                   and one page with all of them: results/runs/report.html"
	@echo "make corpus        mesh every label image in FOLDER=... (phantoms without it) unattended, in three settings: the"
	@echo "                   rate of success, the reasons of failures, and the cost in results/runs/corpus.html; a second"
	@echo "                   call continues"
	@echo "make build         the programs, in build/bin/"
	@echo "make python        the Python package podm, in build/python/"
	@echo "make profiled      programs and package as in make wheel and make deb, in build-profiled/: GCC optimises the"
	@echo "                   mesher by a profile; the meshes are those of make build, which takes half the time"
	@echo "make install       the programs, their scripts and the library, in PREFIX=/usr/local (DESTDIR=FOLDER: under it)"
	@echo "make wheel         dist/podmark-*.whl, which pip installs on Linux with glibc 2.31 or later: programs and package"
	@echo "make sdist         dist/podmark-*.tar.gz, the sources, which pip builds where \`make python\` works"
	@echo "make deb           dist/*.deb, packages of Debian 12: podmark, podmark-mpi, podmark-dev, python3-podm"
	@echo "make peers         the other programs that \`make experiments\` uses: TetGen, Gmsh and likwid as packages, and"
	@echo "                   CGAL's mesher (GPL, compiles for about 3 minutes, stays in build/bin/); CGAL6=FOLDER: also"
	@echo "                   the mesher of the CGAL 6 whose headers are in FOLDER/include"
	@echo "make setup         install the Debian 12 packages for all of these (root or sudo; otherwise prints what to run)"
	@echo "make clean         remove the build folders and dist/; results stay"
	@echo
	@echo "Each target makes its prerequisites, including setup and build."
	@echo "  NATIVE=1         compile for this machine's processor instead of any x86-64-v3 or ARMv8 processor"
	@echo "  IMAGE=FILE       (make experiments) use your own segmentation"
	@echo "  DATA=FOLDER      (make test) also run the tests on the real images in FOLDER"
	@echo "  CMAKE_FLAGS=...  further flags for CMake"

setup:
	@scripts/setup

build:
	@scripts/setup build
	$(CONFIGURE)
	cmake --build build

python:
	@scripts/setup build python
	$(CONFIGURE)
	cmake --build build --target podm_python_package

# Wheel and Debian packages are made of this build.
profiled:
	scripts/build_profiled build-profiled $(MARCH) $(CMAKE_FLAGS)

# The programs are linked again, with libraries that are made once and stay in build-wheel/.
wheel: profiled
	@scripts/setup packaging
	scripts/packaging/libraries build-wheel
	scripts/packaging/make_wheel

sdist:
	scripts/packaging/make_sdist

deb: profiled
	@scripts/setup packaging
	scripts/packaging/make_deb

# DESTDIR, from the environment or the command line, is put before PREFIX.
install: build
	$(if $(DESTDIR),DESTDIR="$(abspath $(DESTDIR))") cmake --install build --prefix "$(PREFIX)"

# CMake runs again because packages that it looks for may have been installed since the last time.
peers: build
	@scripts/setup peers
	$(CONFIGURE) $(if $(CGAL6),-DPODM_CGAL6="$(abspath $(CGAL6))")
	cmake --build build --target peers

test:
	@scripts/setup build run python test
	$(CONFIGURE) -DPODM_BUILD_TESTS=ON
	cmake --build build --target all tests
	$(if $(DATA),PODM_TEST_IMAGES="$(abspath $(DATA))") $(if $(SLOW),PODM_SLOW_TESTS=1) \
	  ctest --test-dir build -j$$(n=$$(nproc); echo $$((n < 8 ? n + 1 : 8))) --output-on-failure
	@grep -ho 'skipped: .*' build/Testing/Temporary/LastTest.log | sort | uniq -c || true

# A failing seed is added to the seeds that `make test` repeats.
stress: build
	@scripts/setup run
	cd mesher/tests && PODM_PROGRAM=$(CURDIR)/build/bin/podm /usr/bin/python3 -B stress.py \
	  $(if $(SEED),--seed $(SEED),--seconds $(SECONDS) --keep stress_seeds.txt $(if $(FIRST),--first $(FIRST)) \
	  $(if $(RECORD),--record "$(abspath $(RECORD))")) $(SHAPES)

kill-matrix: build
	@scripts/setup run
	/usr/bin/python3 -B verifiers/tests/kill_matrix.py build/bin/podm build/bin/podm-verify

# To change a figure on purpose, run scripts/update_docs --figures.
audit:
	@scripts/setup run
	scripts/audit

docs: build
	@scripts/setup run docs
	scripts/make_docs

kick-tires:
	$(MAKE) experiments TIER=kick-tires

# The kick-tires tier builds no peers. Trials of meshers that are missing are skipped.
experiments: build $(if $(filter kick-tires,$(TIER)),,peers)
	@scripts/setup run $(if $(filter kick-tires,$(TIER)),,solvers)
	build/bin/podm-bench run --tier $(TIER) $(if $(IMAGE),--image "$(IMAGE)") experiments/*.toml

# Makes the tables and figures of the records in results/runs/, a view of the cut phantom, and one page with all of
# them. Two nodes mesh the phantom leaf by leaf, therefore its mesh and schedule also give figure 2b. The page shows
# at most 200 000 cells.
figures: build
	@scripts/setup run
	mkdir -p $(FIGURES)
	build/bin/podm mesh phantom:abdomen@256 --target-elements 190000 --algorithm pdr-podm --nodes 2 --cores-per-node 1 \
	  --oversubscribe --initial-ratio 2 --schedule $(FIGURES)/abdomen_leaves.jsonl -o $(FIGURES)/abdomen.vtu
	build/bin/podm view $(FIGURES)/abdomen.vtu -o $(FIGURES)/abdomen_cut.png
	build/bin/podm-verify $(FIGURES)/abdomen.vtu --schedule $(FIGURES)/abdomen_leaves.jsonl \
	  --json $(FIGURES)/abdomen_verified.json
	build/bin/podm-bench verdicts --json $(FIGURES)/experiment_verdicts.json experiments/*.toml > /dev/null
	scripts/make_figures $(INPUTS) -o $(FIGURES)
	scripts/report $(INPUTS) -o results/runs/report.html

# An image without a mesh is a result: podm-bench exits with 1, and the page follows.
corpus: build
	@scripts/setup run
	build/bin/podm-bench run experiments/corpus.toml $(if $(FOLDER),--image "$(FOLDER)" --results "$(CORPUS)") || \
	  test $$? = 1
	scripts/report --records "$(CORPUS)/corpus.jsonl" -o results/runs/corpus.html

clean:
	rm -rf build build-* dist
