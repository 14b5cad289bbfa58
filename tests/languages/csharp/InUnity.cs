// SPDX-License-Identifier: BSD-3-Clause
// The sample of Unity's package, driven as Unity drives it, in Unity's frame: InUnity.exe.
using System;
using System.Reflection;
using System.Threading;
using Dynpoint;
using UnityEngine;

static class InUnity
{
    static int failed;

    static void That(bool isSo, string what, params object[] seen)
    {
        if (!isSo) failed++;
        Console.WriteLine((isSo ? "ok " : "FAIL ") + string.Format(System.Globalization.CultureInfo.InvariantCulture,
            what, seen));
    }

    static void Call(MonoBehaviour behaviour, string name)
    {
        behaviour.GetType().GetMethod(name, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(behaviour, null);
    }

    /// <summary>A cube from -1 to 1, its triangles wound as Unity shows them: (b - a) x (c - a) points outside.</summary>
    static UnityEngine.Mesh MakeCube()
    {
        Vector3[] corners = new Vector3[8];
        for (int i = 0; i < 8; i++) corners[i] = new Vector3((i & 1) * 2 - 1, (i >> 1 & 1) * 2 - 1, (i >> 2 & 1) * 2 - 1);
        int[] triangles =
        {
            0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6,
        };
        return new UnityEngine.Mesh { vertices = corners, triangles = triangles };
    }

    /// <summary>An open sheet is felt from its front alone, which only its winding tells.</summary>
    static void Windings()
    {
        UnityEngine.Mesh sheet = new UnityEngine.Mesh
        {
            vertices = new[] { new Vector3(-1, 0, -1), new Vector3(-1, 0, 1), new Vector3(1, 0, 1),
                             new Vector3(1, 0, -1) },
            triangles = new[] { 0, 1, 2, 0, 2, 3 },
        };
        Vector3 up = Vector3.Cross(sheet.vertices[1] - sheet.vertices[0], sheet.vertices[2] - sheet.vertices[0]);
        foreach (float side in new[] { 1f, -1f })
            using (Dynpoint.Mesh mesh = sheet.Compile(new Vector3(side, 1, 1)))
            {
                float[] v = mesh.GetVertices();
                int[] t = mesh.GetTriangles();
                double[] a = new double[3], b = new double[3];
                for (int k = 0; k < 3; k++)
                {
                    a[k] = v[3 * t[1] + k] - v[3 * t[0] + k];
                    b[k] = v[3 * t[2] + k] - v[3 * t[0] + k];
                }
                That(up.y > 0 && a[2] * b[0] - a[0] * b[2] > 0, "a sheet's front stays up, at a scale of {0}", side);
            }
    }

    static void Sample()
    {
        Touch touch = new Touch { organ = new MeshFilter { sharedMesh = MakeCube() }, proxy = new Transform() };
        touch.friction = 0;
        touch.organ.transform.lossyScale = new Vector3(0.5f, 0.1f, 0.25f);
        // A slab of 1 x 0.2 x 0.5 m, turned by 90 degrees about Unity's y, which brings z to x.
        touch.organ.transform.rotation = new Quaternion(0, (float)Math.Sqrt(0.5), 0, (float)Math.Sqrt(0.5));
        Vector3 ahead = touch.organ.transform.rotation * new Vector3(0, 0, 1);
        That(Math.Abs(ahead.x - 1) < 1e-6, "Unity's z goes to {0}", ahead);
        touch.transform.position = new Vector3(0, 0.2f, -0.35f);
        Call(touch, "OnEnable");
        for (int i = 0; i < 60; i++)
        {
            touch.transform.position = touch.transform.position + new Vector3(0, -0.002f, 0);
            Call(touch, "FixedUpdate");
        }
        // Its stylus lies along z, from -0.35 to -0.2, 20 mm deep in the slab, which begins at -0.5.
        That(touch.Force.y > 5 && Math.Abs(touch.Force.x) < 1e-3 && Math.Abs(touch.Force.z) < 1e-3,
             "pushed up, in Unity's frame: {0} N", touch.Force);
        That(touch.proxy.position.y > 0.101f && touch.proxy.position.y < 0.103f, "the proxy lies on it: {0}",
             touch.proxy.position);
        That(Debug.Rays.Count == 60 && Debug.Rays[59].y > 0, "its force is drawn");
        // The push is at the stylus' middle.
        Vector3 expected = Vector3.Cross(new Vector3(0, 0, 0.075f), touch.Force);
        That((touch.Torque - expected).magnitude < 0.02f * expected.magnitude && expected.x < -0.3f,
             "the torque is that of the force at its middle: {0} Nm, expected {1}", touch.Torque, expected);
        // A frame that is turned carries the stylus with it.
        touch.transform.rotation = new Quaternion(0, (float)Math.Sin(0.3), 0, (float)Math.Cos(0.3));
        touch.transform.position = new Vector3(0.1f, 0.3f, 0);
        for (int i = 0; i < 5; i++) Call(touch, "FixedUpdate");
        Tool tool = (Tool)typeof(Touch).GetField("tool", BindingFlags.Instance | BindingFlags.NonPublic).GetValue(touch);
        Hit hit = tool.Hit;
        Vector3 tip = touch.transform.position + touch.transform.rotation * new Vector3(0, 0, touch.length);
        Vector3 along = hit.P.ToUnity() - touch.transform.position;
        That(Vector3.Cross(along, tip - touch.transform.position).magnitude < 1e-6f
             && Math.Abs(hit.Distance - 0.2) < 1e-6,
             "a turned stylus lies where Unity has it: {0} of {1}", hit.P.ToUnity(), tip);
        Call(touch, "OnDisable");
    }

    /// <summary>A simulated hand presses down in the library's frame; y is up in both.</summary>
    static void DeviceSample()
    {
        DeviceTouch touch = new DeviceTouch { organ = new MeshFilter { sharedMesh = MakeCube() } };
        touch.device = "sim:?hand=press";
        touch.held = new Transform();
        touch.proxy = new Transform();
        touch.organ.transform.lossyScale = new Vector3(0.5f, 0.1f, 0.5f);
        touch.organ.transform.position = new Vector3(0, -0.1f, 0.3f);
        touch.transform.position = new Vector3(0, 0.02f, 0.3f);
        Call(touch, "OnEnable");
        int shown = 0;
        float highest = 0, apart = 0, ahead = 0;
        for (int frame = 0; frame < 2000000 && highest < 0.5f; frame++)
        {
            Call(touch, "Update");
            Thread.Yield();
            highest = Math.Max(highest, touch.Force.y);
            apart = Math.Max(apart, touch.proxy.position.y - touch.held.position.y);
            ahead = Math.Max(ahead, touch.held.position.z);
            shown++;
        }
        Call(touch, "OnDisable");
        That(highest >= 0.5f && apart > 0 && Math.Abs(ahead - 0.3f) < 0.1f,
             "a device in a thread: {0:f2} N up, its proxy {1:f4} m above the hand, at z {2:f2}", highest, apart, ahead);
    }

    /// <summary>Unity disables, and enables once more, also what could not be enabled.</summary>
    static void Failures()
    {
        foreach (MonoBehaviour sample in new MonoBehaviour[]
                 {
                     new Touch { organ = new MeshFilter { sharedMesh = MakeCube() } },
                     new DeviceTouch { organ = new MeshFilter { sharedMesh = MakeCube() }, device = "nothing:" },
                 })
        {
            MeshFilter organ = sample is Touch ? ((Touch)sample).organ : ((DeviceTouch)sample).organ;
            string said = "";
            foreach (float scale in new[] { 0f, 1f })
            {
                organ.transform.lossyScale = new Vector3(scale, scale, scale);
                foreach (string name in new[] { "OnEnable", "OnDisable" })
                    try
                    {
                        Call(sample, name);
                    }
                    catch (TargetInvocationException error)
                    {
                        said += name + " " + error.InnerException.GetType().Name + " ";
                    }
            }
            const string refused = "OnEnable DynpointException ";
            That(said == (sample is Touch ? refused : refused + refused), "{0} that could not be enabled: {1}",
                 sample.GetType().Name, said);
        }
    }

    static int Main()
    {
        Failures();
        Windings();
        Sample();
        DeviceSample();
        return failed > 0 ? 2 : 0;
    }
}
