// SPDX-License-Identifier: BSD-3-Clause
package dynpoint;

import java.lang.foreign.Arena;
import java.lang.foreign.MemorySegment;
import java.lang.foreign.SymbolLookup;
import java.nio.file.Files;
import java.nio.file.Path;

/** The native library: libdynpoint_all.so of `make csharp-native`, in java.library.path or in LD_LIBRARY_PATH. */
final class Library {
    private static final SymbolLookup LOOKUP = load();

    private Library() {}

    static MemorySegment find(String name) {
        return LOOKUP.find(name).orElseThrow(() -> new UnsatisfiedLinkError("the native library has no " + name
            + ": it is older than these sources, or built without that part"));
    }

    private static SymbolLookup load() {
        String name = System.mapLibraryName("dynpoint_all"), paths = System.getProperty("java.library.path", "");
        for (String folder : paths.split(System.getProperty("path.separator")))
            if (Files.exists(Path.of(folder, name)))
                return SymbolLookup.libraryLookup(Path.of(folder, name), Arena.global());
        try {
            return SymbolLookup.libraryLookup(name, Arena.global());
        } catch (IllegalArgumentException error) {
            throw new UnsatisfiedLinkError(name + " was not found: it is looked for in java.library.path (" + paths
                + ") and where the system looks; `make csharp-native` builds it");
        }
    }

    /** A text of the library. */
    static String text(MemorySegment s) {
        return s.reinterpret(4096).getString(0);
    }

    static void check(int result, String what) {
        if (result != Abi.DPT_OK) throw new DynpointException(result, what, null);
    }
}
