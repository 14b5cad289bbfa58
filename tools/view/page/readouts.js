// SPDX-License-Identifier: BSD-3-Clause
// The numbers beside the picture, of the frame that is shown. All text enters as text.
"use strict";
const readouts = (() => {
  const CONTACT = ["unknown", "separated", "touching", "pressed in"];
  const STATUS = ["stale", "local", "bounded", "exact"];
  const REASON = [
    "acts",
    "free: it touches nothing",
    "stale: there is no valid input",
    "undecided: on which side is not known",
    "off: switched off",
    "inside: it began in a body",
    "failed: this tick could not be felt",
  ];
  const FAILED = 6;
  const HELD = 4;
  const LEFT_OUT = [
    [1, "contacts"],
    [2, "strip triangles"],
    [4, "vertices"],
  ];
  const PROXY = 2; // the law whose coupling pulls
  const word = (words, number) => words[number] ?? `unknown (${number})`;
  const fixed = (value, decimals, unit) => (Number.isFinite(value) ? `${value.toFixed(decimals)} ${unit}` : "\u2013");
  const millimetres = value => fixed(1e3 * value, 3, "mm");
  const micros = seconds => (seconds > 0 ? fixed(1e6 * seconds, 1, "\u00b5s") : "\u2013"); // a made-up clock has none
  const hertz = value => (value > 0 ? fixed(value, 0, "Hz") : "\u2013");
  const time = seconds => (Number.isFinite(seconds) ? `${seconds.toFixed(3)} s` : "\u2013");
  const coordinates = place => place.map(value => (1e3 * value).toFixed(2).padStart(9)).join("");

  // The number in the list of all segments of the one that is nearest.
  const segmentOf = (snapshot, tool) =>
    tool && tool.nearestSegment < tool.segments
      ? snapshot.segments[tool.firstSegment + tool.nearestSegment]
      : undefined;

  // What the ticks' depth is of this tool: held by a proxy, how far device and proxy are apart.
  const depthWord = tool => (tool?.law === PROXY ? "Coupling" : "Depth");

  // Why there is no force: of the last tick, if that failed.
  function reasonOf(tool, last) {
    const reason = last?.reason === FAILED ? FAILED : (tool?.reason ?? 0);
    return reason === 0 ? "" : word(REASON, reason);
  }

  // Bodies count from 0, as in a scene file.
  function heldOf(snapshot) {
    const held = (snapshot.bodies ?? []).flatMap((body, index) => (body.flags & HELD ? [index] : []));
    return held.length ? `Held where it was, as it could not be moved: body ${held.join(", ")}.` : "";
  }

  // Name of a readout: its text, for a frame, one of its tools and what the page itself counts.
  function texts(frame, index, page) {
    const { snapshot } = frame;
    const tool = snapshot.tools[index];
    const segment = segmentOf(snapshot, tool);
    const last = frame.ticks[frame.ticks.length - 1];
    const force = tool ? rays.length(tool.wrench.slice(0, 3)) : NaN;
    const depth = depths.ofTool(snapshot, index, segment, last);
    const gap = depths.gapOf(segment);
    const left = LEFT_OUT.filter(([bit]) => snapshot.flags & bit)
      .map(([, what]) => what)
      .join(", ");
    return {
      tick: snapshot.steps.toLocaleString("en"),
      time: time(snapshot.time),
      contact: segment ? word(CONTACT, segment.contact) : "\u2013",
      near: depth !== null ? millimetres(depth) : gap !== null ? millimetres(gap) : "\u2013",
      nearWord: depth !== null ? "depth" : "gap",
      distance: segment ? millimetres(segment.distance) : "\u2013",
      force: fixed(force, 2, "N"),
      torque: tool ? fixed(1e3 * rays.length(tool.wrench.slice(3)), 1, "mN m") : "\u2013",
      reason: reasonOf(tool, last),
      held: heldOf(snapshot),
      coupling: last && tool?.law === PROXY ? millimetres(last.depth) : "\u2013",
      ...channelView.texts(snapshot, index),
      energy: tool ? fixed(1e3 * tool.energy, 3, "mJ") : "\u2013",
      triangle: segment && segment.triangle !== snapshotReader.NONE ? String(segment.triangle) : "\u2013",
      status: segment ? word(STATUS, segment.status) : "\u2013",
      haptics: hertz(frame.hapticRate),
      physics: hertz(frame.physicsRate),
      view: hertz(frame.viewRate),
      drawn: hertz(page.drawnRate),
      work: micros(frame.tickP99),
      late: micros(frame.lateP99),
      dropped: frame.dropped.toLocaleString("en"),
      lost: frame.ticksLost.toLocaleString("en"),
      left: left ? `Not in this picture for want of room: ${left}.` : "",
    };
  }

  class Readouts {
    constructor(root) {
      this.fields = new Map(
        [...root.querySelectorAll("[data-readout]")].map(field => [field.dataset.readout, field]),
      );
      this.reset();
    }

    // Of a new scene: a row comes when it has something to say, and stays.
    reset() {
      for (const field of this.fields.values()) if (field.matches("dd")) field.parentElement.hidden = true;
    }

    show(all) {
      for (const [name, text] of Object.entries(all)) {
        const field = this.fields.get(name);
        if (!field || field.textContent === text) continue;
        field.textContent = text;
        if (text !== "\u2013" && field.matches("dd")) field.parentElement.hidden = false;
        if (field.dataset.optional !== undefined) field.hidden = text === "";
      }
      const contact = this.fields.get("contact");
      contact.dataset.word = all.contact;
    }
  }

  return { Readouts, texts, depthWord, coordinates, time };
})();
