// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Dynpoint
{
    /// <summary>A body of your own in a scene, y being up.</summary>
    public sealed class SceneBody
    {
        public Mesh Mesh;
        public Pose Pose = Pose.Identity;

        /// <summary>Friction and the like; null: those of new bodies.</summary>
        public BodySettings? Settings;

        /// <summary>In texts of the library; null: it has none.</summary>
        public string Name;

        /// <summary>Of a mesh with springs; see dpt_host_body. Its pointers are not used.</summary>
        public HostBody Def;
    }

    /// <summary>What is felt, and how; see dpt_host_def.</summary>
    public sealed class SceneOptions
    {
        /// <summary>Numbers and flags. Its pointers and counts are not used.</summary>
        public HostDef Def = Scene.Defaults();

        /// <summary>Path of a recording of all ticks; null: there is none.</summary>
        public string Record;

        /// <summary>Path of a compiled arm, whose tool is used.</summary>
        public string Tool;

        /// <summary>Path of the device's dynamics.</summary>
        public string Identified;

        /// <summary>Tips of the tool, and how its jaws move, as `dynpoint run` takes them.</summary>
        public string[] Tips;

        public string Jaw;

        /// <summary>Instead of a scene's name.</summary>
        public SceneBody[] Bodies;

        /// <summary>The tool, in its own frame, instead of the scene's.</summary>
        public Segment[] Segments;

        /// <summary>The device of a loop of your own, where the scene opens none: Scene.Tick.</summary>
        public DeviceInfo? Info;

        /// <summary>Called after each tick of Run, in the thread that runs it. It must not wait. An exception ends the
        /// run, and comes out of it.</summary>
        public Action<SceneTick> Felt;
    }

    /// <summary>What a tick of Scene.Run was.</summary>
    public struct SceneTick
    {
        /// <summary>Where the hand is, in the device's own frame.</summary>
        public DeviceState State;

        /// <summary>At the hand, before the guard.</summary>
        public Wrench Wrench;

        /// <summary>Not Ok if the tick gave no force: ENotReady while the clutch is down.</summary>
        public Result Result;

        /// <summary>s.</summary>
        public double Dt;

        /// <summary>The pose to draw the tool at, in the scene. A stylus lies along its x.</summary>
        public Pose Proxy;
    }

    /// <summary>
    /// A scene that is felt with a device, and safely so: coupling, passivity and a guard before the motors, as `dynpoint
    /// run` has them. One thread at a time may use it; Stop may be called from any. However it ends, the device gets zero
    /// force.
    /// </summary>
    public sealed unsafe class Scene : Exclusive, IDisposable
    {
        private static readonly HostFeltFn feltFunction = OnFelt;
        private readonly Handle handle = new Handle();
        private readonly Action<SceneTick> felt;
        private Exception failure;

        /// <summary>A scene's name (Names), or the path of a scene file, a compiled mesh or arm; and a device, as
        /// "sim:?hand=press".</summary>
        public Scene(string scene, string device) : this(scene, device, new SceneOptions())
        {
        }

        /// <summary>The scene is null where options.Bodies are given, the device where options.Info is.</summary>
        public Scene(string scene, string device, SceneOptions options)
        {
            if (options == null) throw new ArgumentNullException("options");
            Library.Load();
            felt = options.Felt;
            try
            {
                Open(scene, device, options);
            }
            catch
            {
                handle.Dispose();
                throw;
            }
        }

        private void Open(string scene, string device, SceneOptions options)
        {
            HostDef def = options.Def;
            def.Size = (uint)sizeof(HostDef);
            def.Scene = handle.Text(scene);
            def.Device = handle.Text(device);
            def.Tool = handle.Text(options.Tool);
            def.Identified = handle.Text(options.Identified);
            def.Record = handle.Text(options.Record);
            def.Jaw = handle.Text(options.Jaw);
            def.Tips = handle.Texts(options.Tips);
            def.User = handle.Callee(this);
            def.Felt = felt == null ? IntPtr.Zero : Marshal.GetFunctionPointerForDelegate(feltFunction);
            DeviceInfo info = options.Info ?? DeviceInfo.Sized();
            info.Size = (uint)sizeof(DeviceInfo);
            def.Info = options.Info == null ? IntPtr.Zero : (IntPtr)(&info);
            SceneBody[] own = options.Bodies ?? new SceneBody[0];
            HostBody[] bodies = new HostBody[own.Length];
            Pose[] poses = new Pose[own.Length];
            BodySettings[] settings = new BodySettings[own.Length];
            HostError error = HostError.Sized();
            IntPtr host;
            Result result;
            fixed (HostBody* b = bodies)
            fixed (Pose* p = poses)
            fixed (BodySettings* s = settings)
            fixed (Segment* g = options.Segments)
            {
                for (int i = 0; i < own.Length; i++)
                {
                    if (own[i] == null || own[i].Mesh == null) throw new ArgumentException("Scene: a body has no mesh");
                    bodies[i] = own[i].Def;
                    bodies[i].Size = (uint)sizeof(HostBody);
                    bodies[i].Mesh = handle.Keep(own[i].Mesh);
                    bodies[i].Name = handle.Text(own[i].Name);
                    poses[i] = own[i].Pose;
                    bodies[i].Pose = (IntPtr)(p + i);
                    settings[i] = own[i].Settings ?? BodySettings.Sized();
                    settings[i].Size = (uint)sizeof(BodySettings);
                    bodies[i].Settings = own[i].Settings == null ? IntPtr.Zero : (IntPtr)(s + i);
                }
                def.Bodies = (IntPtr)b;
                def.BodyCount = (uint)own.Length;
                def.Segments = (IntPtr)g;
                def.SegmentCount = options.Segments == null ? 0 : (uint)options.Segments.Length;
                result = Native.dpt_host_open(&def, &host, &error);
            }
            Note = error.Text.ToString();
            if (result != Result.Ok) throw DynpointException.Make(result, "Scene", Note);
            handle.Take(host);
            Address = host;
        }

        /// <summary>Numbers of a scene with the defaults, to change some of them.</summary>
        public static HostDef Defaults()
        {
            Library.Load();
            HostDef def;
            Native.dpt_host_def_defaults(&def, (UIntPtr)sizeof(HostDef));
            return def;
        }

        /// <summary>The scenes that the library makes itself.</summary>
        public static string[] Names
        {
            get
            {
                Library.Load();
                List<string> names = new List<string>();
                while (true)
                {
                    string name = Utf8.Read(Native.dpt_host_get_scene((uint)names.Count), 100);
                    if (name == null) return names.ToArray();
                    names.Add(name);
                }
            }
        }

        /// <summary>What a person should know after the last call, as that the coupling is softer than was asked for; or
        /// "".</summary>
        public string Note { get; private set; }

        /// <summary>Serves the device in this thread, until Stop, after Def.Ticks, or when the device is lost.</summary>
        public LoopStats Run()
        {
            LoopStats stats = LoopStats.Sized();
            HostError error = HostError.Sized();
            IntPtr host = Enter("Scene.Run");
            failure = null;
            Result result = Native.dpt_host_run(host, &stats, &error);
            Exception thrown = failure;
            Leave();
            Note = error.Text.ToString();
            if (thrown != null) throw new InvalidOperationException("Scene.Run: what Felt calls has failed", thrown);
            if (result != Result.Ok) throw DynpointException.Make(result, "Scene.Run", Note);
            return stats;
        }

        /// <summary>Ends the present run, or the next one. From any thread.</summary>
        public void Stop()
        {
            bool isHeld = false;
            try
            {
                handle.DangerousAddRef(ref isHeld);
                Native.dpt_host_stop(handle.DangerousGetHandle());
            }
            finally
            {
                if (isHeld) handle.DangerousRelease();
            }
        }

        /// <summary>One tick of a loop of your own. The wrench is to be sent whatever is returned: ENotReady while the
        /// clutch is down, and Ok also without a fresh sample.</summary>
        public Result Tick(DeviceState state, ulong nowNs, out Wrench wrench)
        {
            Wrench sent;
            state.Size = (uint)sizeof(DeviceState);
            Result result = Native.dpt_host_tick(Enter("Scene.Tick"), &state, nowNs, &sent);
            Leave();
            wrench = sent;
            return result;
        }

        /// <summary>What is so now, and what has happened since it was opened.</summary>
        public HostInfo Info
        {
            get
            {
                HostInfo info = HostInfo.Sized();
                Result result = Native.dpt_host_get_info(Enter("Scene.Info"), &info);
                Leave();
                DynpointException.Check(result, "Scene.Info");
                return info;
            }
        }

        /// <summary>The pose to draw the tool at.</summary>
        public Pose Proxy
        {
            get
            {
                Pose pose;
                IntPtr host = Enter("Scene.Proxy");
                Result result = Native.dpt_tool_get_proxy(Native.dpt_host_get_world(host), Native.dpt_host_get_tool(host),
                                                          &pose);
                Leave();
                DynpointException.Check(result, "Scene.Proxy");
                return pose;
            }
        }

#if ENABLE_IL2CPP
        [AOT.MonoPInvokeCallback(typeof(HostFeltFn))]
#endif
        private static void OnFelt(void* user, IntPtr host, LoopSample* sample, Result result, Wrench* wrench)
        {
            Scene scene = GCHandle.FromIntPtr((IntPtr)user).Target as Scene;
            if (scene == null || scene.failure != null) return;
            try
            {
                SceneTick tick = new SceneTick { Wrench = *wrench, Result = result, Dt = sample->Dt };
                tick.State = *(DeviceState*)sample->State;
                IntPtr world = Native.dpt_host_get_world(host);
                uint tool = Native.dpt_host_get_tool(host);
                Native.dpt_tool_get_proxy(world, tool, &tick.Proxy);
                scene.felt(tick);
            }
            catch (Exception error)
            {
                scene.failure = error;
                Native.dpt_host_stop(host);
            }
        }

        /// <summary>Ends the recording, and closes the device. It must not be running.</summary>
        public void Dispose()
        {
            if (!EnterToClose("Scene.Dispose")) return;
            Address = IntPtr.Zero;
            handle.Dispose();
            Leave();
            if (handle.Closed != Result.Ok) throw DynpointException.Make(handle.Closed, "Scene.Dispose", handle.Said);
        }

        /// <summary>The host, and what must stay as long as it is open, also where nobody disposes of it.</summary>
        private sealed class Handle : SafeHandle
        {
            private readonly List<IntPtr> texts = new List<IntPtr>();
            private readonly List<Mesh> meshes = new List<Mesh>();
            private GCHandle kept, callee;

            internal Handle() : base(new IntPtr(-1), true)
            {
                kept = GCHandle.Alloc(meshes);
                SetHandle(IntPtr.Zero);
            }

            internal Result Closed { get; private set; }
            internal string Said { get; private set; }

            public override bool IsInvalid
            {
                get { return handle == new IntPtr(-1); }
            }

            internal void Take(IntPtr host)
            {
                SetHandle(host);
            }

            internal IntPtr Callee(Scene scene)
            {
                callee = GCHandle.Alloc(scene, GCHandleType.Weak);
                return GCHandle.ToIntPtr(callee);
            }

            internal IntPtr Keep(Mesh mesh)
            {
                IntPtr address = mesh.Enter();
                meshes.Add(mesh);
                return address;
            }

            internal IntPtr Text(string text)
            {
                byte[] bytes = Utf8.Bytes(text);
                if (bytes == null) return IntPtr.Zero;
                IntPtr copy = Marshal.AllocHGlobal(bytes.Length);
                texts.Add(copy);
                Marshal.Copy(bytes, 0, copy, bytes.Length);
                return copy;
            }

            /// <summary>Addresses of texts, and a zero behind the last.</summary>
            internal IntPtr Texts(string[] several)
            {
                if (several == null) return IntPtr.Zero;
                IntPtr list = Marshal.AllocHGlobal((several.Length + 1) * IntPtr.Size);
                texts.Add(list);
                for (int i = 0; i <= several.Length; i++)
                    Marshal.WriteIntPtr(list, i * IntPtr.Size, i < several.Length ? Text(several[i]) : IntPtr.Zero);
                return list;
            }

            protected override bool ReleaseHandle()
            {
                HostError error = HostError.Sized();
                if (handle != IntPtr.Zero) Closed = Native.dpt_host_close(handle, &error);
                Said = error.Text.ToString();
                foreach (IntPtr text in texts) Marshal.FreeHGlobal(text);
                foreach (Mesh mesh in meshes) mesh.Leave();
                kept.Free();
                if (callee.IsAllocated) callee.Free();
                return true;
            }
        }
    }
}
