// SPDX-License-Identifier: BSD-3-Clause
// The scene of tests/languages in C#: Touch.exe [ROUNDS] prints HASH TICKS SECONDS (touch.c).
using System;
using System.Diagnostics;
using Dynpoint;

static class Touch
{
    const int Rings = 24, Sides = 48, Ticks = 10000;

    static double[] Circle(int k)
    {
        double t = (double)(k % (Sides / 4)) / (Sides / 4), c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
        switch (k / (Sides / 4) % 4)
        {
            case 0: return new[] { c, s };
            case 1: return new[] { -s, c };
            case 2: return new[] { -c, -s };
            default: return new[] { s, -c };
        }
    }

    static Mesh MakeBall()
    {
        double[] vertices = new double[(Rings + 1) * Sides * 3];
        int[] corners = new int[Rings * Sides * 6];
        for (int r = 0; r <= Rings; r++)
            for (int k = 0; k < Sides; k++)
            {
                double[] height = Circle(r), turn = Circle(k);
                double[] place = { 0.05 * height[1] * turn[0], 0.05 * height[1] * turn[1], 0.05 * height[0] };
                place.CopyTo(vertices, 3 * (r * Sides + k));
                int a = r * Sides + k, b = r * Sides + (k + 1) % Sides;
                if (r < Rings) new[] { a, a + Sides, b, b, a + Sides, b + Sides }.CopyTo(corners, 6 * a);
            }
        return Mesh.Compile(vertices, corners);
    }

    static int Fold(int tick, int n)
    {
        return Math.Abs(tick % (2 * n) - n);
    }

    static Pose Path(int tick)
    {
        double u = (Fold(tick, 2000) - 1000) * 0.00005;
        return new Pose(new Double3((Fold(tick, 1500) - 750) * 0.00002, (Fold(tick, 1100) - 550) * 0.00002,
                                    0.05 + Fold(tick, 500) * 0.00001),
                        new Rotation((1 - u * u) / (1 + u * u), 0, 2 * u / (1 + u * u), 0));
    }

    static double Feel(Mesh mesh, Pose[] poses, Wrench[] wrenches)
    {
        using (World world = new World())
        {
            world.AddBody(mesh).SetFriction(0.3, 0.3);
            Tool tool = world.AddTool(new Segment(new Double3(-0.025, 0, 0), new Double3(0.025, 0, 0), 0.002));
            Stopwatch watch = Stopwatch.StartNew();
            for (int tick = 0; tick < Ticks; tick++)
                wrenches[tick] = tool.Tick(poses[tick], 0.001);
            return watch.Elapsed.TotalSeconds;
        }
    }

    static void Main(string[] arguments)
    {
        Pose[] poses = new Pose[Ticks];
        Wrench[] wrenches = new Wrench[Ticks];
        double least = double.PositiveInfinity;
        for (int tick = 0; tick < Ticks; tick++) poses[tick] = Path(tick);
        using (Mesh mesh = MakeBall())
            for (int round = arguments.Length > 0 ? int.Parse(arguments[0]) : 1; round > 0; round--)
                least = Math.Min(least, Feel(mesh, poses, wrenches));
        ulong hash = 14695981039346656037;
        foreach (Wrench w in wrenches)
            foreach (double x in new[] { w.Force.X, w.Force.Y, w.Force.Z, w.Torque.X, w.Torque.Y, w.Torque.Z })
                for (int shift = 0; shift < 64; shift += 8)
                    hash = (hash ^ ((ulong)BitConverter.DoubleToInt64Bits(x) >> shift & 255)) * 1099511628211;
        Console.WriteLine(string.Format(System.Globalization.CultureInfo.InvariantCulture, "{0:x16} {1} {2:f6}", hash,
                                        Ticks, least));
    }
}
