// SPDX-License-Identifier: BSD-3-Clause
// The scene of tests/languages in Java: Touch [ROUNDS] prints HASH TICKS SECONDS (touch.c).
import dynpoint.Mesh;
import dynpoint.World;

final class Touch {
    static final int RINGS = 24, SIDES = 48, TICKS = 10000;

    static double[] circle(int k) {
        double t = (double) (k % (SIDES / 4)) / (SIDES / 4), c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t);
        return switch (k / (SIDES / 4) % 4) {
            case 0 -> new double[] { c, s };
            case 1 -> new double[] { -s, c };
            case 2 -> new double[] { -c, -s };
            default -> new double[] { s, -c };
        };
    }

    static Mesh makeBall() {
        double[] vertices = new double[(RINGS + 1) * SIDES * 3];
        int[] corners = new int[RINGS * SIDES * 6];
        for (int r = 0; r <= RINGS; r++)
            for (int k = 0; k < SIDES; k++) {
                double[] height = circle(r), turn = circle(k);
                int a = r * SIDES + k, b = r * SIDES + (k + 1) % SIDES;
                vertices[3 * a] = 0.05 * height[1] * turn[0];
                vertices[3 * a + 1] = 0.05 * height[1] * turn[1];
                vertices[3 * a + 2] = 0.05 * height[0];
                int[] two = { a, a + SIDES, b, b, a + SIDES, b + SIDES };
                if (r < RINGS) System.arraycopy(two, 0, corners, 6 * a, 6);
            }
        return Mesh.compile(vertices, corners);
    }

    static int fold(int tick, int n) {
        return Math.abs(tick % (2 * n) - n);
    }

    static double[] path(int tick) {
        double u = (fold(tick, 2000) - 1000) * 0.00005;
        return new double[] { (fold(tick, 1500) - 750) * 0.00002, (fold(tick, 1100) - 550) * 0.00002,
                              0.05 + fold(tick, 500) * 0.00001,
                              (1 - u * u) / (1 + u * u), 0, 2 * u / (1 + u * u), 0 };
    }

    static double feel(Mesh mesh, double[][] poses, double[][] wrenches) {
        try (World world = new World()) {
            world.addBody(mesh).setFriction(0.3, 0.3);
            World.Tool tool = world.addTool(new double[] { -0.025, 0, 0 }, new double[] { 0.025, 0, 0 }, 0.002);
            long began = System.nanoTime();
            for (int tick = 0; tick < TICKS; tick++)
                tool.tick(poses[tick], 0.001, wrenches[tick]);
            return 1e-9 * (System.nanoTime() - began);
        }
    }

    public static void main(String[] arguments) {
        double[][] poses = new double[TICKS][], wrenches = new double[TICKS][6];
        double least = Double.POSITIVE_INFINITY;
        for (int tick = 0; tick < TICKS; tick++) poses[tick] = path(tick);
        Mesh mesh = makeBall();
        for (int round = arguments.length > 0 ? Integer.parseInt(arguments[0]) : 1; round > 0; round--)
            least = Math.min(least, feel(mesh, poses, wrenches));
        long hash = 0xcbf29ce484222325L;
        for (double[] wrench : wrenches)
            for (double x : wrench)
                for (int shift = 0; shift < 64; shift += 8)
                    hash = (hash ^ (Double.doubleToRawLongBits(x) >>> shift & 255)) * 1099511628211L;
        System.out.printf(java.util.Locale.ROOT, "%016x %d %.6f%n", hash, TICKS, least);
    }
}
