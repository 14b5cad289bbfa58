# SPDX-License-Identifier: BSD-3-Clause
# WebAssembly by clang and lld: the core, which is freestanding, and the compiler, which has what it needs of a C library
# in itself (wasi-libc). Neither asks its host for anything. dynpoint.js is their layer in JavaScript.
WASM := build/wasm
CLANG ?= clang
WASM_FLAGS := -std=gnu99 -O3 $(EXACT) $(WARNINGS) -Wno-shorten-64-to-32 -msimd128 -mbulk-memory -fvisibility=hidden -MMD -MP $(INCLUDES)
WASM_LINK := -Wl,--gc-sections,--strip-all,--stack-first,-z,stack-size=1048576
wasm_objects = $(patsubst %.c,$(WASM)/$1/%.o,$(wildcard $2))
WASM_CORE := $(call wasm_objects,core,$(FOLDERS:%=src/%/*.c) src/bindings/wasm/memcmp.c)
# The compiler uses folders of the core; the links leave out what is not called.
WASM_COMPILE := $(call wasm_objects,compile,$(patsubst %,src/%/*.c,compile text base mesh arm) src/bindings/wasm/no_files.c)
WASM_COMPILE_CALLS := malloc free dpt_version dpt_result_name dpt_compile_def_defaults dpt_compile_bytes dpt_compile_arrays \
  dpt_compiled_free dpt_spring_net_def_defaults

.PHONY: wasm
wasm: $(WASM)/dynpoint.wasm $(WASM)/dynpoint_compile.wasm $(WASM)/dynpoint.js ## the core and the compiler for browsers and node (make deps wasm)

$(WASM)/core/%.o: %.c
	@mkdir -p $(@D)
	$(CLANG) --target=wasm32 $(WASM_FLAGS) -Isrc/bindings/wasm/include -c $< -o $@
$(WASM)/core/src/kernel/kernel_scalar.o: WASM_FLAGS += -fno-vectorize
# Else the loop would become a call of itself.
$(WASM)/core/src/bindings/wasm/memcmp.o: WASM_FLAGS += -fno-builtin

# Without that model of threads clang 14 fails on errno.
$(WASM)/compile/%.o: %.c
	@mkdir -p $(@D)
	$(CLANG) --target=wasm32-wasi $(WASM_FLAGS) -ftls-model=local-exec -c $< -o $@

$(WASM)/dynpoint.wasm: $(WASM_CORE)
	$(CLANG) --target=wasm32 -nostdlib $(WASM_LINK) -Wl,--no-entry,--export-dynamic,--export=__heap_base $^ -o $@

$(WASM)/dynpoint_compile.wasm: $(WASM_COMPILE)
	$(CLANG) --target=wasm32-wasi -mexec-model=reactor $(WASM_LINK) $(WASM_COMPILE_CALLS:%=-Wl,--export=%) \
	  $(patsubst %,-Wl$(comma)--wrap=__wasi_fd_%,close seek write) $^ -o $@

$(WASM)/layouts.wasm: src/bindings/wasm/wasm_layouts.c tests/abi/layouts.txt $(wildcard include/*.h include/dynpoint/*.h)
	@mkdir -p $(@D)
	$(CLANG) --target=wasm32-wasi -std=gnu11 -nostdlib -Iinclude -Itests/abi -Wl,--no-entry,--export=get_layout_rows $< -o $@

$(WASM)/dynpoint.js: $(wildcard src/bindings/wasm/*.js) tools/packaging/wasm_layer.js $(WASM)/layouts.wasm
	$(NODE) tools/packaging/wasm_layer.js $(WASM)/layouts.wasm src/bindings/wasm/dynpoint.js >$@.new
	mv $@.new $@

-include $(WASM_CORE:.o=.d) $(WASM_COMPILE:.o=.d)
