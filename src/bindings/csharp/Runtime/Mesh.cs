// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.IO;
using System.Runtime.InteropServices;

namespace Dynpoint
{
    /// <summary>Masses and springs that Mesh.Compile makes; see dpt_spring_net_def.</summary>
    public sealed class SpringNet
    {
        /// <summary>Numbers: 0 is the default. Its pointers and counts are not used.</summary>
        public SpringNetDef Def;

        /// <summary>Where the body is of another material, or fixed; null: nowhere.</summary>
        public SpringRegion[] Regions;

        /// <summary>Vertices that do not move, by their numbers in the source; null: none.</summary>
        public uint[] Fixed;

        public unsafe SpringNet(Net kind)
        {
            Library.Load();
            SpringNetDef def;
            Native.dpt_spring_net_def_defaults(&def, (UIntPtr)sizeof(SpringNetDef));
            def.Kind = kind;
            Def = def;
        }
    }

    /// <summary>How a mesh is compiled; see dpt_compile_def. What is 0 is the default.</summary>
    public sealed class CompileOptions
    {
        /// <summary>Angle between normals from which on an edge is a crease, rad.</summary>
        public double Crease;

        /// <summary>The most threads that it uses; the bytes are the same for any number.</summary>
        public int Threads;

        /// <summary>Moves the mesh near the origin; Mesh.Info.Origin says by how much.</summary>
        public bool Recentre;

        /// <summary>Null: no springs.</summary>
        public SpringNet Springs;
    }

    /// <summary>
    /// A compiled mesh. It does not change, and all threads may share it. After Dispose its methods throw; a world that
    /// has a body of it keeps its memory as long as it is needed.
    /// </summary>
    public sealed unsafe class Mesh : IDisposable
    {
        private readonly Memory memory;
        private readonly IntPtr mesh;

        private Mesh(Memory memory, string what)
        {
            IntPtr opened;
            Result result = Native.dpt_mesh_open((void*)memory.Start, memory.Bytes, &opened);
            if (result != Result.Ok)
            {
                memory.Dispose();
                throw DynpointException.Make(result, what, null);
            }
            this.memory = memory;
            mesh = opened;
        }

        /// <summary>The bytes of a compiled mesh, a .dpa file. They are copied.</summary>
        public static Mesh Open(byte[] file)
        {
            if (file == null) throw new ArgumentNullException("file");
            Library.Load();
            Block block = new Block((UIntPtr)file.Length);
            Marshal.Copy(file, 0, block.Start, file.Length);
            return new Mesh(block, "Mesh.Open");
        }

        /// <summary>A compiled mesh (.dpa).</summary>
        public static Mesh Load(string path)
        {
            return Open(File.ReadAllBytes(path));
        }

        /// <summary>A file of triangles (OBJ, STL, PLY, OFF), compiled; 0.001 metres per unit is one of
        /// millimetres.</summary>
        public static Mesh Load(string path, double metresPerUnit, CompileOptions options = null)
        {
            if (path == null) throw new ArgumentNullException("path");
            Library.Load();
            using (Setup setup = new Setup(metresPerUnit, options, "Mesh.Load"))
            {
                CompileDef def = setup.Def;
                Compiled made;
                Diag diag = Diag.Sized();
                fixed (byte* name = Utf8.Bytes(path))
                {
                    Result result = Native.dpt_compile_file(name, &def, &made, &diag);
                    return Take(result, made, diag, path);
                }
            }
        }

        /// <summary>Triangles from arrays: three coordinates a vertex, three vertices a triangle, seen from outside
        /// against the clock.</summary>
        public static Mesh Compile(double[] vertices, int[] corners, double metresPerUnit = 1,
                                   CompileOptions options = null)
        {
            if (vertices == null) throw new ArgumentNullException("vertices");
            if (corners == null) throw new ArgumentNullException("corners");
            if (vertices.Length % 3 != 0 || corners.Length % 3 != 0)
                throw new ArgumentException("Mesh.Compile: wanted three numbers for each vertex and each triangle");
            Library.Load();
            using (Setup setup = new Setup(metresPerUnit, options, "Mesh.Compile"))
            {
                CompileDef def = setup.Def;
                Compiled made;
                Diag diag = Diag.Sized();
                fixed (double* v = vertices)
                fixed (int* c = corners)
                {
                    Result result = Native.dpt_compile_arrays(v, (UIntPtr)(vertices.Length / 3), (uint*)c,
                                                              (UIntPtr)(corners.Length / 3), &def, &made, &diag);
                    return Take(result, made, diag, "Mesh.Compile");
                }
            }
        }

        private static Mesh Take(Result result, Compiled made, Diag diag, string what)
        {
            if (result == Result.Ok) return new Mesh(new CompiledBytes(made), what);
            string place = diag.Line > 0 ? "line " + diag.Line + ": " : "";
            throw DynpointException.Make(result, what, place + diag.Text);
        }

        /// <summary>For a body that keeps its memory.</summary>
        internal IntPtr Address
        {
            get { return mesh; }
        }

        internal IntPtr Enter()
        {
            memory.Enter("Mesh");
            return mesh;
        }

        internal void Leave()
        {
            memory.Leave();
        }

        /// <summary>What the compiler found and repaired, and what the file holds.</summary>
        public MeshInfo Info
        {
            get
            {
                MeshInfo info = MeshInfo.Sized();
                Result result = Native.dpt_mesh_get_info(Enter(), &info);
                Leave();
                DynpointException.Check(result, "Mesh.Info");
                return info;
            }
        }

        /// <summary>Three coordinates a vertex, m: a copy.</summary>
        public float[] GetVertices()
        {
            float* xyz;
            uint count;
            Result result = Native.dpt_mesh_get_vertices(Enter(), &xyz, &count);
            float[] copy = result == Result.Ok ? new float[3 * (long)count] : null;
            if (copy != null && count > 0) Marshal.Copy((IntPtr)xyz, copy, 0, copy.Length);
            Leave();
            DynpointException.Check(result, "Mesh.GetVertices");
            return copy;
        }

        /// <summary>Three vertices a triangle, as the compiler wound it: a copy.</summary>
        public int[] GetTriangles()
        {
            uint* corners;
            uint count;
            Result result = Native.dpt_mesh_get_triangles(Enter(), &corners, null, &count);
            return Copy(result, corners, 3 * (long)count, "Mesh.GetTriangles");
        }

        /// <summary>The number in the source of each vertex: a copy. For a program that moves its own vertices.</summary>
        public int[] GetVertexSources()
        {
            uint* sources;
            uint count;
            Result result = Native.dpt_mesh_get_vertex_sources(Enter(), &sources, &count);
            return Copy(result, sources, count, "Mesh.GetVertexSources");
        }

        /// <summary>The end of a call that began with Enter.</summary>
        private int[] Copy(Result result, uint* numbers, long count, string what)
        {
            int[] copy = result == Result.Ok ? new int[count] : null;
            if (copy != null && count > 0) Marshal.Copy((IntPtr)numbers, copy, 0, copy.Length);
            Leave();
            DynpointException.Check(result, what);
            return copy;
        }

        /// <summary>The bytes of the .dpa file: a copy.</summary>
        public byte[] ToBytes()
        {
            Enter();
            byte[] copy = new byte[(long)(ulong)memory.Bytes];
            Marshal.Copy(memory.Start, copy, 0, copy.Length);
            Leave();
            return copy;
        }

        /// <summary>The nearest pair of each of n segments and the mesh: ends are 6 n numbers, ax, ay, az, bx, by, bz;
        /// radii n, or null for 0.</summary>
        public Hit[] Query(double[] ends, double[] radii = null, bool pairOnly = false)
        {
            if (ends == null) throw new ArgumentNullException("ends");
            if (ends.Length % 6 != 0 || (radii != null && radii.Length != ends.Length / 6))
                throw new ArgumentException("Mesh.Query: wanted six numbers for each segment, and one radius or none");
            Hit[] hits = new Hit[ends.Length / 6];
            fixed (double* e = ends)
            fixed (double* r = radii)
            fixed (Hit* h = hits)
                Query(e, r, h, hits.Length, pairOnly);
            return hits;
        }

#if DYNPOINT_SPAN || NETCOREAPP || NETSTANDARD2_1_OR_GREATER || UNITY_2021_2_OR_NEWER
        /// <summary>The same without a new array: as many hits as segments.</summary>
        public void Query(ReadOnlySpan<double> ends, ReadOnlySpan<double> radii, Span<Hit> hits, bool pairOnly = false)
        {
            if (ends.Length != 6 * hits.Length || (radii.Length != 0 && radii.Length != hits.Length))
                throw new ArgumentException("Mesh.Query: wanted six numbers, a hit, a radius or none for each segment");
            fixed (double* e = &MemoryMarshal.GetReference(ends))
            fixed (double* r = &MemoryMarshal.GetReference(radii))
            fixed (Hit* h = &MemoryMarshal.GetReference(hits))
                Query(e, radii.Length == 0 ? null : r, h, hits.Length, pairOnly);
        }
#endif

        private void Query(double* ends, double* radii, Hit* hits, int count, bool pairOnly)
        {
            QueryDef def = QueryDef.Sized();
            def.Pair = pairOnly ? 1u : 0u;
            IntPtr entered = Enter();
            if (count > 0) hits[0].Size = (uint)sizeof(Hit);
            Result result = Native.dpt_query_segments(entered, null, ends, radii, (UIntPtr)count, hits, &def);
            Leave();
            DynpointException.Check(count > 0 ? result : Result.Ok, "Mesh.Query");
        }

        /// <summary>The memory goes once no body needs it any more.</summary>
        public void Dispose()
        {
            memory.CloseWhenUnused();
        }

        /// <summary>A def, and arrays that it points to, which stay until it is disposed of.</summary>
        private sealed class Setup : IDisposable
        {
            private GCHandle regions, vertices;
            private IntPtr springs;

            internal CompileDef Def;

            internal Setup(double metresPerUnit, CompileOptions options, string what)
            {
                if (!(metresPerUnit > 0) || double.IsInfinity(metresPerUnit))
                    throw new ArgumentOutOfRangeException("metresPerUnit", what + ": wanted metres per unit, above 0");
                CompileDef def;
                Native.dpt_compile_def_defaults(&def, (UIntPtr)sizeof(CompileDef));
                def.Scale = metresPerUnit;
                if (options != null)
                {
                    if (options.Crease != 0) def.Crease = options.Crease;
                    if (options.Threads != 0) def.Threads = (uint)options.Threads;
                    def.Recentre = options.Recentre ? 1u : 0u;
                    if (options.Springs != null) def.Springs = KeepSprings(options.Springs);
                }
                Def = def;
            }

            private IntPtr KeepSprings(SpringNet net)
            {
                SpringNetDef def = net.Def;
                def.Size = (uint)sizeof(SpringNetDef);
                def.Regions = Keep(net.Regions, out def.RegionCount, ref regions);
                def.Fixed = Keep(net.Fixed, out def.FixedCount, ref vertices);
                springs = Marshal.AllocHGlobal(sizeof(SpringNetDef));
                *(SpringNetDef*)springs = def;
                return springs;
            }

            private static IntPtr Keep(Array array, out uint count, ref GCHandle pin)
            {
                count = array == null ? 0 : (uint)array.Length;
                if (count == 0) return IntPtr.Zero;
                pin = GCHandle.Alloc(array, GCHandleType.Pinned);
                return pin.AddrOfPinnedObject();
            }

            public void Dispose()
            {
                if (regions.IsAllocated) regions.Free();
                if (vertices.IsAllocated) vertices.Free();
                if (springs != IntPtr.Zero) Marshal.FreeHGlobal(springs);
                springs = IntPtr.Zero;
            }
        }
    }
}
