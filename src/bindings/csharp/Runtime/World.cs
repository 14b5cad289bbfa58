// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.Collections.Generic;

namespace Dynpoint
{
    /// <summary>
    /// Bodies, and tools that feel them. One thread at a time may be in it, its bodies and its tools: a second one gets
    /// an InvalidOperationException, and nothing happens. Different worlds may run in different threads, and share
    /// meshes.
    /// </summary>
    public sealed unsafe class World : Exclusive, IDisposable
    {
        private readonly Block block;
        private readonly List<Body> bodies = new List<Body>();

        /// <summary>With the defaults: a proxy of 500 N/m for each tool, 16 bodies, 4 tools.</summary>
        public World() : this(Defaults())
        {
        }

        /// <summary>See dpt_world_def. Of the def, pointers are not used.</summary>
        public World(WorldDef def)
        {
            Library.Load();
            def.Size = (uint)sizeof(WorldDef);
            def.Baseline = def.ReservedPointer = IntPtr.Zero;
            UIntPtr bytes = Native.dpt_world_bytes(&def);
            if (bytes == UIntPtr.Zero) throw DynpointException.Make(Result.EArgument, "World", null);
            block = new Block(bytes);
            IntPtr world;
            Result result = Native.dpt_world_create((void*)block.Start, bytes, &def, &world);
            if (result != Result.Ok) block.Dispose();
            DynpointException.Check(result, "World");
            Address = world;
        }

        /// <summary>The def of a world with the defaults, to change some of it.</summary>
        public static WorldDef Defaults()
        {
            Library.Load();
            WorldDef def;
            Native.dpt_world_def_defaults(&def, (UIntPtr)sizeof(WorldDef));
            return def;
        }

        /// <summary>One tick of dt seconds.</summary>
        public void Step(double dt)
        {
            Result result = Native.dpt_world_step(Enter("World.Step"), dt, null);
            Leave();
            if (result != Result.Ok) throw DynpointException.Make(result, "World.Step", null);
        }

        /// <summary>One tick, and what it found over all tools.</summary>
        public Step Report(double dt)
        {
            Step step = Dynpoint.Step.Sized();
            Result result = Native.dpt_world_step(Enter("World.Report"), dt, &step);
            Leave();
            DynpointException.Check(result, "World.Report");
            return step;
        }

        /// <summary>A rigid body at the origin.</summary>
        public Body AddBody(Mesh mesh)
        {
            return AddBody(mesh, Pose.Identity);
        }

        /// <summary>A rigid body. It stays until it is removed, and keeps the mesh's memory.</summary>
        public Body AddBody(Mesh mesh, Pose pose)
        {
            if (mesh == null) throw new ArgumentNullException("mesh");
            IntPtr opened = mesh.Enter();
            try
            {
                uint id;
                Body body = null;
                Result result = Native.dpt_body_add(Enter("World.AddBody"), opened, &pose, &id);
                if (result == Result.Ok) bodies.Add(body = new Body(this, mesh, id, null));
                Leave();
                DynpointException.Check(result, "World.AddBody");
                opened = IntPtr.Zero;
                return body;
            }
            finally
            {
                if (opened != IntPtr.Zero) mesh.Leave();
            }
        }

        /// <summary>A body whose vertices are moved, by you or by Springs.</summary>
        public DeformableBody AddDeformable(Mesh mesh)
        {
            return AddDeformable(mesh, DeformableBody.Defaults(), Pose.Identity);
        }

        /// <summary>See dpt_deformable_def. Of the def, pointers are not used.</summary>
        public DeformableBody AddDeformable(Mesh mesh, DeformableDef def, Pose pose)
        {
            if (mesh == null) throw new ArgumentNullException("mesh");
            Block memory = null;
            IntPtr opened = mesh.Enter();
            try
            {
                def.Size = (uint)sizeof(DeformableDef);
                def.Mesh = opened;
                def.Pose = (IntPtr)(&pose);
                def.Compliances = def.ReservedPointer = IntPtr.Zero;
                UIntPtr bytes = Native.dpt_deformable_bytes(&def);
                if (bytes == UIntPtr.Zero) throw DynpointException.Make(Result.EArgument, "World.AddDeformable", null);
                memory = new Block(bytes);
                uint id;
                DeformableBody body = null;
                Result result = Native.dpt_body_add_deformable(Enter("World.AddDeformable"), (void*)memory.Start, bytes,
                    &def, &id);
                if (result == Result.Ok) bodies.Add(body = new DeformableBody(this, mesh, id, memory));
                Leave();
                DynpointException.Check(result, "World.AddDeformable");
                opened = IntPtr.Zero;
                return body;
            }
            finally
            {
                if (opened != IntPtr.Zero)
                {
                    mesh.Leave();
                    if (memory != null) memory.Dispose();
                }
            }
        }

        /// <summary>A tool of capsules in its own frame.</summary>
        public Tool AddTool(params Segment[] segments)
        {
            if (segments == null) throw new ArgumentNullException("segments");
            uint id;
            Result result;
            fixed (Segment* s = segments)
                result = Native.dpt_tool_add(Enter("World.AddTool"), s, (uint)segments.Length, &id);
            Leave();
            DynpointException.Check(result, "World.AddTool");
            return new Tool(this, id);
        }

        /// <summary>Forgets all earlier steps. Poses and settings stay.</summary>
        public void Reset()
        {
            Result result = Native.dpt_world_reset(Enter("World.Reset"));
            Leave();
            DynpointException.Check(result, "World.Reset");
        }

        /// <summary>The most that it has used at one time.</summary>
        public WorldInfo Info
        {
            get
            {
                WorldInfo info = WorldInfo.Sized();
                Result result = Native.dpt_world_get_info(Enter("World.Info"), &info);
                Leave();
                DynpointException.Check(result, "World.Info");
                return info;
            }
        }

        /// <summary>Several bodies go on by dt, each by its springs: a tool that touches more than one is solved for with
        /// all that it touches. See dpt_bodies_step_springs. A null among the springs is a body with a
        /// compliance.</summary>
        public void StepSprings(DeformableBody[] moved, Springs[] springs, double dt)
        {
            if (moved == null) throw new ArgumentNullException("moved");
            if (springs == null) throw new ArgumentNullException("springs");
            if (moved.Length != springs.Length)
                throw new ArgumentException("World.StepSprings: wanted springs for each body");
            uint[] ids = new uint[moved.Length];
            IntPtr[] addresses = new IntPtr[moved.Length];
            int entered = 0;
            Result result;
            try
            {
                for (; entered < moved.Length; entered++)
                {
                    if (moved[entered] == null || moved[entered].World != this)
                        throw new ArgumentException("World.StepSprings: wanted bodies of this world");
                    ids[entered] = moved[entered].Id;
                    if (springs[entered] != null) addresses[entered] = springs[entered].Enter("World.StepSprings");
                }
                fixed (uint* i = ids)
                fixed (IntPtr* s = addresses)
                    result = Native.dpt_bodies_step_springs(Enter("World.StepSprings"), i, s, (uint)ids.Length, dt, null);
                Leave();
            }
            finally
            {
                while (entered-- > 0)
                    if (springs[entered] != null) springs[entered].Leave();
            }
            DynpointException.Check(result, "World.StepSprings");
        }

        internal void Forget(Body body)
        {
            bodies.Remove(body);
        }

        /// <summary>Its bodies and tools go with it.</summary>
        public void Dispose()
        {
            if (!EnterToClose("World.Dispose")) return;
            Address = IntPtr.Zero;
            block.Dispose();
            foreach (Body body in bodies) body.LetGo();
            bodies.Clear();
            Leave();
        }
    }
}
