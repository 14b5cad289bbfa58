// SPDX-License-Identifier: BSD-3-Clause
// Mouse, pen and fingers on the picture: rotate, pan, zoom, pick, and drag the handle of a simulated hand.
"use strict";
const pointers = (() => {
  const TURN = 0.007; // radians a pixel
  const STILL = 4; // pixels that a click may move
  const CLICK = 500; // ms
  const GRAB = 14; // pixels from the handle
  const GRAB_FINGER = 26;

  const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

  // on: { camera() or null, handle() in pixels or null, hand, pick(at) }
  function attach(canvas, on) {
    const down = new Map(); // pointers that are down: where
    let gesture = null;

    const at = event => {
      const { left, top } = canvas.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };

    function begin(event) {
      if (!on.camera()) return;
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true, focusVisible: false });
      down.set(event.pointerId, at(event));
      const [first, second] = [...down.values()];
      if (second) {
        gesture = { kind: "pinch", at: middle(first, second), apart: apart(first, second) };
        return;
      }
      const handle = on.handle();
      const near = event.pointerType === "touch" ? GRAB_FINGER : GRAB;
      const from = handle && apart(handle, first) <= near ? on.hand.start(event.timeStamp) : null;
      const pans = event.button !== 0 || event.shiftKey;
      gesture = {
        kind: from ? "hand" : pans ? "pan" : "rotate",
        at: first,
        from,
        start: first,
        moved: false,
        click: event.button === 0 && !from,
        begun: event.timeStamp,
      };
    }

    function move(event) {
      if (!down.has(event.pointerId) || !gesture) return;
      const place = at(event);
      const view = on.camera();
      const [x, y] = gesture.at;
      down.set(event.pointerId, place);
      if (gesture.kind === "pinch") {
        const [first, second] = [...down.values()];
        const centre = middle(first, second);
        const wide = apart(first, second);
        view.pan(centre[0] - x, centre[1] - y);
        if (wide > 0 && gesture.apart > 0) view.zoom(gesture.apart / wide);
        gesture = { kind: "pinch", at: centre, apart: wide };
        return;
      }
      if (!gesture.moved && apart(place, gesture.start) < STILL) return;
      gesture.moved = true;
      gesture.at = place;
      if (gesture.kind === "rotate") view.rotate(-TURN * (place[0] - x), TURN * (place[1] - y));
      if (gesture.kind === "pan") view.pan(place[0] - x, place[1] - y);
      if (gesture.kind === "hand")
        on.hand.want(moved(gesture.from, place[0] - gesture.start[0], place[1] - gesture.start[1]), event.timeStamp);
    }

    // A place moved by pixels, in the plane of the screen.
    function moved(place, aside, below) {
      const view = on.camera();
      const by = view.pixelSize(place);
      const { right, above } = view.axes();
      return place.map((value, k) => value + by * (aside * right[k] - below * above[k]));
    }

    function end(event) {
      if (!down.delete(event.pointerId)) return;
      const still = gesture && gesture.click && !gesture.moved && event.timeStamp - gesture.begun < CLICK;
      if (event.type === "pointerup" && still) on.pick(gesture.start);
      const [rest] = down.values();
      gesture = rest ? { kind: "rotate", at: rest, start: rest, moved: true, click: false } : null;
    }

    canvas.addEventListener("pointerdown", begin);
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener(
      "wheel",
      event => {
        event.preventDefault();
        const lines = [1, 20, 400][event.deltaMode] ?? 1;
        on.camera()?.zoom(Math.exp(0.0012 * Math.max(-400, Math.min(400, lines * event.deltaY))));
      },
      { passive: false },
    );
  }

  return { attach };
})();
