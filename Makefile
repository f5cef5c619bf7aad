# The two commands are `make demo` and `make test`; each sets the machine up, builds, and runs.
# Plain CMake presets (see CMakePresets.json) do the same for those who have the packages.
BUILD  := build/release
# Tests run with the assertions of Eigen and of the standard library (preset `test`).
TESTED := build/test
JOBS   ?= $(shell nproc)
SHELL  := /bin/bash
space  := $(subst ,, )

.PHONY: help setup build demo test long campaigns docs pictures format format-check tidy asan asan-readers asan-runs tsan bench peers bench-peers fuzz soak nightly gcc install clean

help: ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /  make \1|/' | column -t -s '|'

setup: ## install what is missing (apt; needs root or sudo)
	@tools/setup.sh

build: setup ## build/release/bin/veridyn, without tests
	cmake --preset release -DVERIDYN_TESTS=OFF --log-level=WARNING
	cmake --build $(BUILD) -j $(JOBS) --target veridyn

demo: build ## a complete run on a built-in aircraft; report in out/demo
	$(BUILD)/bin/veridyn demo --out out/demo

# So many tests that wait (tests/waiting_tests.txt) run next to JOBS tests that compute.
WAITING ?= 2
# Labels of what does not run in `make test`.
LATER := soak|long|campaign|sanitized

test: setup format-check ## build and run the test suite
	$(build_with_tests)
	$(call run_tests,$(TESTED)) -LE '$(LATER)'

long: setup ## tests of accuracy and of coverage over many recordings (label long)
	$(build_with_tests)
	$(call run_tests,$(TESTED)) -L long

CAMPAIGNS ?= .

campaigns: setup ## those that take up to two minutes each (label campaign); CAMPAIGNS="vehicle" for those of one module
	$(build_with_tests)
	$(call run_tests,$(TESTED)) -L campaign -L '^($(subst $(space),|,$(CAMPAIGNS)))'

define build_with_tests
	cmake --preset test --log-level=WARNING
	cmake --build $(TESTED) -j $(JOBS)
endef
# Tests of a build folder: $(call run_tests,FOLDER) and which of them.
define run_tests
	@echo '{"version": {"major": 1, "minor": 0}, "local": [{"cores": [{"id": "all", "slots": $(JOBS)}], "waiting": [{"id": "all", "slots": $(WAITING)}]}]}' >$(1)/test_resources.json
	ctest --test-dir $(1) --output-on-failure -j $$(($(JOBS) + $(WAITING))) --resource-spec-file test_resources.json
endef

docs: setup ## API reference from the headers: build/docs/html/index.html
	@node tools/docs.mjs build/docs

pictures: setup ## run the numbered examples and draw what they computed: docs/images/examples
	cmake --preset test --log-level=WARNING
	cmake --build $(TESTED) -j $(JOBS) --target numbered_examples
	ctest --test-dir $(TESTED) --output-on-failure -j $(JOBS) -R '^example_[0-9]'
	node tools/example_pictures.mjs $(TESTED)/examples docs/images/examples

format: ## reformat sources and documents
	git ls-files -co --exclude-standard '*.cpp' '*.hpp' | xargs clang-format -i
	node tools/wrap_markdown.mjs --write

format-check: setup
	@git ls-files -co --exclude-standard '*.cpp' '*.hpp' | xargs clang-format --dry-run -Werror
	@node tools/wrap_markdown.mjs --check

TIDY ?= veridyn bench/reproduction apps/veridyn

tidy: setup ## clang-tidy on every module; TIDY="veridyn/io" for one, TIDY="$(tools/changed_folders.sh)" for what changed
	@node tools/unnamed_names.mjs
	cmake --preset test --log-level=WARNING
	tools/tidy.sh $(TESTED) $(JOBS) $(TIDY)

ASAN_MODULES ?= core numerics estimation io camera recording aircraft vehicle tyre road muscle osim cueing live report reproduction apps
# One full run of each domain.
ASAN_RUNS := example_several_flights|example_vehicle_identify_sweep|example_muscle_emg|example_cueing_knobs

asan: setup ## tests of every module under the address and undefined-behaviour sanitizers; ASAN_MODULES="io" for one
	cmake --preset asan --log-level=WARNING
	cmake --build build/asan -j $(JOBS) --target $(ASAN_MODULES:%=veridyn_%_tests)
	$(call run_tests,build/asan) -LE '$(LATER)' -L '^($(subst $(space),|,$(ASAN_MODULES)))$$'

asan-readers: setup ## tests of what reads files and packets of others, these readers compiled with the sanitizers
	cmake --preset test --log-level=WARNING
	cmake --build $(TESTED) -j $(JOBS) --target sanitized_tests
	$(call run_tests,$(TESTED)) -L '^sanitized$$'

asan-runs: setup ## a full run of each domain under these sanitizers
	cmake --preset asan --log-level=WARNING
	cmake --build build/asan -j $(JOBS) --target veridyn
	$(call run_tests,build/asan) -R '^($(ASAN_RUNS))$$'

# What runs in threads beside each other, by module. The sanitizer's shadow memory wants addresses that are not shuffled.
TSAN_MODULES ?= live numerics estimation io recording aircraft reproduction apps
TSAN_live := TripleBuffer.*:LiveLoop*:RunningLoop*:LivePage*:LiveRecorder*:*Teleoperation*:*PseudoTerminal*
TSAN_numerics := ParallelFor*:BlockStore*:Ranks*:SharedWork*:ValueLog*
TSAN_estimation := Smoother*:OpenLoop*:BatchEvaluator*:SharedModel*:*NumberOfThreads*:*UsesTheThreads*
TSAN_io := PlainRows*
TSAN_recording := SampleEvidence*:StudyData*
TSAN_aircraft := OpenLoop.IsTheSame*:FlightSensitivity.IsTheSame*:Reconstruct.GivesTheSame*:ModelFreeEngine*:RecordingEvidence.OfAClean*:AircraftStudy.IdentifiesWhat*
TSAN_reproduction := BatchExperiment.IsTheSame*
TSAN_apps := Program.GivesTheSameBytes*:Program.IdentifiesARecordingWrittenByItself:VehicleProgram.SameSeed*

tsan: setup ## tests of what runs in threads under the thread sanitizer; TSAN_MODULES="live" for one module
	cmake --preset tsan --log-level=WARNING
	cmake --build build/tsan -j $(JOBS) --target $(TSAN_MODULES:%=veridyn_%_tests)
	@set -e; $(foreach module,$(TSAN_MODULES),echo "tsan: $(module)"; TSAN_OPTIONS=halt_on_error=1 setarch $$(uname -m) -R \
	  build/tsan/bin/veridyn_$(module)_tests --gtest_brief=1 --gtest_filter='$(TSAN_$(module)):-*Soak*:*AllocatesNothing*';)

bench: setup ## benchmarks; results in build/bench/*.json
	cmake --preset bench --log-level=WARNING
	cmake --build build/bench -j $(JOBS)
	tools/bench.sh build/bench

# One comparison: make peers PEERS="-k ulog".
peers: setup ## comparisons with OpenSim, JSBSim, pymavlink and others (bench/peers); skipped without a package index
	cmake --preset test --log-level=WARNING
	cmake --build $(TESTED) -j $(JOBS) --target veridyn
	VERIDYN_PROGRAM=$(CURDIR)/$(TESTED)/bin/veridyn tools/peers.sh pytest -p no:cacheprovider -q bench/peers $(PEERS)

bench-peers: build ## times of these programs and ours, in one run; build/peers/bench.json
	tools/peers.sh python bench/peers/bench_peers.py build/peers/bench.json

fuzz: setup ## each reader under libFuzzer for SECONDS_EACH (60)
	cmake --preset test --log-level=WARNING
	cmake --build $(TESTED) -j $(JOBS) --target fuzz
	JOBS=$(JOBS) fuzz/run.sh $(or $(SECONDS_EACH),60) $(TESTED)

soak: setup ## long-running campaigns (label soak), coverage of intervals
	cmake --preset release -DVERIDYN_TESTS=ON --log-level=WARNING
	cmake --build $(BUILD) -j $(JOBS)
	ctest --test-dir $(BUILD) --output-on-failure -j $(JOBS) -L soak
	examples/coverage/run.sh $(BUILD)/bin/veridyn out/coverage 10

nightly: setup ## all that is too long for .ci/run: every test, module and check, an hour and more
	$(MAKE) test
	$(MAKE) peers
	$(MAKE) long
	$(MAKE) campaigns
	$(MAKE) tidy
	$(MAKE) asan-readers
	$(MAKE) asan
	$(MAKE) asan-runs
	$(MAKE) tsan
	$(MAKE) fuzz SECONDS_EACH=60
	$(MAKE) gcc
	$(MAKE) soak

gcc: setup ## everything compiled by g++ with its warnings
	cmake --preset gcc --log-level=WARNING
	cmake --build build/gcc -j $(JOBS)

install: build ## into PREFIX (default /usr/local)
	cmake --install $(BUILD) $(if $(PREFIX),--prefix $(PREFIX))

clean: ## remove all that was built
	rm -rf build out web/dist web/node_modules
