# SPDX-License-Identifier: BSD-3-Clause
# Java: declarations made from the ABI's model, for the sample in src/bindings/java. Its native library is that of C#.
.PHONY: java-sources
java-sources: $(B)/java/dynpoint/Abi.java ## the declarations for Java's foreign functions, build/java/dynpoint/Abi.java

$(B)/java/dynpoint/Abi.java: $(B)/abi.json tools/packaging/abi_java.py
	@mkdir -p $(@D)
	$(PYTHON) -B tools/packaging/abi_java.py $(B)/abi.json >$@.new && mv $@.new $@
