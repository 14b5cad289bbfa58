# SPDX-License-Identifier: BSD-3-Clause
# C#: one native library of the core, the compiler, the drivers, curved tips and the host; declarations made from the
# ABI's model; sources in the layout of a package of Unity, and a package of NuGet. Mono's mcs compiles them here.
CS := $(B)/csharp
MCS ?= mcs
# As .NET names the platform that is built for: the folder of the native library in the packages.
CS_SYSTEM := $(if $(filter windows,$(PLATFORM)),win,$(if $(filter macos,$(PLATFORM)),osx,linux))
RID ?= $(CS_SYSTEM)-$(if $(filter aarch64% arm64%,$(MACHINE)),arm64,x64)
CS_NAME_win := dynpoint_all.dll
CS_NAME_osx := libdynpoint_all.dylib
CS_NAME_linux := libdynpoint_all.so
CS_LIBRARY := $(CS_NAME_$(CS_SYSTEM))
CS_NATIVE := $(CS)/native/$(RID)/$(CS_LIBRARY)
CS_SOURCES := $(wildcard src/bindings/csharp/Runtime/*.cs)
CS_MADE := $(CS)/generated/Native.cs
CS_ALL := $(CS_SOURCES) $(addprefix $(CS)/generated/,Native.cs Enums.cs Structs.cs)

.PHONY: csharp csharp-native nupkg
csharp-native: $(CS_NATIVE) ## the native library of the packages of C# and Java, for this platform, or for that of CC
csharp: $(CS)/Dynpoint.dll ## Dynpoint.dll and its native library beside it, in build/csharp (make deps languages)

CS_OBJECTS := $(sort $(CORE) $(COMPILE) $(TEXT) $(DRIVER_PARTS) $(CONVEX_PARTS) $(HOST))
ifeq ($(CS_SYSTEM),linux)
CS_LINK := -Wl,-soname,$(CS_LIBRARY) -Wl,--version-script=src/symbols.map
else ifeq ($(CS_SYSTEM),win)
CS_LINK := $(CS)/dynpoint_all.def
$(CS_NATIVE): $(CS_LINK)
$(CS_LINK): $(CS_OBJECTS)
	@mkdir -p $(@D)
	{ echo EXPORTS; $(NM) -g $^ | sed -n 's/^[0-9a-f]* T \(dpt_[a-z0-9_]*\)$$/\1/p' | sort -u; } >$@
endif
$(CS_NATIVE): $(CS_OBJECTS)
	@mkdir -p $(@D)
	$(CC) $(CONFIG_CFLAGS) $(LDFLAGS) -shared $(CS_LINK) $(CS_OBJECTS) \
	  $(CONVEX_LIBS) $(JANSSON_LIBS) $(PLATFORM_LIBS) -lm $(THREADS) $(DL) -o $@

$(CS_MADE): $(B)/abi.json tools/packaging/abi_csharp.py
	@mkdir -p $(@D)
	$(PYTHON) -B tools/packaging/abi_csharp.py $(B)/abi.json $(@D)

# Beside it lies what it loads.
$(CS)/Dynpoint.dll: $(CS_SOURCES) $(CS_MADE) $(CS_NATIVE)
	cp $(CS_NATIVE) $(CS)
	$(MCS) -nologo -warnaserror -nowarn:1591 -unsafe -optimize -d:DYNPOINT_SPAN -target:library -doc:$(CS)/Dynpoint.xml \
	  -out:$@ $(CS_ALL)

# Mono has spans in its mscorlib, .NET has not: in what any of them is to load there are none.
CS_NUGET := $(CS)/nuget/Dynpoint.dll
$(CS_NUGET): $(CS_SOURCES) $(CS_MADE)
	@mkdir -p $(@D)
	$(MCS) -nologo -warnaserror -nowarn:1591 -unsafe -optimize -target:library -doc:$(CS)/nuget/Dynpoint.xml -out:$@ \
	  $(CS_ALL)

nupkg: $(CS_NUGET) $(CS_NATIVE) ## packages of Unity and NuGet, with build/csharp/native/*: not run in Unity or .NET
	$(PYTHON) -B tools/packaging/csharp_package.py $(VERSION) $(CS)
