// SPDX-License-Identifier: BSD-3-Clause
using System;

namespace Dynpoint
{
    /// <summary>
    /// Masses and springs of a mesh that was compiled with a SpringNet. DeformableBody.StepSprings steps them in a world,
    /// Step alone. One thread at a time may use them.
    /// </summary>
    public sealed unsafe class Springs : Exclusive, IDisposable
    {
        private readonly Block block;
        private readonly Mesh mesh;

        /// <summary>With the defaults, at rest.</summary>
        public Springs(Mesh mesh) : this(mesh, Defaults())
        {
        }

        /// <summary>See dpt_springs_def. Of the def, pointers are not used.</summary>
        public Springs(Mesh mesh, SpringsDef def)
        {
            if (mesh == null) throw new ArgumentNullException("mesh");
            def.Size = (uint)sizeof(SpringsDef);
            def.Mesh = mesh.Enter();
            def.ReservedPointer = IntPtr.Zero;
            Result result = Result.EUnsupported;
            IntPtr springs = IntPtr.Zero;
            UIntPtr bytes = Native.dpt_springs_bytes(&def);
            if (bytes != UIntPtr.Zero)
            {
                block = new Block(bytes);
                result = Native.dpt_springs_create((void*)block.Start, bytes, &def, &springs);
            }
            else if (mesh.Info.SpringNodes > 0)
            {
                result = Result.EArgument;
            }
            if (result != Result.Ok)
            {
                mesh.Leave();
                if (block != null) block.Dispose();
                throw DynpointException.Make(result, "Springs", null);
            }
            this.mesh = mesh;
            Address = springs;
        }

        /// <summary>The def of springs with the defaults, to change some of it.</summary>
        public static SpringsDef Defaults()
        {
            Library.Load();
            SpringsDef def;
            Native.dpt_springs_def_defaults(&def, (UIntPtr)sizeof(SpringsDef));
            return def;
        }

        /// <summary>How many nodes there are.</summary>
        public int Count
        {
            get
            {
                int count = (int)Native.dpt_springs_get_count(Enter("Springs.Count"));
                Leave();
                return count;
            }
        }

        /// <summary>The longest step that is stable, s; 0: none is.</summary>
        public double StableStep
        {
            get
            {
                double step = Native.dpt_springs_get_stable_step(Enter("Springs.StableStep"));
                Leave();
                return step;
            }
        }

        /// <summary>Goes on by dt, without a world, under these loads on nodes.</summary>
        public SpringsInfo Step(double dt, params Load[] loads)
        {
            SpringsInfo info = SpringsInfo.Sized();
            Result result;
            fixed (Load* l = loads)
                result = Native.dpt_springs_step(Enter("Springs.Step"), dt, l, loads == null ? 0 : (uint)loads.Length,
                                                 &info);
            Leave();
            DynpointException.Check(result, "Springs.Step");
            return info;
        }

        /// <summary>Where the nodes are, m: three numbers each.</summary>
        public float[] GetPositions()
        {
            IntPtr springs = Enter("Springs.GetPositions");
            float[] positions = new float[3 * (long)Native.dpt_springs_get_count(springs)];
            Result result;
            fixed (float* p = positions)
                result = Native.dpt_springs_get_nodes(springs, (uint)(positions.Length / 3), p, null);
            Leave();
            DynpointException.Check(result, "Springs.GetPositions");
            return positions;
        }

        /// <summary>Puts nodes, from `first` on, somewhere else, at rest.</summary>
        public void SetPositions(float[] positions, int first = 0)
        {
            if (positions == null) throw new ArgumentNullException("positions");
            if (positions.Length % 3 != 0)
                throw new ArgumentException("Springs.SetPositions: wanted three numbers for each node");
            Result result;
            fixed (float* p = positions)
                result = Native.dpt_springs_set_nodes(Enter("Springs.SetPositions"), (uint)first,
                                                      (uint)(positions.Length / 3), p, null);
            Leave();
            DynpointException.Check(result, "Springs.SetPositions");
        }

        /// <summary>J: what springs hold, and what moves.</summary>
        public void GetEnergy(out double elastic, out double kinetic)
        {
            double held, moving;
            Result result = Native.dpt_springs_get_energy(Enter("Springs.GetEnergy"), &held, &moving);
            Leave();
            DynpointException.Check(result, "Springs.GetEnergy");
            elastic = held;
            kinetic = moving;
        }

        public void Dispose()
        {
            if (!EnterToClose("Springs.Dispose")) return;
            Address = IntPtr.Zero;
            block.Dispose();
            mesh.Leave();
            Leave();
        }
    }
}
