# SPDX-License-Identifier: BSD-3-Clause
# The crates of Rust (docs/rust.md): sources of the tree, declarations made from the headers, and the single files.
RUST := $(B)/rust
RUST_TARGET = $(abspath $(RUST)/target)
RUST_SOURCES := $(wildcard $(addprefix src/bindings/rust/,README.md $(addprefix dynpoint*/,Cargo.toml *.rs src/*.rs)))

.PHONY: crate crate-sources
crate-sources: $(RUST)/crates/Cargo.toml

# The last file that is written: a tree that is whole has it.
$(RUST)/crates/Cargo.toml: $(B)/abi.json $(B)/amalgamation/LICENSE tools/packaging/abi_rust.py tests/abi/layouts.txt \
  $(RUST_SOURCES)
	@rm -rf $(@D) && mkdir -p $(@D)
	cp -R src/bindings/rust/dynpoint-sys src/bindings/rust/dynpoint $(@D)
	@mkdir $(@D)/dynpoint-sys/c && cp $(B)/amalgamation/*.[ch] $(@D)/dynpoint-sys/c
	@for crate in dynpoint-sys dynpoint; do cp LICENSE src/bindings/rust/README.md $(@D)/$$crate || exit 1; done
	$(PYTHON) -B tools/packaging/abi_rust.py $(B)/abi.json include tests/abi/layouts.txt \
	  $(@D)/dynpoint-sys/src/abi.rs $(@D)/dynpoint/src/plain.rs
	@printf '[workspace]\nmembers = ["dynpoint-sys", "dynpoint"]\nresolver = "2"\n' >$@

crate: crate-sources ## the crates of Rust, build/rust/target/package/*.crate (python3 with pycparser, cargo)
	cd $(RUST)/crates && cargo package --quiet --workspace --allow-dirty --target-dir '$(RUST_TARGET)' $(CARGO_FLAGS)
	@ls '$(RUST_TARGET)'/package/*.crate
