// SPDX-License-Identifier: BSD-3-Clause
// A headless Chromium, driven over a pipe by its own protocol: no port is open, and it ends when the pipe does.
"use strict";
const fs = require("fs");
const path = require("path");
const { spawn } = require("child_process");
const PATIENCE = 120000; // ms: a browser that nothing has started before may need more than 20 s on a busy machine
const sleep = ms => new Promise(done => setTimeout(done, ms));

// By progress, not by the clock alone: where the machine is busy, as many answers take longer.
async function until(what, ask) {
  const end = Date.now() + PATIENCE;
  for (let asked = 0; Date.now() < end || asked < PATIENCE / 30; asked++, await sleep(30)) {
    const got = await ask();
    if (got) return got;
  }
  throw new Error(`never: ${what}`);
}

// Each message of the protocol is JSON that a zero byte ends.
function pipe(child) {
  const waiting = new Map();
  const listeners = new Map();
  let last = 0;
  let rest = [];
  const take = text => {
    const { id, error, result, sessionId, method, params } = JSON.parse(text);
    if (!id) return listeners.get(sessionId)?.(method, params);
    const { resolve, reject } = waiting.get(id);
    waiting.delete(id);
    if (error) reject(new Error(error.message));
    else resolve(result);
  };
  child.stdio[4].on("data", data => {
    for (let zero; (zero = data.indexOf(0)) >= 0; data = data.subarray(zero + 1)) {
      take(Buffer.concat([...rest, data.subarray(0, zero)]).toString());
      rest = [];
    }
    if (data.length > 0) rest.push(data);
  });
  const send = (method, params, sessionId) =>
    new Promise((resolve, reject) => {
      waiting.set(++last, { resolve, reject });
      child.stdio[3].write(`${JSON.stringify({ id: last, method, params, sessionId })}\0`);
    });
  return { send, listeners };
}

class Page {
  constructor(send, targetId) {
    Object.assign(this, { send, targetId, said: [], asked: [], loaded: false });
  }

  hear(method, params) {
    if (method === "Runtime.exceptionThrown")
      this.said.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === "Runtime.consoleAPICalled" && ["error", "warning", "assert"].includes(params.type))
      this.said.push(params.args.map(({ value, description }) => value ?? description).join(" "));
    if (method === "Log.entryAdded" && params.entry.level !== "verbose")
      this.said.push(`${params.entry.source}: ${params.entry.text}`);
    if (method === "Network.requestWillBeSent") this.asked.push(params.request.url);
    if (method === "Page.loadEventFired") this.loaded = true;
  }

  async ask(expression) {
    const { result, exceptionDetails } = await this.send("Runtime.evaluate", {
      expression,
      awaitPromise: true,
      returnByValue: true,
    });
    if (exceptionDetails)
      throw new Error(
        `${expression.slice(0, 120)}: ${exceptionDetails.exception?.description ?? exceptionDetails.text}`,
      );
    return result.value;
  }

  // A function of the page with arguments that JSON can carry.
  call(work, ...given) {
    return this.ask(`(${work})(${given.map(value => JSON.stringify(value)).join(", ")})`);
  }

  // Until what was asked for is in the picture: two of them.
  settle() {
    return this.ask("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))");
  }

  state() {
    return this.ask("dynpoint.state()");
  }

  text(id) {
    return this.ask(`document.getElementById(${JSON.stringify(id)}).textContent`);
  }

  readout(name) {
    return this.ask(`document.querySelector('[data-readout="${name}"]').textContent`);
  }

  // modifiers: 8 is Shift
  async key(key, modifiers = 0) {
    const text = key.length === 1 ? { text: key } : key === "Enter" ? { text: "\r" } : {};
    await this.send("Input.dispatchKeyEvent", { type: "keyDown", key, modifiers, ...text });
    await this.send("Input.dispatchKeyEvent", { type: "keyUp", key, modifiers });
  }

  async drag(from, to, { button = "left", modifiers = 0 } = {}) {
    const buttons = { left: 1, right: 2 }[button];
    await this.mouse("mousePressed", from, { button, modifiers, buttons, clickCount: 1 });
    for (let i = 1; i <= 4; i++)
      await this.mouse(
        "mouseMoved",
        from.map((value, k) => value + (i / 4) * (to[k] - value)),
        { button, modifiers, buttons },
      );
    await this.mouse("mouseReleased", to, { button, modifiers, clickCount: 1 });
  }

  async click(at) {
    await this.mouse("mousePressed", at, { button: "left", buttons: 1, clickCount: 1 });
    await this.mouse("mouseReleased", at, { button: "left", clickCount: 1 });
  }

  mouse(type, [x, y], options) {
    return this.send("Input.dispatchMouseEvent", { type, x, y, ...options });
  }

  // steps: for each step the places of all fingers
  async touch(steps) {
    for (const [i, places] of steps.entries())
      await this.send("Input.dispatchTouchEvent", {
        type: i === 0 ? "touchStart" : "touchMove",
        touchPoints: places.map(([x, y], id) => ({ x, y, id })),
      });
    await this.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  }

  size(width, height, mobile = false) {
    return this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile });
  }

  media(features) {
    return this.send("Emulation.setEmulatedMedia", {
      features: Object.entries(features).map(([name, value]) => ({ name, value })),
    });
  }

  async shoot(file) {
    const { data } = await this.send("Page.captureScreenshot", { format: "png" });
    fs.writeFileSync(file, data, "base64");
  }
}

// room: an empty folder for its profile
function launch(room, ...flags) {
  const child = spawn(
    "chromium",
    [
      "--headless",
      "--no-sandbox",
      "--use-angle=swiftshader",
      "--enable-unsafe-swiftshader",
      "--remote-debugging-pipe",
      "--no-first-run",
      `--user-data-dir=${fs.mkdtempSync(path.join(room, "profile-"))}`,
      ...flags,
    ],
    { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] },
  );
  const { send, listeners } = pipe(child);
  const gone = new Promise(done => {
    child.on("exit", done);
  });

  // A window of its own: a page behind another one draws nothing. A small one, as each pixel is computed by the processor.
  async function visit(url, { width = 960, height = 640, features = {} } = {}) {
    const { targetId } = await send("Target.createTarget", { url: "about:blank", newWindow: true });
    const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
    const page = new Page((method, params) => send(method, params, sessionId), targetId);
    listeners.set(sessionId, (method, params) => page.hear(method, params));
    for (const part of ["Runtime", "Log", "Network", "Page"]) await page.send(`${part}.enable`);
    await page.size(width, height);
    await page.media({ "prefers-reduced-motion": "reduce", "prefers-color-scheme": "light", ...features });
    await page.send("Page.navigate", { url });
    await until("the page's load", () => page.loaded);
    return page;
  }

  return {
    visit,
    leave: page => send("Target.closeTarget", { targetId: page.targetId }),
    close: async () => {
      send("Browser.close").catch(() => {});
      await gone;
    },
  };
}

module.exports = { launch, until, sleep };
