# SPDX-License-Identifier: BSD-3-Clause
# The tests: a program a noun, tests/FOLDER/test_NAME.c, which ends in "N passed, M failed, K skipped". All programs lie
# in $(B)/tests. A program is linked with every other source of its folder, and with what it uses of tests/lib.

# Those of other folders are linked in a way of their own, below.
TOPICS := base mesh compile kernel nearest sweep hull contact strip query force deform exchange track insertion proxy world arm drivers host tools view $(if $(VIEW_SERVER),view/server) fuzz
EXACT_TESTS := test_sweep_exact test_sweep_moving
TEST_SOURCES := $(filter-out $(EXACT_TESTS:%=tests/sweep/%.c),$(wildcard $(TOPICS:%=tests/%/test_*.c)))
TESTS := $(addprefix $(B)/tests/,$(basename $(notdir $(TEST_SOURCES))))
TEST_PARTS := $(call objects,tests/oracle/*.c tests/data/*.c) \
              $(B)/src/scene/shape.o $(B)/src/scene/shape_organs.o $(CORE) $(TEXT) $(COMPILE) $(DRIVER_PARTS) $(SIMULATE)
TEST_LIB := $(B)/tests/lib.a
PARTS_LIB := $(B)/tests/parts.a
LINKED = $(filter-out %.a,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group
LINK_TEST = $(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $(LINKED) -lm $(THREADS) $(DL) $(LDLIBS) -o $@

$(B)/tests/%.o: INCLUDES += -Itests -Itools -Idrivers
# A sample as it stands.
$(B)/tests/world/test_own_physics.o: INCLUDES += -Idocs
# What a test program does itself takes longer to optimize than to run; under sanitizers so do the program and what reads
# URDF.
QUICKLY := $(filter-out tests/kernel/%,$(TEST_SOURCES) $(EXACT_TESTS:%=tests/sweep/%.c) \
  $(wildcard tests/fuzz/*.c tests/fuzz/calls/*.c tests/vm/*.c tests/urdf/*.c tests/convex/*.c))
ifneq ($(filter release scalar sanitize,$(CONFIG)),)
$(QUICKLY:%.c=$(B)/%.o): CONFIG_CFLAGS += -Og
endif
ifeq ($(CONFIG),sanitize)
$(B)/tests/%.o: CONFIG_CFLAGS += -O1
$(B)/tools/%.o: CONFIG_CFLAGS += -O1
$(B)/src/urdf/%.o: CONFIG_CFLAGS += -Og
endif
# Objects that are the same in another configuration are release's, where they are. Scalar: for its programs of `make
# check` all that does not see the kernels; that other flags give the same bits is for tests/amalgamation.sh to show.
# Sanitize: the oracles, for it is the library that is looked at.
LIKE_RELEASE.scalar := $(if $(filter check-programs,$(MAKECMDGOALS)),src tools,src/text src/convex) tests drivers
LIKE_RELEASE.sanitize := tests/oracle tests/data
LIKE_RELEASE := $(LIKE_RELEASE.$(CONFIG))
ifneq ($(LIKE_RELEASE),)
define MADE_BY_RELEASE
build/$1/%.o:
	$$(MAKE) CONFIG=release $$@
endef
$(foreach folder,$(LIKE_RELEASE),$(eval $(call MADE_BY_RELEASE,$(folder))))
KNOWN := $(shell find $(LIKE_RELEASE:%=build/%) -name '*.d' 2>/dev/null)
OF_RELEASE := $(filter-out %_sites.d %/stand_in_3_0.d,$(if $(KNOWN),$(shell grep -L -e src/kernel/kernel_ops.h -e /built_with.h $(KNOWN))))
COPIED := $(patsubst build/%.d,$(B)/%.o,$(OF_RELEASE))
$(COPIED): $(B)/%.o: build/%.o
	@mkdir -p $(@D)
	cp $< $@
-include $(OF_RELEASE)
endif
shared_of = $(filter-out $(B)/tests/fuzz/% $(B)/$1test_%,$(call objects,$1*.c))
define TEST_PROGRAM
$(B)/tests/$(basename $(notdir $1)): $(B)/$(1:.c=.o) $(call shared_of,$(dir $1))
endef
$(foreach source,$(TEST_SOURCES),$(eval $(call TEST_PROGRAM,$(source))))
SITED := $(B)/tests/test_damaged_files $(B)/tests/test_arm
COUNTED_TESTS := $(B)/tests/test_linear_cost $(B)/tests/test_compile_cost $(B)/tests/test_springs_cost $(B)/tests/test_proxy_work \
  $(B)/tests/test_needle_soft_cost
ifneq ($(CONFIG),release)
TESTS := $(filter-out $(COUNTED_TESTS),$(TESTS))
endif
$(filter-out $(SITED) $(COUNTED_TESTS),$(TESTS)): $(PARTS_LIB) $(TEST_LIB)
	$(LINK_TEST)
$(TEST_LIB): $(call objects,tests/lib/*.c)
$(PARTS_LIB): $(TEST_PARTS)
# q, for src and tests/oracle have files of the same name.
$(TEST_LIB) $(PARTS_LIB) $(B)/tests/tools.a:
	rm -f $@
	$(AR) qcs $@ $^
$(B)/tests/test_parallel: private LDLIBS = -Wl,--wrap=pthread_create,--wrap=pthread_join,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free


# The readers, with the line of each check that refuses (tests/lib/sites.h).
$(B)/tests/%_sites.c: src/%.c
	@mkdir -p $(@D)
	@grep -q 'return fail' $< || { echo "$<: no line to mark: 'return fail' matches nothing"; exit 1; }
	{ echo 'extern int site;'; echo '#line 1 "$<"'; \
	  sed 's/return fail/return site = site ? site : __LINE__, fail/' $<; } >$@
$(B)/tests/%_sites.o: $(B)/tests/%_sites.c
	$(CC) $(ALL_CFLAGS) -c $< -o $@
$(B)/tests/test_damaged_files: $(B)/tests/mesh/mesh_open_sites.o $(filter-out $(B)/src/mesh/mesh_open.o,$(TEST_PARTS)) $(TEST_LIB)
$(B)/tests/test_arm: $(B)/tests/arm/arm_open_sites.o $(filter-out $(B)/src/arm/arm_open.o,$(TEST_PARTS)) $(TEST_LIB)
$(SITED):
	$(LINK_TEST)
$(B)/tests/test_arm_compile: private LDLIBS = -Wl,--wrap=calloc

# Programs that count basic blocks (tests/lib/block_count.h): the library once more, with a call in each block.
UNCOUNTED := $(filter-out $(B)/src/kernel/%,$(CORE) $(TEXT) $(COMPILE))
COUNTED := $(UNCOUNTED:$(B)/%=$(B)/counted/%)
$(B)/counted/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -O2 -fsanitize-coverage=trace-pc -c $< -o $@
$(COUNTED_TESTS): $(COUNTED) $(filter-out $(UNCOUNTED),$(TEST_PARTS)) $(TEST_LIB)
	$(LINK_TEST)
$(COUNTED_TESTS): private LDLIBS = $(patsubst %,-Wl$(comma)--wrap=%,memset memcpy memmove memcmp memchr calloc realloc)

$(B)/tests/test_exactness: | $(B)/dynpoint

# Tests of the program's parts: linked with what they use of it, all but its main.
tests_of = $(patsubst $1/%.c,$(B)/tests/%,$(wildcard $1/test_*.c))
TOOLS_LIB := $(B)/tests/tools.a
$(TOOLS_LIB): $(filter-out $(B)/tools/cli/dynpoint.o,$(TOOLS)) $(PLATFORM_PROGRAM) $(filter-out $(B)/src/scene/shape%,$(HOST)) $(URDF_PARTS) $(CONVEX_PARTS)
TOOLS_TESTS := $(call tests_of,tests/host) $(call tests_of,tests/tools) $(call tests_of,tests/view) $(call tests_of,tests/view/server) $(B)/tests/test_springs_passes $(B)/tests/test_fuzz
$(TOOLS_TESTS): $(TOOLS_LIB)
TOOLS_TEST_LIBS := -Wl,--as-needed $(LWS_LIBS) $(JANSSON_LIBS) $(URDF_LIBS) $(CONVEX_LIBS)
$(TOOLS_TESTS): private LDLIBS = $(TOOLS_TEST_LIBS)
$(B)/tests/test_run_motors: private LDLIBS = $(TOOLS_TEST_LIBS) $(CAN_WRAPPED:%=-Wl,--wrap=%) -Wl,--wrap=clock_nanosleep,--wrap=nanosleep
$(B)/tests/test_view_loop: private LDLIBS = $(TOOLS_TEST_LIBS) -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free

# Scene files: where the program reads them.
FUZZ_PARTS := $(filter-out $(B)/tests/fuzz/test_fuzz.o $(if $(SCENE_FILE),,$(B)/tests/fuzz/scene.o $(B)/tests/fuzz/plan.o),$(call objects,tests/fuzz/*.c))
$(B)/tests/test_fuzz: $(FUZZ_PARTS)
$(B)/tests/fuzz/test_fuzz.o: INCLUDES += -I$(B)
$(B)/tests/fuzz/test_fuzz.o: $(B)/built_with.h

# Random calls of everything public; what its own code takes from the heap is counted.
CALLS_PARTS := $(call objects,tests/fuzz/calls/*.c)
$(B)/tests/test_calls: $(CALLS_PARTS) $(PARTS_LIB) $(TEST_LIB)
	$(LINK_TEST)
$(B)/tests/test_calls: private LDLIBS = -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free
TESTS += $(B)/tests/test_calls

# With CONFIG=fuzz or fuzz-fast alone: each target as a program of libFuzzer's.
FUZZ_TARGETS := obj stl ply off tetgen regions trace $(if $(SCENE_FILE),scene plan) mesh forged arm wire motor record snapshot request
FUZZ_SHARED := $(filter-out $(FUZZ_TARGETS:%=$(B)/tests/fuzz/%.o) $(B)/tests/fuzz/mutate.o,$(FUZZ_PARTS))
$(B)/tests/fuzz/fuzz_%: $(B)/tests/fuzz/%.o $(FUZZ_SHARED) $(TOOLS_LIB) $(PARTS_LIB) $(TEST_LIB)
	$(CC) $(subst fuzzer-no-link,fuzzer,$(CONFIG_CFLAGS)) $(LDFLAGS) $(LINKED) -lm $(THREADS) $(DL) $(TOOLS_TEST_LIBS) -o $@
fuzz-programs: $(FUZZ_TARGETS:%=$(B)/tests/fuzz/fuzz_%)
.PHONY: fuzz-programs

# Calls of the system that the test lets fail.
WRAPPED := malloc calloc realloc free open read close clock_gettime clock_nanosleep nanosleep getrlimit \
           mlockall munlockall pthread_getschedparam pthread_setschedparam
$(B)/tests/test_syscalls: private LDLIBS = $(WRAPPED:%=-Wl,--wrap=%)
$(B)/tests/test_loop_phase: private LDLIBS = -Wl,--wrap=clock_gettime,--wrap=clock_nanosleep
SERIAL_WRAPPED := open close read write poll ioctl flock tcgetattr tcsetattr tcflush calloc clock_gettime
$(B)/tests/test_serial $(B)/tests/test_serial_faults: private LDLIBS = $(SERIAL_WRAPPED:%=-Wl,--wrap=%)
CAN_WRAPPED := socket bind setsockopt ioctl recvmmsg sendmmsg poll close clock_gettime malloc calloc fopen fread
$(B)/tests/test_can $(B)/tests/test_can_arm $(B)/tests/test_can_faults $(B)/tests/test_can_open $(B)/tests/test_can_motors: private LDLIBS = $(CAN_WRAPPED:%=-Wl,--wrap=%)

# Stand-ins for libHD, loaded as the vendor's would be: a whole one, one as of version 3.0, and three that do not load or
# are not what they are called. libPHANToMIO.so.4 is not where the loader looks.
HD_STAND_INS := $(addprefix $(B)/tests/libHD-,stand-in.so 3.0.so empty.so lonely.so mismatched.so)
HD_SHARED = $(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(@F)
$(B)/tests/libHD-stand-in.so: $(B)/tests/drivers/hd/stand_in.o $(B)/tests/drivers/hd/stand_in_scheduler.o
	$(HD_SHARED) $^ -lm $(THREADS) -o $@
$(B)/tests/drivers/hd/stand_in_3_0.o: tests/drivers/hd/stand_in.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -DSTAND_IN_3_0 -c $< -o $@
$(B)/tests/libHD-3.0.so: $(B)/tests/drivers/hd/stand_in_3_0.o $(B)/tests/drivers/hd/stand_in_scheduler.o
	$(HD_SHARED) $^ -lm $(THREADS) -o $@
$(B)/tests/drivers/hd/libPHANToMIO.so.4 $(B)/tests/libHD-empty.so: $(B)/tests/drivers/hd/empty.o
	$(HD_SHARED) $^ -o $@
$(B)/tests/libHD-lonely.so: $(B)/tests/drivers/hd/empty.o $(B)/tests/drivers/hd/libPHANToMIO.so.4
	$(HD_SHARED) -Wl,--no-as-needed $^ -o $@
$(B)/tests/libHD-mismatched.so: $(B)/tests/drivers/hd/mismatched.o
	$(HD_SHARED) $^ -o $@
HD_TESTS := $(patsubst %,$(B)/tests/test_%,openhaptics openhaptics_calibration openhaptics_faults openhaptics_open hd_stand_in)
$(HD_TESTS): | $(HD_STAND_INS)
HD_WRAPPED := dlopen dlsym dlerror calloc clock_gettime getenv fopen access
$(HD_TESTS): private LDLIBS = $(HD_WRAPPED:%=-Wl,--wrap=%)
test-programs check-programs: $(HD_STAND_INS)
-include $(patsubst %,$(B)/tests/drivers/hd/%.d,stand_in stand_in_3_0 stand_in_scheduler)

# Exact arithmetic: where there are g++ and gmpxx.
EXACT_LIBS := $(if $(shell echo '$(HASH)include <gmpxx.h>' | $(CXX) -E -x c++ - >/dev/null 2>&1 && echo yes),-lgmpxx -lgmp -lstdc++)
ifneq ($(EXACT_LIBS),)
TESTS += $(EXACT_TESTS:%=$(B)/tests/%)
endif
EXACT_PARTS := $(patsubst %.cc,$(B)/%.o,$(wildcard tests/oracle/*.cc))
$(filter-out $(COPIED),$(EXACT_PARTS)): $(B)/%.o: %.cc
	@mkdir -p $(@D)
	$(CXX) -std=c++11 -O2 -g -Wall -Wextra -MMD -MP -Itests $(CONFIG_CFLAGS) $(CFLAGS_EXTRA) -c $< -o $@
$(EXACT_TESTS:%=$(B)/tests/%): $(B)/tests/%: $(B)/tests/sweep/%.o $(call shared_of,tests/sweep/) $(EXACT_PARTS) \
                              $(PARTS_LIB) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $(LINKED) -lm $(THREADS) $(DL) $(EXACT_LIBS) -o $@

# Robots' descriptions: where the library reads them.
ifneq ($(URDF_PARTS),)
TESTS += $(B)/tests/test_urdf_golden $(B)/tests/test_urdf_sizes $(B)/tests/test_urdf_arm $(B)/tests/test_urdf_tips
test-programs check-programs: $(B)/tests/urdf/answers
endif
$(B)/tests/urdf/answers: $(B)/tests/urdf/answers.o $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm -o $@
$(B)/tests/test_urdf_%: private LDLIBS = -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free
$(B)/tests/test_urdf_%: $(B)/tests/urdf/test_urdf_%.o $(B)/tests/urdf/surroundings.o $(URDF_PARTS) $(PARTS_LIB) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $(LINKED) -lm $(THREADS) $(LDLIBS) $(URDF_LIBS) -o $@

# Curved tips: where the library is built.
CONVEX_TESTS := $(patsubst tests/convex/%.c,$(B)/tests/%,$(wildcard tests/convex/test_*.c))
ifneq ($(CONVEX_PARTS),)
TESTS += $(CONVEX_TESTS)
endif
$(CONVEX_TESTS): $(B)/tests/%: $(B)/tests/convex/%.o $(call shared_of,tests/convex/) $(CONVEX_PARTS) $(PARTS_LIB) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $(LINKED) -lm $(THREADS) $(LDLIBS) $(CONVEX_LIBS) -o $@
$(B)/tests/test_convex_faults: private LDLIBS = $(patsubst %,-Wl$(comma)--wrap=%,ccdGJKPenetration ccdMPRPenetration ccdGJKIntersect ccdMPRIntersect)

$(B)/tests/firmware/link $(B)/tests/firmware/pull: %: %.o $(B)/tests/firmware/emulator.o $(DRIVER_PARTS) $(TEXT) $(CORE) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm -lpthread $(DL) -o $@

# A sample as it stands, on devices whose plug is pulled: the firmware and tests/vm.
SAFE_DEVICE := $(B)/tests/safe_device
$(SAFE_DEVICE): docs/samples/safe_device.c $(foreach lib,host drivers $(if $(CONVEX_PARTS),convex) compile,$(B)/libdynpoint_$(lib).a) $(B)/libdynpoint.a
	@mkdir -p $(@D)
	$(CC) -std=c99 -Iinclude $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm $(THREADS) $(DL) $(CONVEX_LIBS) $(JANSSON_LIBS) -o $@

# On a real kernel with SocketCAN (tests/vm/check.sh runs every test_* there).
VM_TESTS := $(patsubst tests/%.c,$(B)/tests/%,$(wildcard tests/vm/test_*.c))
VM_PARTS := $(filter-out $(B)/tests/vm/test_%,$(call objects,tests/vm/*.c))
$(B)/tests/vm/test_%: $(B)/tests/vm/test_%.o $(VM_PARTS) $(DRIVER_PARTS) $(SIMULATE) $(TEXT) $(COMPILE) $(CORE) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm $(THREADS) $(DL) -o $@

vm: all $(SAFE_DEVICE) $(VM_TESTS) $(B)/tests/test_can $(B)/tests/test_can_arm $(B)/tests/test_can_faults ## the tests on a real kernel, in an emulated machine
	@sh tests/vm/check.sh $(B)

firmware: all $(SAFE_DEVICE) $(B)/tests/firmware/link $(B)/tests/firmware/pull ## the driver against a Cortex-M7 in QEMU, and what a tick takes there
	@sh tests/firmware/run.sh $(B)

test: ## a part of every kind of test in about a minute, after some minutes of building: no network, nothing installed
	@sh tests/run.sh test

check: ## all tests; as root on Debian installs 21 MB of packages (DEPS=no: nothing, DEPS=all: all); STRICT=1 lets skips fail
	@sh tests/run.sh check

check-release: ## that, and what takes long for what it can find: before a release
	@sh tests/run.sh release

check-planted: all test-programs ## faults are planted, one after the other, and a test must find each; check-release does it too
	@sh tests/planted.sh $(B)
	@sh tests/planted.sh $(B) tests/view/planted.txt

SOAKED := exactness deform deform_push surface_motion bed_organs proxy_soak needle_soak needle_soft needle_soft_life needle_soft_soak proxy_side certificate budget budget_worlds broad_phase sheets sheet_touches gap_continuity depth depth_forms contact_life contact_forms contact_integrals route route_strip strip strip_memory overlap pair hull_pair hull_search hull_sweep parallel no_system_calls loop $(if $(CONVEX_PARTS),convex)
soak: all $(SOAKED:%=$(B)/tests/test_%) $(SAFE_DEVICE) $(B)/tests/firmware/link $(B)/tests/firmware/pull $(B)/tests/vm/test_can_pull ## 10^8 ticks against the tree, 10^7 of the proxy; all of DPT_DATA against brute force
	@$(B)/tests/test_certificate 672000
	@$(B)/tests/test_budget 8000
	@$(B)/tests/test_budget_worlds 8000
	@$(B)/tests/test_broad_phase 8000
	@$(B)/tests/test_sheets 10000000
	@$(B)/tests/test_sheet_touches 10000000
	@$(B)/tests/test_gap_continuity 10000000
	@sh tests/oracle/inside.sh $(B)
	@sh tests/tools/plan_soak.sh $(B)
	@$(B)/tests/test_depth 1000
	@$(B)/tests/test_depth_forms 1000
	@$(B)/tests/test_contact_life
	@$(B)/tests/test_contact_forms
	@$(B)/tests/test_contact_integrals 2000
	@$(B)/tests/test_route 2000
	@$(B)/tests/test_route_strip
	@$(B)/tests/test_strip 4000
	@$(B)/tests/test_strip_memory 40
	@$(B)/tests/test_overlap 1000
	@$(B)/tests/test_pair 10000000
	@$(B)/tests/test_hull_pair 2000000
	@$(B)/tests/test_hull_search
	@$(B)/tests/test_hull_sweep 100000
	@$(B)/tests/test_bed_organs
	@$(B)/tests/test_parallel
	@$(B)/tests/test_no_system_calls
	@$(B)/tests/test_loop 60000
	@$(B)/tests/test_proxy_soak 10000000
	@$(B)/tests/test_needle_soak 10000000
	@$(B)/tests/test_needle_soft_soak 1000000
	@$(B)/tests/test_needle_soft
	@$(B)/tests/test_needle_soft_life
	@$(B)/tests/test_proxy_side 10000000
	@$(B)/tests/test_surface_motion 5000
	@$(B)/tests/test_deform 8400
	@$(B)/tests/test_deform_push 8400
	@$(if $(CONVEX_PARTS),$(B)/tests/test_convex,:)
	@$(B)/tests/test_exactness soak
	@PULLS=400 sh tests/firmware/run.sh $(B)
	@sh tests/vm/run.sh -t 3600 '$(B)/tests/vm/test_can_pull 350' || [ $$? -eq 77 ]

fuzz: ## 10^8 random calls (CALLS_RUNS), then 10^8 executions (FUZZ_RUNS) of the fuzz targets by libFuzzer
	@sh tests/fuzz/calls.sh
	@sh tests/fuzz/fuzz.sh

check-view: all ## the viewer's page in a headless Chromium; make check does it too
	@sh tests/view/check.sh $(B)

check-wasm: all $(B)/tests/wasm/native_answers ## WebAssembly against the native library; make check does it too
	@sh tests/wasm/check.sh $(B)

.PHONY: check-npm
check-npm: ## the package of npm, as it is installed; make check does it too
	@sh tests/js/check.sh $(B)

check-platforms: all ## musl, Windows by mingw-w64, zig and wine, macOS by zig; make check does musl, make check-release all
	@sh tests/platforms/musl.sh $(B)
	@sh tests/platforms/windows.sh $(B)
	@sh tests/platforms/macos.sh $(B)

check-page: all $(B)/tests/page/feel_again ## the page with the core in it, against the native library; make check does it too
	@sh tests/page/check.sh $(B)

pictures: all ## the pictures of README and docs: drawings by the core itself, stills and a moving one by a headless Chromium
	@sh tests/pictures/make.sh $(B)

BENCH_PROGRAMS := $(patsubst %,$(B)/tests/bench/%,dump_mesh deform strips budgets strip_coverage springs spring_methods soft_liver scenes tori snapshots sweeps rests jumps pauses tips joined proxy_ticks proxy_jumps proxy_hangs host_ticks python_ticks needle_peers)
measured: all $(B)/tests/wasm/native_answers $(BENCH_PROGRAMS)
	@sh tests/bench/run.sh $(B)
	@sh tests/bench/deform.sh $(B)
	@sh tests/bench/budgets.sh $(B)
	@sh tests/bench/strips.sh $(B)
	@$(B)/tests/bench/strip_coverage >$(B)/bench/strip_coverage.csv
	@sh tests/bench/needle.sh $(B)
	@$(B)/tests/bench/needle_peers >$(B)/bench/needle_peers.csv
	@sh tests/bench/soft.sh $(B)
	@sh tests/bench/soft.sh $(B) feel
	@sh tests/bench/repeats.sh $(B)/bench/springs.csv $(B)/tests/bench/springs cost
	@$(B)/tests/bench/springs map >$(B)/bench/springs_map.csv
	@sh tests/bench/repeats.sh $(B)/bench/soft_liver.csv $(B)/tests/bench/soft_liver
	@sh tests/bench/table1.sh $(B)
	@for program in sweeps rests tips joined jumps pauses snapshots; do \
	  sh tests/bench/repeats.sh $(B)/bench/$$program.csv $(B)/tests/bench/$$program || exit; done
	@$(PYTHON) -B tests/bench/viewer.py $(B) | tee $(B)/bench/viewer.csv
	@sh tests/bench/wasm.sh $(B)

.PHONY: bench-batch
bench-batch: ## 1,000 environments beside single worlds and MuJoCo (make deps python soft): the table of docs/batch.md, some 6 minutes
	@sh tests/bench/python_batch.sh $(B)

bench: measured ## time against peers, those whose packages are here, and whether plans hold
	@sh tests/bench/plans.sh $(B)
.PHONY: measured

not_run = $(patsubst %,$(B)/tests/test_%,$(shell awk '/^[a-z]/ && $$$1 == "-" { print $$1 }' tests/programs.txt))
test-programs: all $(filter-out $(call not_run,2),$(TESTS))
# What programs.txt, and the scripts, run of this configuration.
COLUMN := $(subst release,3,$(subst scalar,4,$(subst sanitize,5,$(CONFIG))))
check-programs: $(if $(filter scalar,$(CONFIG)),$(LIBS:%=%.a),all) $(filter-out $(call not_run,$(COLUMN)),$(TESTS)) $(if $(filter release,$(CONFIG)),$(VM_TESTS) $(SAFE_DEVICE))
ifeq ($(CONFIG),release)
check-programs: $(if $(shell command -v $(PYTHON)),$(B)/amalgamation/LICENSE) $(B)/tests/firmware/link $(B)/tests/firmware/pull $(B)/tests/wasm/native_answers $(B)/tests/page/feel_again $(BENCH_PROGRAMS)
endif
.PHONY: test-programs check-programs
-include $(TEST_SOURCES:%.c=$(B)/%.d) $(VM_TESTS:=.d) $(wildcard $(TOPICS:%=$(B)/tests/%/*.d) $(B)/tests/lib/*.d) \
          $(patsubst %.o,%.d,$(VM_PARTS) $(TEST_PARTS) $(FUZZ_PARTS) $(CALLS_PARTS) $(COUNTED))
-include $(wildcard $(EXACT_TESTS:%=$(B)/tests/sweep/%.d) $(B)/tests/urdf/*.d $(B)/tests/*/*_sites.d $(B)/tests/bench/*.d \
           $(B)/tests/firmware/*.d $(B)/tests/oracle/*.d $(B)/tests/drivers/hd/*.d)

$(B)/tests/bench/dump_mesh: $(B)/tests/bench/dump_mesh.o $(B)/tools/cli/command_options.o $(B)/tools/cli/complete.o \
  $(patsubst %,$(B)/src/scene/%.o,host_file host_error scene_list) $(DRIVER_PARTS) $(PLATFORM_PROGRAM) $(TEXT) $(COMPILE) $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm $(THREADS) $(DL) -o $@

$(B)/tests/bench/strips $(B)/tests/bench/budgets $(B)/tests/bench/python_ticks $(B)/tests/wasm/native_answers $(B)/tests/page/feel_again: %: %.o $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm -o $@

$(B)/tests/bench/deform: %: %.o $(B)/tests/oracle/brute.o $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm -o $@

$(B)/tests/bench/springs $(B)/tests/bench/spring_methods: %: %.o $(B)/tests/deform/made_net.o \
                              $(B)/tests/oracle/spring_balance.o $(CORE) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm -o $@
$(B)/tests/bench/scenes $(B)/tests/bench/tori: $(B)/tests/bench/play.o
$(B)/tests/bench/soft_liver $(B)/tests/bench/scenes $(B)/tests/bench/tori $(B)/tests/bench/snapshots: %: %.o $(B)/src/scene/scene_list.o $(B)/src/scene/shape.o $(B)/src/scene/shape_organs.o \
                             $(TEXT) $(COMPILE) $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm $(THREADS) -o $@
$(B)/tests/bench/sweeps $(B)/tests/bench/rests $(B)/tests/bench/jumps $(B)/tests/bench/pauses $(B)/tests/bench/tips $(B)/tests/bench/joined $(B)/tests/bench/proxy_ticks $(B)/tests/bench/proxy_jumps $(B)/tests/bench/proxy_hangs $(B)/tests/bench/needle_peers: %: %.o $(PARTS_LIB) $(TEST_LIB)
	$(LINK_TEST)
$(B)/tests/bench/proxy_jumps: $(B)/tests/proxy/jump_run.o $(B)/tests/proxy/soak_oracle.o
$(B)/tests/bench/proxy_hangs: $(B)/tests/proxy/hang_run.o
$(B)/tests/bench/host_ticks: %: %.o $(HOST_PARTS) $(COMPILE) $(DRIVER_PARTS) $(CONVEX_PARTS) $(TEXT) $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $(sort $^) -lm $(THREADS) $(DL) $(CONVEX_LIBS) $(JANSSON_LIBS) -o $@
$(B)/tests/bench/strip_coverage: $(B)/tests/bench/strip_coverage.o $(call shared_of,tests/strip/) $(TEST_PARTS) $(TEST_LIB)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm $(THREADS) $(DL) -o $@

stability: all ## run the laboratory of force, and make docs/stability.md and its charts of it
	@mkdir -p $(B)/bench
	$(B)/dynpoint stability --effort 1 --json >$(B)/bench/stability.json
	$(B)/dynpoint stability hum --effort 1 --json >>$(B)/bench/stability.json || [ $$? -eq 1 ]
	$(PYTHON) -B tests/bench/stability.py $(B)/bench/stability.json docs

SOFT_TABLES := $(addprefix $(B)/tests/,$(addprefix test_,springs_indent springs_poisson own_compliance))
soft-tables: all $(SOFT_TABLES) ## the tables of docs/algorithms/springs.md and deform.md: docs/charts/soft-*.csv; TABLES="soft-told" those alone
	$(PYTHON) -B tests/bench/soft_tables.py $(B) docs/charts $(TABLES)

figures: all $(B)/tests/bench/proxy_ticks ## measure what the README says of the default tick: docs/charts/default-tick.csv; beside nothing else
	@sh tests/bench/figures.sh $(B) docs/charts/default-tick.csv

charts: measured ## measure as bench does, draw docs/charts and keep their data
	$(PYTHON) -B tests/bench/chart.py $(B)/bench docs/charts
	$(PYTHON) -B tests/bench/chart_paper.py $(B)/bench docs/charts
	$(B)/dynpoint chart liver --ticks 20000 --repeats 3 -o $(B)/bench/chart-liver \
	  $$(ls $(B)/bench/peers | grep -q . && echo --peers $(B)/bench/peers)
	$(B)/dynpoint chart laparoscopy --repeats 3 -o $(B)/bench/chart-laparoscopy
	cp $(foreach scene,liver laparoscopy,$(B)/bench/chart-$(scene).csv $(B)/bench/chart-$(scene).svg) docs/charts
