# SPDX-License-Identifier: BSD-3-Clause
"""dynpoint.bulk: lists that are compiled, queried and swept, on processes of this machine and on Dask's workers; a
worker is killed in the middle, and nothing is lost, nothing done twice, and every hash is the program's. BULK is how
many organs."""
import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import unittest.mock
from concurrent.futures import CancelledError, Future
from pathlib import Path

import numpy as np

import dynpoint as dp
import dynpoint.bulk
from verdicts import PROGRAM, main, program

COUNT = int(os.environ.get("BULK", 40))


def write_organs(room):
    """Organs, each another: a liver whose vertices are moved by a wave of its own. Every tenth is malformed in one of
    four ways."""
    program("make", "liver", "1500", "-o", room / "liver.obj")
    lines = (room / "liver.obj").read_text(encoding="ascii").splitlines()
    places = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
    faces = [line for line in lines if line.startswith("f ")]
    (room / "in").mkdir()
    for i in range(COUNT):
        moved = places * (1 + 0.05 * np.sin(i + 20 * places[:, ::-1]))
        rows = ["v %.7f %.7f %.7f" % tuple(place) for place in moved]
        wrong = i // 10 % 4 if i % 10 == 9 else None
        rows += faces if wrong is None else (faces + ["f 1 2 99999"], faces + ["v 1 nan 2"], [], ["f 1 2 x"])[wrong]
        (room / f"in/{i}.obj").write_text("\n".join(rows) + "\n", encoding="ascii")


def manifest(room, name):
    (room / name).mkdir()
    lines = [f"{room}/in/{i}.obj\t{room}/{name}/{i}.dpa" for i in range(COUNT)]
    (room / f"{name}.list").write_text("# organs\n\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return room / f"{name}.list", room / f"{name}.tsv"


def facts(rows, name):
    """What must be the same whoever did it."""
    return [(Path(row.source).name, Path(row.out).name, row.verdict, row.hash) for row in rows]


def killer(table, pids, killed, after=None):
    """Kill one of the processes once a twentieth of the rows is there: early, as the table lags behind what is done."""
    for _ in range(6000):
        if table.exists() and table.read_bytes().count(b"\n") > COUNT // 20 + 2 and pids():
            pid = pids()[0]
            os.kill(pid, signal.SIGKILL)
            killed.append(pid)
            return
        time.sleep(0.001)


class Bulk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.room = Path(cls.folder.name)
        write_organs(cls.room)
        path, table = manifest(cls.room, "program")
        subprocess.run([PROGRAM, "compile", "--list", path, "-o", table, "-j", "2"], capture_output=True, check=False)
        cls.wanted = facts(dp.bulk.read_table(table), "program")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def judge(self, name, table, summary):
        self.assertEqual(facts(summary.rows, name), self.wanted)
        self.assertEqual(facts(dp.bulk.read_table(table), name), self.wanted)
        bad = COUNT // 10
        self.assertEqual((summary.done, summary.refused), (COUNT - bad, bad))
        self.assertEqual(len({row[2] for row in self.wanted}), min(4, bad) + 1, self.wanted)
        self.assertEqual(sorted(path.name for path in (self.room / name).iterdir()),
                         sorted(row[1] for row in self.wanted if row[2] == "DPT_OK"))
        for path in (self.room / name).iterdir():
            self.assertEqual(path.read_bytes(), (self.room / "program" / path.name).read_bytes())

    def test_a_pool_whose_worker_is_killed(self):
        path, table = manifest(self.room, "pool")
        killed = []
        thread = threading.Thread(target=killer, args=(
            table, lambda: [child.pid for child in multiprocessing.active_children()], killed))
        thread.start()
        summary = dp.bulk.run("compile", path, table, workers=2, unit="m")
        thread.join()
        self.assertEqual((len(killed), summary.lost, summary.kept), (1, 1, 0))
        self.judge("pool", table, summary)
        before = table.read_bytes()
        again = dp.bulk.run("compile", path, table, workers=2, unit="m")
        self.assertEqual((again.kept, table.read_bytes()), (COUNT, before))

    def test_dask_s_workers_one_of_which_is_killed(self):
        try:
            import distributed
        except ImportError:
            self.skipTest("no distributed")
        for workers in (1, 2):
            name = f"dask{workers}"
            path, table = manifest(self.room, name)
            with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None,
                                          silence_logs=50) as cluster, distributed.Client(cluster) as client:
                workers_pids = list(client.run(os.getpid).values())
                killed = []
                thread = threading.Thread(target=killer, args=(table, lambda: workers_pids, killed))
                thread.start()
                began = time.perf_counter()
                summary = dp.bulk.run("compile", path, table, client=client, unit="m")
                took = time.perf_counter() - began
                thread.join()
            print(f"note Dask, {workers} workers, one killed: {COUNT / took:.0f} organs a second")
            self.assertEqual(len(killed), 1)
            self.judge(name, table, summary)

    def test_who_is_stopped_goes_on(self):
        path, table = manifest(self.room, "stopped")
        command = [sys.executable, "-m", "dynpoint.bulk", "compile", path, table, "--unit", "m", "--workers", "1"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
        killer(table, lambda: [process.pid], [])
        process.wait()
        with self.assertRaises(ProcessLookupError):  # its workers end, too
            for _ in range(200):
                os.killpg(process.pid, 0)
                time.sleep(0.05)
        rows = dp.bulk.read_table(table)
        self.assertTrue(COUNT // 20 < len(rows) < COUNT, len(rows))
        with open(table, "ab") as file:
            file.write(b"in/1.obj\tout/1.dpa\tDPT")
        Path(rows[0].out).write_bytes(b"damaged")
        Path(rows[1].out).unlink()
        summary = dp.bulk.run("compile", path, table, workers=2, unit="m")
        self.assertTrue(0 < summary.kept < len(rows))
        self.judge("stopped", table, summary)
        with self.assertRaisesRegex(ValueError, "other settings|these settings"):
            dp.bulk.run("compile", path, table, workers=1, unit="mm")

    def test_Ctrl_C_stops_it_without_a_word_of_its_workers(self):
        path, table = manifest(self.room, "interrupted")
        command = [sys.executable, "-m", "dynpoint.bulk", "compile", path, table, "--unit", "m", "--workers", "1"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                   start_new_session=True,
                                   preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        while process.poll() is None and not (table.exists() and table.read_bytes().count(b"\n") > COUNT // 20 + 2):
            time.sleep(0.001)
        os.killpg(process.pid, signal.SIGINT)
        said = process.communicate(timeout=300)[1]
        self.assertEqual((process.returncode, said), (130, "dynpoint.bulk: stopped; called again, it goes on\n"))
        self.assertLess(len(dp.bulk.read_table(table)), COUNT)
        self.judge("interrupted", table, dp.bulk.run("compile", path, table, workers=2, unit="m"))

    def test_a_job_that_kills_each_worker_is_named(self):
        jobs = [dp.bulk.Job("compile", (f"{self.room}/in/{i}.obj", f"{self.room}/deadly{i}.dpa"), {"unit": "m"})
                for i in range(4)]
        jobs.insert(2, dp.bulk.Job("compile", ("deadly", "never.dpa"), {"unit": Deadly()}))
        pool = dp.bulk._Pool(2)
        rows = {row.out: row for row in pool.run(jobs)}
        self.assertEqual(len(rows), 5)
        self.assertEqual(rows["never.dpa"].verdict, dp.bulk.LOST)
        self.assertEqual([rows[job.out].verdict for job in jobs if job.out != "never.dpa"], ["DPT_OK"] * 4)
        self.assertGreaterEqual(pool.lost, 3)

    def test_queries_and_sweeps(self):
        room = self.room
        mesh = dp.Mesh.load(room / "program/0.dpa")
        random = np.random.default_rng(5)
        for k in range(3):
            np.save(room / f"ends{k}.npy", random.uniform(-0.15, 0.15, (200, 6)))
        poses = np.zeros((300, 7))
        poses[:, 1], poses[:, 3] = np.linspace(0.2, -0.03, 300), 1
        np.save(room / "poses.npy", poses)
        lines = [f"{room}/program/{k}.dpa\t{room}/hits{k}.npy\t{room}/ends{k}.npy" for k in range(3)]
        lines.append(f"{room}/program/9.dpa\t{room}/none.npy\t{room}/ends0.npy")
        (room / "query.list").write_text("\n".join(lines), encoding="utf-8")
        summary = dp.bulk.run("query", room / "query.list", room / "query.tsv", workers=2, radius=0.002)
        self.assertEqual([row.verdict for row in summary.rows], ["DPT_OK"] * 3 + ["DPT_E_SYSTEM"])
        hits = np.load(room / "hits0.npy")
        self.assertEqual(hits.tobytes(), mesh.query(np.load(room / "ends0.npy"), radius=0.002).tobytes())
        settings = [{"tool": {"stiffness": k}, "radius": 0.003, "length": 0.1} for k in (200, 400)]
        lines = [f"{room}/program/0.dpa\t{room}/felt{k}.npy\t{room}/poses.npy\t{json.dumps(each)}"
                 for k, each in enumerate(settings)]
        lines.append(f"liver\t{room}/scene.npy\t{room}/poses.npy\t{json.dumps({'stiffness': 300})}")
        (room / "sweep.list").write_text("\n".join(lines), encoding="utf-8")
        first = dp.bulk.run("sweep", room / "sweep.list", room / "sweep.tsv", workers=2)
        second = dp.bulk.run("sweep", room / "sweep.list", room / "again.tsv", workers=1)
        self.assertEqual([row.verdict for row in first.rows], ["DPT_OK"] * 3, first.rows)
        self.assertEqual(facts(first.rows, ""), facts(second.rows, ""))
        soft, stiff, scene = (np.load(room / name) for name in ("felt0.npy", "felt1.npy", "scene.npy"))
        touched = np.abs(soft[:, 1]) > 0.01
        self.assertGreater(touched.sum(), 50)
        self.assertTrue(np.allclose(stiff[touched, 1], 2 * soft[touched, 1], rtol=0.05))
        self.assertGreater(np.abs(scene).max(), 0.1)
        with dp.World() as world:
            world.add_body(mesh)
            tool = world.add_tool([0, 0, 0], [0, 0, 0.1], 0.003, stiffness=200)
            self.assertEqual(soft.tobytes(), np.array([tool.tick(pose, 0.001) for pose in poses]).tobytes())

    def test_a_damaged_array_is_one_job_s_verdict(self):
        room = self.room
        (room / "empty.npy").touch()
        np.savez(room / "whole.npz", np.zeros((9, 6)))
        (room / "cut.npy").write_bytes((room / "whole.npz").read_bytes()[:-60])
        np.save(room / "good.npy", np.zeros((2, 6)))
        names = ("empty", "cut", "good")
        lines = [f"{room}/program/0.dpa\t{room}/of_{name}.npy\t{room}/{name}.npy" for name in names]
        (room / "damaged.list").write_text("\n".join(lines), encoding="utf-8")
        summary = dp.bulk.run("query", room / "damaged.list", room / "damaged.tsv", workers=1)
        self.assertEqual([row.verdict for row in summary.rows], ["EOFError", "BadZipFile", "DPT_OK"])
        self.assertTrue(summary.rows[0].note)

    def test_what_the_machine_lacked_is_tried_again(self):
        room = self.room
        (room / "later.list").write_text(f"{room}/in/0.obj\t{room}/later/0.dpa\n", encoding="utf-8")
        first = dp.bulk.run("compile", room / "later.list", room / "later.tsv", workers=1, unit="m")
        (room / "later").mkdir()
        second = dp.bulk.run("compile", room / "later.list", room / "later.tsv", workers=1, unit="m")
        self.assertEqual([(row.verdict, row.hash) for row in (*first.rows, *second.rows)],
                         [("DPT_E_SYSTEM", ""), ("DPT_OK", self.wanted[0][3])])
        self.assertEqual((second.kept, [path.name for path in (room / "later").iterdir()]), (0, ["0.dpa"]))

    def test_parts_that_dead_workers_left_are_swept_up(self):
        room = self.room
        (room / "swept").mkdir()
        left = ["0.dpa.77-00c0ffee.part", "1.dpa.77-00c0ffee.part", "0.dpa.part"]
        for name in left:
            (room / "swept" / name).touch()
        (room / "swept.list").write_text(f"{room}/in/0.obj\t{room}/swept/0.dpa\n", encoding="utf-8")
        dp.bulk.run("compile", room / "swept.list", room / "swept.tsv", workers=1, unit="m")
        self.assertEqual(sorted(path.name for path in (room / "swept").iterdir()), sorted(["0.dpa", *left[1:]]))

    def test_names_of_any_bytes_are_those_of_the_program(self):
        room = self.room / "odd"
        room.mkdir()
        names = [b"\xc2\x85next", "line\u2028end \u809d".encode(), b"\xff\xfe", b"form\x0cfeed", b"back\rspace"]
        base = os.fsencode(room)
        for name in names:
            shutil.copy(self.room / "in/0.obj", os.path.join(base, name + b".obj"))
        lines = [b"%s/%s.obj\t%s/%s.dpa" % (base, name, base, name) for name in names]
        (room / "list").write_bytes(b"\r\n".join(lines) + b"\n")
        summary = dp.bulk.run("compile", room / "list", room / "bulk.tsv", workers=2, unit="m")
        self.assertEqual([(row.verdict, row.hash) for row in summary.rows], [("DPT_OK", self.wanted[0][3])] * len(names))
        subprocess.run([PROGRAM, "compile", "--list", room / "list", "-o", room / "program.tsv"], check=True,
                       capture_output=True)
        told = [[line.split(b"\t")[:4] for line in (room / name).read_bytes().split(b"\n")[2:-1]]
                for name in ("program.tsv", "bulk.tsv")]
        self.assertEqual(told[0], told[1])
        # A table that ends in the middle of a letter.
        content = (room / "bulk.tsv").read_bytes()
        (room / "bulk.tsv").write_bytes(content[:content.index(b"\x80\xa8") + 1])
        again = dp.bulk.run("compile", room / "list", room / "bulk.tsv", workers=1, unit="m")
        self.assertEqual((again.kept, again.done), (1, len(names)))

    def test_one_call_at_a_time_works_on_a_list(self):
        room = self.room / "alone"
        room.mkdir()
        (room / "list").write_text(f"{self.room}/in/0.obj\t{room}/0.dpa\n", encoding="utf-8")
        with dp.bulk.locked(room / "list"):
            with self.assertRaisesRegex(BlockingIOError, "another call works on this list"):
                dp.bulk.run("compile", room / "list", room / "table.tsv", workers=1, unit="m")
            ran = subprocess.run([PROGRAM, "compile", "--list", room / "list", "-o", room / "table.tsv"], check=False,
                                 capture_output=True, text=True)
            self.assertEqual((ran.returncode, "another dynpoint works on this list" in ran.stderr), (2, True))
        self.assertEqual([path.name for path in room.iterdir()], ["list"])
        self.assertEqual(dp.bulk.run("compile", room / "list", room / "table.tsv", workers=1, unit="m").done, 1)
        # A pipe is read once, and is nobody's to lock.
        os.mkfifo(room / "pipe")
        writer = threading.Thread(target=(room / "pipe").write_text, args=((room / "list").read_text(),))
        writer.start()
        piped = [sys.executable, "-m", "dynpoint.bulk", "compile", room / "pipe", room / "table.tsv", "--unit", "m"]
        ran = subprocess.run(piped, check=False, capture_output=True, text=True, timeout=300)
        writer.join()
        self.assertEqual((ran.returncode, "1 of these were there" in ran.stdout), (0, True), ran.stderr)

    def test_a_connection_of_dask_s_that_is_lost_is_no_verdict(self):
        room = self.room / "wire"
        room.mkdir()
        wire = Wire({"once": [OSError("the line is dead")], "ever": [OSError("the line is dead")] * 9,
                     "killed": [KilledWorker("died")] * 9, "cancelled": [CancelledError("gone")] * 9})
        names = ["good", *wire.faults, "\udcff"]
        lines = [f"{self.room}/in/0.obj\t{room}/{name}.dpa" for name in names]
        (room / "list").write_text("\n".join(lines), encoding="utf-8", errors="surrogateescape")
        with unittest.mock.patch.object(dp.bulk, "import_module", lambda name: wire):
            first = dp.bulk.run("compile", room / "list", room / "table.tsv", client=wire, unit="m")
        self.assertEqual([row.verdict for row in first.rows], ["DPT_OK", "DPT_OK", "LOST", "LOST", "LOST", "DPT_OK"])
        self.assertEqual(first.rows[2].note, "OSError: the line is dead")
        self.assertEqual(wire.sent, {"good": 1, "once": 2, "ever": 2, "killed": 1, "cancelled": 2, "\udcff": 1})
        second = dp.bulk.run("compile", room / "list", room / "table.tsv", workers=1, unit="m")
        self.assertEqual((second.kept, second.done), (3, 6))

    def test_a_scheduler_that_is_not_there_is_told(self):
        for scheduler, said in (("tcp:/x", ""), ("nowhere://a:1", "nowhere")):
            ran = subprocess.run([sys.executable, "-m", "dynpoint.bulk", "compile", self.room / "program.list", self.room / "none.tsv",
                                  "--scheduler", scheduler], check=False, capture_output=True, text=True, timeout=300)
            self.assertEqual((ran.returncode, "Traceback" in ran.stderr), (1, False), ran.stderr)
            self.assertRegex(ran.stderr, f"dynpoint.bulk: (No module named .distributed|.*{said})")

    def test_manifests_that_are_wrong(self):
        for text, why in (("a\n", ":1: a line of compile has 2 cells"), ("", "lists nothing"),
                          ("a.obj\tb.dpa\n\na.obj\tb.dpa\n", ":3: 'b.dpa' is to be written twice"),
                          ("a.obj\tb.obj\n", "does not end in .dpa"),
                          ("a.obj\tb.dpa\na.obj\t./b.dpa\n", ":2: './b.dpa' is to be written twice, as in line 1"),
                          (f"a.obj\tb.dpa\na.obj\t{os.getcwd()}/../{Path.cwd().name}/b.dpa\n", "twice, as in line 1")):
            (self.room / "wrong.list").write_text(text, encoding="utf-8")
            with self.assertRaisesRegex(ValueError, why):
                dp.bulk.run("compile", self.room / "wrong.list", self.room / "wrong.tsv")
        (self.room / "wrong.list").write_text("a.dpa\tb.npy\tc.npy\na.dpa\t./c.npy\td.npy\n", encoding="utf-8")
        with self.assertRaisesRegex(ValueError, ":2: what it writes is read, too, in line 1"):
            dp.bulk.run("query", self.room / "wrong.list", self.room / "wrong.tsv")


class KilledWorker(Exception):
    """By the name of Dask's."""


class Wire:
    """A client of Dask's whose jobs fail on the way, as often as their names say; and its as_completed."""

    status = "running"

    def __init__(self, faults):
        self.faults, self.sent, self.queue = faults, {}, []

    def nthreads(self):
        return {"here": 1}

    def submit(self, call, job, key, pure):
        name = Path(job.out).stem
        key.encode()  # as Dask does, whatever the file is called
        self.sent[name] = self.sent.get(name, 0) + 1
        future = Future()
        future.key = key
        if self.faults.get(name):
            error = self.faults[name].pop()
            if isinstance(error, CancelledError):
                future.cancel()
                future.set_running_or_notify_cancel()
            else:
                future.set_exception(error)
        else:
            future.set_result(call(job))
        return future

    def as_completed(self):
        return self

    def add(self, future):
        self.queue.append(future)

    def __next__(self):
        return self.queue.pop(0)


class Deadly:
    """A setting that a worker dies of when it is unpickled in one."""

    def __reduce__(self):
        return _die, ()


def _die():
    if multiprocessing.parent_process() is not None:
        os.kill(os.getpid(), signal.SIGKILL)
    return "m"


if __name__ == "__main__":
    main()
