// SPDX-License-Identifier: BSD-3-Clause
// The keys, for the whole page. The help panel in page.html names them.
"use strict";
const keys = (() => {
  const TURN = 0.08; // radians
  const PAN = 24; // pixels
  const ZOOM = 1.12; // times
  const HAND = 0.01; // radii of the scene
  const VIEW_OF = { 1: "front", 2: "back", 3: "left", 4: "right", 5: "top", 6: "bottom" };
  const MOVES_CAMERA = {
    a: view => view.rotate(-TURN, 0),
    d: view => view.rotate(TURN, 0),
    w: view => view.rotate(0, TURN),
    s: view => view.rotate(0, -TURN),
    i: view => view.pan(0, PAN),
    k: view => view.pan(0, -PAN),
    j: view => view.pan(PAN, 0),
    l: view => view.pan(-PAN, 0),
    "+": view => view.zoom(1 / ZOOM),
    "=": view => view.zoom(1 / ZOOM),
    "-": view => view.zoom(ZOOM),
  };
  const MOVES_TIME = {
    " ": "toggle",
    ArrowLeft: "back",
    ArrowRight: "forward",
    Home: "begin",
    End: "end",
    "[": "slower",
    "]": "faster",
  };
  const MOVES_HAND = {
    ArrowLeft: ["right", -1],
    ArrowRight: ["right", 1],
    ArrowUp: ["above", 1],
    ArrowDown: ["above", -1],
    PageUp: ["back", -1],
    PageDown: ["back", 1],
  };
  const ACTS = { f: "fit", p: "save", t: "theme", o: "deformation", "?": "help", Enter: "pick", Escape: "unpick" };
  // What an element with the focus does with a key by itself.
  const own = (element, key) =>
    element.closest("dialog") ||
    (element.matches("select") && key !== "?") ||
    (element.matches("input") && /^(Arrow|Page|Home|End)/.test(key)) ||
    (element.matches("button, summary") && (key === " " || key === "Enter"));

  // on: { camera(), radius(), hand, handFirst, controls(), view(name), and a function for each word above }
  function attach(on) {
    addEventListener("keydown", event => {
      const { key } = event;
      const lower = key.length === 1 ? key.toLowerCase() : key;
      if (event.ctrlKey || event.metaKey || event.altKey || own(event.target, key)) return;
      const view = on.camera();
      const axis = event.shiftKey !== on.handFirst && MOVES_HAND[key]; // with Shift, or where the hand is first without
      if (axis && on.controls() && view) {
        const direction = view.axes()[axis[0]];
        const by = axis[1] * HAND * on.radius();
        on.hand.moveBy(
          direction.map(value => by * value),
          event.timeStamp,
        );
      } else if (MOVES_CAMERA[lower]) {
        if (view) MOVES_CAMERA[lower](view);
      } else if (VIEW_OF[key]) on.view(VIEW_OF[key]);
      else if (MOVES_TIME[key]) on[MOVES_TIME[key]]();
      else if (ACTS[lower]) on[ACTS[lower]]();
      else return;
      event.preventDefault();
    });
  }

  return { attach };
})();
