// SPDX-License-Identifier: BSD-3-Clause
// What the page's workers do: one compiles a mesh and ends, one runs the world. Messages to the page are bytes for the
// viewer, and objects with a `kind` for the rest.
"use strict";
(() => {
  const BEAT = 4; // ms: browsers have no shorter timer
  const { TouchWorld } = touchWorld;
  const { TouchLoop, idleOver } = touchLoop;
  let core = null;
  const early = []; // what came before the core was there
  let loop = null;
  let made = null; // what the world was made of
  let timer = null;
  let recording = null;

  const numbersOf = ({ law, stiffness }) => ({ law: dynpoint.constants[`DPT_LAW_${law.toUpperCase()}`], stiffness });
  const send = bytes => postMessage(bytes, [bytes.buffer]);
  const tell = report => postMessage({ kind: "report", ...report });

  // A world, anew; the old one stays if the new one cannot be.
  function open({ file, scene, choices, idles }) {
    const touch = new TouchWorld(core, file, scene, numbersOf(choices));
    loop?.touch.close();
    made = { file, scene, choices, idles };
    recording = null;
    loop = new TouchLoop(touch, { now: () => performance.now(), send, tell });
    loop.onTick = record;
    if (idles) loop.idle = idleOver(touch.half, scene.sag);
    send(
      touchMessages.scene(touch, {
        program: `dynpoint ${core.version}, in this page`,
        device: { name: "your hand", simulated: true, rate: 1000, workspace: null },
      }),
    );
  }

  // A body that left its box, or a number that is none: from the beginning, and the page says why.
  function beat() {
    try {
      loop?.beat();
    } catch (error) {
      if (!(error instanceof dynpoint.DynpointError)) throw error;
      open(made);
      postMessage({ kind: "restarted", reason: error.message });
    }
  }

  // Every tick of a world from its beginning, for a comparison: poses, and snapshots one behind the other.
  function record(touch) {
    if (!recording) return;
    recording.poses.set(touch.toolPose, 7 * recording.count++);
    const { vertices } = touch.mesh.info;
    const isLast = recording.count === recording.ticks;
    recording.snapshots.push(touch.world.getSnapshot({ maxVertices: isLast && touch.isSoft ? vertices : 0 }).slice());
    if (!isLast) return;
    const { poses, snapshots, law, stiffness } = recording;
    const { body, pose, segment, loadRadius = 0 } = touch;
    recording = null;
    const { file } = made;
    postMessage({ kind: "recorded", poses, snapshots, law, stiffness, body, pose, segment, loadRadius, file });
  }

  const acts = {
    async core({ bytes }) {
      core = await dynpoint.openCore(bytes);
      const { DAMPING, MASS, PERIOD } = heldDevice;
      postMessage({ kind: "ready", limit: core.stableStiffness(MASS, DAMPING, PERIOD, 0, 0) });
      timer ??= setInterval(beat, BEAT);
      for (const message of early.splice(0)) acts[message.kind](message);
    },
    async compile(job) {
      const answer = await compileJob.run(dynpoint, job);
      postMessage({ kind: "compiled", ...answer }, answer.file ? [answer.file.buffer] : []);
    },
    scene(message) {
      try {
        open(message);
      } catch (error) {
        postMessage({ kind: "refused", reason: error.message });
      }
    },
    force({ choices }) {
      if (!loop) return;
      made.choices = choices;
      const numbers = numbersOf(choices);
      if (loop.touch.takes(numbers)) loop.touch.setForce(numbers);
      else acts.scene(made);
    },
    pause({ paused }) {
      clearInterval(timer);
      timer = null;
      if (paused) return;
      loop?.resume();
      timer = setInterval(beat, BEAT);
    },
    text({ text }) {
      loop?.hear(text);
      if (made && text.startsWith("hand ")) made.idles = false;
    },
    record({ ticks }) {
      open(made);
      const { law, stiffness } = loop.touch;
      recording = { ticks, count: 0, law, stiffness, poses: new Float64Array(7 * ticks), snapshots: [] };
    },
  };

  onmessage = ({ data }) => {
    if (core || data.kind === "core" || data.kind === "compile") acts[data.kind](data);
    else early.push(data);
  };
})();
