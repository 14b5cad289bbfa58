// SPDX-License-Identifier: BSD-3-Clause
using System;
using System.Threading;
using Dynpoint;
using UnityEngine;

/// <summary>
/// A device that touches what `organ` shows, by the host library's loop of 1 kHz in a thread of its own, with its guard.
/// This object stands where the device's origin is in the scene.
/// </summary>
public class DeviceTouch : MonoBehaviour
{
    public MeshFilter organ;
    [Tooltip("Drawn where the hand holds the tool")] public Transform held;
    [Tooltip("Drawn where the tool is that goes through nothing")] public Transform proxy;
    [Tooltip("As `dynpoint run --device` takes it")] public string device = "sim:?hand=press&live=1";
    public float length = 0.15f;
    public float radius = 0.002f;
    [Tooltip("Metres of the scene for one of the hand")] public float zoom = 1;

    /// <summary>What the hand feels, N.</summary>
    public Vector3 Force { get; private set; }

    private readonly object gate = new object();
    private Dynpoint.Mesh mesh;
    private Scene scene;
    private Thread loop;
    private SceneTick last;
    private bool isFelt;
    private Exception failure;
    private Double3 origin;

    private void OnEnable()
    {
        mesh = organ.sharedMesh.Compile(organ.transform.lossyScale);
        SceneOptions options = new SceneOptions { Felt = Feel };
        options.Bodies = new[] { new SceneBody { Mesh = mesh, Pose = organ.transform.ToDynpoint(), Name = "organ" } };
        origin = transform.position.ToDynpoint();
        for (int k = 0; k < 3; k++) options.Def.Origin[k] = origin[k];
        options.Def.Length = length;
        options.Def.Radius = radius;
        options.Def.Zoom = zoom;
        scene = new Scene(null, device, options);
        isFelt = false;
        failure = null;
        loop = new Thread(Run) { Priority = System.Threading.ThreadPriority.Highest };
        loop.Start();
    }

    private void Run()
    {
        try
        {
            scene.Run();
        }
        catch (Exception error)
        {
            lock (gate) failure = error;
        }
    }

    /// <summary>In the loop's thread: it must not wait, nor ask Unity for anything.</summary>
    private void Feel(SceneTick tick)
    {
        lock (gate)
        {
            last = tick;
            isFelt = true;
        }
    }

    private void Update()
    {
        SceneTick tick;
        Exception error;
        bool isThere;
        lock (gate)
        {
            tick = last;
            isThere = isFelt;
            error = failure;
            failure = null;
        }
        if (error != null) Debug.LogException(error);
        if (!isThere) return;
        Force = tick.Wrench.Force.ToUnity();
        Double3 hand = tick.State.Pose.Position;
        for (int k = 0; k < 3; k++) hand[k] = origin[k] + zoom * hand[k];
        if (held != null) held.SetPose(new Dynpoint.Pose(hand, tick.State.Pose.Orientation));
        if (proxy != null) proxy.SetPose(tick.Proxy);
    }

    /// <summary>The device gets zero force. Where OnEnable failed, there is less to close.</summary>
    private void OnDisable()
    {
        if (scene != null)
        {
            scene.Stop();
            loop.Join();
            scene.Dispose();
        }
        if (mesh != null) mesh.Dispose();
        scene = null;
        mesh = null;
    }
}
