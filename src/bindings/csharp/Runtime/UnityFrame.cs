// SPDX-License-Identifier: BSD-3-Clause
using System;

namespace Dynpoint
{
    /// <summary>
    /// Unity's frame and the library's. Both have y up and x to the right; Unity's z points forward, and its frame is
    /// left-handed; the library's z points back. So z changes its sign. What turns (rotations, torques, angular
    /// velocities) is mirrored the other way round, and so is the winding of triangles. Each function is its own inverse.
    /// </summary>
    public static class UnityFrame
    {
        /// <summary>A place, a direction, a velocity, a force.</summary>
        public static Double3 Mirror(Double3 vector)
        {
            return new Double3(vector.X, vector.Y, -vector.Z);
        }

        /// <summary>A torque, an angular velocity, the axis of a turn.</summary>
        public static Double3 MirrorTurn(Double3 axis)
        {
            return new Double3(-axis.X, -axis.Y, axis.Z);
        }

        public static Rotation Mirror(Rotation rotation)
        {
            return new Rotation(rotation.W, -rotation.X, -rotation.Y, rotation.Z);
        }

        public static Pose Mirror(Pose pose)
        {
            return new Pose(Mirror(pose.Position), Mirror(pose.Orientation));
        }

        public static Wrench Mirror(Wrench wrench)
        {
            return new Wrench { Force = Mirror(wrench.Force), Torque = MirrorTurn(wrench.Torque) };
        }

        public static Segment Mirror(Segment segment)
        {
            return new Segment(Mirror(segment.A), Mirror(segment.B), segment.Radius);
        }

        /// <summary>Vertices of a mesh, three coordinates each: another array.</summary>
        public static double[] MirrorVertices(double[] vertices)
        {
            double[] mirrored = (double[])vertices.Clone();
            for (int i = 2; i < mirrored.Length; i += 3) mirrored[i] = -mirrored[i];
            return mirrored;
        }

        /// <summary>Triangles, three vertices each, so that their front stays outside: another array.</summary>
        public static int[] MirrorTriangles(int[] triangles)
        {
            if (triangles.Length % 3 != 0) throw new ArgumentException("wanted three vertices for each triangle");
            int[] mirrored = (int[])triangles.Clone();
            for (int i = 0; i < mirrored.Length; i += 3)
            {
                mirrored[i + 1] = triangles[i + 2];
                mirrored[i + 2] = triangles[i + 1];
            }
            return mirrored;
        }
    }
}
