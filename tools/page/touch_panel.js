// SPDX-License-Identifier: BSD-3-Clause
// The panel: which body, which law, how stiff; a mesh of the visitor's own; what was reached.
"use strict";
const touchPanel = (() => {
  const { SCENES, shapeOf } = touchScenes;
  const { element, notice, say, plot, theHand, actions } = viewer;
  const link = viewer.own.connection;
  const OWN = "own";
  const MOST = 200e6; // bytes of a file
  const MARGIN = 1.5; // by which the limit is above the stiffest
  const HOLDS = 0.99; // of 1,000 ticks a second
  const DEPTH_STEP = 0.012; // radii of the scene, 30 times a second
  const LAWS = {
    proxy: "A spring to where the tool would be if it went through nothing: no buzz, and no falling through.",
    bed: "The gradient of an energy along the tool. Smooth, but a tool that is pushed through comes out behind.",
    point: "A push out at the deepest point. Where two ways out are as long, the force jumps from one to the other.",
  };
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const compiled = new Map(); // by the scene's name: what the worker makes a world of
  let asked = 0; // which choice is the newest
  const state = { scene: null, report: null, limit: Infinity };

  const chosenLaw = () => document.querySelector('input[name="law"]:checked').value;
  const choices = () => ({ law: chosenLaw(), stiffness: Number(element("touch-stiffness").value) });
  const thousands = value => Math.round(value).toLocaleString("en");

  function show(name) {
    const { file, scene, size } = compiled.get(name);
    state.scene = name;
    showLimit();
    element("touch-scene").value = name;
    element("touch-size").textContent = size;
    element("touch-size").hidden = size === "";
    link.post({ kind: "scene", file, scene, choices: choices(), idles: !calm.matches && !link.touched });
  }

  // A listed body, compiled when it is first asked for.
  async function choose(name) {
    const mine = ++asked;
    if (!compiled.has(name)) {
      const scene = SCENES[name];
      const options = scene.springs ? { springs: scene.springs } : {};
      const { file, refused } = await link.compile({ source: pack.bytes(shapeOf(scene)), options });
      if (refused) return notice(`${scene.title}: ${refused}`);
      compiled.set(name, { file, scene, size: "" });
    }
    if (mine === asked) show(name);
  }

  const millimetres = sides => `${sides.map(side => (1e3 * side).toPrecision(3)).join(" \u00d7 ")} mm`;

  function sizeOf({ sides, scale }) {
    const shown = millimetres(sides.map(side => side * scale));
    const own = sides.map(side => Number(side.toPrecision(4))).join(" \u00d7 ");
    return `${own} units, shown as ${shown}. It stays in this page.`;
  }

  // What cannot be used is said in a sentence, and the scene at hand goes on.
  async function take(file) {
    if (file.size > MOST)
      return notice(`${file.name} has ${thousands(file.size / 1e6)} MB; this page reads up to ${MOST / 1e6} MB.`);
    const mine = ++asked;
    say(`${file.name} is being compiled`);
    notice("");
    let source;
    try {
      source = new Uint8Array(await file.arrayBuffer());
    } catch {
      return notice(`${file.name} cannot be read.`);
    }
    const made = await link.compile({ source, fits: true });
    if (mine !== asked) return;
    if (made.refused) return notice(`${file.name}: ${made.refused}. The scene goes on as it was.`);
    const scene = { title: file.name.slice(0, 200), colour: null };
    compiled.set(OWN, { file: made.file, scene, size: sizeOf(made) });
    const list = element("touch-scene");
    list.querySelector(`[value=${OWN}]`)?.remove();
    list.add(new Option(scene.title, OWN));
    show(OWN);
  }

  function changeForce() {
    element("touch-law").textContent = LAWS[chosenLaw()];
    element("touch-newtons").textContent = `${thousands(choices().stiffness)} N/m`;
    link.post({ kind: "force", choices: choices() });
  }

  // The slider ends below what is stable for the hand, and for a body that gives way.
  function showLimit() {
    const { limit, scene } = state;
    const stiffest = compiled.get(scene)?.scene.stiffest?.[chosenLaw()];
    const most = Math.floor(limit / MARGIN / 50) * 50;
    if (!Number.isFinite(most)) return changeForce();
    element("touch-stiffness").max = String(Math.min(most, stiffest ?? most));
    element("touch-limit").textContent =
      `Stable below ${thousands(limit)} N/m for this hand (${heldDevice.MASS} kg, ` +
      `${heldDevice.DAMPING} Ns/m, a force each ms). ` +
      (stiffest ? "A body that gives way takes less: the " : "The ") +
      `slider ends at ${thousands(element("touch-stiffness").max)}.`;
    changeForce();
  }

  function takeLimit({ limit }) {
    state.limit = limit;
    showLimit();
  }

  function showReport(report) {
    state.report = report;
    const rate = element("touch-rate");
    const [reached, micros] = rate.querySelectorAll("b");
    const holds = report.rate >= HOLDS * 1000;
    reached.textContent = thousands(report.rate);
    micros.textContent = report.micros.toFixed(1);
    rate.dataset.state = holds ? "" : "bad";
    const slow = ". This browser does not hold 1,000 now; time in the scene runs slower.";
    rate.querySelector("span").textContent = holds ? "" : slow;
    const [turned, jump] = element("touch-noise").querySelectorAll("b");
    turned.textContent = thousands(report.turned);
    jump.textContent = report.jump.toFixed(2);
  }

  // While a button is held the tool goes on in depth.
  function listenDepth() {
    for (const button of element("touch-depth").children) {
      let timer = null;
      const move = () => {
        const by = Number(button.dataset.way) * DEPTH_STEP * actions.radius();
        theHand.moveBy(
          actions
            .camera()
            .axes()
            .back.map(value => by * value),
          performance.now(),
        );
      };
      const end = () => {
        clearInterval(timer);
        timer = null;
      };
      button.addEventListener("pointerdown", () => {
        if (!actions.controls() || timer) return;
        move();
        timer = setInterval(move, 33);
      });
      for (const name of ["pointerup", "pointercancel", "pointerleave"]) button.addEventListener(name, end);
      button.addEventListener("click", event => event.detail === 0 && actions.controls() && move()); // by the keyboard
    }
  }

  function listenFiles() {
    element("touch-choose").addEventListener("click", () => element("touch-file").click());
    element("touch-file").addEventListener("change", ({ target }) => {
      if (target.files[0]) take(target.files[0]);
      target.value = ""; // the same file may be chosen again
    });
    addEventListener("dragover", event => {
      event.preventDefault();
      document.body.dataset.drop = "";
    });
    addEventListener("dragleave", event => event.relatedTarget === null && delete document.body.dataset.drop);
    addEventListener("drop", event => {
      event.preventDefault();
      delete document.body.dataset.drop;
      if (event.dataTransfer.files[0]) take(event.dataTransfer.files[0]);
    });
  }

  function listen() {
    element("touch-scene").addEventListener("change", ({ target }) => choose(target.value));
    for (const radio of document.querySelectorAll('input[name="law"]')) radio.addEventListener("change", showLimit);
    element("touch-stiffness").addEventListener("input", changeForce);
    listenFiles();
    listenDepth();
    document.addEventListener("visibilitychange", () => link.post({ kind: "pause", paused: document.hidden }));
    link.hear("ready", takeLimit);
    link.hear("report", showReport);
    link.hear("refused", ({ reason }) => notice(`The scene cannot be made: ${reason}.`));
    link.hear("restarted", ({ reason }) => notice(`The scene began anew: ${reason}.`));
    link.hear("touched", () => (element("touch-hint").hidden = true));
  }

  // For tests and the console: the scene anew, and every tick of it; touch_worker.js says what comes.
  const record = ticks =>
    new Promise(done => {
      link.hear("recorded", done);
      link.post({ kind: "record", ticks });
    });

  function start() {
    for (const [name, { title }] of Object.entries(SCENES)) element("touch-scene").add(new Option(title, name));
    element("touch-hint").hidden = false;
    plot.choose(["force", "depth"]);
    element("plots").setAttribute("aria-label", "Force and depth over time");
    listen();
    changeForce();
    if (document.hidden) link.post({ kind: "pause", paused: true });
    choose("liver");
  }

  start();
  Object.assign(window.dynpoint, { record, panel: () => ({ ...state, touched: link.touched }) });
  return { take, state };
})();
