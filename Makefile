# SPDX-License-Identifier: BSD-3-Clause
# `make help` lists the targets. Everything is built below build/; nothing is written elsewhere.

# The words behind deps are groups of packages, not targets.
ifeq ($(firstword $(MAKECMDGOALS)),deps)
GROUPS := $(filter-out deps,$(MAKECMDGOALS))
.PHONY: $(MAKECMDGOALS)
deps: ## what the tests can use beside a compiler: the groups of packages; deps GROUP... or deps all installs them
	@sh tests/deps.sh $(GROUPS)
$(GROUPS): deps ; @:
else

CONFIG ?= release
VERSION := $(shell sed -n 's/^\#define DPT_VERSION_STRING "\(.*\)"/\1/p' include/dynpoint/base.h)
SOVERSION := 1
B := $(if $(filter release,$(CONFIG)),build,build/$(CONFIG))

CC ?= cc
AR ?= ar
LD ?= ld
NM ?= nm
OBJCOPY ?= objcopy
PYTHON ?= python3
CFLAGS ?= -O3
CXXFLAGS ?= $(CFLAGS)
PREFIX ?= /usr/local
BINDIR ?= $(PREFIX)/bin
LIBDIR ?= $(PREFIX)/lib
INCLUDEDIR ?= $(PREFIX)/include
PKGCONFIGDIR ?= $(LIBDIR)/pkgconfig
DATADIR ?= $(PREFIX)/share
MANDIR ?= $(DATADIR)/man

# The same bits everywhere. gcc 12's straight-line vectoriser fuses multiply and add in spite of
# -ffp-contract=off where the target has FMA, so it stays off; tests/abi looks at the objects.
WARNINGS := -Wall -Wextra -Wshadow -Wconversion
EXACT := -fno-math-errno -fno-trapping-math -ffp-contract=off -fno-tree-slp-vectorize
# Includes begin at these; those of drivers, program and tests at their own roots too.
INCLUDES := -Iinclude -Isrc
ALL_CFLAGS = -std=gnu99 $(CPPFLAGS) $(CFLAGS) $(EXACT) $(WARNINGS) $(PLATFORM_CFLAGS) -MMD -MP $(INCLUDES) $(CONFIG_CFLAGS) $(CFLAGS_EXTRA)

ifeq ($(CONFIG),scalar)
CONFIG_CFLAGS := -DDPT_SCALAR -fno-tree-vectorize
else ifeq ($(CONFIG),sanitize)
CFLAGS := -O2 -g1
CONFIG_CFLAGS := -fsanitize=address,undefined -fno-sanitize-recover=all
else ifeq ($(CONFIG),fuzz)
CFLAGS := -O2 -g
CONFIG_CFLAGS := -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -DFUZZ_ENGINE
else ifeq ($(CONFIG),fuzz-fast)
CFLAGS := -O2 -g
CONFIG_CFLAGS := -fsanitize=fuzzer-no-link -DFUZZ_ENGINE
else ifeq ($(CONFIG),debug)
CFLAGS := -O0 -g
else ifeq ($(CONFIG),coverage)
CFLAGS := -O0 -g
CONFIG_CFLAGS := --coverage
endif

# The folders of the core, in the order of their layers (docs/design.md).
FOLDERS := base mesh kernel nearest sweep hull contact strip query force deform exchange track insertion proxy tissue world arm
objects = $(patsubst %.c,$(B)/%.o,$(wildcard $1))
CORE := $(call objects,$(FOLDERS:%=src/%/*.c))
TEXT := $(call objects,src/text/*.c)
COMPILE := $(call objects,src/compile/*.c)
# Device back ends: a folder each. What lies in drivers/ itself serves all of them.
BACK_ENDS := sim replay serial openhaptics can
DRIVERS ?= $(BACK_ENDS)
ifneq ($(filter-out $(BACK_ENDS),$(DRIVERS)),)
$(error no driver $(filter-out $(BACK_ENDS),$(DRIVERS)): there are $(BACK_ENDS))
endif
# The system that is built for, by what the compiler says: a folder of drivers/platform, and how a library is named and
# linked there. Each of ours finds the others beside itself.
MACHINE := $(shell $(CC) -dumpmachine)
PLATFORM ?= $(if $(findstring windows,$(MACHINE))$(findstring mingw,$(MACHINE)),windows,$(if $(findstring macos,$(MACHINE))$(findstring darwin,$(MACHINE)),macos,linux))
PLATFORM_CFLAGS := -fPIC -fvisibility=hidden
# The compiler starts threads and the loop ranks its own: the core is linked to no thread library.
THREADS := -pthread
ifeq ($(PLATFORM),windows)
EXE := .exe
SO := -$(SOVERSION).dll
# Two warnings come from mingw-w64 itself: its isnan, and its printf of before C99. gcc takes a stack for aligned that is not: its assembler makes these moves unaligned.
PLATFORM_CFLAGS := -Wno-format -Wno-float-conversion -D__USE_MINGW_ANSI_STDIO=1 -D_FILE_OFFSET_BITS=64 \
  $(shell $(CC) -Wa,-muse-unaligned-vector-move -Werror -c -x c /dev/null -o /dev/null >/dev/null 2>&1 && echo -Wa,-muse-unaligned-vector-move)
LDFLAGS += -static
PLATFORM_LIBS := -lbcrypt
PLATFORM_PROGRAM_LIBS := -lws2_32 -lshell32
define LINK_SHARED
{ echo 'LIBRARY $(@F)'; echo EXPORTS; $(NM) -g $(filter %.o,$^) | sed -n 's/^[0-9a-f]* T \(dpt_[a-z0-9_]*\)$$/\1/p' | sort -u; } >$*.def
$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -shared -Wl,--out-implib,$*.dll.a $*.def $(filter %.o,$^) $(patsubst %$(SO),%.dll.a,$(filter %$(SO),$^)) $(LDLIBS) $(PLATFORM_LIBS) -o $@
endef
else ifeq ($(PLATFORM),macos)
SO := .$(SOVERSION).dylib
define LINK_SHARED
$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -dynamiclib -Wl,-install_name,@rpath/$(@F) -Wl,-rpath,@loader_path $^ $(LDLIBS) -o $@
ln -sf $(@F) $*.dylib
endef
else
SO := .so.$(SOVERSION)
# dlopen; a C library that has it in itself has an empty one of that name.
DL := -ldl
define LINK_SHARED
$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -shared -Wl,-soname,$(@F) -Wl,-rpath,'$$ORIGIN' -Wl,--version-script=src/symbols.map $^ -lm $(LDLIBS) -o $@
ln -sf $(@F) $*.so
endef
endif
PLATFORM_ALL := $(call objects,$(patsubst %,drivers/platform/%/*.c,$(if $(filter windows,$(PLATFORM)),windows,posix $(PLATFORM))))
# What a program asks of its system, and no library does.
PLATFORM_PROGRAM := $(filter %_program.o,$(PLATFORM_ALL))
# Serial lines are the drivers' alone.
PLATFORM_SERIAL := $(filter %_serial.o,$(PLATFORM_ALL))
# One driver alone loads a library; a program without it may be linked statically.
PLATFORM_LIBRARY := $(if $(filter openhaptics,$(DRIVERS)),,$(filter %_library.o,$(PLATFORM_ALL)))
# What an interpreter's extension asks of its system, and nothing else does.
PLATFORM_INTERPRETER := $(filter %_interpreter.o,$(PLATFORM_ALL))
PLATFORM_PARTS := $(filter-out $(PLATFORM_PROGRAM) $(PLATFORM_SERIAL) $(PLATFORM_LIBRARY) $(PLATFORM_INTERPRETER),$(PLATFORM_ALL))
# Firmware copies wire_device.[ch] (docs/wire.md); no host needs it.
WIRE_DEVICE := $(B)/drivers/serial/wire_device.o
DRIVER_PARTS := $(filter-out $(WIRE_DEVICE),$(call objects,drivers/*.c $(DRIVERS:%=drivers/%/*.c))) $(PLATFORM_PARTS) $(PLATFORM_SERIAL)
comma := ,
empty :=
# Since make 4.3 a backslash before # stays where a function is called.
HASH := \#
# Robots' descriptions: where there are urdfdom and a C++ compiler. URDF=no leaves them out.
URDF_HERE = $(if $(filter fuzz fuzz-fast,$(CONFIG)),no,$(shell echo '$(HASH)include <urdf_parser/urdf_parser.h>' | \
  $(CXX) $$(pkg-config --cflags urdfdom console_bridge expat 2>&1) -E -x c++ - >/dev/null 2>&1 && echo yes || echo no))
URDF := $(or $(URDF),$(URDF_HERE))
ifeq ($(URDF),yes)
URDF_PARTS := $(patsubst %.cc,$(B)/%.o,$(wildcard src/urdf/*.cc)) $(B)/src/text/open_file.o
URDF_CFLAGS := $(shell pkg-config --cflags urdfdom console_bridge expat)
URDF_LIBS := -Wl,--as-needed $(shell pkg-config --libs urdfdom console_bridge expat) -lstdc++
endif
# Curved tips: where a library can be linked to libccd. CONVEX=no leaves them out.
CONVEX_HERE = $(if $(filter fuzz fuzz-fast,$(CONFIG)),no,$(shell printf '$(HASH)include <ccd/ccd.h>\nint main(void) { ccd_t ccd; CCD_INIT(&ccd); return ccdMPRIntersect(0, 0, &ccd); }\n' | \
  $(CC) $$(pkg-config --cflags ccd 2>&1) -x c - $$(pkg-config --libs ccd 2>&1) -o /dev/null >/dev/null 2>&1 && echo yes || echo no))
CONVEX := $(or $(CONVEX),$(CONVEX_HERE))
ifeq ($(CONVEX),yes)
CONVEX_PARTS := $(call objects,src/convex/*.c)
CONVEX_CFLAGS := $(shell pkg-config --cflags ccd)
CONVEX_LIBS := $(shell pkg-config --libs ccd)
endif
# Scene files and plans: where the program can be linked to jansson. JANSSON=no leaves them out.
JSON_SOURCES := $(wildcard src/scene/json_*.c src/scene/scene_file*.c tools/plan/plan_file_parse.c)
JANSSON_HERE = $(shell printf '$(HASH)include <jansson.h>\nint main(void) { return !json_null(); }\n' | \
  $(CC) $$(pkg-config --cflags jansson 2>&1) -x c - $$(pkg-config --libs jansson 2>&1) -o /dev/null >/dev/null 2>&1 && echo yes || echo no)
JANSSON := $(or $(JANSSON),$(JANSSON_HERE))
ifeq ($(JANSSON),yes)
SCENE_FILE := $(JSON_SOURCES:%.c=$(B)/%.o)
JANSSON_CFLAGS := $(shell pkg-config --cflags jansson)
JANSSON_LIBS := $(shell pkg-config --libs jansson)
endif
# The viewer's server: where the program can be linked to libwebsockets. LWS=no leaves it out.
LWS_HERE = $(shell printf '$(HASH)include <libwebsockets.h>\nint main(void) { lws_set_log_level(0, 0); return 0; }\n' | \
  $(CC) $$(pkg-config --cflags libwebsockets 2>&1) -x c - $$(pkg-config --libs libwebsockets 2>&1) -o /dev/null >/dev/null 2>&1 && echo yes || echo no)
LWS := $(or $(LWS),$(LWS_HERE))
ifeq ($(LWS),yes)
VIEW_SERVER := $(call objects,tools/view/server/*.c)
LWS_CFLAGS := $(shell pkg-config --cflags libwebsockets)
LWS_LIBS := $(shell pkg-config --libs libwebsockets)
endif
# The viewer's page: where node and three.js can make it. VIEW_PAGE=no leaves it out.
NODE ?= node
VIEW_PAGE_HERE = $(if $(and $(wildcard tools/view/page/make_page.js),$(wildcard build/view/node_modules/three/package.json),$(shell command -v $(NODE))),yes,no)
VIEW_PAGE := $(or $(VIEW_PAGE),$(VIEW_PAGE_HERE))
HOST := $(filter-out $(JSON_SOURCES:%.c=$(B)/%.o),$(call objects,src/scene/*.c src/host/*.c)) $(filter $(B)/src/scene/%,$(SCENE_FILE))
# The rooms of the program, but for what is built where a library is found.
ROOMS := cli shape record run view plot chart measure plan lab
TOOLS := $(filter-out $(JSON_SOURCES:%.c=$(B)/%.o),$(call objects,$(ROOMS:%=tools/%/*.c))) $(filter $(B)/tools/%,$(SCENE_FILE)) $(VIEW_SERVER)
# The other ends of a line, for `device simulate` and the tests: of the back ends that were chosen.
SIMULATE := $(call objects,$(wildcard $(DRIVERS:%=tools/simulate/simulate_%*.c))) $(if $(filter serial,$(DRIVERS)),$(WIRE_DEVICE))
LIBS_OF_C := $(B)/libdynpoint $(B)/libdynpoint_compile $(B)/libdynpoint_drivers $(B)/libdynpoint_convex $(B)/libdynpoint_host
LIBS := $(B)/libdynpoint $(B)/libdynpoint_compile $(B)/libdynpoint_drivers $(if $(URDF_PARTS),$(B)/libdynpoint_urdf) $(if $(CONVEX_PARTS),$(B)/libdynpoint_convex) $(B)/libdynpoint_host

# What this machine lacks, for the last line of make; not what the user left out, and not with make -s.
IS_SILENT := $(findstring s,$(filter-out --%,$(firstword -$(MAKEFLAGS))))
lacks = $(if $(and $(filter file,$(origin $1)),$(filter no,$($1))),echo "built without $2: make deps $3";)
LEFT_OUT = $(if $(IS_SILENT),,$(call lacks,URDF,robots in URDF (urdfdom and a C++ compiler),light) \
  $(call lacks,CONVEX,curved tips (libccd),light) \
  $(call lacks,JANSSON,scene files (jansson),light) \
  $(call lacks,LWS,the viewer in a browser (libwebsockets),view) \
  $(call lacks,VIEW_PAGE,the viewer's page (node and three.js),view))

SUMMARY := $(B)/summary.txt

# For foreign-function interfaces: all headers, whichever libraries this build has (docs/ffi.md).
CDEF := $(B)/include/dynpoint_cdef.h
# The manual's pages are what the program says of itself: where it runs.
MAN := $(if $(filter release,$(CONFIG)),$(if $(filter linux,$(PLATFORM)),$(B)/man/dynpoint.1))

.PHONY: all summary amalgamation force demo test check check-platforms check-view check-wasm check-page firmware vm bench charts figures soft-tables pictures stability soak fuzz install uninstall help clean
.SECONDARY:
all: $(B)/dynpoint$(EXE) $(LIBS:%=%.a) $(LIBS:%=%$(SO)) $(CDEF) $(MAN) $(SUMMARY) ## the program and the libraries (default)
	@:; $(LEFT_OUT)

# What is built in, what is not, and why: in one place, installed with the pages.
has = printf '%-22s %s\n' '$2' '$(if $(filter yes,$($1)),yes,no: $(if $(filter yes,$($1_HERE)),left out by $1=$($1),needs $3: make deps $4))';
# zig cc --version writes a file a.o here, unless it is given another name.
$(SUMMARY): force
	@mkdir -p $(@D)
	@{ printf '%-22s %s\n' version '$(VERSION)' configuration '$(CONFIG)' 'built for' '$(PLATFORM), $(MACHINE)' \
	     compiler "$$($(CC) --version -o /dev/null 2>&1 | head -n 1)" CPPFLAGS '$(CPPFLAGS)' CFLAGS '$(CFLAGS)' CXXFLAGS '$(CXXFLAGS)' \
	     LDFLAGS '$(LDFLAGS)'; \
	   for driver in $(BACK_ENDS); do case ' $(DRIVERS) ' in *" $$driver "*) has=yes ;; *) has='no: it is not in DRIVERS' ;; esac; \
	     printf '%-22s %s\n' "driver $$driver" "$$has"; done; \
	   $(call has,URDF,robots in URDF,urdfdom and a C++ compiler,light) \
	   $(call has,CONVEX,curved tips,libccd,light) \
	   $(call has,JANSSON,scene files and plans,jansson,light) \
	   $(call has,LWS,viewer in a browser,libwebsockets,view) \
	   $(call has,VIEW_PAGE,the viewer'"'"'s page,node and three.js,view) \
	   printf '%-22s %s\n' 'manual pages' '$(if $(MAN),yes,no: they are made by a release build for Linux)'; } | sed 's/ *$$//' >$@.now
	@cmp -s $@.now $@ && rm $@.now || mv $@.now $@
summary: $(SUMMARY) ## what is built in, what is not, and why
	@cat $<

$(B)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -c $< -o $@

$(B)/%.o: %.cc
	@mkdir -p $(@D)
	$(CXX) -std=c++11 $(CPPFLAGS) $(CXXFLAGS) $(EXACT) -Wall -Wextra $(PLATFORM_CFLAGS) -MMD -MP $(INCLUDES) $(URDF_CFLAGS) $(CONFIG_CFLAGS) $(CFLAGS_EXTRA) -c $< -o $@

$(B)/src/kernel/kernel_scalar.o: CONFIG_CFLAGS += -fno-tree-vectorize

# For aarch64, compilers call a helper for an atomic exchange; the core calls nothing. Others do not know the option.
$(B)/src/exchange/latest.o: CONFIG_CFLAGS += $(shell $(CC) -mno-outline-atomics -Werror -E -x c /dev/null >/dev/null 2>&1 && echo -mno-outline-atomics)

$(B)/src/convex/%.o: INCLUDES += $(CONVEX_CFLAGS)
$(B)/drivers/%.o $(B)/src/scene/%.o $(B)/src/host/%.o: INCLUDES += -Idrivers
$(B)/tools/%.o: INCLUDES += -Idrivers -Itools
$(JSON_SOURCES:%.c=$(B)/%.o): INCLUDES += $(JANSSON_CFLAGS)
$(B)/tools/view/server/%.o: INCLUDES += $(LWS_CFLAGS)

# built_with.h says what was chosen for this build; it changes only when that does.
CHOOSERS := $(B)/drivers/device.o $(B)/tools/cli/arm_file.o $(B)/tools/cli/cmd_device.o $(B)/src/scene/scene_def.o \
            $(B)/src/scene/tip_shape.o \
            $(B)/tools/plan/plan_file.o \
            $(B)/tools/view/view_serve.o
$(CHOOSERS): INCLUDES += -I$(B)
$(CHOOSERS): $(B)/built_with.h
$(B)/built_with.h: force
	@mkdir -p $(@D)
	@{ echo '#define DPT_DRIVERS $(patsubst %,DRIVER(%),$(DRIVERS))'; \
	   echo '#define DPT_BACK_ENDS $(foreach name,$(BACK_ENDS),"$(name)",)'; \
	   for part in $(DRIVERS) $(if $(URDF_PARTS),urdf) $(if $(CONVEX_PARTS),convex) $(if $(SCENE_FILE),jansson) $(if $(VIEW_SERVER),lws) $(if $(filter yes made,$(VIEW_PAGE)),view_page); do \
	     echo "#define DPT_HAS_$$(echo $$part | tr a-z A-Z)"; done; } >$@.now
	@cmp -s $@.now $@ && rm $@.now || mv $@.now $@

# The page is the same in every configuration; its policy's line goes into a header, without the line's end. VIEW_PAGE=made:
# it lies there already, as in a package of sources.
ifneq ($(filter yes made,$(VIEW_PAGE)),)
$(B)/tools/view/view_serve.o: build/view/page.html build/view/page.csp.line
build/view/page.csp.line: build/view/page.html
	tr -d '\n' <build/view/page.csp >$@
endif
ifeq ($(VIEW_PAGE),yes)
build/view/page.html: $(wildcard tools/view/page/*.js tools/view/page/*.html tools/view/page/*.css) build/view/node_modules/three/package.json
	$(NODE) tools/view/page/make_page.js build/view
endif

# One object a library, its inner symbols local: a static library meets no one else's names. Only linkers of ELF do that.
# With link-time optimization it ends here: whose names are local is a property of an object of machine code.
JOIN = $(if $(findstring -flto,$(CFLAGS)),$(CC) $(CFLAGS) -r -nostdlib -flinker-output=nolto-rel,$(LD) -r)
ONE := $(if $(filter linux,$(PLATFORM)),.o,.a)
$(B)/libdynpoint$(ONE): $(CORE)
$(B)/libdynpoint_compile$(ONE): $(COMPILE) $(TEXT)
$(B)/libdynpoint_drivers$(ONE): $(DRIVER_PARTS) $(TEXT)
$(B)/libdynpoint_convex$(ONE): $(CONVEX_PARTS)
# Of the drivers' inner parts it has its own: one line of a loop, and the platform.
HOST_PARTS := $(HOST) $(B)/drivers/loop_line.o $(PLATFORM_PARTS)
$(B)/libdynpoint_host$(ONE): $(HOST_PARTS) $(TEXT)
$(LIBS_OF_C:%=%.o):
	$(JOIN) $^ -o $@
	$(OBJCOPY) --localize-hidden $@
ifneq ($(ONE),.o)
$(LIBS_OF_C:%=%.a):
	rm -f $@
	$(AR) rcs $@ $^
endif

# What C++ shares among objects is local too: the library's name is all that is seen.
$(B)/libdynpoint_urdf.o: $(URDF_PARTS)
	$(JOIN) $^ -o $@
	$(OBJCOPY) --wildcard --keep-global-symbol='dpt_urdf_*' $@
$(B)/libdynpoint_urdf$(SO): private LDLIBS = $(URDF_LIBS)
$(B)/libdynpoint_urdf$(SO): $(URDF_PARTS) $(B)/libdynpoint_compile$(SO) $(B)/libdynpoint$(SO)

%.a: %.o
	rm -f $@
	$(AR) rcs $@ $<

$(B)/libdynpoint_compile$(SO): private LDLIBS = $(THREADS)
$(B)/libdynpoint_drivers$(SO): private LDLIBS = $(THREADS) $(DL)
$(B)/libdynpoint_convex$(SO): private LDLIBS = $(CONVEX_LIBS)
$(B)/libdynpoint_host$(SO): private LDLIBS = $(THREADS) $(JANSSON_LIBS)
$(B)/libdynpoint$(SO): $(CORE)
$(B)/libdynpoint_compile$(SO): $(COMPILE) $(TEXT) $(B)/libdynpoint$(SO)
$(B)/libdynpoint_drivers$(SO): $(DRIVER_PARTS) $(TEXT) $(B)/libdynpoint$(SO)
$(B)/libdynpoint_convex$(SO): $(CONVEX_PARTS) $(B)/libdynpoint$(SO)
$(B)/libdynpoint_host$(SO): $(HOST_PARTS) $(TEXT) $(if $(CONVEX_PARTS),$(B)/libdynpoint_convex$(SO)) \
  $(B)/libdynpoint_drivers$(SO) $(B)/libdynpoint_compile$(SO) $(B)/libdynpoint$(SO)
%$(SO):
	$(LINK_SHARED)

$(B)/dynpoint$(EXE): $(TOOLS) $(PLATFORM_PROGRAM) $(SIMULATE) $(HOST) $(URDF_PARTS) $(CONVEX_PARTS) $(COMPILE) $(TEXT) $(DRIVER_PARTS) $(CORE)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) $^ -lm $(THREADS) $(DL) $(URDF_LIBS) $(CONVEX_LIBS) $(JANSSON_LIBS) $(LWS_LIBS) $(PLATFORM_LIBS) $(PLATFORM_PROGRAM_LIBS) -o $@

$(B)/man/dynpoint.1: $(B)/dynpoint tools/packaging/man.sh
	sh tools/packaging/man.sh $(B)/dynpoint $(@D)

folders = $(subst $(empty) $(empty),$(comma),$(strip $1))
$(CDEF): include/dynpoint.h $(wildcard include/dynpoint/*.h) tools/packaging/cdef.sh
	@mkdir -p $(@D)
	CC='$(CC)' sh tools/packaging/cdef.sh include $@ libdynpoint=$(call folders,$(FOLDERS:%=src/%)) \
	  libdynpoint_compile=src/compile libdynpoint_drivers=drivers libdynpoint_urdf=src/urdf \
	  libdynpoint_convex=src/convex libdynpoint_host=src/host

# What the bindings of other languages are made from (needs python3-pycparser).
$(B)/abi.json: $(CDEF) tools/packaging/abi_model.py
	$(PYTHON) -B tools/packaging/abi_model.py $(CDEF) >$@.new && mv $@.new $@

amalgamation: $(B)/amalgamation/LICENSE ## the core and the compiler as single files, for firmware, crates, packages (needs python3)
$(B)/amalgamation/LICENSE: LICENSE $(wildcard tools/packaging/*.py tools/packaging/*.h) tools/packaging/cmake/CMakeLists.txt $(wildcard include/*.h include/*/*.h $(FOLDERS:%=src/%/*.[ch]) src/compile/*.[ch] src/text/*.[ch])
	@rm -rf $(@D) && mkdir -p $(@D)
	@$(PYTHON) -B tools/packaging/amalgamate.py $(@D) dynpoint=$(call folders,$(CORE:$(B)/%.o=%.c)) \
	  dynpoint_compile=$(call folders,$(patsubst $(B)/%.o,%.c,$(COMPILE) $(TEXT)))
	@cp tools/packaging/cmake/CMakeLists.txt $(@D)
	@cp LICENSE $@

demo: ## build, make a liver, slide a tool over it, and prove every answer
	@echo building ...
	@$(MAKE) -s all
	@sh tools/demo.sh $(B)

include src/bindings/wasm/wasm.mk
include src/bindings/js/js.mk
include src/bindings/python/python.mk
include src/bindings/csharp/csharp.mk
include src/bindings/java/java.mk
include src/bindings/rust/rust.mk
include tools/page/page.mk
include tools/packaging/site/site.mk
include tests/tests.mk

# What is installed, and where: tools/packaging/install.sh.
INSTALL = DESTDIR='$(DESTDIR)' PREFIX='$(PREFIX)' BINDIR='$(BINDIR)' LIBDIR='$(LIBDIR)' INCLUDEDIR='$(INCLUDEDIR)' \
  PKGCONFIGDIR='$(PKGCONFIGDIR)' DATADIR='$(DATADIR)' MANDIR='$(MANDIR)' VERSION='$(VERSION)' SOVERSION='$(SOVERSION)' \
  LIBRARIES='$(notdir $(LIBS))' THREADS='$(THREADS)' DL='$(DL)' JANSSON='$(JANSSON)' CCD='$(CONVEX)' sh tools/packaging/install.sh
install: ## what make has built, into PREFIX, or DESTDIR and the directory variables
	@$(INSTALL) $(B)

uninstall: ## what the manifest of install lists
	@$(INSTALL) --remove

help: ## this list
	@echo 'make [TARGET] [CONFIG=release|scalar|sanitize|debug|coverage] [DRIVERS="$(BACK_ENDS)"] [URDF=no] [CONVEX=no] [JANSSON=no] [LWS=no] [VIEW_PAGE=no]'
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  \1\t\2/p' $(filter Makefile %.mk,$(MAKEFILE_LIST)) | expand -t 16

clean: ## remove build/
	rm -rf build

-include $(patsubst %.o,%.d,$(CORE) $(TEXT) $(COMPILE) $(URDF_PARTS) $(CONVEX_PARTS) $(DRIVER_PARTS) $(PLATFORM_PROGRAM) $(HOST) $(TOOLS) $(SIMULATE))
endif
