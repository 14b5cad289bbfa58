// SPDX-License-Identifier: BSD-3-Clause
// Unity's frame and back. Unity's own rules are written here once more: it rotates by q v q*, and its cross product is
// the usual formula; in a left-handed frame both turn the other way, which is what a mirror does.
using System;
using Dynpoint;

static class UnityFrames
{
    static readonly Random random = new Random(20260);

    static double Any()
    {
        return random.NextDouble() * 2 - 1;
    }

    static Double3 AnyVector()
    {
        return new Double3(Any(), Any(), Any());
    }

    static Rotation AnyRotation()
    {
        double w = Any(), x = Any(), y = Any(), z = Any(), length = Math.Sqrt(w * w + x * x + y * y + z * z);
        return new Rotation(w / length, x / length, y / length, z / length);
    }

    static Double3 Cross(Double3 a, Double3 b)
    {
        return new Double3(a.Y * b.Z - a.Z * b.Y, a.Z * b.X - a.X * b.Z, a.X * b.Y - a.Y * b.X);
    }

    static Double3 Add(Double3 a, Double3 b, double factor)
    {
        return new Double3(a.X + factor * b.X, a.Y + factor * b.Y, a.Z + factor * b.Z);
    }

    static double Apart(Double3 a, Double3 b)
    {
        return Math.Abs(a.X - b.X) + Math.Abs(a.Y - b.Y) + Math.Abs(a.Z - b.Z);
    }

    /// <summary>R(q) v, the same formula in both frames.</summary>
    static Double3 Rotate(Rotation q, Double3 v)
    {
        Double3 u = new Double3(q.X, q.Y, q.Z), t = Cross(u, v);
        t = new Double3(2 * t.X, 2 * t.Y, 2 * t.Z);
        return Add(Add(v, t, q.W), Cross(u, t), 1);
    }

    static double Volume(double[] vertices, int[] triangles)
    {
        double six = 0;
        for (int i = 0; i < triangles.Length; i += 3)
        {
            Double3[] c = new Double3[3];
            for (int k = 0; k < 3; k++)
                c[k] = new Double3(vertices[3 * triangles[i + k]], vertices[3 * triangles[i + k] + 1],
                                   vertices[3 * triangles[i + k] + 2]);
            Double3 n = Cross(c[0], c[1]);
            six += n.X * c[2].X + n.Y * c[2].Y + n.Z * c[2].Z;
        }
        return six / 6;
    }

    static void Poses()
    {
        bool isBack = true;
        double place = 0, turned = 0, torque = 0;
        for (int i = 0; i < 10000; i++)
        {
            Pose unity = new Pose(AnyVector(), AnyRotation()), ours = UnityFrame.Mirror(unity);
            isBack &= UnityFrame.Mirror(ours).Equals(unity);
            // A point of the frame goes to the same place.
            Double3 point = AnyVector();
            Double3 there = Add(Rotate(unity.Orientation, point), unity.Position, 1);
            Double3 here = Add(Rotate(ours.Orientation, UnityFrame.Mirror(point)), ours.Position, 1);
            place = Math.Max(place, Apart(UnityFrame.Mirror(here), there));
            // A turn after a turn.
            Rotation second = AnyRotation();
            Double3 twice = Rotate(second, Rotate(unity.Orientation, point));
            Double3 also = Rotate(UnityFrame.Mirror(second), Rotate(ours.Orientation, UnityFrame.Mirror(point)));
            turned = Math.Max(turned, Apart(UnityFrame.Mirror(also), twice));
            // The torque of a force at a place: Unity's AddForceAtPosition is AddForce with AddTorque of the cross
            // product.
            Double3 force = AnyVector();
            Wrench wrench = new Wrench { Force = UnityFrame.Mirror(force) };
            wrench.Torque = Cross(UnityFrame.Mirror(point), wrench.Force);
            Wrench back = UnityFrame.Mirror(wrench);
            torque = Math.Max(torque, Apart(back.Torque, Cross(point, force)) + Apart(back.Force, force));
        }
        Check.That(isBack, "10,000 poses to the library's frame and back: the same bits");
        Check.That(place < 1e-12 && turned < 1e-12, "points and turns of them are the same: {0:e1}, {1:e1}", place,
                   turned);
        Check.That(torque < 1e-15, "torques of forces at places are the same: {0:e1}", torque);
        // A small turn about a torque moves a point as the torque does, in both frames.
        Double3 axis = new Double3(0, 1e-4, 0), at = new Double3(1, 0, 0);
        Double3 unityMoves = Cross(axis, at), oursMove = Cross(UnityFrame.MirrorTurn(axis), UnityFrame.Mirror(at));
        Check.That(Apart(UnityFrame.Mirror(oursMove), unityMoves) == 0 && unityMoves.Z < 0 && oursMove.Z > 0,
                   "a turn about y goes from x to -z in Unity, and so to z here");
    }

    static void Meshes()
    {
        bool isBack = true, isOutward = true;
        double apart = 0;
        for (int i = 0; i < 100; i++)
        {
            double[] vertices = (double[])Feel.Corners.Clone();
            for (int k = 0; k < vertices.Length; k++) vertices[k] = (float)(vertices[k] + 0.3 * Any());
            double[] ours = UnityFrame.MirrorVertices(vertices);
            int[] triangles = UnityFrame.MirrorTriangles(Feel.Triangles);
            isBack &= string.Join(",", UnityFrame.MirrorVertices(ours)) == string.Join(",", vertices)
                && string.Join(",", UnityFrame.MirrorTriangles(triangles)) == string.Join(",", Feel.Triangles);
            apart = Math.Max(apart, Math.Abs(Volume(ours, triangles) - Volume(vertices, Feel.Triangles)));
            using (Mesh mesh = Mesh.Compile(ours, triangles))
                isOutward &= mesh.Info.TurnedTriangles == 0 && mesh.Info.InwardComponents == 0;
            if (i == 0)
                using (Mesh wrong = Mesh.Compile(ours, Feel.Triangles))
                    Check.That(wrong.Info.TurnedTriangles == 12,
                               "without the other winding the compiler would turn them all");
        }
        Check.That(isBack, "100 meshes there and back: the same");
        Check.That(isOutward && apart < 1e-12, "their front stays outside, their volume the same: {0:e1}", apart);
    }

    public static void Run()
    {
        Poses();
        Meshes();
    }
}
