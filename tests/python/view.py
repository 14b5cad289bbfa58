# SPDX-License-Identifier: BSD-3-Clause
"""Scene.view: what a page gets, whom the server refuses, a page in Chromium, and in a frame of a notebook's."""

import gc
import http.server
import json
import os
import pickle
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import dynpoint as dp
from dynpoint import _serve
from pages import Page
from verdicts import main

HAND = "sim:?hand=press&live=1"
SAMPLES = Path(__file__).resolve().parents[2] / "docs/samples"
CHROMIUM = shutil.which("chromium")
POLICY = 1008
NEEDS_PAGE = unittest.skipUnless((Path(dp.__file__).parent / "page.html").exists(), "a build without the viewer's page")


def wait_for(seconds):
    """How long the server waits for headers and a token."""
    _serve.HEADERS_SECONDS = _serve.TOKEN_SECONDS = _serve._Handler.timeout = seconds


PATIENCE = _serve.HEADERS_SECONDS
wait_for(60.0)  # a busy machine lets everybody wait


def until(what, ask, seconds=120):
    ends = time.monotonic() + seconds
    while not (got := ask()):
        if time.monotonic() > ends:
            raise AssertionError(f"never: {what}")
        time.sleep(0.02)
    return got


class Running:
    """A scene that runs in a thread, and its view."""

    def __init__(self, device=HAND, scene="liver", **settings):
        self.felt, self.place = 0, None
        self.scene = dp.Scene(scene, device, felt=self.feel)
        self.view = self.scene.view(**settings)
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def feel(self, state, wrench, dt, result):
        self.felt += 1
        if self.felt % 20 == 1:
            self.place = state.pose[:3].tolist()

    def run(self):
        self.stats = self.scene.run()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.scene.stop()
        self.thread.join()
        self.scene.close()


class Framing(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        content = b"<!DOCTYPE html><title>notebook</title>" + self.server.content.encode()
        self.send_response(200)
        self.send_header("content-type", "text/html")
        self.send_header("content-length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_):
        pass


class Notebook(http.server.ThreadingHTTPServer):
    """A page of another origin that shows what an object says of itself."""

    def __init__(self, content):
        super().__init__(("127.0.0.1", 0), Framing)
        self.content = content
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def __exit__(self, *_):
        self.shutdown()
        self.server_close()


class Browser:
    """A headless Chromium at an address, with a profile of its own."""

    def __init__(self, url):
        self.room = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        self.process = subprocess.Popen(
            [
                CHROMIUM,
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--no-first-run",
                "--remote-debugging-port=0",
                f"--user-data-dir={self.room.name}",
                url,
            ],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env={name: value for name, value in os.environ.items() if name != "LD_PRELOAD"},
        )  # sanitizers are not its

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.room.cleanup()


def drawn(view):
    """Frames that a page has drawn, or 0."""
    return max((client.frames - client.undrawn for client in view._server.clients), default=0)


def answers(url):
    try:
        Page(url).socket.close()
    except OSError:
        return False
    return True


@NEEDS_PAGE
class View(unittest.TestCase):
    def test_the_page_is_the_program_s_and_its_policy_holds(self):
        folder = Path(dp.__file__).parent
        with Running() as one, Page(one.view.url) as page:
            status, headers = page.ask()
            self.assertEqual(status, 200)
            self.assertEqual(page.take(int(headers["content-length"])), (folder / "page.html").read_bytes())
            self.assertEqual(headers["content-security-policy"], (folder / "page.csp").read_text().strip())
            self.assertIn("frame-ancestors 'none'", headers["content-security-policy"])
            self.assertEqual(
                {
                    name: headers[name]
                    for name in (
                        "x-content-type-options",
                        "referrer-policy",
                        "cache-control",
                        "cross-origin-resource-policy",
                        "cross-origin-opener-policy",
                    )
                },
                {
                    "x-content-type-options": "nosniff",
                    "referrer-policy": "no-referrer",
                    "cache-control": "no-store",
                    "cross-origin-resource-policy": "same-origin",
                    "cross-origin-opener-policy": "same-origin",
                },
            )
            self.assertNotIn("access-control-allow-origin", headers)

    def test_a_page_gets_the_scene_and_every_tick(self):
        with Running() as one, Page(one.view.url) as page:
            kind, size = struct.unpack_from("<II", first := page.join())
            told = json.loads(first[8 : 8 + size])
            self.assertEqual((kind, told["mode"], told["title"], told["control"]), (1, "live", "liver", False))
            self.assertEqual(
                (told["device"]["name"], told["device"]["simulated"], told["device"]["rate"]), (HAND, True, 1000)
            )
            mesh, blob = told["meshes"][0], (size + 15) // 8 * 8
            corners = np.frombuffer(first, np.uint32, 3 * mesh["triangles"], blob + mesh["corners"])
            self.assertLess(corners.max(), mesh["vertices"])
            page.say("ready")
            times, numbers, forces = [], [], []
            while len(times) < 300 or max(forces, default=0) < 0.05:
                frame = page.hear()
                kind, size, ticks, _, number, dropped, lost = struct.unpack_from("<IIIIQQQ", frame)
                self.assertEqual((kind, lost, len(frame)), (2, 0, 80 + size + 40 * ticks))
                rows = np.frombuffer(frame, [("time", "<f8"), ("force", "<f4"), ("rest", "V28")], ticks, 80 + size)
                times += rows["time"].tolist()
                forces += rows["force"].tolist()
                numbers.append(number)
                self.assertEqual(dropped, number - numbers[0] - len(numbers) + 1)
                self.assertGreater(struct.unpack_from("<d", frame, 72)[0], 0)
                page.say("drawn")
            self.assertTrue((np.diff(times) > 0).all() and np.diff(numbers).min() > 0)
            self.assertTrue(np.allclose(np.diff(times).sum(), times[-1] - times[0]))
            self.assertLess(len(times), one.felt + 1)
            one.scene.stop()
            one.thread.join()
            one.scene.close()
            while struct.unpack_from("<I", last := page.hear())[0] == 2:
                pass
            self.assertEqual(last, struct.pack("<II", 3, 21) + b"The scene was closed.")

    def test_a_page_gets_what_a_tool_wears_its_jaws_and_the_second_view(self):
        grasper = SAMPLES / "grasper.json"
        for name, parts, has_jaws, has_inset in (("laparoscopy", 0, False, True), (grasper, 3, True, False)):
            with dp.Scene(str(name), HAND) as scene:
                first = scene.view_begin(b"", b"", False)
                scene.view_end()
            told = json.loads(first[8 : 8 + struct.unpack_from("<I", first, 4)[0]])
            self.assertEqual((len(told["dress"]), told["jaws"], told["inset"] is not None), (parts, has_jaws, has_inset))

    def test_a_view_slows_no_tick_and_moves_no_bit(self):
        """The hand's simulated clock makes all runs alike."""
        asked = []
        for views in (False, True):
            with (
                tempfile.TemporaryDirectory() as room,
                dp.Scene("liver", "sim:?hand=press", ticks=1500, record=Path(room) / "r.dpr") as scene,
            ):
                if views:
                    with Page(scene.view().url) as page:
                        page.join()
                        page.say("ready")
                        scene.run()
                else:
                    scene.run()
                scene.close()
                asked.append(dp.Recording(Path(room) / "r.dpr").records["asked"].copy())
        self.assertTrue(asked[0].any())
        self.assertTrue(np.array_equal(*asked))

    def test_strangers_are_refused(self):
        with Running() as one:
            port = one.view.url.split(":")[2].split("/")[0]
            for status, line, headers in (
                (403, "GET / HTTP/1.1", {"host": f"evil.example:{port}"}),
                (403, "GET / HTTP/1.1", {"host": None}),
                (403, "GET / HTTP/1.1", {"host": "127.0.0.1"}),
                (404, "GET /x HTTP/1.1", {}),
                (404, "GET //x HTTP/1.1", {}),
                (405, "POST / HTTP/1.1", {}),
                (405, "OPTIONS / HTTP/1.1", {}),
            ):
                with Page(one.view.url) as page:
                    self.assertEqual(page.ask(line, **headers)[0], status, (line, headers))
            for status, headers in (
                (403, {"origin": "http://evil.example"}),
                (403, {"origin": None}),
                (403, {"origin": "null"}),
                (403, {"origin": f"https://127.0.0.1:{port}"}),
                (403, {"origin": f"http://localhost:{port}"}),
                (403, {"host": f"evil.example:{port}", "origin": f"http://evil.example:{port}"}),
                (400, {"sec_websocket_protocol": "chat"}),
                (400, {"upgrade": "h2c"}),
            ):
                with Page(one.view.url) as page:
                    self.assertEqual(page.upgrade(**headers), status, headers)
            with Page(one.view.url.replace("127.0.0.1", "localhost")) as page:
                self.assertEqual(page.join()[:4], b"\1\0\0\0")
            self.assertEqual(one.view._server.refused, 15)

    def test_a_wrong_token_is_refused_and_a_late_one(self):
        with Running() as one:
            for token in ("0" * 32, one.view.url[-32:].upper().swapcase()[:31], "", one.view.url[-32:] + "0"):
                with Page(one.view.url) as page:
                    self.assertEqual(page.upgrade(), 101)
                    page.say(token)
                    self.assertEqual(page.hear(), POLICY)
            self.assertEqual(PATIENCE, 2.0)
            self.addCleanup(wait_for, 60.0)
            wait_for(0.5)
            with Page(one.view.url) as page:  # headers that never end
                page.socket.sendall(b"GET / HTTP/1.1\r\n")
                self.assertEqual(page.socket.recv(1), b"")
            wait_for(60.0)
            _serve.TOKEN_SECONDS = 0.5
            with Page(one.view.url) as page:
                self.assertEqual(page.upgrade(), 101)
                self.assertEqual(page.hear(), POLICY)
            self.assertEqual(one.view.pages, 0)

    def test_a_page_that_says_what_it_should_not_goes(self):
        cases = {
            "binary": dict(first=0x82),
            "a fragment": dict(first=0x01),
            "a reserved bit": dict(first=0xC1),
            "unmasked": dict(masked=False),
        }
        with Running() as one:
            with Page(one.view.url) as page:
                page.join()
                page.socket.sendall(struct.pack(">BBQ", 0x81, 0xFF, 5))  # a length of eight bytes
                self.assertEqual(page.closed_with(), POLICY)
            for name, how in cases.items():
                with Page(one.view.url) as page:
                    page.join()
                    page.say("ready", **how)
                    self.assertEqual(page.closed_with(), POLICY, name)
            for words in (
                ["hello"],
                ["drawn"],
                ["ready", "ready"],
                ["x" * 5000],
                ["hand 0 0 0"],
                ["ready", "drawn", "drawn", "drawn", "drawn"],
            ):
                with Page(one.view.url) as page:
                    page.join()
                    for word in words:
                        page.say(word)
                    self.assertEqual(page.closed_with(), POLICY, words)
            with Page(one.view.url) as page:
                page.join()
                try:
                    for _ in range(1000):
                        page.say("", first=0x8A)  # pongs count for nothing
                    for _ in range(1000):
                        page.say("", first=0x81)
                except OSError:
                    pass
                self.assertEqual(page.closed_with(), POLICY)
            until("they are gone", lambda: one.view.pages == 0)

    def test_a_fifth_page_waits_and_a_slow_one_holds_up_none(self):
        with Running() as one:
            pages = [Page(one.view.url) for _ in range(4)]
            for page in pages:
                page.join()
                page.say("ready")
            with Page(one.view.url) as fifth:
                self.assertEqual(fifth.upgrade(), 503)
            for _ in range(40):  # the others never say that they have drawn
                pages[0].hear()
                pages[0].say("drawn")
            self.assertEqual(one.view.pages, 4)
            for page in pages:
                page.socket.close()
            until("room", lambda: one.view.pages == 0)
            with Page(one.view.url) as page:
                page.join()

    def test_a_hand_is_steered_where_that_was_allowed(self):
        with Running("sim:?hand=hold&live=1", control=True) as one, Page(one.view.url) as page:
            first = page.join()
            box = json.loads(first[8 : 8 + struct.unpack_from("<I", first, 4)[0]])["device"]["workspace"]
            page.say("ready")
            aim = np.array([0.03, 0.15, 0.01])  # of the device, whose workspace is that box; clear of the liver
            low, high = np.reshape(box, (2, 3))
            page.say("hand {} {} {}".format(*(low + (aim + 0.2) / 0.4 * (high - low))))
            until("it goes there", lambda: one.place and np.linalg.norm(one.place - aim) < 5e-3)
            for words in ("hand nan 0 0", "hand 1e7 0 0", "hand 0 0", "hand 0 0 0 0"):
                with Page(one.view.url) as other:
                    other.join()
                    other.say(words)
                    self.assertEqual(other.closed_with(), POLICY, words)
        with (
            dp.Scene("liver", info=dp.Device("sim:").info) as scene,
            self.assertRaisesRegex(ValueError, "control: only a simulated hand"),
        ):
            scene.view(control=True)

    def test_a_page_that_takes_nothing_is_let_go(self):
        self.addCleanup(setattr, _serve, "SEND_SECONDS", _serve.SEND_SECONDS)
        for seconds in (0.5, 600.0):
            _serve.SEND_SECONDS = seconds
            server = _serve.ViewServer([bytes(64 << 20)])
            with Page(server.url) as page:
                self.assertEqual(page.upgrade(), 101)
                page.say(page.token)
                until("its thread waits", lambda: server.clients and server.clients[0].link.lock.locked())
                if seconds < 1:
                    for _ in range(20):  # else the other thread asks whether it is there, and may find out first
                        try:
                            page.say("", first=0x8A)
                        except OSError:
                            break
                        time.sleep(0.1)
                    until("its place is free", lambda: not server.clients)
                closes = threading.Thread(target=server.close)
                closes.start()
                closes.join(60)
                self.assertFalse(closes.is_alive())
                until("nobody waits for it", lambda: not server.clients)
        self.addCleanup(setattr, _serve, "PAGE_SECONDS", _serve.PAGE_SECONDS)
        _serve.PAGE_SECONDS = 0.5
        server = _serve.ViewServer([b""])
        server.page = bytes(64 << 20)
        with Page(server.url) as page:
            self.assertEqual(page.ask()[0], 200)
            until("the connection is free", lambda: server._places._value == _serve.CONNECTIONS)
        server.close()

    def test_who_may_frame_it_is_a_list_of_origins(self):
        with dp.Scene("liver", "sim:", ticks=1) as scene:
            for frames in ("https://*.org", ["https://a.org; script-src *"], ["*"], ["https://a.org b.org"], [""]):
                with self.assertRaisesRegex(ValueError, "frames: "):
                    scene.view(frames=frames)
            named = ("https://hub.example.org", "http://localhost:*")
            with scene.view(frames=named) as view:
                self.assertIn("frame-ancestors " + " ".join(named) + ";", view._server.policy() + ";")

    def test_a_view_that_is_closed_while_its_scene_runs_can_be_followed_by_another(self):
        with Running() as one:
            until("it runs", lambda: one.felt)
            one.view.close()
            one.scene.stop()
            one.thread.join()
            with Page(one.scene.view().url) as page:
                self.assertEqual(page.join()[:4], b"\1\0\0\0")

    def test_a_view_ends_with_its_scene(self):
        scene = dp.Scene("liver", "sim:", ticks=1)
        view = scene.view(title="<b>ü</b>")
        with self.assertRaisesRegex(RuntimeError, "viewed already"):
            scene.view()
        with self.assertRaisesRegex(TypeError, "pickled"):
            pickle.dumps(view)
        self.assertNotIn(view.url[-32:], repr(view))
        self.assertIn("&lt;b&gt;ü", view._repr_html_())
        view.close()
        self.assertTrue(view.closed)
        self.assertNotIn("iframe", view._repr_html_())
        again = scene.view()
        self.assertNotEqual(again.url[-32:], view.url[-32:])
        del scene
        gc.collect()
        until("it closes with what it shows", lambda: again.closed)
        until("nobody answers", lambda: not answers(again.url))
        until("no thread stays", lambda: not any(one.name.startswith("dynpoint") for one in threading.enumerate()))

    @unittest.skipUnless(CHROMIUM, "no chromium")
    def test_a_browser_draws_what_runs(self):
        with Running() as one, Browser(one.view.url):
            until("frames", lambda: drawn(one.view) > 20)
            self.assertEqual(one.view._server.refused, 0)

    @unittest.skipUnless(CHROMIUM, "no chromium")
    def test_a_notebook_shows_it_in_a_frame_and_other_pages_cannot(self):
        with Running() as one:
            shown = one.view._repr_html_()
            with Notebook(shown) as notebook:
                with Browser(f"http://localhost:{notebook.server_port}/"):
                    until("frames", lambda: drawn(one.view) > 20)
                until("it left", lambda: one.view.pages == 0)
                wrong = shown.replace(one.view.url[-32:], "0" * 32)
                notebook.content = wrong
                with Browser(f"http://localhost:{notebook.server_port}/"):
                    until("it is refused", lambda: one.view._server.refused > 0)
                    self.assertEqual(one.view.pages, 0)
                notebook.content = shown
                with Browser(f"http://[::ffff:127.0.0.1]:{notebook.server_port}/"):
                    time.sleep(6)
                    self.assertEqual(one.view.pages, 0)

    def test_the_program_s_view_goes_through_this_server_where_there_is_no_other(self):
        with tempfile.TemporaryDirectory() as room:
            package = Path(room) / "dynpoint"
            shutil.copytree(Path(dp.__file__).parent, package)
            (package / "libdynpoint_view.so").unlink(missing_ok=True)
            record = Path(room) / "r.dpr"
            with dp.Scene("liver", "sim:?hand=press", ticks=200, record=record) as scene:
                scene.run()
            environment = {**os.environ, "PYTHONPATH": room, "PYTHONUNBUFFERED": "1"}
            for words, mode in (([record], "recording"), (["liver"], "live"), (["liver", "--control"], "live")):
                with subprocess.Popen(
                    [sys.executable, "-m", "dynpoint", "view", *words, "--for", "60"],
                    env=environment,
                    text=True,
                    stdout=subprocess.PIPE,
                ) as ran:
                    with Page(re.search(r"http:\S+", ran.stdout.readline())[0]) as page:
                        first = page.join()
                        told = json.loads(first[8 : 8 + struct.unpack_from("<I", first, 4)[0]])
                        self.assertEqual((told["mode"], told["control"]), (mode, "--control" in words))
                        page.say("ready")
                        kinds = []
                        while 3 not in kinds and len(kinds) < 9:
                            kinds.append(struct.unpack_from("<I", page.hear())[0])
                            if kinds[-1] == 2:
                                page.say("drawn")
                        self.assertGreater(kinds.count(2), 5)
                    ran.terminate()
            # Until it is interrupted, also where a shell that started this test in the background let SIGINT be ignored.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            for what in (record, "liver"):
                with subprocess.Popen(
                    [sys.executable, "-m", "dynpoint", "view", what],
                    env=environment,
                    text=True,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.PIPE,
                ) as ran:
                    try:
                        with Page(re.search(r"http:\S+", ran.stdout.readline())[0]) as page:
                            self.assertEqual(page.join()[:4], b"\1\0\0\0")
                        with self.assertRaises(subprocess.TimeoutExpired):
                            ran.wait(1)
                        ran.send_signal(signal.SIGINT)
                        self.assertEqual((ran.wait(60), ran.stderr.read()), (0, ""))
                    finally:
                        ran.kill()
            for words, why in (
                (["liver", "--law", "bed"], "--law needs libwebsockets (Debian: libwebsockets17)"),
                (["liver", "--for", "0"], "--for must be positive"),
                ([record, "--for", "nan"], "--for must be positive"),
            ):
                told = subprocess.run(
                    [sys.executable, "-m", "dynpoint", "view", *words],
                    env=environment,
                    capture_output=True,
                    text=True,
                    timeout=60,
                )
                self.assertEqual((told.returncode, told.stderr), (2, f"dynpoint view: {why}\n"))


main()
