// SPDX-License-Identifier: BSD-3-Clause
// node program.js PROGRAM ROOM: the real program and its page in a headless Chromium: a scene that runs, a hand that the page
// steers, a server that dies and comes back, a recording as a page. The other tests have a mock in place of the program.
"use strict";
const fs = require("fs");
const path = require("path");
const { spawn, execFileSync } = require("child_process");
const { launch, until, sleep } = require("./chromium.js");
const { check, finish, assert, scripts } = require("./verdicts.js");
const { likeness, colour, pixel, on } = require("./page_sights.js");
const { scale } = scripts("scale");
const [program, room] = process.argv.slice(2).map(name => path.resolve(name));
const runtime = path.join(room, "runtime");

// A run with a viewer: { url, kill(), said() }.
async function run(...words) {
  const child = spawn(program, words, { env: { ...process.env, XDG_RUNTIME_DIR: runtime } });
  let said = "";
  child.stdout.on("data", data => (said += data));
  child.stderr.on("data", data => (said += data));
  const gone = new Promise(done => child.on("exit", done));
  const url = await until("an address", () => /http:\S+/.exec(said)?.[0]);
  return {
    url,
    said: () => said,
    end: async signal => {
      child.kill(signal);
      await gone;
    },
  };
}

const scene = ["membrane", "--law", "proxy", "--view", "--for", "300"];
const live = hand => ["run", ...scene, "--device", `sim:?hand=${hand}&live=1`];
const frames = async (page, more) => {
  const before = (await page.state()).number ?? -1;
  await until(`${more} more frames`, async () => (await page.state()).number > before + more);
};
const ask = (page, words) => page.ask(`(() => { const s = viewer.own.frame.snapshot; return ${words}; })()`);

async function running(browser) {
  const one = await run(...live("press&reach=0.025&cycle=3"));
  const page = await browser.visit(one.url);
  await check("a scene that runs is drawn: frames, ticks, rates", async () => {
    await until("frames", async () => (await page.state()).number > 20);
    const { ticks, refused } = await page.state();
    assert(ticks > 200 && refused === 0, `${ticks} ticks, ${refused} refused`);
    const rate = await until("a rate", () => ask(page, "viewer.own.frame.hapticRate"));
    assert(rate > 100 && rate < 1100, `${rate} Hz`);
  });
  await check("the tool is over the membrane in its colour, and the arrow points as the wrench does", async () => {
    // The hand goes on until the page stops: on a busy machine the frame at which it stops is another than the one that was seen.
    const pressed = async () => (await ask(page, "Math.hypot(...s.tools[0].wrench.slice(0, 3))")) > 0.08;
    await until("a frame that stands, with a force", async () => {
      await until("a force", pressed);
      await page.key(" ");
      await page.settle();
      const stands = await pressed();
      if (!stands) await page.key("End");
      return stands;
    });
    const [ends, wrench, bands] = await ask(
      page,
      "[[s.segments[0].proxyA, s.segments[0].proxyB], s.tools[0].wrench.slice(0, 3), s.contacts.map(c => [c.s0, c.s1])]",
    );
    const force = Math.hypot(...wrench);
    assert(force > 0.05, `${force} N in the frame that is shown`);
    const [arrow] = await page.ask("dynpoint.arrows()");
    const shaft = arrow.to.map((value, k) => value - arrow.from[k]);
    const cosine = shaft.reduce((sum, value, k) => sum + value * wrench[k], 0) / force / Math.hypot(...shaft);
    assert(cosine > 0.999999 && Math.abs(arrow.newtons - force) < 1e-9, `${cosine}, ${arrow.newtons} N`);
    // From the top: from the side the rim of the dent may hide the tool. Contacts are bands, coloured by their depth.
    await page.key("5");
    await page.key("f");
    await page.settle();
    const proxy = await colour(page, "proxy");
    const depths = Array.from({ length: 65 }, (_, i) => scale.colour(i / 64));
    const isDepth = got => depths.some(rgb => rgb.every((value, k) => Math.abs(value - got[k]) <= 6));
    const seen = [];
    let right = 0;
    for (const s of [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]) {
      const got = await pixel(page, on(ends, s));
      const isBare = bands.every(([s0, s1]) => s < s0 - 0.05 || s > s1 + 0.05);
      right += likeness(got, proxy) > 0.95 || (!isBare && isDepth(got));
      seen.push(`${got}${isBare ? "" : " (contact)"}`);
    }
    assert(right >= 7, seen.join("; "));
    await page.key("End");
  });
  await check("the page of a running world asks no one else, and says nothing in the console", () => {
    const strange = page.asked.filter(address => !address.startsWith(one.url.split("#")[0]));
    assert.deepStrictEqual(strange, []);
    assert.deepStrictEqual(page.said, []);
  });
  await one.end("SIGINT");
  await check("the end of a run is said", async () => {
    await until("the end", async () => (await page.state()).ended);
    assert.match((await page.state()).ended, /The run ended/);
    assert.match(one.said(), /with a fresh sample/);
  });
  await browser.leave(page);
}

async function steered(browser) {
  const one = await run(...live("hold"), "--control");
  const page = await browser.visit(one.url);
  await check("the page moves the hand, and the tool follows", async () => {
    await frames(page, 5);
    await page.key("f");
    const before = await ask(page, "s.segments[0].a");
    const [x, y] = await page.call(place => {
      const [left, top] = dynpoint.project(place);
      const box = document.getElementById("picture").getBoundingClientRect();
      return [left + box.left, top + box.top];
    }, before);
    await page.drag([x, y], [x + 60, y]);
    const moved = async () => Math.hypot(...(await ask(page, "s.segments[0].a")).map((v, k) => v - before[k]));
    await until("a tool that moved", async () => (await moved()) > 0.005);
  });
  await one.end("SIGINT");
  await browser.leave(page);
}

async function again(browser) {
  const port = String(20000 + (process.pid % 20000));
  let one = await run(...live("press"), "--port", port);
  const page = await browser.visit(one.url);
  await check("when the program dies the page says so, and it finds the next run at the same port", async () => {
    await frames(page, 5);
    await one.end("SIGKILL");
    await until("a notice", async () => /away/.test((await page.state()).notice));
    const { opened } = await page.state();
    one = await run(...live("press"), "--port", port);
    await until("a new connection", async () => (await page.state()).opened > opened);
    await until("new frames", async () => (await page.state()).number < 200 && (await page.state()).steps > 0);
    await frames(page, 5);
  });
  await browser.leave(page);
  await check("a token that is wrong is refused, and the page says so", async () => {
    const [address, token] = one.url.split("#");
    const stranger = await browser.visit(`${address}#${token.replace(/.$/, last => (last === "0" ? "1" : "0"))}`);
    await until("a sentence", async () => /refuses this page's token/.test((await stranger.state()).notice));
    assert.strictEqual((await stranger.state()).frames, 0);
    await browser.leave(stranger);
  });
  await one.end("SIGINT");
}

async function recorded(browser) {
  const inRoom = (...words) => execFileSync(program, words, { cwd: room, stdio: ["ignore", "ignore", "inherit"] });
  inRoom("run", "soft-liver", "--device", "sim:?hand=press&cycle=2", "--for", "2", "--record", "felt.dpr");
  inRoom("view", "felt.dpr", "-o", "felt.html");
  const page = await browser.visit(`file://${path.resolve(room, "felt.html")}`);
  await check("a recording of a soft liver plays in a page: all of its ticks, 60 frames a second, vertices that move", async () => {
    await until("its end", async () => (await page.state()).ended);
    const { ended, frames, ticks, refused } = await page.state();
    assert.match(ended, /whole: 2000 records/);
    assert(ticks === 2000 && frames >= 119 && frames <= 122 && refused === 0, `${ticks}, ${frames}, ${refused}`);
    const low = () => page.ask("[...viewer.own.view.bodies.values()][0].positions.reduce((a, v, i) => (i % 3 === 1 ? a + v : a), 0)");
    await page.ask("viewer.play.seek(0), 0");
    await page.settle();
    const before = await low();
    await page.ask("viewer.play.seek(62), 0");
    await page.settle();
    assert(Math.abs((await low()) - before) > 1e-3, "no vertex moved");
    assert.deepStrictEqual([page.said, page.asked.filter(address => !/^(file|blob|data):/.test(address))], [[], []]);
  });
  await browser.leave(page);
}

(async () => {
  fs.mkdirSync(runtime, { recursive: true, mode: 0o700 });
  const browser = launch(room);
  try {
    await running(browser);
    await steered(browser);
    await again(browser);
    await recorded(browser);
  } finally {
    await browser.close();
  }
  await sleep(0);
  finish();
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
