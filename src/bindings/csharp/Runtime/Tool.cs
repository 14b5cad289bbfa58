// SPDX-License-Identifier: BSD-3-Clause
using System;

namespace Dynpoint
{
    /// <summary>A tool of a world: capsules that feel its bodies. Answers are those of the last step.</summary>
    public sealed unsafe class Tool : Member
    {
        internal Tool(World world, uint id) : base(world, id)
        {
        }

        /// <summary>Where the device holds it. To set it sweeps the motion; Teleport jumps.</summary>
        public Pose Pose
        {
            get
            {
                Pose pose;
                Finish(Native.dpt_tool_get_pose(World.Enter("Tool.Pose"), Id, &pose), "Tool.Pose");
                return pose;
            }
            set { Finish(Native.dpt_tool_set_pose(World.Enter("Tool.Pose"), Id, &value), "Tool.Pose"); }
        }

        public void Teleport(Pose pose)
        {
            Finish(Native.dpt_tool_teleport(World.Enter("Tool.Teleport"), Id, &pose), "Tool.Teleport");
        }

        /// <summary>Makes it a free tool, of as many capsules as it has, in the world's frame.</summary>
        public void SetSegments(params Segment[] segments)
        {
            if (segments == null) throw new ArgumentNullException("segments");
            Result result;
            fixed (Segment* s = segments)
                result = Native.dpt_tool_set_segments(World.Enter("Tool.SetSegments"), Id, s, (uint)segments.Length);
            Finish(result, "Tool.SetSegments");
        }

        /// <summary>A tick of its world, for a loop with one tool: set the pose, step, get the wrench.</summary>
        public Wrench Tick(Pose pose, double dt)
        {
            Wrench wrench = new Wrench();
            IntPtr world = World.Enter("Tool.Tick");
            Result result = Native.dpt_tool_set_pose(world, Id, &pose);
            if (result == Result.Ok) result = Native.dpt_world_step(world, dt, null);
            if (result == Result.Ok) result = Native.dpt_tool_get_wrench(world, Id, &wrench);
            Finish(result, "Tool.Tick");
            return wrench;
        }

        /// <summary>To change one: get, change, set.</summary>
        public ToolSettings Settings
        {
            get
            {
                ToolSettings settings = ToolSettings.Sized();
                Finish(Native.dpt_tool_get_settings(World.Enter("Tool.Settings"), Id, &settings), "Tool.Settings");
                return settings;
            }
            set
            {
                value.Size = (uint)sizeof(ToolSettings);
                Finish(Native.dpt_tool_set_settings(World.Enter("Tool.Settings"), Id, &value), "Tool.Settings");
            }
        }

        /// <summary>Force, and torque about the origin of the tool's frame, in world axes.</summary>
        public Wrench Wrench
        {
            get
            {
                Wrench wrench;
                Finish(Native.dpt_tool_get_wrench(World.Enter("Tool.Wrench"), Id, &wrench), "Tool.Wrench");
                return wrench;
            }
        }

        /// <summary>The same, with the reason why it is zero, energy and flags.</summary>
        public ForceInfo ForceInfo
        {
            get
            {
                ForceInfo info = ForceInfo.Sized();
                Finish(Native.dpt_tool_get_force_info(World.Enter("Tool.ForceInfo"), Id, &info), "Tool.ForceInfo");
                return info;
            }
        }

        /// <summary>The pose that has gone through nothing: where to draw the tool.</summary>
        public Pose Proxy
        {
            get
            {
                Pose pose;
                Finish(Native.dpt_tool_get_proxy(World.Enter("Tool.Proxy"), Id, &pose), "Tool.Proxy");
                return pose;
            }
        }

        /// <summary>The nearest pair of the tool and all bodies, at the device's pose.</summary>
        public Hit Hit
        {
            get
            {
                Hit hit = Dynpoint.Hit.Sized();
                Finish(Native.dpt_tool_get_hit(World.Enter("Tool.Hit"), Id, &hit), "Tool.Hit");
                return hit;
            }
        }

        /// <summary>The nearest pair of one capsule.</summary>
        public Hit GetSegmentHit(int segment)
        {
            Hit hit = Dynpoint.Hit.Sized();
            Finish(Native.dpt_tool_get_segment_hit(World.Enter("Tool.GetSegmentHit"), Id, (uint)segment, &hit),
                   "Tool.GetSegmentHit");
            return hit;
        }

        /// <summary>The first touch of a capsule between the last two steps.</summary>
        public Sweep GetSweep(int segment)
        {
            Sweep sweep = Sweep.Sized();
            Finish(Native.dpt_tool_get_sweep(World.Enter("Tool.GetSweep"), Id, (uint)segment, &sweep), "Tool.GetSweep");
            return sweep;
        }

        /// <summary>Its contacts, in a world with WorldDef.MaxContacts above 0.</summary>
        public Contact[] GetContacts()
        {
            const string what = "Tool.GetContacts";
            Contact[] contacts = new Contact[16];
            while (true)
            {
                uint count;
                Result result;
                int capacity = contacts.Length;
                contacts[0].Size = (uint)sizeof(Contact);
                fixed (Contact* c = contacts)
                    result = Native.dpt_tool_get_contacts(World.Enter(what), Id, c, (uint)capacity, &count);
                Finish(result, what);
                Array.Resize(ref contacts, (int)count);
                if (count <= capacity) return contacts;
            }
        }

        /// <summary>Where bodies push it; the forces add up to the wrench.</summary>
        public ToolLoad[] GetLoads()
        {
            const string what = "Tool.GetLoads";
            ToolLoad[] loads = new ToolLoad[16];
            while (true)
            {
                uint count;
                Result result;
                int capacity = loads.Length;
                loads[0].Size = (uint)sizeof(ToolLoad);
                fixed (ToolLoad* l = loads)
                    result = Native.dpt_tool_get_loads(World.Enter(what), Id, l, (uint)capacity, &count);
                Finish(result, what);
                Array.Resize(ref loads, (int)count);
                if (count <= capacity) return loads;
            }
        }

        /// <summary>The part of Body.Wrench that this tool does.</summary>
        public Wrench GetBodyWrench(Body body)
        {
            if (body == null) throw new ArgumentNullException("body");
            if (body.World != World) throw new ArgumentException("Tool.GetBodyWrench: wanted a body of the tool's world");
            Wrench wrench;
            Finish(Native.dpt_tool_get_body_wrench(World.Enter("Tool.GetBodyWrench"), Id, body.Id, &wrench),
                   "Tool.GetBodyWrench");
            return wrench;
        }

        /// <summary>Tests a motion up to the first touch, and leaves the tool where it is.</summary>
        public Sweep TryPose(Pose pose, double clearance, out Pose reached)
        {
            Sweep sweep = Sweep.Sized();
            Pose end = pose;
            Finish(Native.dpt_tool_try_pose(World.Enter("Tool.TryPose"), Id, &pose, clearance, &sweep, &end),
                   "Tool.TryPose");
            reached = end;
            return sweep;
        }

        public bool IsValid
        {
            get
            {
                bool isValid = Native.dpt_tool_is_valid(World.Enter("Tool.IsValid"), Id) != 0;
                World.Leave();
                return isValid;
            }
        }

        /// <summary>Takes it out of its world.</summary>
        public void Remove()
        {
            Finish(Native.dpt_tool_remove(World.Enter("Tool.Remove"), Id), "Tool.Remove");
        }
    }
}
