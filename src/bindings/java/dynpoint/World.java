// SPDX-License-Identifier: BSD-3-Clause
package dynpoint;

import static dynpoint.Abi.*;
import static java.lang.foreign.ValueLayout.*;

import java.lang.foreign.Arena;
import java.lang.foreign.MemorySegment;
import java.util.HashMap;
import java.util.Map;

/**
 * Bodies, and tools that feel them. It belongs to the thread that made it: another one gets a WrongThreadException, and
 * after close() everybody an IllegalStateException.
 */
public final class World implements AutoCloseable {
    private final Arena arena = Arena.ofConfined();
    private final MemorySegment world, pose = arena.allocate(dpt_pose.LAYOUT), wrench = arena.allocate(dpt_wrench.LAYOUT);
    private final MemorySegment id = arena.allocate(JAVA_INT);
    private final Map<Integer, Mesh> meshes = new HashMap<>();

    public World() {
        MemorySegment def = arena.allocate(dpt_world_def.LAYOUT), out = arena.allocate(ADDRESS);
        dpt_world_def_defaults(def, def.byteSize());
        long bytes = dpt_world_bytes(def);
        Library.check(dpt_world_create(arena.allocate(bytes, 64), bytes, def, out), "World");
        world = out.get(ADDRESS, 0).reinterpret(arena, null);
    }

    /** A rigid body at a pose: position in m, and a unit quaternion (w, x, y, z). Its mesh stays as long as it. */
    public Body addBody(Mesh mesh, double... at) {
        Library.check(dpt_body_add(world, mesh.address(), poseOf(at), id), "World.addBody");
        meshes.put(id.get(JAVA_INT, 0), mesh);
        return new Body(id.get(JAVA_INT, 0));
    }

    /** A tool of one capsule, in its own frame: ends and radius, m. */
    public Tool addTool(double[] a, double[] b, double radius) {
        try (Arena call = Arena.ofConfined()) {
            MemorySegment segment = call.allocate(dpt_segment.LAYOUT);
            for (int k = 0; k < 3; k++) {
                dpt_segment.a(segment, k, a[k]);
                dpt_segment.b(segment, k, b[k]);
            }
            dpt_segment.radius(segment, radius);
            Library.check(dpt_tool_add(world, segment, 1, id), "World.addTool");
        }
        return new Tool(id.get(JAVA_INT, 0));
    }

    public void step(double dt) {
        Library.check(dpt_world_step(world, dt, MemorySegment.NULL), "World.step");
    }

    private MemorySegment poseOf(double[] at) {
        if (at.length == 0) return MemorySegment.NULL;
        if (at.length != 7) throw new IllegalArgumentException("a pose is 7 numbers: position, quaternion (w, x, y, z)");
        for (int k = 0; k < 3; k++) dpt_pose.position(pose, k, at[k]);
        for (int k = 0; k < 4; k++) dpt_pose.orientation(pose, k, at[3 + k]);
        return pose;
    }

    /** Memory and all that is in it. */
    @Override
    public void close() {
        arena.close();
        meshes.clear();
    }

    /** A body of this world. */
    public final class Body {
        private final int body;

        private Body(int body) {
            this.body = body;
        }

        public void setPose(double... at) {
            Library.check(dpt_body_set_pose(world, body, poseOf(at)), "Body.setPose");
        }

        public void setFriction(double still, double moving) {
            try (Arena call = Arena.ofConfined()) {
                MemorySegment settings = dpt_body_settings.sized(call);
                Library.check(dpt_body_get_settings(world, body, settings), "Body.setFriction");
                dpt_body_settings.static_friction(settings, still);
                dpt_body_settings.kinetic_friction(settings, moving);
                Library.check(dpt_body_set_settings(world, body, settings), "Body.setFriction");
            }
        }

        public void remove() {
            Library.check(dpt_body_remove(world, body), "Body.remove");
            meshes.remove(body);
        }
    }

    /** A tool of this world. */
    public final class Tool {
        private final int tool;

        private Tool(int tool) {
            this.tool = tool;
        }

        public void setPose(double... at) {
            Library.check(dpt_tool_set_pose(world, tool, poseOf(at)), "Tool.setPose");
        }

        /** Force (N), and torque (Nm) about the origin of the tool's frame: six numbers. */
        public double[] wrench() {
            double[] felt = new double[6];
            getWrench(felt);
            return felt;
        }

        private void getWrench(double[] felt) {
            Library.check(dpt_tool_get_wrench(world, tool, wrench), "Tool.wrench");
            MemorySegment.copy(wrench, JAVA_DOUBLE, 0, felt, 0, 6);
        }

        /** Set the pose, step the world, get the wrench: a tick of a loop with one tool. */
        public void tick(double[] at, double dt, double[] felt) {
            setPose(at);
            step(dt);
            getWrench(felt);
        }

        /** The pose that has gone through nothing: where to draw the tool. */
        public double[] proxy() {
            Library.check(dpt_tool_get_proxy(world, tool, pose), "Tool.proxy");
            return pose.toArray(JAVA_DOUBLE);
        }

        public void remove() {
            Library.check(dpt_tool_remove(world, tool), "Tool.remove");
        }
    }
}
