// SPDX-License-Identifier: BSD-3-Clause
package dynpoint;

import static dynpoint.Abi.*;
import static java.lang.foreign.ValueLayout.*;

import java.lang.foreign.Arena;
import java.lang.foreign.MemorySegment;

/** A compiled mesh. It does not change, and threads share it. Its memory goes when nobody has it, a world included. */
public final class Mesh implements AutoCloseable {
    private final MemorySegment mesh;
    private volatile boolean isClosed;

    private Mesh(MemorySegment bytes, Arena arena, String what) {
        try (Arena call = Arena.ofConfined()) {
            MemorySegment out = call.allocate(ADDRESS);
            Library.check(dpt_mesh_open(bytes, bytes.byteSize(), out), what);
            mesh = out.get(ADDRESS, 0).reinterpret(arena, null);
        }
    }

    /** The bytes of a compiled mesh, a .dpa file. They are copied. */
    public static Mesh open(byte[] file) {
        Arena arena = Arena.ofAuto();
        MemorySegment bytes = arena.allocate(Math.max(file.length, 1), 64).asSlice(0, file.length);
        bytes.copyFrom(MemorySegment.ofArray(file));
        return new Mesh(bytes, arena, "Mesh.open");
    }

    /** A file of triangles (OBJ, STL, PLY, OFF), compiled; 0.001 metres per unit is one of millimetres. */
    public static Mesh load(String path, double metresPerUnit) {
        try (Arena call = Arena.ofConfined()) {
            MemorySegment made = call.allocate(dpt_compiled.LAYOUT), diag = dpt_diag.sized(call);
            int result = dpt_compile_file(call.allocateFrom(path), def(call, metresPerUnit), made, diag);
            return take(result, made, diag, path);
        }
    }

    /** Three coordinates a vertex, m; three vertices a triangle, seen from outside against the clock. */
    public static Mesh compile(double[] vertices, int[] corners) {
        if (vertices.length % 3 != 0 || corners.length % 3 != 0)
            throw new IllegalArgumentException("wanted three numbers for each vertex and each triangle");
        try (Arena call = Arena.ofConfined()) {
            MemorySegment made = call.allocate(dpt_compiled.LAYOUT), diag = dpt_diag.sized(call);
            return take(dpt_compile_arrays(call.allocateFrom(JAVA_DOUBLE, vertices), vertices.length / 3,
                                           call.allocateFrom(JAVA_INT, corners), corners.length / 3, def(call, 1),
                                           made, diag),
                        made, diag, "Mesh.compile");
        }
    }

    private static MemorySegment def(Arena call, double metresPerUnit) {
        if (!(metresPerUnit > 0)) throw new IllegalArgumentException("wanted metres per unit, above 0");
        MemorySegment def = call.allocate(dpt_compile_def.LAYOUT);
        dpt_compile_def_defaults(def, def.byteSize());
        dpt_compile_def.scale(def, metresPerUnit);
        return def;
    }

    private static Mesh take(int result, MemorySegment made, MemorySegment diag, String what) {
        if (result != DPT_OK) throw new DynpointException(result, what, dpt_diag.text(diag));
        Arena arena = Arena.ofAuto();
        MemorySegment bytes = dpt_compiled.bytes(made).reinterpret(dpt_compiled.size(made), arena, Mesh::free);
        return new Mesh(bytes, arena, what);
    }

    private static void free(MemorySegment bytes) {
        try (Arena call = Arena.ofConfined()) {
            MemorySegment made = call.allocate(dpt_compiled.LAYOUT);
            dpt_compiled.bytes(made, bytes);
            dpt_compiled_free(made);
        }
    }

    MemorySegment address() {
        if (isClosed) throw new IllegalStateException("the mesh is closed");
        return mesh;
    }

    /** The distances of segments and the mesh: six numbers each, ax, ay, az, bx, by, bz. */
    public double[] distances(double[] ends) {
        if (ends.length % 6 != 0) throw new IllegalArgumentException("wanted six numbers for each segment");
        int count = ends.length / 6;
        try (Arena call = Arena.ofConfined()) {
            MemorySegment hits = call.allocate(dpt_hit.LAYOUT, Math.max(count, 1)), def = dpt_query_def.sized(call);
            dpt_hit.size(hits, (int) dpt_hit.LAYOUT.byteSize());
            dpt_query_def.pair(def, 1);
            Library.check(dpt_query_segments(address(), MemorySegment.NULL, call.allocateFrom(JAVA_DOUBLE, ends),
                                             MemorySegment.NULL, count, hits, def), "Mesh.distances");
            double[] distances = new double[count];
            for (int i = 0; i < count; i++)
                distances[i] = dpt_hit.distance(hits.asSlice(i * dpt_hit.LAYOUT.byteSize()));
            return distances;
        }
    }

    /** From now on it is refused; bodies of it stay as they are. */
    @Override
    public void close() {
        isClosed = true;
    }
}
