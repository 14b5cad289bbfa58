// SPDX-License-Identifier: BSD-3-Clause
#if UNITY_5_3_OR_NEWER
using System;
using UnityEngine;

namespace Dynpoint
{
    /// <summary>Unity's values as the library's, and back: UnityFrame with Unity's types.</summary>
    public static class UnityValues
    {
        public static Double3 ToDynpoint(this Vector3 vector)
        {
            return UnityFrame.Mirror(new Double3(vector.x, vector.y, vector.z));
        }

        /// <summary>Of unit length, which products of quaternions in float are only nearly.</summary>
        public static Rotation ToDynpoint(this Quaternion rotation)
        {
            double x = rotation.x, y = rotation.y, z = rotation.z, w = rotation.w;
            double length = Math.Sqrt(x * x + y * y + z * z + w * w);
            return UnityFrame.Mirror(new Rotation(w / length, x / length, y / length, z / length));
        }

        /// <summary>Where a transform is, without its scale.</summary>
        public static Pose ToDynpoint(this Transform transform)
        {
            return new Pose(transform.position.ToDynpoint(), transform.rotation.ToDynpoint());
        }

        public static Vector3 ToUnity(this Double3 vector)
        {
            Double3 mirrored = UnityFrame.Mirror(vector);
            return new Vector3((float)mirrored.X, (float)mirrored.Y, (float)mirrored.Z);
        }

        /// <summary>For Rigidbody.AddTorque.</summary>
        public static Vector3 TorqueToUnity(this Double3 torque)
        {
            Double3 mirrored = UnityFrame.MirrorTurn(torque);
            return new Vector3((float)mirrored.X, (float)mirrored.Y, (float)mirrored.Z);
        }

        public static Quaternion ToUnity(this Rotation rotation)
        {
            Rotation mirrored = UnityFrame.Mirror(rotation);
            return new Quaternion((float)mirrored.X, (float)mirrored.Y, (float)mirrored.Z, (float)mirrored.W);
        }

        public static void SetPose(this Transform transform, Pose pose)
        {
            transform.position = pose.Position.ToUnity();
            transform.rotation = pose.Orientation.ToUnity();
        }

        /// <summary>A mesh of Unity, compiled: at the scale of the object that shows it, in its frame.</summary>
        public static Mesh Compile(this UnityEngine.Mesh mesh, Vector3 scale, CompileOptions options = null)
        {
            Vector3[] places = mesh.vertices;
            double[] vertices = new double[3 * places.Length];
            for (int i = 0; i < places.Length; i++)
            {
                vertices[3 * i] = (double)places[i].x * scale.x;
                vertices[3 * i + 1] = (double)places[i].y * scale.y;
                vertices[3 * i + 2] = (double)places[i].z * scale.z;
            }
            int[] triangles = mesh.triangles;
            // A scale of an odd number of negative signs turns triangles over.
            if (scale.x * scale.y * scale.z >= 0) triangles = UnityFrame.MirrorTriangles(triangles);
            return Mesh.Compile(UnityFrame.MirrorVertices(vertices), triangles, 1, options);
        }
    }
}
#endif
