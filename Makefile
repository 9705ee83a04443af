# Thin rules over CMake, the programs in build/bin/ and scripts/. `make` alone lists them.

MARCH = $(if $(NATIVE),native,x86-64-v3)
CMAKE_FLAGS ?=
CONFIGURE = cmake -S . -B build -G Ninja -DPODM_MARCH=$(MARCH) -DPODM_UNITE=ON $(CMAKE_FLAGS)
FIGURES = results/runs/figures
INPUTS = --records results/runs --verified $(FIGURES)/abdomen_verified.json \
  --schedule $(FIGURES)/abdomen_leaves.jsonl --mesh $(FIGURES)/abdomen.vtu \
  --experiment-verdicts $(FIGURES)/experiment_verdicts.json
TIER ?= default
PREFIX ?= /usr/local
SECONDS ?= 600

.DEFAULT_GOAL := help
.PHONY: help setup build install python peers test stress kill-matrix audit docs kick-tires experiments figures clean

help:
	@echo "make kick-tires    the smallest runs of every experiment, in some minutes; tables and results/runs/"
	@echo "make experiments   the experiments at the size of a laptop (TIER=full: of the whole machine); a second call"
	@echo "                   goes on where the first ended"
	@echo "make test          all tests"
	@echo "make stress        random runs of up to 256 workers on random images for SECONDS=600, each verified and"
	@echo "                   replayed; SEED=N repeats one"
	@echo "make kill-matrix   every mutant of a mesh and the claim of podm-verify that rejects it"
	@echo "make audit         every figure and table of the documentation, recomputed from the rows in results/reference/"
	@echo "make docs          the documentation as a site that needs no network: build/docs/site/index.html"
	@echo "make figures       tables and figures of results/runs/ beside the paper's, a mesh cut open: $(FIGURES)/,"
	@echo "                   and one page of it all: results/runs/report.html"
	@echo "make build         the programs, in build/bin/"
	@echo "make python        the Python package podm, in build/python/"
	@echo "make install       programs, what they run and the library, in PREFIX=/usr/local (DESTDIR=FOLDER: below that)"
	@echo "make peers         what \`make experiments\` compares and counts with: TetGen, Gmsh and likwid as packages, and"
	@echo "                   CGAL's mesher (GPL, compiles for some 3 minutes, stays in build/bin/); CGAL6=FOLDER: also"
	@echo "                   that of the CGAL 6 whose headers are in FOLDER/include"
	@echo "make setup         install the Debian 12 packages of all of these (root or sudo; otherwise says what to run)"
	@echo "make clean         remove build folders; results stay"
	@echo
	@echo "Each makes what it needs, setup and build included."
	@echo "  NATIVE=1         compile for this machine's processor instead of any x86-64-v3 one"
	@echo "  IMAGE=FILE       (make experiments) on your own segmentation"
	@echo "  DATA=FOLDER      (make test) also run the tests on the real images in FOLDER"
	@echo "  CMAKE_FLAGS=...  more flags for CMake"

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

# DESTDIR, of the environment or the command line, stands before PREFIX.
install: build
	$(if $(DESTDIR),DESTDIR="$(abspath $(DESTDIR))") cmake --install build --prefix "$(PREFIX)"

# Configured anew: the packages that it looks for may have come since.
peers: build
	@scripts/setup peers
	$(CONFIGURE) $(if $(CGAL6),-DPODM_CGAL6="$(abspath $(CGAL6))")
	cmake --build build --target peers

test:
	@scripts/setup build run python test
	$(CONFIGURE) -DPODM_BUILD_TESTS=ON
	cmake --build build --target all tests
	$(if $(DATA),PODM_TEST_IMAGES="$(abspath $(DATA))") ctest --test-dir build -j4 --output-on-failure
	@grep -ho 'skipped: .*' build/Testing/Temporary/LastTest.log | sort | uniq -c || true

# A failing seed joins those that `make test` repeats.
stress: build
	@scripts/setup run
	cd mesher/tests && PODM_PROGRAM=$(CURDIR)/build/bin/podm /usr/bin/python3 -B stress.py \
	  $(if $(SEED),--seed $(SEED),--seconds $(SECONDS) --keep stress_seeds.txt $(if $(FIRST),--first $(FIRST)) \
	  $(if $(RECORD),--record "$(abspath $(RECORD))"))

kill-matrix: build
	@scripts/setup run
	/usr/bin/python3 -B verifiers/tests/kill_matrix.py build/bin/podm build/bin/podm-verify

# A figure that is meant to change: scripts/update_docs --figures.
audit:
	@scripts/setup run
	scripts/audit

docs: build
	@scripts/setup run docs
	scripts/make_docs

kick-tires:
	$(MAKE) experiments TIER=kick-tires

# The least of the experiments goes without the meshers that it would compare with: their trials are skipped.
experiments: build $(if $(filter kick-tires,$(TIER)),,peers)
	@scripts/setup run $(if $(filter kick-tires,$(TIER)),,solvers)
	build/bin/podm-bench run --tier $(TIER) $(if $(IMAGE),--image "$(IMAGE)") experiments/*.toml

# Tables and figures of the records in results/runs/, the phantom cut open, and one page of it all. The phantom is
# meshed leaf by leaf by two nodes: its mesh and schedule make figure 2b too. The page shows at most 200 000 cells.
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

clean:
	rm -rf build build-*
