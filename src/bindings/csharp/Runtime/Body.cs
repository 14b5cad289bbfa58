// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.Runtime.InteropServices;

namespace Dynpoint
{
    /// <summary>A body of a world.</summary>
    public unsafe class Body : Member
    {
        private readonly Block memory;
        private bool isGone;

        internal Body(World world, Mesh mesh, uint id, Block memory) : base(world, id)
        {
            Mesh = mesh;
            this.memory = memory;
        }

        public Mesh Mesh { get; private set; }

        /// <summary>The last valid pose. To set it sweeps the motion; Teleport jumps.</summary>
        public Pose Pose
        {
            get
            {
                Pose pose;
                Finish(Native.dpt_body_get_pose(World.Enter("Body.Pose"), Id, &pose), "Body.Pose");
                return pose;
            }
            set { Finish(Native.dpt_body_set_pose(World.Enter("Body.Pose"), Id, &value), "Body.Pose"); }
        }

        public void Teleport(Pose pose)
        {
            Finish(Native.dpt_body_teleport(World.Enter("Body.Teleport"), Id, &pose), "Body.Teleport");
        }

        /// <summary>To change one: get, change, set.</summary>
        public BodySettings Settings
        {
            get
            {
                BodySettings settings = BodySettings.Sized();
                Finish(Native.dpt_body_get_settings(World.Enter("Body.Settings"), Id, &settings), "Body.Settings");
                return settings;
            }
            set
            {
                value.Size = (uint)sizeof(BodySettings);
                Finish(Native.dpt_body_set_settings(World.Enter("Body.Settings"), Id, &value), "Body.Settings");
            }
        }

        /// <summary>Coulomb friction of contacts that stick, and of those that slip.</summary>
        public void SetFriction(double still, double moving)
        {
            BodySettings settings = Settings;
            settings.StaticFriction = still;
            settings.KineticFriction = moving;
            Settings = settings;
        }

        /// <summary>What all tools do to it in the last step.</summary>
        public Wrench Wrench
        {
            get
            {
                Wrench wrench;
                Finish(Native.dpt_body_get_wrench(World.Enter("Body.Wrench"), Id, &wrench), "Body.Wrench");
                return wrench;
            }
        }

        public bool IsValid
        {
            get
            {
                bool isValid = Native.dpt_body_is_valid(World.Enter("Body.IsValid"), Id) != 0;
                World.Leave();
                return isValid;
            }
        }

        /// <summary>Takes it out of its world.</summary>
        public void Remove()
        {
            Result result = Native.dpt_body_remove(World.Enter("Body.Remove"), Id);
            if (result == Result.Ok)
            {
                World.Forget(this);
                LetGo();
            }
            Finish(result, "Body.Remove");
        }

        internal void LetGo()
        {
            if (isGone) return;
            isGone = true;
            Mesh.Leave();
            if (memory != null) memory.Dispose();
        }
    }

    /// <summary>A body whose vertices are moved: by you, or by Springs. Numbers of vertices are those of
    /// Mesh.GetVertices.</summary>
    public sealed unsafe class DeformableBody : Body
    {
        internal DeformableBody(World world, Mesh mesh, uint id, Block memory) : base(world, mesh, id, memory)
        {
        }

        /// <summary>The def of a body with the defaults, to change some of it.</summary>
        public static DeformableDef Defaults()
        {
            Library.Load();
            DeformableDef def;
            Native.dpt_deformable_def_defaults(&def, (UIntPtr)sizeof(DeformableDef));
            return def;
        }

        /// <summary>Moves vertices, from `first` on: three coordinates each, in the body's frame, m. None moves farther
        /// than `bound`; below 0 it is measured.</summary>
        public void SetVertices(float[] positions, int first = 0, double bound = -1)
        {
            if (positions == null) throw new ArgumentNullException("positions");
            fixed (float* p = positions) SetVertices(p, positions.Length, first, bound);
        }

#if DYNPOINT_SPAN || NETCOREAPP || NETSTANDARD2_1_OR_GREATER || UNITY_2021_2_OR_NEWER
        /// <summary>The same.</summary>
        public void SetVertices(ReadOnlySpan<float> positions, int first = 0, double bound = -1)
        {
            fixed (float* p = &MemoryMarshal.GetReference(positions)) SetVertices(p, positions.Length, first, bound);
        }
#endif

        private void SetVertices(float* positions, int length, int first, double bound)
        {
            const string what = "DeformableBody.SetVertices";
            if (length % 3 != 0) throw new ArgumentException(what + ": wanted three numbers for each vertex");
            IntPtr world = World.Enter(what);
            Finish(Native.dpt_body_set_vertices(world, Id, (uint)first, (uint)(length / 3), positions, bound), what);
        }

        /// <summary>Moves the vertices with the nodes that they are embedded in: three numbers for each of all
        /// nodes.</summary>
        public void SetNodes(float[] nodes)
        {
            const string what = "DeformableBody.SetNodes";
            if (nodes == null) throw new ArgumentNullException("nodes");
            IntPtr world = World.Enter(what);
            uint* numbers;
            float* weights;
            uint count;
            Result result = Native.dpt_mesh_get_embedding(Mesh.Address, &numbers, &weights, &count);
            bool isRight = result != Result.Ok || nodes.Length == 3 * (long)count;
            if (result == Result.Ok && isRight)
                fixed (float* n = nodes) result = Native.dpt_body_set_nodes(world, Id, n);
            Finish(result, what);
            if (!isRight) throw new ArgumentException(what + ": wanted " + 3 * (long)count + " numbers, not "
                                                      + nodes.Length);
        }

        /// <summary>Where the vertices are, in the body's frame, m: a copy.</summary>
        public float[] GetVertices()
        {
            const string what = "DeformableBody.GetVertices";
            float* xyz;
            uint count;
            float[] copy = null;
            Result result = Native.dpt_body_get_vertices(World.Enter(what), Id, &xyz, &count);
            if (result == Result.Ok) Marshal.Copy((IntPtr)xyz, copy = new float[3 * (long)count], 0, (int)(3 * count));
            Finish(result, what);
            return copy;
        }

        /// <summary>What tools do to vertices in the last step, for whoever owns the physics.</summary>
        public Load[] GetLoads()
        {
            const string what = "DeformableBody.GetLoads";
            Load[] loads = new Load[256];
            while (true)
            {
                uint count;
                Result result;
                fixed (Load* l = loads)
                    result = Native.dpt_body_get_loads(World.Enter(what), Id, l, (uint)loads.Length, &count);
                bool isTooSmall = result == Result.EFull && count > loads.Length;
                Finish(isTooSmall ? Result.Ok : result, what);
                Array.Resize(ref loads, (int)count);
                if (!isTooSmall) return loads;
            }
        }

        /// <summary>After a step of the world: the springs go on by dt, and the vertices with them. Null for a body with
        /// a compliance. See dpt_body_step_springs.</summary>
        public SpringsInfo StepSprings(Springs springs, double dt)
        {
            const string what = "DeformableBody.StepSprings";
            SpringsInfo info = SpringsInfo.Sized();
            IntPtr address = springs == null ? IntPtr.Zero : springs.Enter(what);
            try
            {
                Finish(Native.dpt_body_step_springs(World.Enter(what), Id, address, dt, &info), what);
            }
            finally
            {
                if (springs != null) springs.Leave();
            }
            return info;
        }
    }
}
