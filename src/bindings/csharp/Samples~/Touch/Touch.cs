// SPDX-License-Identifier: BSD-3-Clause
using Dynpoint;
using UnityEngine;

/// <summary>
/// A tool that touches what `organ` shows. Put it on an empty object, which you move by a device, a script or by hand:
/// the stylus points along the object's z. `proxy` is drawn where the tool is that goes through nothing.
/// </summary>
public class Touch : MonoBehaviour
{
    public MeshFilter organ;
    public Transform proxy;
    public float length = 0.15f;
    public float radius = 0.002f;
    public float stiffness = 500;
    public float friction = 0.3f;
    [Tooltip("Ticks of the world in one step of Unity's physics")] public int ticks = 20;

    /// <summary>What the tool feels, N.</summary>
    public Vector3 Force { get; private set; }

    /// <summary>About this object's origin, Nm, as Rigidbody.AddTorque takes it.</summary>
    public Vector3 Torque { get; private set; }

    private Dynpoint.Mesh mesh;
    private World world;
    private Body body;
    private Tool tool;
    private Vector3 lastPosition;
    private Quaternion lastRotation;

    private void OnEnable()
    {
        mesh = organ.sharedMesh.Compile(organ.transform.lossyScale);
        world = new World();
        body = world.AddBody(mesh, organ.transform.ToDynpoint());
        body.SetFriction(friction, friction);
        tool = world.AddTool(new Segment(Vector3.zero.ToDynpoint(), new Vector3(0, 0, length).ToDynpoint(), radius));
        ToolSettings settings = tool.Settings;
        settings.Stiffness = stiffness;
        tool.Settings = settings;
        tool.Teleport(transform.ToDynpoint());
        lastPosition = transform.position;
        lastRotation = transform.rotation;
    }

    private void FixedUpdate()
    {
        body.Pose = organ.transform.ToDynpoint();
        Wrench wrench = new Wrench();
        for (int i = 1; i <= ticks; i++)
        {
            float part = (float)i / ticks;
            Dynpoint.Pose held = new Dynpoint.Pose(Vector3.Lerp(lastPosition, transform.position, part).ToDynpoint(),
                                                   Quaternion.Slerp(lastRotation, transform.rotation, part).ToDynpoint());
            wrench = tool.Tick(held, Time.fixedDeltaTime / ticks);
        }
        lastPosition = transform.position;
        lastRotation = transform.rotation;
        Force = wrench.Force.ToUnity();
        Torque = wrench.Torque.TorqueToUnity();
        if (proxy != null) proxy.SetPose(tool.Proxy);
        Debug.DrawRay(transform.position, 0.02f * Force, Color.red);
    }

    /// <summary>Where OnEnable failed, there is less to close.</summary>
    private void OnDisable()
    {
        if (world != null) world.Dispose();
        if (mesh != null) mesh.Dispose();
        world = null;
        mesh = null;
    }
}
