# SPDX-License-Identifier: BSD-3-Clause
# The package of Python: one extension on the limited API of 3.11, of the core, the compiler, the drivers, the host and
# the sources here; the program beside it; the typed package on top. setup.py calls this for its two files, and packs
# them.
PY := $(B)/python
# From any folder.
PY_PYTHON = $(if $(findstring /,$(PYTHON)),$(abspath $(PYTHON)),$(PYTHON))
PY_SOURCES := $(wildcard src/bindings/python/*.c)
PY_INCLUDE ?= $(shell $(PYTHON) -c 'import sysconfig; print(sysconfig.get_path("include"))')
# What goes by built_with.h is compiled once more: a wheel has all drivers, and asks for urdfdom, libccd and libwebsockets
# when they are first needed (parts/): for each there is a library beside the extension, where this build could make it.
PY_CHOSEN := $(patsubst $(B)/%,$(PY)/%,$(CHOOSERS))
PY_LOADED := $(patsubst src/%.c,$(B)/src/%.o,$(wildcard src/bindings/python/parts/*.c))
PY_OBJECTS := $(filter-out $(CHOOSERS),$(CORE) $(TEXT) $(COMPILE) $(DRIVER_PARTS) $(HOST)) \
  $(filter $(PY)/drivers/% $(PY)/src/%,$(PY_CHOSEN)) $(PY_SOURCES:%.c=$(B)/%.o) \
  $(addprefix $(B)/,tools/view/scene_view.o tools/view/view_scene.o tools/view/view_stream.o) \
  $(filter-out %/part_view.o %/part_urdf.o,$(PY_LOADED)) $(PLATFORM_INTERPRETER) $(PLATFORM_LIBRARY)
# The wheels of a release have urdfdom and what it stands on in the program itself: compiled of WHEEL_URDF, their sources.
WHEEL_URDF ?=
ifneq ($(WHEEL_URDF),)
PY_URDF_SOURCES := $(addprefix $(WHEEL_URDF)/,$(patsubst %,urdfdom/urdf_parser/src/%.cpp,joint link model pose world) \
  console-bridge/src/console.cpp $(patsubst %,tinyxml/%.cpp,tinyxml tinyxmlerror tinyxmlparser) $(patsubst %,expat/expat/lib/%.c,xmlparse xmlrole xmltok \
  $(if $(filter windows,$(PLATFORM)),random_rand_s,random_dev_urandom)))
PY_URDF := $(URDF_PARTS) $(patsubst $(WHEEL_URDF)/%,$(PY)/urdf/%.o,$(PY_URDF_SOURCES))
endif
PY_PROGRAM := $(filter-out $(CHOOSERS) $(VIEW_SERVER),$(TOOLS) $(PLATFORM_PROGRAM) $(SIMULATE) $(HOST) $(COMPILE) $(TEXT) $(DRIVER_PARTS) $(CORE)) \
  $(PY_CHOSEN) $(if $(WHEEL_URDF),$(filter-out %/part_urdf.o,$(PY_LOADED)) $(PY_URDF),$(PY_LOADED)) $(PLATFORM_LIBRARY)
PY_VIEW_SERVER := $(patsubst $(B)/%,$(PY)/%,$(VIEW_SERVER))
# What Python calls an extension, and how it is linked: it finds Python's symbols in the program that loads it. On Windows
# they are python3.dll's, the DLL of the limited API, of which an import library is made: of those that are used.
ifeq ($(PLATFORM),windows)
PY_EXTENSION := _dynpoint.pyd
PY_LINK_EXTENSION = $(LDFLAGS) -shared -Wl,--gc-sections
PY_PYTHON_LIB := $(PY)/libpython3.a
else ifeq ($(PLATFORM),macos)
PY_EXTENSION := _dynpoint.abi3.so
PY_LINK_EXTENSION = $(LDFLAGS) -dynamiclib -Wl,-undefined,dynamic_lookup -Wl,-install_name,@rpath/$(@F) -Wl,-dead_strip
else
PY_EXTENSION := _dynpoint.abi3.so
PY_LINK_EXTENSION = $(LDFLAGS) -shared -Wl,--gc-sections -Wl,-rpath,'$$ORIGIN' -Wl,--version-script=src/bindings/python/python.map
endif
DLLTOOL ?= dlltool
PY_PARTS := $(addprefix $(PY)/parts/,$(PY_EXTENSION) dynpoint$(EXE) $(if $(WHEEL_URDF),,$(if $(URDF_PARTS),libdynpoint_urdf.so)) \
  $(if $(CONVEX_PARTS),libdynpoint_convex.so) $(if $(VIEW_SERVER),libdynpoint_view.so) \
  $(if $(filter yes made,$(VIEW_PAGE)),page.html page.csp))
PY_LINK = $(CC) $(CONFIG_CFLAGS)
PY_LINK_PROGRAM = $(LDFLAGS) $(if $(filter linux,$(PLATFORM)),-Wl$(comma)--gc-sections -Wl$(comma)-rpath$(comma)'$$ORIGIN')
PY_LINK_PART = $(LDFLAGS) -shared -Wl,--gc-sections,-z,defs -Wl,--version-script=src/bindings/python/parts/part.map $^ -lm $(THREADS) $(DL)

.PHONY: wheel wheel-release sdist python-parts
python-parts: $(PY_PARTS)

# What setup.py packs, apart from the tree: it writes beside what it reads.
PY_FILES := $(addprefix src/bindings/python/,setup.py pyproject.toml README.md)
# Terms of what is in it besides: NAME=FILE.
PY_LICENSES :=
PY_COPY = rm -rf $1 && mkdir -p $1 && cp $(PY_FILES) LICENSE $1 && \
  $(foreach terms,$(PY_LICENSES),cp $(word 2,$(subst =, ,$(terms))) $1/LICENSE.$(firstword $(subst =, ,$(terms))) &&) mkdir $1/dynpoint && \
  cp src/bindings/python/dynpoint/*.py src/bindings/python/dynpoint/*.pyi src/bindings/python/dynpoint/py.typed $1/dynpoint

wheel: python-parts ## the package of Python, build/python/dynpoint-*.whl (make deps python)
	@rm -f $(PY)/dynpoint-*.whl
	$(call PY_COPY,$(PY)/package)
	cd $(PY)/package && DYNPOINT_TREE='$(CURDIR)' DYNPOINT_PARTS='$(abspath $(PY)/parts)' $(PY_PYTHON) setup.py --quiet bdist_wheel --dist-dir ..
	@ls $(PY)/dynpoint-*.whl

# The wheels of a release are made by zig, which has headers and libraries of other systems: of glibc 2.28, of musl, of Windows
# and of macOS 11. Python's headers are this machine's; those for Windows, whose sizes are others, are in WHEEL_PYTHON. jansson
# and urdfdom go in. For glibc jansson is Debian's, of the system or of WHEEL_ROOT, where packages of another machine are
# unpacked; elsewhere it is compiled of WHEEL_JANSSON, its sources. urdfdom is compiled everywhere: its C++ is that of zig's own
# library (libc++, linked in), and so no system's need be there. libccd does not go in, and is loaded where Debian's headers
# tell how. libwebsockets is not asked for: Python's own server is there.
WHEEL_FOR ?= x86_64
WHEEL_ROOT ?=
WHEEL_MACHINE := $(firstword $(subst -, ,$(WHEEL_FOR)))
WHEEL_SYSTEM := $(or $(word 2,$(subst -, ,$(WHEEL_FOR))),glibc)
ifeq ($(WHEEL_SYSTEM),glibc)
WHEEL_TARGET := $(WHEEL_MACHINE)-linux-gnu.2.28
WHEEL_TAG := linux_$(WHEEL_MACHINE)
else ifeq ($(WHEEL_SYSTEM),musl)
WHEEL_TARGET := $(WHEEL_MACHINE)-linux-musl
WHEEL_TAG := musllinux_1_2_$(WHEEL_MACHINE)
else ifeq ($(WHEEL_SYSTEM),windows)
WHEEL_TARGET := $(WHEEL_MACHINE)-windows-gnu
WHEEL_TAG := win_amd64
else
WHEEL_TARGET := $(WHEEL_MACHINE)-macos.11.0
WHEEL_TAG := macosx_11_0_$(WHEEL_MACHINE:aarch64=arm64)
endif
WHEEL_MADE := build/wheel-$(WHEEL_FOR)
WHEEL_ZIG = $(PY_PYTHON) -m ziglang
WHEEL_LIBS := $(WHEEL_ROOT)/usr/lib/$(WHEEL_MACHINE)-linux-gnu
WHEEL_HEADERS = $(wildcard $(foreach name,jansson.h jansson_config.h ccd, \
  $(WHEEL_ROOT)/usr/include/$(name) $(WHEEL_ROOT)/usr/include/$(WHEEL_MACHINE)-linux-gnu/$(name)))
# What jansson's configure would find: where the seed of its hashes comes from.
WHEEL_JANSSON_USES = -DHAVE_STDINT_H -DHAVE_ATOMIC_BUILTINS $(if $(filter windows,$(WHEEL_SYSTEM)),-DUSE_WINDOWS_CRYPTOAPI, \
  $(addprefix -D,USE_URANDOM $(addprefix HAVE_,OPEN CLOSE READ FCNTL_H UNISTD_H SYS_STAT_H SYS_TYPES_H SYS_TIME_H \
  SCHED_H SCHED_YIELD GETTIMEOFDAY GETPID)))
# The folders of its headers; and what its configure scripts would say.
WHEEL_URDF_USES = $(addprefix -isystem ,$(WHEEL_MADE)/include $(addprefix $(WHEEL_URDF)/,tinyxml expat/expat/lib console-bridge/include \
  urdfdom/urdf_parser/include $(patsubst %,urdfdom-headers/%/include,urdf_exception urdf_model urdf_model_state urdf_sensor urdf_world))) \
  -DTIXML_USE_STL -DURDFDOM_STATIC -DXML_STATIC
WHEEL_EXPAT_USES = XML_NS XML_DTD XML_GE=1 BYTEORDER=1234 XML_CONTEXT_BYTES=1024 HAVE_MEMMOVE HAVE_STDINT_H HAVE_STDLIB_H HAVE_STRING_H \
  $(if $(filter windows,$(WHEEL_SYSTEM)),,XML_DEV_URANDOM HAVE_UNISTD_H HAVE_FCNTL_H)
WHEEL_TERMS = jansson=$(if $(filter glibc,$(WHEEL_SYSTEM)),$(WHEEL_ROOT)/usr/share/doc/libjansson4/copyright,$(WHEEL_JANSSON)/LICENSE) \
  $(if $(WHEEL_URDF),$(foreach one,urdfdom/LICENSE urdfdom-headers/LICENSE console-bridge/LICENSE tinyxml/readme.txt expat/COPYING, \
  $(firstword $(subst /, ,$(one)))=$(WHEEL_URDF)/$(one)) libcxx=$(WHEEL_LIBCXX_TERMS))
WHEEL_LIBCXX_TERMS = $(shell $(PYTHON) -c 'import pathlib, ziglang; print(pathlib.Path(ziglang.__file__).parent / "lib/libcxx/LICENSE.TXT")')
WHEEL_MAKE = DYNPOINT_PLATFORM=$(WHEEL_TAG) $(MAKE) wheel B=$(WHEEL_MADE) CC='$(WHEEL_ZIG) cc -target $(WHEEL_TARGET)' \
  CXX='$(WHEEL_ZIG) c++ -target $(WHEEL_TARGET)' URDF=$(if $(WHEEL_URDF),yes,no) URDF_CFLAGS='$(WHEEL_URDF_USES)' URDF_LIBS= \
  PY_LICENSES='$(WHEEL_TERMS)' LWS=no LDFLAGS=-s PY_INCLUDE=$(WHEEL_MADE)/include/python JANSSON=yes JANSSON_CFLAGS='-I$(WHEEL_MADE)/include'
wheel-release: ## the same for a release (make deps wheels): for glibc 2.28; WHEEL_FOR=x86_64-windows, ...: docs/python.md
	rm -rf $(WHEEL_MADE)/include $(WHEEL_MADE)/dynpoint-*.whl && mkdir -p $(WHEEL_MADE)/include
	printf '#define CONSOLE_BRIDGE_DLLAPI\n' >$(WHEEL_MADE)/include/console_bridge_export.h
	printf '#define %s\n' $(WHEEL_EXPAT_USES) | tr = ' ' >$(WHEEL_MADE)/include/expat_config.h
ifeq ($(WHEEL_SYSTEM),windows)
	cp -R $(WHEEL_PYTHON) $(WHEEL_MADE)/include/python
else
	cp -R $(PY_INCLUDE) $(WHEEL_MADE)/include/python
	cp "$$($(PYTHON) -c 'import sysconfig; print(sysconfig.get_config_h_filename())')" $(WHEEL_MADE)/include/python/pyconfig.h
endif
ifeq ($(WHEEL_SYSTEM),glibc)
	cp -R $(WHEEL_HEADERS) $(WHEEL_MADE)/include
	+$(WHEEL_MAKE) JANSSON_LIBS='$(WHEEL_LIBS)/libjansson.so' \
	  CONVEX=yes CONVEX_CFLAGS='-I$(WHEEL_MADE)/include' CONVEX_LIBS='$(WHEEL_LIBS)/libccd.so'
	LD_LIBRARY_PATH="$(if $(WHEEL_ROOT),$(abspath $(WHEEL_LIBS)))" PATH="$(if $(findstring /,$(PYTHON)),$(dir $(PY_PYTHON)):)$$PATH" \
	  auditwheel repair --plat auto --exclude libccd.so.2 --wheel-dir $(WHEEL_MADE) $(WHEEL_MADE)/python/*.whl
else
	cp $(WHEEL_JANSSON)/src/jansson.h $(WHEEL_MADE)/include
	sed 's/@json_inline@/inline/; s/@json_[a-z_]*@/1/' $(WHEEL_JANSSON)/src/jansson_config.h.in >$(WHEEL_MADE)/include/jansson_config.h
	rm -rf $(WHEEL_MADE)/jansson && mkdir $(WHEEL_MADE)/jansson && : >$(WHEEL_MADE)/jansson/jansson_private_config.h
	for source in $(wildcard $(WHEEL_JANSSON)/src/*.c); do $(WHEEL_ZIG) cc -target $(WHEEL_TARGET) -O2 -fPIC -fvisibility=hidden \
	  $(WHEEL_JANSSON_USES) -I$(WHEEL_MADE)/jansson -I$(WHEEL_MADE)/include -c $$source \
	  -o $(WHEEL_MADE)/jansson/$$(basename $$source .c).o || exit 1; done
	$(WHEEL_ZIG) ar rcs $(WHEEL_MADE)/libjansson.a $(WHEEL_MADE)/jansson/*.o
	+$(WHEEL_MAKE) CONVEX=no JANSSON_LIBS='$(WHEEL_MADE)/libjansson.a' DLLTOOL='$(WHEEL_ZIG) dlltool'
	cp $(WHEEL_MADE)/python/*.whl $(WHEEL_MADE)
endif

sdist: $(if $(filter yes made,$(VIEW_PAGE)),build/view/page.html) ## its sources, build/python/dynpoint-*.tar.gz: with what it is built of
	@rm -f $(PY)/dynpoint-*.tar.gz
	$(call PY_COPY,$(PY)/sdist)
	mkdir -p $(PY)/sdist/tree/tests/abi
	cp -R Makefile LICENSE include src drivers tools $(PY)/sdist/tree
	cp tests/tests.mk $(PY)/sdist/tree/tests
	cp tests/abi/layouts.txt $(PY)/sdist/tree/tests/abi
	$(if $(filter yes made,$(VIEW_PAGE)),mkdir -p $(PY)/sdist/tree/build/view && \
	  cp build/view/page.html build/view/page.csp $(PY)/sdist/tree/build/view)
	printf 'graft tree\nglobal-exclude *.pyc *.so program\n' >$(PY)/sdist/MANIFEST.in
	cd $(PY)/sdist && $(PY_PYTHON) setup.py --quiet sdist --dist-dir ..
	@ls $(PY)/dynpoint-*.tar.gz

$(B)/src/bindings/python/%.o: src/bindings/python/%.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -Itests/abi -Idrivers -Itools -isystem $(PY_INCLUDE) -c $< -o $@
$(PY)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -I$(PY) -Idrivers -Itools -c $< -o $@
$(PY_LOADED): INCLUDES += -Itools
$(PY_VIEW_SERVER): CONFIG_CFLAGS += -fvisibility=default $(LWS_CFLAGS)
$(PY_CHOSEN): $(PY)/built_with.h
$(PY)/built_with.h: force
	@mkdir -p $(@D)
	@{ echo '#define DPT_DRIVERS $(patsubst %,DRIVER(%),$(DRIVERS))'; \
	   echo '#define DPT_BACK_ENDS $(foreach name,$(BACK_ENDS),"$(name)",)'; \
	   echo '#define DPT_LOADS_CONVEX'; \
	   for part in $(DRIVERS) $(if $(SCENE_FILE),jansson) urdf convex lws $(if $(filter yes made,$(VIEW_PAGE)),view_page); do \
	     echo "#define DPT_HAS_$$(echo $$part | tr a-z A-Z)"; done; } >$@.now
	@cmp -s $@.now $@ && rm $@.now || mv $@.now $@

$(PY)/parts/$(PY_EXTENSION): $(PY_OBJECTS) $(PY_PYTHON_LIB)
	@mkdir -p $(@D)
	$(PY_LINK) $(PY_LINK_EXTENSION) $^ -lm $(THREADS) $(DL) $(JANSSON_LIBS) $(PLATFORM_LIBS) -o $@
$(PY)/libpython3.a: $(PY_SOURCES:%.c=$(B)/%.o)
	@mkdir -p $(@D)
	{ echo 'LIBRARY python3.dll'; echo EXPORTS; $(NM) -u $^ | sed -n 's/^ *U __imp_\(_*Py[A-Za-z_0-9]*\)$$/\1/p' | sort -u; } >$(PY)/python3.def
	$(DLLTOOL) -m i386:x86-64 -d $(PY)/python3.def -l $@
# The extension's own sources under sanitizers, for tests/python/sanitize.sh; the library's are there in the tests in C.
PY_SANITIZED := $(PY_SOURCES:%.c=$(PY)/sanitized/%.o)
$(PY_SANITIZED): CONFIG_CFLAGS += -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
$(PY)/sanitized/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -Itests/abi -Idrivers -Itools -isystem $(PY_INCLUDE) -c $< -o $@
$(PY)/sanitized/_dynpoint.abi3.so: $(PY_SANITIZED) $(filter-out $(PY_SOURCES:%.c=$(B)/%.o),$(PY_OBJECTS))
	$(PY_LINK) -fsanitize=address,undefined $(PY_LINK_EXTENSION) $^ -lm $(THREADS) $(DL) $(JANSSON_LIBS) -o $@
$(PY)/parts/dynpoint$(EXE): $(PY_PROGRAM)
	@mkdir -p $(@D)
	$(if $(WHEEL_URDF),$(CXX) $(CONFIG_CFLAGS),$(PY_LINK)) $(PY_LINK_PROGRAM) $(sort $^) -lm $(THREADS) $(DL) $(JANSSON_LIBS) $(PLATFORM_LIBS) $(PLATFORM_PROGRAM_LIBS) -o $@

ifneq ($(WHEEL_URDF),)
$(PY)/urdf/%.cpp.o: $(WHEEL_URDF)/%.cpp
	@mkdir -p $(@D)
	$(CXX) -std=c++11 -O2 $(EXACT) -w -fvisibility=hidden $(URDF_CFLAGS) -c $< -o $@
$(PY)/urdf/%.c.o: $(WHEEL_URDF)/%.c
	@mkdir -p $(@D)
	$(CC) -O2 -w -fvisibility=hidden $(URDF_CFLAGS) -c $< -o $@
endif

$(PY)/parts/libdynpoint_urdf.so: $(URDF_PARTS) $(COMPILE) $(TEXT) $(CORE)
	@mkdir -p $(@D)
	$(CXX) $(CONFIG_CFLAGS) $(PY_LINK_PART) $(URDF_LIBS) -o $@
$(PY)/parts/libdynpoint_convex.so: $(CONVEX_PARTS) $(CORE)
	@mkdir -p $(@D)
	$(CC) $(CONFIG_CFLAGS) $(PY_LINK_PART) $(CONVEX_LIBS) -o $@
$(PY)/parts/libdynpoint_view.so: $(PY_VIEW_SERVER) $(B)/tools/view/view_request.o $(TEXT) $(PLATFORM_PROGRAM) $(PLATFORM_PARTS)
	@mkdir -p $(@D)
	$(CC) $(CONFIG_CFLAGS) $(PY_LINK_PART) $(LWS_LIBS) -o $@
$(PY)/parts/page.html $(PY)/parts/page.csp: build/view/page.html
	@mkdir -p $(@D)
	cp build/view/$(@F) $@
ifneq ($(filter yes made,$(VIEW_PAGE)),)
$(PY)/tools/view/view_serve.o: build/view/page.html build/view/page.csp.line
endif

-include $(PY_SOURCES:%.c=$(B)/%.d) $(PY_LOADED:.o=.d) $(PY_VIEW_SERVER:.o=.d) $(PY_CHOSEN:.o=.d)
