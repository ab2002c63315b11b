# The few commands of the house; CMake does the work (CMakePresets.json).

PREFIX ?= /usr/local
JOBS ?= $(shell nproc)
BUILD := build/release
TETRAVOX := $(BUILD)/bin/tetravox

.DEFAULT_GOAL := help
.PHONY: help demo test bench papers build install format check gallery clean

help:
	@echo "make demo      draw four embedded datasets into out/demo"
	@echo "make test      build everything and run all tests"
	@echo "make bench     measure against VTK: tables in out/bench (QUICK=1: one round of each)"
	@echo "make papers    measure the papers' tables again: out/papers (QUICK=1: one round of each)"
	@echo "make build     build the tool: $(TETRAVOX)"
	@echo "make install   install tool, library and CMake package (PREFIX=$(PREFIX))"
	@echo "make gallery   draw the pictures of README and docs again, measure those of docs/methods"
	@echo "make format    format all C++"
	@echo "make check     formatting and include rules"
	@echo "make clean     remove build/release and out"
	@echo "demo, test, bench, papers and build first install what is missing: tools/install_dependencies.sh"

# A tree that was never configured leaves out the tests, so that a build needs no test packages.
CONFIGURE = cmake --preset release \
  $(if $(wildcard $(BUILD)/build.ninja),,-DTETRAVOX_WITH_TESTS=OFF -DTETRAVOX_WITH_BENCH=OFF)

build:
	@tools/install_dependencies.sh build
	@test -f $(BUILD)/build.ninja || $(CONFIGURE)
	@cmake --build --preset release --parallel $(JOBS) --target product

demo: build
	@tools/draw_pictures.sh demo $(TETRAVOX) out/demo

gallery: build
	@tools/draw_pictures.sh gallery $(TETRAVOX) docs/images
	@tools/draw_pictures.sh methods $(TETRAVOX) docs/methods/images
	@python3 tools/measure_pictures.py $(TETRAVOX) docs/methods/classification.md

test:
	@tools/install_dependencies.sh build test
	@cmake --preset release -DTETRAVOX_WITH_TESTS=ON
	@cmake --build --preset release --parallel $(JOBS)
	@ctest --preset release --parallel $(JOBS)

bench:
	@tools/install_dependencies.sh build bench
	@$(CONFIGURE) -DTETRAVOX_WITH_BENCH=ON
	@cmake --build --preset release --parallel $(JOBS) --target product export_dataset visibility_orders
	@/usr/bin/python3 bench/run.py --build $(BUILD) $(if $(QUICK),--quick) $(if $(README),--readme $(README))

# What measures by OpenGL, where the tree is built with it.
GL_PAPERS = $(if $(shell grep -s '^TETRAVOX_WITH_GL:BOOL=OFF' $(BUILD)/CMakeCache.txt),,papers_opengl projection_tables \
  slicing_tables)

papers:
	@tools/install_dependencies.sh build bench
	@$(CONFIGURE) -DTETRAVOX_WITH_BENCH=ON
	@cmake --build --preset release --parallel $(JOBS) --target preintegration_tables $(GL_PAPERS)
	@mkdir -p out/papers
	@$(BUILD)/bin/preintegration_tables --json out/papers/tables.json $(if $(QUICK),--quick) > out/papers/tables.md
	@cat out/papers/tables.md
ifeq ($(strip $(GL_PAPERS)),)
	@echo "left out, as this tree has TETRAVOX_WITH_GL=OFF: the tables by OpenGL, of cell projection and of slicing"
else
	@$(BUILD)/bin/papers_opengl --json out/papers/opengl.json $(if $(DATA),--data $(DATA)) $(if $(QUICK),--quick) \
	  > out/papers/opengl.md
	@cat out/papers/opengl.md
	@$(BUILD)/bin/projection_tables $(if $(DATA),--shared $(DATA)/..) --json out/papers/projection.json \
	  $(if $(QUICK),--quick) > out/papers/projection.md
	@cat out/papers/projection.md
	@$(BUILD)/bin/slicing_tables --json out/papers/slicing.json $(if $(QUICK),--quick) > out/papers/slicing.md
	@cat out/papers/slicing.md
endif

install:
	@tools/install_dependencies.sh build
	@$(CONFIGURE) -DCMAKE_INSTALL_PREFIX=$(PREFIX)
	@cmake --build --preset release --parallel $(JOBS) --target product
	@cmake --install $(BUILD)

format:
	@tools/check_format.sh --fix

check:
	@tools/check_format.sh
	@python3 tools/check_includes.py

clean:
	@rm -rf $(BUILD) out
