# SPDX-License-Identifier: BSD-3-Clause
# The package of Python: one extension on the limited API of 3.11, of the core, the compiler, the drivers, the host and
# the sources here; the program beside it; the typed package on top. setup.py calls this for its two files, and packs
# them.
PY := $(B)/python
# From any folder.
PY_PYTHON = $(if $(findstring /,$(PYTHON)),$(abspath $(PYTHON)),$(PYTHON))
PY_SOURCES := $(wildcard src/bindings/python/*.c)
PY_INCLUDE = $(shell $(PYTHON) -c 'import sysconfig; print(sysconfig.get_path("include"))')
# What goes by built_with.h is compiled once more: a wheel has all drivers, and asks for urdfdom, libccd and libwebsockets
# when they are first needed (parts/): for each there is a library beside the extension, where this build could make it.
PY_CHOSEN := $(patsubst $(B)/%,$(PY)/%,$(CHOOSERS))
PY_LOADED := $(patsubst src/%.c,$(B)/src/%.o,$(wildcard src/bindings/python/parts/*.c))
PY_OBJECTS := $(filter-out $(CHOOSERS),$(CORE) $(TEXT) $(COMPILE) $(DRIVER_PARTS) $(HOST)) \
  $(filter $(PY)/drivers/% $(PY)/src/%,$(PY_CHOSEN)) $(PY_SOURCES:%.c=$(B)/%.o) \
  $(addprefix $(B)/,tools/view/scene_view.o tools/view/view_scene.o tools/view/view_stream.o) \
  $(filter-out %/part_view.o %/part_urdf.o,$(PY_LOADED))
PY_PROGRAM := $(filter-out $(CHOOSERS) $(VIEW_SERVER),$(TOOLS) $(PLATFORM_PROGRAM) $(SIMULATE) $(HOST) $(COMPILE) $(TEXT) $(DRIVER_PARTS) $(CORE)) \
  $(PY_CHOSEN) $(PY_LOADED)
PY_VIEW_SERVER := $(patsubst $(B)/%,$(PY)/%,$(VIEW_SERVER))
PY_PARTS := $(addprefix $(PY)/parts/,_dynpoint.abi3.so dynpoint $(if $(URDF_PARTS),libdynpoint_urdf.so) \
  $(if $(CONVEX_PARTS),libdynpoint_convex.so) $(if $(VIEW_SERVER),libdynpoint_view.so) \
  $(if $(filter yes made,$(VIEW_PAGE)),page.html page.csp))
PY_LINK = $(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -Wl,--gc-sections -Wl,-rpath,'$$ORIGIN'
PY_LINK_PART = $(LDFLAGS) -shared -Wl,--gc-sections,-z,defs -Wl,--version-script=src/bindings/python/parts/part.map $^ -lm $(THREADS) $(DL)

.PHONY: wheel wheel-release sdist python-parts
python-parts: $(PY_PARTS)

# What setup.py packs, apart from the tree: it writes beside what it reads.
PY_FILES := $(addprefix src/bindings/python/,setup.py pyproject.toml README.md)
PY_COPY = rm -rf $1 && mkdir -p $1 && cp $(PY_FILES) LICENSE $1 && mkdir $1/dynpoint && \
  cp src/bindings/python/dynpoint/*.py src/bindings/python/dynpoint/*.pyi src/bindings/python/dynpoint/py.typed $1/dynpoint

wheel: python-parts ## the package of Python, build/python/dynpoint-*.whl (make deps python)
	@rm -f $(PY)/dynpoint-*.whl
	$(call PY_COPY,$(PY)/package)
	cd $(PY)/package && DYNPOINT_TREE='$(CURDIR)' DYNPOINT_PARTS='$(abspath $(PY)/parts)' $(PY_PYTHON) setup.py --quiet bdist_wheel --dist-dir ..
	@ls $(PY)/dynpoint-*.whl

# zig's compiler links to the glibc that it is told, by headers of its own: those of jansson, which goes in, and of
# libccd, which does not, are copied out of the system's, or out of WHEEL_ROOT, where Debian's packages for another
# machine are unpacked. No library of C++ that zig links to is urdfdom's, and libwebsockets is not asked for: Python's
# own server is there.
WHEEL_FOR ?= x86_64
WHEEL_ROOT ?=
MANYLINUX := build/manylinux-$(WHEEL_FOR)
WHEEL_LIBS := $(WHEEL_ROOT)/usr/lib/$(WHEEL_FOR)-linux-gnu
WHEEL_HEADERS = $(wildcard $(foreach name,jansson.h jansson_config.h ccd, \
  $(WHEEL_ROOT)/usr/include/$(name) $(WHEEL_ROOT)/usr/include/$(WHEEL_FOR)-linux-gnu/$(name)))
wheel-release: ## the same for any Linux with glibc 2.28 (make deps wheels), with jansson inside; WHEEL_FOR=aarch64: for another machine
	rm -rf $(MANYLINUX)/include $(MANYLINUX)/dynpoint-*.whl && mkdir -p $(MANYLINUX)/include
	cp -R $(WHEEL_HEADERS) $(MANYLINUX)/include
	DYNPOINT_PLATFORM=linux_$(WHEEL_FOR) $(MAKE) wheel B=$(MANYLINUX) CC='$(PY_PYTHON) -m ziglang cc -target $(WHEEL_FOR)-linux-gnu.2.28' \
	  URDF=no LWS=no LDFLAGS=-Wl,-s \
	  JANSSON=yes JANSSON_CFLAGS='-I$(MANYLINUX)/include' JANSSON_LIBS='$(WHEEL_LIBS)/libjansson.so' \
	  CONVEX=yes CONVEX_CFLAGS='-I$(MANYLINUX)/include' CONVEX_LIBS='$(WHEEL_LIBS)/libccd.so'
	LD_LIBRARY_PATH="$(if $(WHEEL_ROOT),$(WHEEL_LIBS))" PATH="$(if $(findstring /,$(PYTHON)),$(dir $(PY_PYTHON)):)$$PATH" \
	  auditwheel repair --plat auto --exclude libccd.so.2 --wheel-dir $(MANYLINUX) $(MANYLINUX)/python/*.whl

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

$(PY)/parts/_dynpoint.abi3.so: $(PY_OBJECTS)
	@mkdir -p $(@D)
	$(PY_LINK) -shared -Wl,--version-script=src/bindings/python/python.map $^ -lm $(THREADS) $(DL) $(JANSSON_LIBS) -o $@
# The extension's own sources under sanitizers, for tests/python/sanitize.sh; the library's are there in the tests in C.
PY_SANITIZED := $(PY_SOURCES:%.c=$(PY)/sanitized/%.o)
$(PY_SANITIZED): CONFIG_CFLAGS += -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
$(PY)/sanitized/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -Itests/abi -Idrivers -Itools -isystem $(PY_INCLUDE) -c $< -o $@
$(PY)/sanitized/_dynpoint.abi3.so: $(PY_SANITIZED) $(filter-out $(PY_SOURCES:%.c=$(B)/%.o),$(PY_OBJECTS))
	$(PY_LINK) -fsanitize=address,undefined -shared -Wl,--version-script=src/bindings/python/python.map $^ -lm $(THREADS) $(DL) $(JANSSON_LIBS) -o $@
$(PY)/parts/dynpoint: $(PY_PROGRAM)
	@mkdir -p $(@D)
	$(PY_LINK) $(sort $^) -lm $(THREADS) $(DL) $(JANSSON_LIBS) -o $@

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
