// SPDX-License-Identifier: BSD-3-Clause
// What a program does wrong is an exception, and nothing else happens.
using System;
using System.Diagnostics;
using System.Threading;
using Dynpoint;

static class Misuse
{
    static readonly Segment rod = new Segment(new Double3(0, 0, 0), new Double3(0, 0.5, 0), 0.1);

    static void Numbers()
    {
        using (Mesh box = Feel.MakeBox())
        using (World world = new World())
        {
            Body body = world.AddBody(box);
            Tool tool = world.AddTool(rod);
            Check.Refuses(Result.EFinite, () => tool.Pose = new Pose(double.NaN, 0, 0), "a pose of NaN", "Tool.Pose",
                          "not finite");
            Check.Refuses(Result.EPose, () => body.Pose = new Pose(), "a pose of zeros", "Body.Pose", "quaternion");
            Check.Refuses(Result.EArgument, () => world.Step(double.NaN), "a step of NaN", "World.Step",
                          "DPT_E_ARGUMENT");
            Check.Refuses(Result.EArgument, () => body.SetFriction(double.NaN, 0), "friction of NaN", "Body.Settings");
            Check.Refuses(Result.EFinite, () => box.Query(new[] { 0, double.NaN, 0, 0, 0, 0 }), "a query of NaN",
                          "Mesh.Query");
            double[] bad = { 0, 0, 0, 1, 0, 0, double.NaN, 1, 0 };
            Check.Refuses(Result.EFinite, () => Mesh.Compile(bad, new[] { 0, 1, 2 }), "a vertex of NaN", "not finite");
            Check.Refuses(Result.EIndex, () => Mesh.Compile(Feel.Corners, new[] { 0, 1, 8 }),
                          "a triangle without its vertex", "Mesh.Compile");
            Check.Refuses(Result.EIndex, () => Mesh.Compile(Feel.Corners, new[] { 0, 1, -1 }), "a negative vertex",
                          "Mesh.Compile");
            Check.Throws<ArgumentException>(() => Mesh.Compile(new double[7], new int[3]), "seven numbers for vertices",
                                            "three numbers");
            Check.Throws<ArgumentException>(() => box.Query(new double[7]), "seven numbers for a segment", "six numbers");
            Check.Throws<ArgumentException>(() => box.Query(new double[12], new double[1]), "one radius for two",
                                            "one radius");
            Check.Throws<ArgumentOutOfRangeException>(() => Mesh.Load("none.obj", double.NaN), "a unit of NaN",
                                                      "metres per unit");
            Check.Throws<ArgumentNullException>(() => world.AddBody(null), "a body without a mesh");
            Check.Refuses(Result.EArgument, () => world.AddTool(), "a tool without segments", "World.AddTool");
            Check.Refuses(Result.EArgument, () => new World(new WorldDef()), "a world for nothing", "World");
            Check.Refuses(Result.EUnsupported, () => new Springs(box), "springs of a mesh that has none", "Springs");
            DeformableBody soft = world.AddDeformable(box);
            float[] places = soft.GetVertices();
            places[4] = float.NaN;
            Check.Refuses(Result.EFinite, () => soft.SetVertices(places), "vertices of NaN", "SetVertices");
            Check.Refuses(Result.EArgument, () => soft.SetVertices(new float[27]), "more vertices than there are",
                          "SetVertices");
            Check.Refuses(Result.EArgument, () => soft.SetVertices(new float[3], -1), "vertices from -1 on",
                          "SetVertices");
            Check.Throws<ArgumentException>(() => soft.SetVertices(new float[4]), "four numbers for vertices",
                                            "three numbers");
            Check.Throws<ArgumentException>(() => soft.SetNodes(new float[3]), "nodes of a mesh that has none",
                                            "wanted 0");
            Check.Throws<IndexOutOfRangeException>(() => Console.WriteLine(new Double3()[3]), "a fourth coordinate");
        }
    }

    static unsafe void Sizes()
    {
        Guard guard = new Guard { Size = 12 };
        Result result = Native.dpt_guard_init(&guard, null);
        Check.That(result == Result.ESize, "a struct of a wrong size, of the functions as they are: {0}", result);
    }

    static void Lives()
    {
        Mesh box = Feel.MakeBox();
        byte[] bytes = box.ToBytes();
        World world = new World(), other = new World();
        Body body = world.AddBody(box);
        Tool tool = world.AddTool(rod);
        box.Dispose();
        box.Dispose();
        Check.Throws<ObjectDisposedException>(() => other.AddBody(box), "a body of a mesh that was freed", "Mesh");
        Check.Throws<ObjectDisposedException>(() => box.Query(new double[6]), "a query of one");
        Check.Throws<ObjectDisposedException>(() => Console.WriteLine(box.Info), "what is in one");
        Wrench wrench = new Wrench();
        for (int i = 0; i < 100; i++) wrench = tool.Tick(new Pose(0, 1.2 - 0.002 * i, 0), 0.001);
        Check.That(wrench.Force.Y > 10, "the world that has a body of it feels it: {0:f1} N", wrench.Force.Y);
        body.Remove();
        Check.Refuses(Result.EHandle, () => body.Pose = Pose.Identity, "a body that was removed", "Body.Pose", "stale");
        Check.Refuses(Result.EHandle, body.Remove, "a body that was removed twice");
        Check.That(!body.IsValid && tool.IsValid, "it is not valid, the tool is");
        tool.Remove();
        Check.Refuses(Result.EHandle, () => Console.WriteLine(tool.Wrench), "a tool that was removed", "Tool.Wrench");
        world.Dispose();
        world.Dispose();
        Check.Throws<ObjectDisposedException>(() => world.Step(0.001), "a world that was closed", "World");
        Check.Throws<ObjectDisposedException>(() => Console.WriteLine(tool.Hit), "a tool of one");
        Check.Throws<ObjectDisposedException>(() => Console.WriteLine(body.Settings), "a body of one");
        other.Dispose();
        Check.Refuses(Result.ETruncated, () => Mesh.Open(new byte[0]), "no bytes", "Mesh.Open");
        Check.Refuses(Result.EMagic, () => Mesh.Open(new byte[4096]), "bytes of something else", "Mesh.Open");
        bytes[bytes.Length / 2] ^= 1;
        Check.Refuses(Result.EChecksum, () => Mesh.Open(bytes), "bytes that are damaged", "Mesh.Open", "damaged");
        Check.Throws<System.IO.FileNotFoundException>(() => Mesh.Load("none.dpa"), "a file that is not there",
                                                      "none.dpa");
        Check.Refuses(Result.EOpen, () => Mesh.Load("none.obj", 1), "a source that is not there", "none.obj");
        Check.Throws<ArgumentException>(() => Mesh.Load("a\0b", 1), "a path with a zero in it", "zero");
    }

    /// <summary>Two threads that step one world: each call is refused or done, and all done ones count.</summary>
    static void Threads()
    {
        using (Mesh box = Feel.MakeBox())
        using (World world = new World())
        {
            world.AddBody(box);
            Tool tool = world.AddTool(rod);
            int refused = 0, others = 0, closed = 0;
            Action step = () =>
            {
                for (int i = 0; i < 2000000 && Volatile.Read(ref refused) == 0; i++)
                {
                    try
                    {
                        tool.Tick(new Pose(0, 1.2 - 0.0001 * (i % 1000), 0), 0.001);
                    }
                    catch (InvalidOperationException error)
                    {
                        if (error.Message.Contains("one thread at a time")) Interlocked.Increment(ref refused);
                        else Interlocked.Increment(ref others);
                    }
                }
            };
            Thread second = new Thread(() => step());
            second.Start();
            step();
            second.Join();
            Check.That(refused > 0 && others == 0, "a second thread in a world: refused {0} times", refused);
            Check.That(world.Info.Bodies == 1 && tool.Wrench.Force.X == 0, "the world is as it was");
            SceneOptions options = new SceneOptions();
            Scene scene = null;
            options.Felt = tick =>
            {
                try
                {
                    scene.Dispose();
                }
                catch (InvalidOperationException)
                {
                    closed++;
                }
                if (closed == 5) scene.Stop();
            };
            using (scene = new Scene("liver", "sim:?hand=press", options))
            {
                scene.Run();
                Check.That(closed == 5, "a scene that is closed while it runs: refused {0} times; Stop ends it", closed);
            }
            Check.Throws<ObjectDisposedException>(() => scene.Run(), "a scene that was closed");
            Check.Throws<ObjectDisposedException>(() => scene.Stop(), "to stop one");
        }
    }

    static void Scenes()
    {
        Check.Throws<DynpointException>(() => new Scene("nothing.dpa", "sim:"), "a scene that is not there",
                                        "nothing.dpa", "opened");
        Check.Throws<DynpointException>(() => new Scene("liver", "sim:?hand=nothing"), "a device of no such hand",
                                        "nothing");
        Check.Throws<DynpointException>(() => new Scene("liver", null), "a scene without a device", "device");
        SceneOptions options = new SceneOptions { Felt = tick => { throw new TimeoutException("enough"); } };
        using (Scene scene = new Scene("liver", "sim:?hand=press", options))
        {
            Check.Throws<InvalidOperationException>(() => scene.Run(), "what Felt calls fails", "Felt");
            Check.That(scene.Info.Ticks < 100, "it ends the run, after {0} ticks", scene.Info.Ticks);
        }
    }

    /// <summary>Nobody disposes of anything: the collector does.</summary>
    static void Garbage()
    {
        long before = Process.GetCurrentProcess().WorkingSet64, most = 0;
        for (int i = 0; i < 300; i++)
        {
            Mesh box = Feel.MakeBox();
            World world = new World();
            world.AddBody(box);
            DeformableBody soft = world.AddDeformable(box);
            world.AddTool(rod).Tick(new Pose(0, 1.05, 0), 0.001);
            if (i % 50 == 0) new Scene("liver", "sim:?hand=press").Stop();
            if (i % 3 == 0) box.Dispose();
            if (i % 5 == 0) soft.Remove();
            if (i % 10 != 0) continue;
            GC.Collect();
            GC.WaitForPendingFinalizers();
            most = Math.Max(most, Process.GetCurrentProcess().WorkingSet64 - before);
        }
        Check.That(most < 200L << 20, "300 worlds of 1 MiB that nobody closes take {0} MiB", most >> 20);
    }

    public static void Run()
    {
        Numbers();
        Sizes();
        Lives();
        Threads();
        Scenes();
        Garbage();
    }
}
