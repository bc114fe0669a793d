# make garage_sar runs the garage mission in ROS, make test every test; make help lists all targets.
# Each target first installs and builds what is missing: setup/step.sh shows the steps, build/log has their output.

SHELL := /bin/bash
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help

ifneq ($(words $(CURDIR)),1)
$(error $(CURDIR): catkin cannot build in a folder with a blank in its path; move this folder)
endif

VENV := .venv
PYTHON := $(VENV)/bin/python
BUILD := build
ROS2 ?= jazzy
ROS2_VENV := $(BUILD)/venv-$(ROS2)
PEERS := $(BUILD)/venv-peers
JOBS ?= $(shell nproc)
SPEED ?= 5
# Of PyPI: Debian 13 has another version, which formats differently.
CLANG_FORMAT = $(or $(wildcard $(VENV)/bin/clang-format),clang-format)
FUZZ := $(BUILD)/fuzz
FUZZ_SECONDS ?= 60
# Whole missions are excluded: with the sanitizers they take many minutes, and no C++ is used only by them.
SANITIZED := $(addprefix test/python/,propagation network sensing world swarm control fuzz/test_core_entry_points.py)
ARGS ?=
PIP_INSTALL = $(PYTHON) -m pip install --disable-pip-version-check --require-hashes
# The environment for ROS and Python, independent of the user's shell.
ENV := source $(BUILD)/devel/setup.bash &&
# Otherwise each of the many processes of launches and tests compiles all modules again.
unexport PYTHONDONTWRITEBYTECODE
# Tests are many processes, and NumPy would start a thread per core in each, which waits busily.
check test_python test_ros test_ros2: export OPENBLAS_NUM_THREADS ?= 1
CPP_FILES = $(shell git ls-files '*.hpp' '*.cpp')

.PHONY: help announce setup build build_tests compile garage_sar run check test test_cpp test_python test_ros test_ros2 lint tidy bench bench_learning bench_ros bench_ros2 bench_gazebo exactness report build_fuzz fuzz sanitize faults garbage build_gazebo gazebo nightly sizes wheel pictures docs notebook man lock clean

help: ## list the targets
	@sed -n 's/^\([a-z_]*\):[^#]*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 22
	@echo "  options: SPEED=5 (times real time, 0: as fast as possible), ARGS='robots:=5 noise:=20' or ARGS='--noise 20', JOBS=2"

setup: ## install everything that is missing, for each command and test: Debian packages, PyPI packages into .venv
	@$(PARTS) $(DEBIAN)-test $(VENV)/.ready

# The set-up consists of steps. A file in .venv marks a finished one; make runs what does not depend on each other at the
# same time: apt beside pip and the compiler. Only one apt can run, so its steps are in a row.
PARTS := +$(MAKE) --no-print-directory -j4
DEBIAN := $(VENV)/.debian
FIRST := $(if $(wildcard $(VENV)/.run),,yes)
number = $(if $(FIRST),[$(1)] )
step = @setup/step.sh "$(1)" $(BUILD)/log/$(2).log
DEBIAN_FILES := setup/debian-packages.txt setup/install-debian-packages.sh

$(VENV)/.python: $(DEBIAN_FILES)
	$(call step,$(call number,1/5)Debian's venv,debian-venv) setup/install-debian-packages.sh python3-venv
	@# Debian's Python has the ROS packages; another python3 may come first on PATH.
	@test -x $(PYTHON) || /usr/bin/python3 -m venv --system-site-packages $(VENV)
	@touch $@

$(DEBIAN)-build: $(VENV)/.python $(DEBIAN_FILES)
	$(call step,$(call number,2/5)Debian packages to build with,debian-build) setup/install-debian-packages.sh build
	@touch $@

$(VENV)/.run: $(VENV)/.python setup/requirements-run.lock
	$(call step,$(call number,3/5)PyPI packages,pypi-run) $(PIP_INSTALL) --no-compile --requirement setup/requirements-run.lock
	@touch $@

$(DEBIAN)-run: $(DEBIAN)-build
	$(call step,$(call number,4/5)Debian packages to run with,debian-run) setup/install-debian-packages.sh run
	@touch $@

$(DEBIAN)-view: $(DEBIAN)-run
	$(call step,Debian packages for rviz,debian-view) setup/install-debian-packages.sh view
	@touch $@

$(DEBIAN)-test: $(DEBIAN)-view
	$(call step,Debian packages for tests,debian-test) setup/install-debian-packages.sh test
	@touch $@

$(VENV)/.ready: $(VENV)/.run setup/requirements.lock
	$(call step,PyPI packages for all commands and tests,pypi) $(PIP_INSTALL) --requirement setup/requirements.lock
	@touch $@

$(VENV)/.wheel: $(VENV)/.run setup/requirements-wheel.lock
	$(call step,PyPI packages for the wheel,pypi-wheel) $(PIP_INSTALL) --requirement setup/requirements-wheel.lock
	@touch $@

compile: $(DEBIAN)-build $(VENV)/.run
	$(call step,$(call number,5/5)building,build) setup/compile.sh $(BUILD) $(PYTHON) $(JOBS) no

build: announce ## build messages, C++ library and nodes into build/
	@$(PARTS) $(if $(and $(DISPLAY),$(filter garage_sar,$(MAKECMDGOALS))),$(DEBIAN)-view,$(DEBIAN)-run) compile

build_tests: announce
	@$(PARTS) $(DEBIAN)-test $(VENV)/.ready compile
	$(call step,building for tests,build_tests) setup/compile.sh $(BUILD) $(PYTHON) $(JOBS) yes

announce:
	@$(if $(FIRST),cat setup/first-run.txt)

garage_sar: build ## run the garage mission with roslaunch, and rviz if there is a display
	@$(if $(DISPLAY),,cat setup/no-display.txt)
	@$(ENV) roslaunch robotteamsim garage_sar.launch lockstep:=true speed:=$(SPEED) $(ARGS)

run: build ## run the garage mission headless
	@$(VENV)/bin/robotteamsim run garage_sar $(ARGS)

test: lint test_cpp test_python test_ros test_ros2 ## linters, GoogleTest, pytest, rostest, ROS 2; not tidy, sanitize, fuzz, faults, garbage, gazebo

check: build_tests ## run the linters of Python and the fast tests, in about a minute: for every save
	@$(PYTHON) -m ruff check --quiet .
	@$(PYTHON) -m ruff format --quiet --check .
	@$(ENV) $(PYTHON) -m mypy --no-error-summary
	@$(ENV) $(PYTHON) -m pytest test/python -m "not slow" -n $(JOBS) --dist loadfile $(ARGS)

test_cpp: build_tests ## GoogleTest
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_test > $(BUILD)/build_test.log 2>&1 || { cat $(BUILD)/build_test.log; exit 1; }
	@$(BUILD)/devel/lib/robotteamsim/robotteamsim_test --gtest_brief=1

test_python: build_tests ## pytest
	@# One more than cores, because some of these tests wait for processes and browsers.
	@$(ENV) $(PYTHON) -m pytest test/python -n $$(($(JOBS) + 1)) --dist loadfile $(ARGS)

test_ros: build_tests ## rostest, each test with its own master
	@# Twice as many as cores, because half of the time these tests wait for timeouts and for processes to end.
	@$(ENV) $(PYTHON) -m pytest test/ros -n $$((2 * $(JOBS))) --dist worksteal $(ARGS)

# Independent of a ROS that the user's shell has sourced.
ROS2_ENV := env -u PYTHONPATH ROS_VERSION=2 AMENT_PREFIX_PATH=$(CURDIR)/$(ROS2_VENV)
# The wheels are for Linux on x86_64 only.
ROS2_WHEELS = $(filter Linux-x86_64,$(shell uname -sm | tr ' ' -))

test_ros2: build_tests ## tests with rclpy of ROS 2 Jazzy (ROS2=kilted: Kilted), from wheels; each test has a domain of its own
ifeq ($(ROS2_WHEELS),)
	@echo "-- test_ros2: skipped, because ROS 2 has wheels for Linux on x86_64 only"
else
	$(call step,ROS 2 and this package in $(ROS2_VENV),ros2) setup/ros2.sh $(ROS2_VENV) $(BUILD)/$(ROS2) $(JOBS) $(ROS2)
	@$(ROS2_ENV) $(ROS2_VENV)/bin/python -m pytest -c test/ros2/pytest.ini test/ros2 -n $$((2 * $(JOBS))) --dist worksteal $(ARGS)
endif

lint: build_tests ## ruff, mypy, clang-format, yamllint
	@$(PYTHON) -m ruff check --quiet .
	@$(PYTHON) -m ruff format --quiet --check .
	@$(PYTHON) -m mypy --no-error-summary
	@$(CLANG_FORMAT) --dry-run -Werror $(CPP_FILES)
	@yamllint --strict scenarios maps
	@echo "-- linters: clean"

tidy: build_tests ## clang-tidy over the C++ code; about four minutes on two cores
	@command -v run-clang-tidy-14 > /dev/null || { echo "this needs clang-tidy-14 (apt-get install)"; exit 1; }
	@cmake -S . -B $(BUILD)/tidy -DPYTHON_EXECUTABLE=$(CURDIR)/$(PYTHON) -DROBOTTEAMSIM_UNITY=OFF > $(BUILD)/tidy.log
	@run-clang-tidy-14 -quiet -p $(BUILD)/tidy -j$(JOBS) '^$(CURDIR)/src/(cpp|bindings|ros_publisher)/' > $(BUILD)/tidy.log 2>&1 \
		|| { grep -A3 "error:" $(BUILD)/tidy.log; exit 1; }
	@echo "-- clang-tidy: clean"

bench: build_tests ## measure the speed of each part relative to a straightforward one, into bench/results/
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_bench > $(BUILD)/build_bench.log 2>&1 || { cat $(BUILD)/build_bench.log; exit 1; }
	@$(ENV) $(PYTHON) bench/run.py $(BUILD)/devel/lib/robotteamsim/robotteamsim_bench --csv bench/results/speed.csv $(ARGS)
	@$(ENV) $(PYTHON) bench/mission_bench.py --csv bench/results/missions.csv
	@$(ENV) for script in bench/world_bench.py $(filter-out bench/ros_%.py bench/ros2_bench.py bench/world_bench.py bench/mission_bench.py bench/learning_bench.py,$(wildcard bench/*_bench.py)); do $(PYTHON) $$script || exit 1; done

$(PEERS)/.ready: setup/requirements-peers.txt
	$(call step,the peers in $(PEERS),peers) bash -c '/usr/bin/python3 -m venv --clear $(PEERS) && $(PEERS)/bin/python -m pip install --disable-pip-version-check --requirement $<'
	@touch $@

bench_learning: build_tests $(PEERS)/.ready ## measure environments for learning, VMAS and IR-SIM; ARGS="--csv bench/results/learning.csv"
	@$(ENV) $(PYTHON) bench/learning_bench.py $(PEERS)/bin/python $(ARGS)

bench_ros: build_tests ## measure worlds, missions, a team and the network of 1000 robots in ROS; ARGS="--csv bench/results/ros.csv"
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_ros_listener > $(BUILD)/build_bench.log 2>&1 || { cat $(BUILD)/build_bench.log; exit 1; }
	@$(ENV) $(PYTHON) bench/ros_bench.py $(BUILD)/devel/lib/robotteamsim/robotteamsim_ros_listener $(ARGS)
	@$(ENV) $(PYTHON) bench/ros_team_bench.py $(ARGS)
	@$(ENV) $(PYTHON) bench/ros_network_bench.py $(ARGS)

bench_ros2: build_tests ## measure missions in ROS 1, and in ROS 2 in the environment of test_ros2; ARGS="--csv bench/results/ros2.csv"
	@setup/ros2.sh $(ROS2_VENV) $(BUILD)/$(ROS2) $(JOBS) $(ROS2) > $(BUILD)/log/ros2.log 2>&1 || { cat $(BUILD)/log/ros2.log; exit 1; }
	@$(ENV) $(PYTHON) bench/ros2_bench.py $(ARGS)
	@$(ROS2_ENV) $(ROS2_VENV)/bin/python bench/ros2_bench.py $(ARGS)

exactness: build_tests ## compare 50 million cells of maps with one ray each, and links with their reverse
	@cmake --build $(BUILD) -j$(JOBS) --target robotteamsim_exactness > $(BUILD)/build_bench.log 2>&1 || { cat $(BUILD)/build_bench.log; exit 1; }
	@set -o pipefail; $(BUILD)/devel/lib/robotteamsim/robotteamsim_exactness $(ARGS) | tee bench/results/exactness.txt

report: build_tests ## run the five campaigns of study/dissertation (1,500 missions) and write the report; ARGS=--resume continues
	@$(ENV) nice $(PYTHON) -m study.dissertation run $(ARGS)

build_fuzz: build_tests
	@command -v clang++-14 > /dev/null || { echo "this needs clang-14 and libclang-rt-14-dev (apt-get install)"; exit 1; }
	@mkdir -p $(FUZZ)
	@echo "-- building under ASan and UBSan"
	@{ cmake -S test/fuzz -B $(FUZZ) -DCMAKE_CXX_COMPILER=clang++-14 -DPython_EXECUTABLE=$(CURDIR)/$(PYTHON) && \
		cmake --build $(FUZZ) -j$(JOBS); } > $(FUZZ)/build.log 2>&1 || { cat $(FUZZ)/build.log; exit 1; }

fuzz: build_fuzz ## fuzz C++, YAML, bags, messages, missions and import, C++ under ASan and UBSan, FUZZ_SECONDS=60 each
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

faults: build ## kill each node of running missions at random moments; ARGS="--moments 5 /simulation" some of them
	@$(ENV) PYTHONPATH=test/ros:$$PYTHONPATH $(PYTHON) test/faults/kill_nodes.py $(ARGS)

garbage: build ## send a million garbage messages to the nodes of running missions; ARGS="--messages 20000 world" fewer
	@$(ENV) PYTHONPATH=test/ros:test/fuzz:$$PYTHONPATH $(PYTHON) test/faults/garbage.py $(ARGS)

# A Debian 11 with Gazebo 11 in a chroot, because newer Debians have none; empty: Gazebo is on this machine.
GAZEBO_CHROOT ?= $(or $(XDG_CACHE_HOME),$(HOME)/.cache)/robotteamsim/gazebo-bullseye
GAZEBO_RUN := $(if $(GAZEBO_CHROOT),setup/gazebo-chroot.sh run $(GAZEBO_CHROOT))

build_gazebo: build_tests
	@$(if $(GAZEBO_CHROOT),setup/gazebo-chroot.sh create $(GAZEBO_CHROOT))
	$(call step,building the plugins of Gazebo,build_gazebo) $(GAZEBO_RUN) gazebo/build.sh $(BUILD)/gazebo $(JOBS)

gazebo: build_gazebo ## run the garage mission in Gazebo, in a Debian 11 that is created once (10 minutes, 2.1 GB), and check it
	@$(ENV) GAZEBO_CHROOT=$(GAZEBO_CHROOT) $(PYTHON) -m pytest test/gazebo -s $(ARGS)

bench_gazebo: build_gazebo ## run 30 garage missions in Gazebo and in our own world, with the same seeds; ARGS="--first 1 --trials 5"
	@$(ENV) GAZEBO_CHROOT=$(GAZEBO_CHROOT) $(PYTHON) -m study.worlds.gazebo_missions $(ARGS)

NIGHTLY ?= tidy sanitize fuzz faults garbage gazebo

nightly: build_tests ## run what test leaves out, one after the other; NIGHTLY="tidy fuzz" some of it
	+@setup/nightly.sh $(NIGHTLY)

sizes: ## print lines of packages, C++ and tests, and words of docs, beside those of a commit; FROM=HEAD~10
	@/usr/bin/python3 setup/sizes.py $(or $(FROM),HEAD)

wheel: $(DEBIAN)-build $(VENV)/.wheel ## build dist/*.whl for Python 3.11 and newer, which includes Box2D and needs no compiler
	@rm -rf dist && mkdir -p dist/raw
	$(call step,building the wheel,wheel) $(PYTHON) -m pip wheel --verbose --no-deps --no-build-isolation --wheel-dir dist/raw .
	@PATH="$(CURDIR)/$(VENV)/bin:$$PATH" $(PYTHON) -m auditwheel repair --wheel-dir dist dist/raw/*.whl
	@rm -rf dist/raw && ls dist/*.whl

pictures: build_tests ## regenerate the pictures of README and docs
	@$(ENV) $(PYTHON) docs/draw_cases.py
	@$(ENV) $(PYTHON) docs/draw_swarm.py
	@$(ENV) $(PYTHON) -m study.learning.draw_curve
	@$(ENV) $(PYTHON) docs/make_own_building.py
	@$(ENV) $(PYTHON) -m robotteamsim.cli field radio garage_sar --at 4,5 --at 30,36 --at 50,18 --png docs/images/field.png
	@$(ENV) $(PYTHON) -m robotteamsim.cli field radio garage_sar --loss --png docs/images/field_loss.png \
		--compare at=4,5 --compare at=40,30
	@$(ENV) $(PYTHON) -m robotteamsim.cli field voice garage_sar --range highest --png docs/images/field_noise.png \
		--compare voice.noise_db=10 --compare voice.noise_db=20 --compare voice.noise_db=30
	@$(ENV) for map in mrl_arena isr_floor_0; do \
		$(PYTHON) -m robotteamsim.cli plan render $$map --png docs/images/$$map.png || exit 1; done
	@$(ENV) $(PYTHON) -m study.network.office_arms --again
	@rm -rf $(BUILD)/analysis && mkdir -p $(BUILD)/analysis
	@$(ENV) $(PYTHON) -m robotteamsim.cli run garage_sar --seed 7 --bag $(BUILD)/analysis/mission.bag --out $(BUILD)/analysis > /dev/null
	@$(ENV) $(PYTHON) -m robotteamsim.cli analyse $(BUILD)/analysis/mission.bag --scenario garage_sar > /dev/null \
		--png docs/images/analysis.png --gif docs/images/garage_sar.gif
	@$(ENV) $(PYTHON) docs/draw_viewer.py
	@$(ENV) $(PYTHON) docs/make_pictures.py

docs: build_tests ## build the website of docs/ into build/docs, without a network
	@$(ENV) $(PYTHON) docs/build_site.py $(BUILD)/docs
	@echo "-- open $(BUILD)/docs/index.html"

notebook: build_tests ## execute the notebook docs/notebook.ipynb again
	@$(ENV) $(PYTHON) docs/execute_notebook.py docs/notebook.ipynb docs/notebook.ipynb

man: build_tests ## show the man page, build/robotteamsim.1
	@man $(BUILD)/robotteamsim.1

lock: ## write the locks in setup/ again: the versions of the requirements, what they need, and all hashes
	@for name in requirements-run requirements-wheel requirements requirements-jazzy requirements-kilted; do \
		$(PYTHON) -m piptools compile --quiet --generate-hashes --allow-unsafe --strip-extras --no-header --no-annotate \
			--no-emit-index-url --no-emit-find-links --no-emit-trusted-host \
			--output-file setup/$$name.lock setup/$$name.txt || exit 1; done

clean: ## remove build/, dist/ and .venv
	rm -rf $(BUILD) dist $(VENV)
