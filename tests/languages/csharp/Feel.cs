// SPDX-License-Identifier: BSD-3-Clause
// What the objects of the package answer: queries, a soft body, a scene.
using System;
using Dynpoint;

static class Feel
{
    /// <summary>A cube from -1 to 1, its corners at the bits of their number.</summary>
    public static readonly double[] Corners = MakeCorners();

    public static readonly int[] Triangles =
    {
        0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6,
    };

    static double[] MakeCorners()
    {
        double[] corners = new double[24];
        for (int i = 0; i < 24; i++) corners[i] = (i / 3 >> i % 3 & 1) * 2 - 1;
        return corners;
    }

    public static Mesh MakeBox(CompileOptions options = null)
    {
        return Mesh.Compile(Corners, Triangles, 1, options);
    }

    static void Queries()
    {
        using (Mesh box = MakeBox())
        {
            Check.That(box.Info.Triangles == 12 && box.Info.ClosedComponents == 1 && box.Info.TurnedTriangles == 0,
                       "a box is compiled: closed, and wound outward");
            double[] ends = { 0, 3, 0, 0, 5, 0, 4, 0.5, 0, 6, 0.5, 0 };
            Hit[] hits = box.Query(ends, new[] { 0.5, 0 });
            Check.That(hits[0].Distance == 2 && hits[0].Gap == 1.5 && hits[1].Distance == 3 && hits[1].Q.X == 1
                       && hits[0].Status == Status.Exact && hits[1].Contact == ContactState.Separated,
                           "queries: {0} and {1} m", hits[0].Distance, hits[1].Distance);
            Hit[] again = new Hit[2];
            box.Query(new ReadOnlySpan<double>(ends), new ReadOnlySpan<double>(new[] { 0.5, 0 }), new Span<Hit>(again));
            Check.That(again[0].Equals(hits[0]) && again[1].Equals(hits[1]), "the same from a Span");
            using (Mesh opened = Mesh.Open(box.ToBytes()))
                Check.That(opened.Query(ends)[1].Distance == 3 && opened.GetVertices().Length == 24
                           && opened.GetTriangles().Length == 36 && opened.GetVertexSources().Length == 8,
                               "opened anew from its bytes");
        }
    }

    static void SoftBody()
    {
        SpringNet net = new SpringNet(Net.Volume);
        net.Def.Spacing = 0.5;
        net.Def.Density = 100;
        net.Regions = new[] { new SpringRegion { Kind = Region.Box, Fixed = 1 } };
        double[] below = { -9, -9, -9, 9, -0.9, 9 };
        for (int i = 0; i < 6; i++) net.Regions[0].Box[i] = below[i];
        using (Mesh mesh = MakeBox(new CompileOptions { Springs = net }))
        using (World world = new World())
        using (Springs springs = new Springs(mesh))
        {
            DeformableBody body = world.AddDeformable(mesh);
            Tool tool = world.AddTool(new Segment(new Double3(-0.2, 0, 0), new Double3(0.2, 0, 0), 0.1));
            float[] before = body.GetVertices();
            double most = 0, sum = 0;
            for (int tick = 0; tick < 500; tick++)
            {
                tool.Pose = new Pose(0, 1.2 - 0.0008 * tick, 0);
                world.Step(0.001);
                Double3 reaction = body.Wrench.Force, force = tool.Wrench.Force;
                sum = Math.Max(sum, Math.Abs(force.Y + reaction.Y));
                body.StepSprings(springs, 0.001);
                most = Math.Max(most, tool.Wrench.Force.Y);
            }
            float[] after = body.GetVertices();
            double moved = 0;
            for (int i = 0; i < after.Length; i++) moved = Math.Max(moved, Math.Abs(after[i] - before[i]));
            Check.That(most > 10 && moved > 0.01, "a soft body gives way: {0:f1} N, {1:f3} m", most, moved);
            Check.That(sum < 1e-9 * most, "force and reaction sum up to {0:e1} N", sum);
            Check.That(springs.Count == mesh.Info.SpringNodes && springs.GetPositions().Length == 3 * springs.Count,
                       "{0} nodes", springs.Count);
        }
    }

    static void Scenes()
    {
        Check.That(Array.IndexOf(Scene.Names, "liver") >= 0, "scenes of the library: {0}",
                   string.Join(", ", Scene.Names));
        int felt = 0;
        double strongest = 0, highest = 0;
        SceneOptions options = new SceneOptions();
        options.Def.Ticks = 3000;
        options.Felt = tick =>
        {
            felt++;
            Double3 f = tick.Wrench.Force;
            strongest = Math.Max(strongest, Math.Sqrt(f.X * f.X + f.Y * f.Y + f.Z * f.Z));
            highest = Math.Max(highest, Math.Abs(tick.Proxy.Position.Y));
        };
        using (Scene scene = new Scene("liver", "sim:?hand=press", options))
        {
            LoopStats stats = scene.Run();
            HostInfo info = scene.Info;
            Check.That(stats.Ticks == 3000 && felt == 3000 && info.Contacts > 1000 && highest > 0,
                       "a scene on a device: {0} ticks, {1} felt", stats.Ticks, felt);
            Check.That(Math.Abs(strongest - info.ForceMax) < 1e-12 * strongest, "Felt sees the strongest: {0} N",
                       strongest);
            // run.sh compares this line with what the program says.
            Console.WriteLine(string.Format(System.Globalization.CultureInfo.InvariantCulture, "scene {0} {1} {2:r}",
                                            info.Contacts, info.Penetrating, info.ForceMax));
        }
        using (Mesh box = MakeBox())
        {
            SceneBody body = new SceneBody { Mesh = box, Name = "box", Pose = new Pose(0, -1, 0) };
            SceneOptions own = new SceneOptions { Bodies = new[] { body } };
            own.Info = MakeInfo();
            own.Segments = new[] { new Segment(new Double3(0, 0, 0), new Double3(0, 0.1, 0), 0.01) };
            for (int k = 0; k < 3; k++) own.Def.Origin[k] = 0;
            using (Scene scene = new Scene(null, null, own))
            {
                Wrench wrench = new Wrench();
                DeviceState state = new DeviceState { Status = DeviceStatus.Ready, Fresh = 1 };
                state.Pose = new Pose(0, 0.02, 0);
                for (ulong tick = 1; tick <= 100; tick++)
                {
                    state.Sequence = tick;
                    state.TimeNs = tick * 1000000;
                    state.Pose.Position.Y -= 0.00015;
                    scene.Tick(state, state.TimeNs, out wrench);
                }
                Check.That(wrench.Force.Y > 0.5 && scene.Proxy.Position.Y > state.Pose.Position.Y,
                           "a loop and a body of one's own: {0:f2} N",
                           wrench.Force.Y);
            }
        }
    }

    static DeviceInfo MakeInfo()
    {
        DeviceInfo info = DeviceInfo.Sized();
        info.PoseDofs = 6;
        info.WrenchDofs = 3;
        info.Rate = 1000;
        info.ForceMax = 10;
        info.ForceContinuous = 10;
        info.StiffnessMax = 1000;
        return info;
    }

    public static void Run()
    {
        Check.That(Library.Version == Native.Version, "the library's version, {0}", Library.Version);
        Queries();
        SoftBody();
        Scenes();
    }
}
