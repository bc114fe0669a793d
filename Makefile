# make garage_sar runs the garage mission in ROS, make test every test; make help lists all targets.
# Each target first installs and builds what is missing.

SHELL := /bin/bash
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

VENV := .venv
PYTHON := $(VENV)/bin/python
BUILD := build
JOBS ?= $(shell nproc)
SPEED ?= 5
FUZZ := $(BUILD)/fuzz
FUZZ_SECONDS ?= 60
# Whole missions are excluded: with the sanitizers they take many minutes, and no C++ is used only by them.
SANITIZED := $(addprefix test/python/,propagation network sensing world swarm control fuzz/test_core_entry_points.py)
ARGS ?=
# The environment for ROS and Python, independent of the user's shell.
ENV := source $(BUILD)/devel/setup.bash &&
CPP_FILES = $(shell git ls-files '*.hpp' '*.cpp')

.PHONY: help setup build garage_sar run test test_cpp test_python test_ros lint tidy bench bench_ros exactness report build_fuzz fuzz sanitize faults garbage wheel pictures man lock clean

help: ## list the targets
	@sed -n 's/^\([a-z_]*\):[^#]*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 22
	@echo "  options: SPEED=5 (times real time, 0: as fast as possible), ARGS='robots:=5 noise:=20' or ARGS='--noise 20', JOBS=2"

setup: $(VENV)/.ready ## install missing packages: Debian packages, PyPI packages into .venv

$(VENV)/.debian: setup/debian-packages.txt setup/install-debian-packages.sh
	@setup/install-debian-packages.sh setup/debian-packages.txt
	@# Debian's Python has the ROS packages; another python3 may come first on PATH.
	@test -x $(PYTHON) || { echo "-- making $(VENV)"; /usr/bin/python3 -m venv --system-site-packages $(VENV); }
	@touch $@

$(VENV)/.ready: $(VENV)/.debian setup/requirements.lock
	@echo "-- PyPI packages into $(VENV)"
	@$(PYTHON) -m pip install --quiet --disable-pip-version-check --require-hashes --requirement setup/requirements.lock
	@touch $@

build: $(VENV)/.ready ## build messages, C++ library and nodes into build/
	@test -f $(BUILD)/Makefile || { echo "-- configuring"; mkdir -p $(BUILD); \
		cmake -S . -B $(BUILD) -DPYTHON_EXECUTABLE=$(CURDIR)/$(PYTHON) -DCATKIN_ENABLE_TESTING=ON \
		> $(BUILD)/configure.log 2>&1 || { cat $(BUILD)/configure.log; rm -f $(BUILD)/Makefile; exit 1; }; }
	@echo "-- building"
	@cmake --build $(BUILD) -j$(JOBS) > $(BUILD)/build.log 2>&1 || { cat $(BUILD)/build.log; exit 1; }
	@echo $(CURDIR)/$(BUILD)/devel/lib/python3/dist-packages > "$$($(PYTHON) -c 'import site; print(site.getsitepackages()[0])')/robotteamsim.pth"
	@printf '#!%s\nimport sys\n\nfrom robotteamsim.cli import main\n\nif __name__ == "__main__":\n    sys.exit(main())\n' $(CURDIR)/$(PYTHON) > $(VENV)/bin/robotteamsim
	@chmod +x $(VENV)/bin/robotteamsim

garage_sar: build ## run the garage mission with roslaunch, and rviz if there is a display
	@$(ENV) roslaunch robotteamsim garage_sar.launch lockstep:=true speed:=$(SPEED) $(ARGS)

run: build ## run the garage mission headless
	@$(VENV)/bin/robotteamsim run garage_sar $(ARGS)

test: lint test_cpp test_python test_ros ## run every test: linters, GoogleTest, pytest, rostest

test_cpp: build ## GoogleTest
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_test > $(BUILD)/build_test.log 2>&1 || { cat $(BUILD)/build_test.log; exit 1; }
	@$(BUILD)/devel/lib/robotteamsim/robotteamsim_test --gtest_brief=1

test_python: build ## pytest
	@$(ENV) $(PYTHON) -m pytest test/python -n $(JOBS) --dist loadfile $(ARGS)

test_ros: build ## rostest, each test with its own master
	@$(ENV) $(PYTHON) -m pytest test/ros -n $(JOBS) --dist loadfile $(ARGS)

lint: build ## ruff, mypy, clang-format, yamllint
	@$(PYTHON) -m ruff check --quiet .
	@$(PYTHON) -m ruff format --quiet --check .
	@$(PYTHON) -m mypy --no-error-summary
	@clang-format --dry-run -Werror $(CPP_FILES)
	@yamllint --strict scenarios maps
	@echo "-- linters: clean"

tidy: build ## clang-tidy over the C++ code; about four minutes on two cores
	@run-clang-tidy-14 -quiet -p $(BUILD) -j$(JOBS) '^$(CURDIR)/src/(cpp|bindings)/' > $(BUILD)/tidy.log 2>&1 \
		|| { grep -A3 "error:" $(BUILD)/tidy.log; exit 1; }
	@echo "-- clang-tidy: clean"

bench: build ## measure the speed of each part relative to a straightforward one, into bench/results/
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_bench > $(BUILD)/build_bench.log 2>&1 || { cat $(BUILD)/build_bench.log; exit 1; }
	@$(ENV) $(PYTHON) bench/run.py $(BUILD)/devel/lib/robotteamsim/robotteamsim_bench --csv bench/results/speed.csv $(ARGS)
	@$(ENV) $(PYTHON) bench/mission_bench.py --csv bench/results/missions.csv
	@$(ENV) for script in bench/world_bench.py $(filter-out bench/ros_%.py bench/world_bench.py bench/mission_bench.py,$(wildcard bench/*_bench.py)); do $(PYTHON) $$script || exit 1; done

bench_ros: build ## measure worlds, missions, a team and the network of 1000 robots in ROS; ARGS="--csv bench/results/ros.csv"
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_ros_listener > $(BUILD)/build_bench.log 2>&1 || { cat $(BUILD)/build_bench.log; exit 1; }
	@$(ENV) $(PYTHON) bench/ros_bench.py $(BUILD)/devel/lib/robotteamsim/robotteamsim_ros_listener $(ARGS)
	@$(ENV) $(PYTHON) bench/ros_team_bench.py $(ARGS)
	@$(ENV) $(PYTHON) bench/ros_network_bench.py $(ARGS)

exactness: build ## compare 50 million cells of maps with one ray each, and links with their reverse
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_exactness > $(BUILD)/build_bench.log 2>&1 || { cat $(BUILD)/build_bench.log; exit 1; }
	@set -o pipefail; $(BUILD)/devel/lib/robotteamsim/robotteamsim_exactness $(ARGS) | tee bench/results/exactness.txt

report: build ## run the five campaigns of docs/report (1,500 missions) and write the report; ARGS=--resume continues
	@$(ENV) nice $(PYTHON) bench/report_campaigns.py $(ARGS)

build_fuzz: build
	@command -v clang++-14 > /dev/null || { echo "this needs clang-14 and libclang-rt-14-dev (apt-get install)"; exit 1; }
	@mkdir -p $(FUZZ)
	@echo "-- building under ASan and UBSan"
	@{ cmake -S test/fuzz -B $(FUZZ) -DCMAKE_CXX_COMPILER=clang++-14 -DPython_EXECUTABLE=$(CURDIR)/$(PYTHON) && \
		cmake --build $(FUZZ) -j$(JOBS); } > $(FUZZ)/build.log 2>&1 || { cat $(FUZZ)/build.log; exit 1; }

fuzz: build_fuzz ## fuzz C++, YAML, bags, messages and import, C++ under ASan and UBSan, FUZZ_SECONDS=60 each
	@for name in propagation network; do mkdir -p $(FUZZ)/corpus_$$name; echo "-- $$name"; \
		$(FUZZ)/$${name}_fuzzer -max_total_time=$(FUZZ_SECONDS) -max_len=400 -len_control=0 -verbosity=0 \
		-print_final_stats=1 -artifact_prefix=$(FUZZ)/ $(FUZZ)/corpus_$$name test/fuzz/corpus/$$name || exit 1; done
	@echo "-- core"; $(ENV) PYTHONPATH=test/fuzz:$$PYTHONPATH ASAN_OPTIONS=detect_leaks=0 LD_PRELOAD=$$(cat $(FUZZ)/preloaded) \
		$(PYTHON) test/fuzz/core_fuzz.py --seconds $(FUZZ_SECONDS) --core $(FUZZ)/_core*.so
	@$(ENV) $(PYTHON) test/fuzz/input_fuzz.py --seconds $(FUZZ_SECONDS)
	@echo "-- import"; $(ENV) ASAN_OPTIONS=detect_leaks=0 LD_PRELOAD=$$(cat $(FUZZ)/preloaded) \
		$(PYTHON) test/fuzz/import_fuzz.py --seconds $(FUZZ_SECONDS) --core $(FUZZ)/_core*.so 2> $(FUZZ)/import.log \
		|| { tail -60 $(FUZZ)/import.log; exit 1; }

sanitize: build_fuzz ## run the tests of the C++ parts under ASan and UBSan; ARGS="test/python/world -k door" selects some
	@$(ENV) ROBOTTEAMSIM_CORE=$$(ls $(CURDIR)/$(FUZZ)/_core*.so) PYTHONPATH=test/fuzz:$$PYTHONPATH \
		ASAN_OPTIONS=detect_leaks=0 LD_PRELOAD=$$(cat $(FUZZ)/preloaded) $(PYTHON) -m pytest -q -s -p no:cacheprovider -p sanitized_core \
		$(or $(ARGS),$(SANITIZED))

faults: build ## kill each node of running missions at random moments; ARGS="--moments 5 /world" some of them
	@$(ENV) PYTHONPATH=test/ros:$$PYTHONPATH $(PYTHON) test/faults/kill_nodes.py $(ARGS)

garbage: build ## send a million garbage messages to the nodes of running missions; ARGS="--messages 20000 world" fewer
	@$(ENV) PYTHONPATH=test/ros:test/fuzz:$$PYTHONPATH $(PYTHON) test/faults/garbage.py $(ARGS)

wheel: $(VENV)/.ready ## build dist/*.whl, which includes Box2D and needs no compiler
	@rm -rf dist && mkdir -p dist/raw
	@$(PYTHON) -m pip wheel --quiet --no-deps --wheel-dir dist/raw .
	@PATH="$(CURDIR)/$(VENV)/bin:$$PATH" $(PYTHON) -m auditwheel repair --wheel-dir dist dist/raw/*.whl
	@rm -rf dist/raw && ls dist/*.whl

pictures: build ## regenerate the pictures of README and docs
	@$(ENV) $(PYTHON) docs/draw_cases.py
	@$(ENV) $(PYTHON) docs/draw_swarm.py
	@$(ENV) $(PYTHON) docs/make_own_building.py
	@$(ENV) $(PYTHON) -m robotteamsim.cli field radio garage_sar --at 4,5 --at 30,36 --at 50,18 --png docs/images/field.png
	@$(ENV) $(PYTHON) -m robotteamsim.cli field radio garage_sar --loss --png docs/images/field_loss.png \
		--compare at=4,5 --compare at=40,30
	@$(ENV) $(PYTHON) -m robotteamsim.cli field voice garage_sar --range highest --png docs/images/field_noise.png \
		--compare voice.noise_db=10 --compare voice.noise_db=20 --compare voice.noise_db=30
	@$(ENV) for map in mrl_arena isr_floor_0; do \
		$(PYTHON) -m robotteamsim.cli plan render $$map --png docs/images/$$map.png || exit 1; done
	@$(ENV) $(PYTHON) bench/office_arms.py --again
	@rm -rf $(BUILD)/analysis && mkdir -p $(BUILD)/analysis
	@$(ENV) $(PYTHON) -m robotteamsim.cli run garage_sar --seed 7 --bag $(BUILD)/analysis/mission.bag --out $(BUILD)/analysis > /dev/null
	@$(ENV) $(PYTHON) -m robotteamsim.cli analyse $(BUILD)/analysis/mission.bag --png docs/images/analysis.png --scenario garage_sar > /dev/null
	@$(ENV) $(PYTHON) docs/draw_viewer.py
	@$(ENV) $(PYTHON) docs/make_pictures.py

man: build ## write the man page docs/robotteamsim.1 again
	@$(ENV) $(PYTHON) docs/make_man_page.py docs/robotteamsim.1

lock: ## write setup/requirements.lock again: the versions of requirements.txt, what they need, and all hashes
	@$(PYTHON) -m piptools compile --quiet --generate-hashes --allow-unsafe --strip-extras --no-header --no-annotate \
		--no-emit-index-url --no-emit-find-links --no-emit-trusted-host \
		--output-file setup/requirements.lock setup/requirements.txt

clean: ## remove build/, dist/ and .venv
	rm -rf $(BUILD) dist $(VENV)
