// SPDX-License-Identifier: BSD-3-Clause
// Mouse, pen and fingers on the picture: rotate, pan, zoom, pick, and move a simulated hand: by its handle, or, where
// the hand comes first, by any drag and by the wheel.
"use strict";
const pointers = (() => {
  const TURN = 0.007; // radians a pixel
  const STILL = 4; // pixels that a click may move
  const CLICK = 500; // ms
  const GRAB = 14; // pixels from the handle
  const GRAB_FINGER = 26;
  const WHEEL_HAND = 0.0004; // radii of the scene for a unit of the wheel

  const middle = (a, b) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

  // on: { camera() or null, radius(), handle() in pixels or null, hand, handFirst, pick(at) }
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
      const from = isForHand(event, first) ? on.hand.start(event.timeStamp) : null;
      gesture = {
        kind: from ? "hand" : cameraKind(event),
        at: first,
        from,
        start: first,
        moved: false,
        click: event.button === 0 && !from,
        begun: event.timeStamp,
      };
    }

    function isForHand(event, place) {
      const handle = on.handle();
      if (on.handFirst) return handle && event.button === 0 && !event.shiftKey;
      return handle && apart(handle, place) <= (event.pointerType === "touch" ? GRAB_FINGER : GRAB);
    }

    // The right button turns the camera where the left one has the hand.
    const cameraKind = ({ button, shiftKey }) =>
      shiftKey || (button !== 0 && !(on.handFirst && button === 2)) ? "pan" : "rotate";

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
        if (on.handFirst) view.rotate(-TURN * (centre[0] - x), TURN * (centre[1] - y));
        else view.pan(centre[0] - x, centre[1] - y);
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

    // Towards the viewer, or away; a drag goes on from there.
    function wheelHand(by, now) {
      const { back } = on.camera().axes();
      on.hand.moveBy(
        back.map(value => WHEEL_HAND * by * on.radius() * value),
        now,
      );
      if (gesture?.kind === "hand") Object.assign(gesture, { from: on.hand.wanted, start: gesture.at });
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
        const by = Math.max(-400, Math.min(400, lines * event.deltaY));
        if (on.handFirst && !event.ctrlKey && on.handle()) wheelHand(by, event.timeStamp);
        else on.camera()?.zoom(Math.exp(0.0012 * by));
      },
      { passive: false },
    );
  }

  return { attach };
})();
