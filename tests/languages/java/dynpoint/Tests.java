// SPDX-License-Identifier: BSD-3-Clause
// Tests of the sample in Java: dynpoint.Tests LAYOUTS prints "ok WHAT" or "FAIL WHAT", a line a check
// (tests/languages/check.sh).
package dynpoint;

import java.io.IOException;
import java.lang.foreign.Arena;
import java.lang.foreign.MemoryLayout;
import java.lang.foreign.MemoryLayout.PathElement;
import java.lang.foreign.MemorySegment;
import java.lang.foreign.StructLayout;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.Arrays;
import java.util.HashMap;
import java.util.Map;
import java.util.concurrent.CountDownLatch;
import java.util.regex.MatchResult;
import java.util.regex.Pattern;

final class Tests {
    private static int failed;

    private static void that(boolean isSo, String what, Object... seen) {
        if (!isSo) failed++;
        String text = String.format(java.util.Locale.ROOT, what, seen);
        System.out.println((isSo ? "ok " : "FAIL ") + text.replace('\n', ' '));
    }

    private static void refuses(Class<? extends Exception> kind, Runnable call, String what, String... words) {
        String said = "nothing was thrown";
        boolean isSo = false;
        try {
            call.run();
        } catch (Exception error) {
            said = error.toString();
            isSo = kind.isInstance(error) && Arrays.stream(words).allMatch(said::contains);
        }
        that(isSo, "%s (%s)", what, said);
    }

    /** What Java thinks of the structs, beside tests/abi/layouts.txt, which the C compiler is held to. */
    private static void layoutsAreTheLibrarys(String path) throws IOException, ReflectiveOperationException {
        Map<String, StructLayout> structs = new HashMap<>();
        for (StructLayout layout : Abi.LAYOUTS) structs.put(layout.name().orElseThrow(), layout);
        int found = 0;
        String wrong = "";
        Pattern line = Pattern.compile("^(FIELD|SIZE|VALUE)\\((\\w+), *([^)]*)\\)", Pattern.MULTILINE);
        for (MatchResult match : line.matcher(Files.readString(Path.of(path))).results().toList()) {
            String name = match.group(2);
            String[] rest = match.group(3).split(", *");
            StructLayout layout = structs.get(name);
            boolean isSame;
            if (match.group(1).equals("VALUE")) {
                long value = Long.decode(rest[0].replaceAll("[uU]$", ""));
                isSame = name.equals("DPT_RESULT_END") || Abi.class.getDeclaredField(name).getInt(null) == (int) value;
            } else if (match.group(1).equals("SIZE")) {
                isSame = layout.byteSize() == Long.parseLong(rest[0]);
            } else {
                MemoryLayout field = layout.select(PathElement.groupElement(rest[0]));
                isSame = field.byteSize() == Long.parseLong(rest[2])
                    && layout.byteOffset(PathElement.groupElement(rest[0])) == Long.parseLong(rest[1]);
            }
            found += isSame ? 1 : 0;
            if (!isSame) wrong += match.group() + " ";
        }
        that(wrong.isEmpty() && found > 1000, "%d places, sizes and values are those of layouts.txt %s", found, wrong);
    }

    private static final int[] TRIANGLES = {
        0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6,
    };

    /** A cube from -1 to 1, its corners at the bits of their number. */
    private static double[] corners() {
        double[] corners = new double[24];
        for (int i = 0; i < 24; i++) corners[i] = (i / 3 >> i % 3 & 1) * 2 - 1;
        return corners;
    }

    private static World.Tool addRod(World world) {
        return world.addTool(new double[] { 0, 0, 0 }, new double[] { 0, 0.5, 0 }, 0.1);
    }

    private static void misuse() throws InterruptedException {
        Mesh box = Mesh.compile(corners(), TRIANGLES);
        that(box.distances(new double[] { 0, 3, 0, 0, 5, 0 })[0] == 2, "a query");
        World world = new World();
        World.Body body = world.addBody(box);
        World.Tool tool = addRod(world);
        refuses(DynpointException.class, () -> tool.setPose(Double.NaN, 0, 0, 1, 0, 0, 0), "a pose of NaN",
                "Tool.setPose", "DPT_E_FINITE");
        refuses(DynpointException.class, () -> world.step(Double.NaN), "a step of NaN", "World.step", "range");
        refuses(DynpointException.class, () -> box.distances(new double[] { 0, 0, 0, 0, 0, Double.NaN }),
                "a query of NaN", "DPT_E_FINITE");
        refuses(DynpointException.class, () -> Mesh.compile(corners(), new int[] { 0, 1, 8 }),
                "a triangle without its vertex", "vertex 8");
        refuses(IllegalArgumentException.class, () -> Mesh.compile(new double[7], new int[3]),
                "seven numbers for vertices", "three numbers");
        refuses(IllegalArgumentException.class, () -> tool.setPose(1, 2, 3), "three numbers for a pose", "7 numbers");
        refuses(DynpointException.class, () -> Mesh.open(new byte[0]), "no bytes", "DPT_E_TRUNCATED");
        refuses(DynpointException.class, () -> Mesh.open(new byte[4096]), "bytes of something else", "DPT_E_MAGIC");
        refuses(DynpointException.class, () -> Mesh.load("none.obj", 1), "a file that is not there", "none.obj",
                "DPT_E_OPEN");
        try (Arena call = Arena.ofConfined()) {
            MemorySegment guard = call.allocate(Abi.dpt_guard.LAYOUT);
            Abi.dpt_guard.size(guard, 12);
            that(Abi.dpt_guard_init(guard, MemorySegment.NULL) == Abi.DPT_E_SIZE,
                 "a struct of a wrong size, of the functions as they are");
            refuses(IndexOutOfBoundsException.class, () -> Abi.dpt_pose.position(call.allocate(Abi.dpt_pose.LAYOUT), 3),
                    "a fourth coordinate");
        }
        box.close();
        refuses(IllegalStateException.class, () -> world.addBody(box), "a body of a mesh that was freed", "closed");
        System.gc();
        double[] felt = new double[6];
        for (int i = 0; i < 100; i++) tool.tick(new double[] { 0, 1.2 - 0.002 * i, 0, 1, 0, 0, 0 }, 0.001, felt);
        that(felt[1] > 10 && tool.proxy()[1] > 1.09, "the world that has a body of it feels it: %.1f N", felt[1]);
        Throwable[] thrown = new Throwable[1];
        Thread other = new Thread(() -> {
            try {
                world.step(0.001);
            } catch (Throwable error) {
                thrown[0] = error;
            }
        });
        other.start();
        other.join();
        that(thrown[0] instanceof WrongThreadException, "a second thread in a world (%s)", thrown[0]);
        body.remove();
        refuses(DynpointException.class, () -> body.setPose(0, 0, 0, 1, 0, 0, 0), "a body that was removed",
                "Body.setPose", "stale");
        world.close();
        refuses(IllegalStateException.class, () -> world.step(0.001), "a world that was closed", "closed");
        refuses(IllegalStateException.class, tool::wrench, "a tool of one", "closed");
    }

    private static void scenes() throws InterruptedException {
        refuses(DynpointException.class, () -> new Scene("nothing.dpa", "sim:", 1), "a scene that is not there",
                "nothing.dpa", "opened");
        refuses(DynpointException.class, () -> new Scene("liver", "sim:?hand=nothing", 1), "a device of no such hand",
                "nothing");
        Scene scene = new Scene("liver", "sim:?hand=press", 3000);
        that(scene.run() == 3000, "a scene on a device");
        // run.sh compares this line with what the program says.
        System.out.println("scene " + (long) scene.felt()[0] + " " + scene.felt()[1]);
        scene.close();
        refuses(IllegalStateException.class, scene::run, "a scene that was closed", "closed");
        refuses(IllegalStateException.class, scene::stop, "to stop one", "closed");
        scene.close();
        try (Scene endless = new Scene("liver", "sim:?hand=press", 0)) {
            Thread runner = new Thread(() -> {
                for (boolean hasRun = false; !hasRun;) {
                    try {
                        endless.run();
                        hasRun = true; // also without a tick, where it was stopped first
                    } catch (IllegalStateException error) {
                        Thread.onSpinWait(); // the other thread was in it: it is our turn next
                    }
                }
            });
            runner.start();
            int refused = 0;
            for (int i = 0; i < 1000000 && refused == 0 && runner.isAlive(); i++) {
                try {
                    endless.felt();
                } catch (IllegalStateException error) {
                    refused++;
                }
            }
            refuses(IllegalStateException.class, endless::close, "a scene that is closed while it runs", "another call");
            endless.stop();
            runner.join();
            that(refused > 0 && endless.felt()[0] >= 0, "a second thread in a scene is refused; stop() ends it");
        }
    }

    /** A thread stops scenes until they are closed, which another one does meanwhile. */
    private static void closedWhileStopped() throws InterruptedException {
        Throwable[] thrown = new Throwable[1];
        int closed = 0;
        for (; closed < 5 && thrown[0] == null; closed++) {
            Scene scene = new Scene("liver", "sim:?hand=press", 1);
            CountDownLatch begun = new CountDownLatch(1000);
            Thread stopper = new Thread(() -> {
                try {
                    for (;; begun.countDown()) scene.stop();
                } catch (IllegalStateException error) {
                    if (!error.getMessage().contains("closed")) thrown[0] = error;
                }
            });
            stopper.start();
            begun.await();
            try {
                scene.close();
            } catch (IllegalStateException error) {
                thrown[0] = error;
                break;
            }
            stopper.join();
        }
        that(closed == 5, "%d scenes that are closed while another thread stops them (%s)", closed, thrown[0]);
    }

    public static void main(String[] arguments) throws Exception {
        layoutsAreTheLibrarys(arguments[0]);
        misuse();
        scenes();
        closedWhileStopped();
        System.exit(failed > 0 ? 2 : 0);
    }
}
