// SPDX-License-Identifier: BSD-3-Clause
// As much of Unity as the package and its sample use, by Unity's manual: it stands for Unity where there is none. Its
// numbers are floats, its frame is left-handed.
using System;
using System.Collections.Generic;

namespace AOT
{
    [AttributeUsage(AttributeTargets.Method)]
    public class MonoPInvokeCallbackAttribute : Attribute
    {
        public MonoPInvokeCallbackAttribute(Type type)
        {
        }
    }
}

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 zero
        {
            get { return new Vector3(0, 0, 0); }
        }

        public static Vector3 operator *(float factor, Vector3 v)
        {
            return new Vector3(factor * v.x, factor * v.y, factor * v.z);
        }

        public static Vector3 operator +(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        }

        public static Vector3 operator -(Vector3 a, Vector3 b)
        {
            return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        }

        public static Vector3 Cross(Vector3 a, Vector3 b)
        {
            return new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
        }

        public static Vector3 Lerp(Vector3 a, Vector3 b, float part)
        {
            return a + part * (b - a);
        }

        public float magnitude
        {
            get { return (float)Math.Sqrt(x * x + y * y + z * z); }
        }

        public override string ToString()
        {
            return "(" + x + " " + y + " " + z + ")";
        }
    }

    public struct Quaternion
    {
        public float x, y, z, w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static Vector3 operator *(Quaternion q, Vector3 v)
        {
            Vector3 u = new Vector3(q.x, q.y, q.z), t = 2 * Vector3.Cross(u, v);
            return v + q.w * t + Vector3.Cross(u, t);
        }

        /// <summary>Of turns that are near each other it is this but for a small part.</summary>
        public static Quaternion Slerp(Quaternion a, Quaternion b, float part)
        {
            float sign = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w < 0 ? -1 : 1;
            Quaternion q = new Quaternion(a.x + part * (sign * b.x - a.x), a.y + part * (sign * b.y - a.y),
                                          a.z + part * (sign * b.z - a.z), a.w + part * (sign * b.w - a.w));
            float length = (float)Math.Sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
            return new Quaternion(q.x / length, q.y / length, q.z / length, q.w / length);
        }
    }

    public class Transform
    {
        public Vector3 position;
        public Quaternion rotation = new Quaternion(0, 0, 0, 1);
        public Vector3 lossyScale = new Vector3(1, 1, 1);
    }

    public class MonoBehaviour
    {
        public Transform transform = new Transform();
    }

    public class MeshFilter : MonoBehaviour
    {
        public Mesh sharedMesh;
    }

    public class Mesh
    {
        public Vector3[] vertices;
        public int[] triangles;
    }

    [AttributeUsage(AttributeTargets.Field)]
    public class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string text)
        {
        }
    }

    public struct Color
    {
        public static Color red
        {
            get { return new Color(); }
        }
    }

    public static class Time
    {
        public const float fixedDeltaTime = 0.02f;
    }

    public static class Debug
    {
        public static readonly List<Vector3> Rays = new List<Vector3>();

        public static void LogException(Exception error)
        {
            throw error;
        }

        public static void DrawRay(Vector3 start, Vector3 direction, Color color)
        {
            Rays.Add(direction);
        }
    }
}
