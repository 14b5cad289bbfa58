// SPDX-License-Identifier: BSD-3-Clause
// node page_live.js FOLDER ROOM: the page of FOLDER as a server sends it, in a headless Chromium, with a mock of the
// server. Frames come as the protocol has it: two on their way, the next when one has been drawn.
"use strict";
const { launch, until, sleep } = require("./chromium.js");
const { serve } = require("./mock_server.js");
const { check, near, finish, assert } = require("./verdicts.js");
const fixture = require("./stream_fixture.js");
const known = fixture.recording();
const [, , folder, room] = process.argv;
const TOKEN = "0123456789abcdef".repeat(2);

// What a run sends: frame(i), at most `count`, then the end. Counts what the page says.
function runOf({ options = { mode: "live" }, frame = known.frame, count = Infinity } = {}) {
  const run = { heard: [], sent: 0, drawn: 0, hands: [], most: 0, go: true };
  run.on = (text, send) => {
    if (run.heard.length < 50) run.heard.push(text);
    if (text === "token") {
      run.send = send;
      send(fixture.sceneMessage(known.meshes, options));
    }
    if (text === "ready") {
      run.sent = run.drawn = 0;
      run.next();
      run.next();
    }
    if (text === "drawn") {
      run.drawn++;
      if (run.go) run.next();
    }
    if (text.startsWith("hand ")) run.hands.push(text.split(" ").slice(1).map(Number));
  };
  run.next = () => {
    if (run.sent < count) run.send(frame(run.sent++));
    else if (run.sent++ === count) run.send(known.end);
    run.most = Math.max(run.most, run.sent - run.drawn);
  };
  return run;
}

// The fixture's frames one after another, again and again, with a time that runs on.
function endless(step) {
  return i => {
    const message = Buffer.from(known.frame(60 + (i % 120)));
    const ticks = message.readUInt32LE(8);
    const from = 80 + message.readUInt32LE(4);
    message.writeDoubleLE(i * step, 80 + 32);
    message.writeBigUInt64LE(BigInt(i), 16);
    for (let k = 0; k < ticks; k++) message.writeDoubleLE((i + k / ticks) * step, from + 40 * k);
    return message;
  };
}

const urlOf = ({ port }, token = TOKEN) => `http://127.0.0.1:${port}/#${token}`;
const sight = page =>
  page.ask("(({ number }) => ({ number, mode: document.getElementById('mode').textContent }))(dynpoint.state())");

async function following(browser) {
  const run = runOf({ frame: endless(1 / 60) });
  const server = await serve(folder, TOKEN, run.on);
  const page = await browser.visit(urlOf(server));
  await until("frames", async () => (await page.state()).number > 30);
  await check(
    "the page joins with its token, asks for frames after the scene, and answers each frame it drew",
    async () => {
      assert.deepStrictEqual(run.heard.slice(0, 4), ["token", "ready", "drawn", "drawn"]);
      assert(run.most <= 2, `${run.most} on their way`);
      const { number } = await page.state();
      await until("more", async () => (await page.state()).number > number + 30);
      assert.strictEqual((await sight(page)).mode, "Live");
      near(await page.ask("(({ from, to }) => to - from)(dynpoint.plotScale('force'))"), 10, 1e-9);
    },
  );
  await check(
    "a pause holds the picture while frames come and are answered; one can scrub, and follow again",
    async () => {
      await page.key(" ");
      await page.settle();
      const { number, mode } = await sight(page);
      const { drawn } = run;
      assert.strictEqual(mode, "Paused: the run goes on");
      await until("answers", () => run.drawn > drawn + 20);
      assert.strictEqual((await sight(page)).number, number);
      await page.key("ArrowLeft");
      await page.key("ArrowLeft");
      await until("two frames back", async () => (await sight(page)).number === number - 2);
      await page.key("Home");
      await until("the first", async () => (await sight(page)).number === 0);
      await page.key("End");
      await until("the newest", async () => (await sight(page)).number > number + 20);
      assert.strictEqual((await sight(page)).mode, "Live");
    },
  );
  await check("a frame that is refused is answered too, is said, and the next is shown", async () => {
    const bad = Buffer.from(known.frame(3));
    bad.writeUInt32LE(7, 88);
    run.go = false;
    await until("all answers", () => run.drawn === run.sent);
    run.send(bad);
    await until("its answer", () => run.drawn === run.sent + 1);
    await until("the sentence", async () =>
      /A message was refused\. The snapshot is of version 7/.test((await page.state()).notice),
    );
    run.go = true;
    run.drawn--;
    run.next();
    const { number } = await page.state();
    await until("more", async () => (await page.state()).number > number + 10);
  });
  await check("a script that is not the page's, and another address, are refused by its policy", async () => {
    assert.deepStrictEqual(page.said, []);
    await page.ask(
      "document.body.append(Object.assign(document.createElement('script'), { textContent: 'window.strange = 1' }))",
    );
    assert.strictEqual(await page.ask("window.strange"), undefined);
    assert.strictEqual(
      await page.ask("fetch('http://127.0.0.2:9/').then(() => 'sent', error => error.name)"),
      "TypeError",
    );
    assert(
      page.said.length > 0 &&
        page.said.every(text => /Content Security Policy|Refused to connect|Fetch API/i.test(text)),
      page.said.join(),
    );
    page.said.length = 0;
  });
  await check("when the server dies the page says so, and it finds the next one at its place", async () => {
    await page.key("d");
    const { azimuth } = await page.ask("dynpoint.camera()");
    await server.die();
    await until("away", async () => /server is away/.test((await page.state()).notice));
    await until("the word", async () => (await sight(page)).mode === "Away");
    const again = runOf({ frame: endless(1 / 60) });
    const { port } = server;
    const second = await serve(folder, TOKEN, again.on, port);
    await until("frames again", async () => again.drawn > 10 && (await page.state()).notice === "");
    assert((await page.state()).opened >= 2);
    assert.strictEqual((await sight(page)).mode, "Live");
    assert.strictEqual((await page.ask("dynpoint.camera()")).azimuth, azimuth, "the camera stays");
    await second.die();
  });
  await browser.leave(page);
}

async function refusing(browser) {
  const run = runOf();
  const server = await serve(folder, TOKEN, run.on);
  const page = await browser.visit(urlOf(server, "f".repeat(32)));
  await check("a token that is refused is said, and not tried again", async () => {
    await until("the sentence", async () => /refuses this page's token/.test((await page.state()).notice));
    await sleep(1500);
    assert.deepStrictEqual([(await page.state()).opened, (await page.state()).mode, run.heard], [1, null, []]);
    assert.deepStrictEqual(page.said, []);
  });
  await browser.leave(page);
  await server.die();
}

async function remembering(browser) {
  const run = runOf({ frame: endless(0.5) });
  const server = await serve(folder, TOKEN, run.on);
  const page = await browser.visit(urlOf(server));
  await check("of a running world at least 20 s are kept, and no more than fit", async () => {
    await until("a minute of the world's time", async () => (await page.state()).number > 120);
    const { frames, bytes } = await page.state();
    assert(frames >= 20 / 0.5 && frames <= 30 / 0.5 + 1, `${frames} frames`);
    assert(bytes < 400e6);
    await page.key("Home");
    await page.settle();
    const { time } = await page.state();
    const newest = await page.ask("viewer.history.last.time");
    assert(newest - time >= 20 && newest - time <= 30, `${newest - time} s`);
  });
  await browser.leave(page);
  await server.die();
}

async function steering(browser) {
  const run = runOf({ options: { mode: "live", control: true }, frame: endless(1 / 60) });
  const server = await serve(folder, TOKEN, run.on);
  const page = await browser.visit(urlOf(server));
  await until("frames", async () => (await page.state()).number > 5);
  await page.key("1");
  await check("a drag of the handle moves the hand, in the picture's plane, at most 60 times a second", async () => {
    const box = await page.ask(
      "(({ left, top }) => [left, top])(document.getElementById('picture').getBoundingClientRect())",
    );
    const [place, at] = await page.ask(
      "(pose => [pose.slice(0, 3), dynpoint.project(pose.slice(0, 3))])(viewer.own.frame.snapshot.tools[0].pose)",
    );
    const start = at.map((value, k) => value + box[k]);
    const begun = Date.now();
    const camera = await page.ask("JSON.stringify(dynpoint.camera())");
    await page.mouse("mousePressed", start, { button: "left", buttons: 1, clickCount: 1 });
    for (let i = 1; i <= 60; i++)
      await page.mouse("mouseMoved", [start[0] + i, start[1] - i / 2], { button: "left", buttons: 1 });
    await page.mouse("mouseReleased", [start[0] + 60, start[1] - 30], { button: "left", clickCount: 1 });
    await page.settle(); // it is sent with a picture
    await sleep(200);
    const { length } = run.hands;
    const last = run.hands[length - 1];
    const seconds = (Date.now() - begun) / 1000;
    assert(length >= 2 && length <= 60 * seconds + 2, `${length} in ${seconds} s`);
    const [x, y] = await page.call(place => dynpoint.project(place), last);
    near([x - at[0], y - at[1]], [60, -30], 8, "moved by pixels:");
    near(last[1], place[1], 1e-3, "away from the picture's plane:");
    assert.strictEqual(await page.ask("JSON.stringify(dynpoint.camera())"), camera, "the camera stays");
    near(await page.ask("viewer.own.picked === null ? 1 : 0"), 1, 0);
  });
  await check("Shift and arrows move it too; without them the camera and the time move", async () => {
    await sleep(1100);
    run.hands.length = 0;
    const { radius } = await page.ask("dynpoint.scales()");
    await page.key("ArrowUp", 8);
    await until("a hand", () => run.hands.length > 0);
    const [place] = run.hands;
    await page.key("PageUp", 8);
    await until("another", () => run.hands.length > 1);
    near(
      run.hands[1].map((value, k) => value - place[k]),
      [0, 0.01 * radius, 0],
      1e-5,
    );
    assert.strictEqual((await page.state()).playing, true);
  });
  await browser.leave(page);
  await server.die();
  const alone = runOf({ frame: endless(1 / 60) });
  const other = await serve(folder, TOKEN, alone.on);
  const second = await browser.visit(urlOf(other));
  await check("a hand that must not be steered is not", async () => {
    await until("frames", async () => (await second.state()).number > 5);
    await second.drag([500, 400], [540, 420]);
    await second.key("ArrowUp", 8);
    await sleep(200);
    assert.deepStrictEqual(alone.hands, []);
  });
  await browser.leave(second);
  await other.die();
}

async function ending(browser) {
  for (const [mode, count] of [
    ["live", 40],
    ["recording", 200],
  ]) {
    const run = runOf({ options: { mode }, count });
    const server = await serve(folder, TOKEN, run.on);
    const page = await browser.visit(urlOf(server));
    await check(`the end of a run that is sent as ${mode} is said, and all of it can be seen again`, async () => {
      await until("the end", async () => (await page.state()).ended === "The recording is whole.");
      await sleep(700);
      const { opened, frames } = await page.state();
      assert.deepStrictEqual([opened, frames, (await page.state()).notice], [1, count, ""]);
      await page.key("Home");
      await until("the first", async () => (await page.state()).number === 0);
      await page.key("End");
      await until("the last", async () => (await page.state()).number === count - 1);
      await server.die();
      await sleep(300);
      assert.deepStrictEqual(
        [(await sight(page)).mode, (await page.state()).notice],
        [mode === "live" ? "Ended" : "Recording", ""],
      );
      assert.deepStrictEqual(page.said, []);
    });
    await browser.leave(page);
  }
}

async function main() {
  const browser = launch(room);
  await following(browser);
  await refusing(browser);
  await remembering(browser);
  await steering(browser);
  await ending(browser);
  await browser.close();
  finish();
}

main().catch(error => {
  console.log(`FAIL the page's live test itself: ${error.stack}`);
  process.exit(1);
});
