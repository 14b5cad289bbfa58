// SPDX-License-Identifier: BSD-3-Clause
package dynpoint;

import static dynpoint.Abi.*;
import static java.lang.foreign.ValueLayout.*;

import java.lang.foreign.Arena;
import java.lang.foreign.MemorySegment;
import java.util.concurrent.atomic.AtomicBoolean;

/**
 * A scene that is felt with a device, and safely so: the host library. One thread at a time may use it; stop() may be
 * called from any.
 */
public final class Scene implements AutoCloseable {
    private final Arena arena = Arena.ofShared();
    private final MemorySegment host;
    private final AtomicBoolean isBusy = new AtomicBoolean();
    private final Object stopping = new Object(); // held while it is stopped, and while it is closed

    /** A scene's name or path, a device, and after how many ticks a run ends; 0: none. */
    public Scene(String scene, String device, long ticks) {
        MemorySegment opened = null;
        try (Arena call = Arena.ofConfined()) {
            MemorySegment def = call.allocate(dpt_host_def.LAYOUT), out = call.allocate(ADDRESS),
                error = dpt_host_error.sized(call);
            dpt_host_def_defaults(def, def.byteSize());
            dpt_host_def.scene(def, call.allocateFrom(scene));
            dpt_host_def.device(def, call.allocateFrom(device));
            dpt_host_def.ticks(def, ticks);
            int result = dpt_host_open(def, out, error);
            if (result != DPT_OK) throw new DynpointException(result, "Scene", dpt_host_error.text(error));
            opened = out.get(ADDRESS, 0).reinterpret(arena, null);
        } finally {
            if (opened == null) arena.close();
        }
        host = opened;
    }

    private void enter(String what) {
        if (!isBusy.compareAndSet(false, true)) throw new IllegalStateException(what + ": another call is in this scene");
    }

    /** Serves the device in this thread, until stop(), after the ticks, or when it is lost. How many ticks it was. */
    public long run() {
        enter("Scene.run");
        try (Arena call = Arena.ofConfined()) {
            MemorySegment stats = dpt_loop_stats.sized(call), error = dpt_host_error.sized(call);
            int result = dpt_host_run(host, stats, error);
            if (result != DPT_OK) throw new DynpointException(result, "Scene.run", dpt_host_error.text(error));
            return dpt_loop_stats.ticks(stats);
        } finally {
            isBusy.set(false);
        }
    }

    /** Ends the present run, or the next one. From any thread. */
    public void stop() {
        synchronized (stopping) {
            dpt_host_stop(host);
        }
    }

    /** Ticks with contact, and the strongest force at the hand, N. */
    public double[] felt() {
        enter("Scene.felt");
        try (Arena call = Arena.ofConfined()) {
            MemorySegment info = dpt_host_info.sized(call);
            Library.check(dpt_host_get_info(host, info), "Scene.felt");
            return new double[] { dpt_host_info.contacts(info), dpt_host_info.force_max(info) };
        } finally {
            isBusy.set(false);
        }
    }

    /** The device gets zero force. It must not be running. */
    @Override
    public void close() {
        enter("Scene.close");
        try {
            if (!arena.scope().isAlive()) return;
            synchronized (stopping) {
                dpt_host_close(host, MemorySegment.NULL);
                arena.close();
            }
        } finally {
            isBusy.set(false);
        }
    }
}
