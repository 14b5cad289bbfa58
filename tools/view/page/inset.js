// SPDX-License-Identifier: BSD-3-Clause
// A second, small view of the scene, drawn into a part of the same picture, where an element of the page leaves room.
"use strict";
const inset = (() => {
  const FINE = 2; // lines and arrows are so much finer than in the large view

  class Inset {
    // frame: the element whose inside it fills
    constructor(frame) {
      this.frame = frame;
      this.camera = new camera.Camera(() => {});
    }

    // place: nine numbers as of a camera of the scene, or null: there is none
    set(place, up, radius) {
      this.isThere = place !== null;
      this.frame.hidden = !this.isThere;
      if (!this.isThere) return;
      Object.assign(this.camera, { up, radius });
      this.camera.place(place);
    }

    // { x, y, width, height } in pixels of the picture, y upward, or null where there is no room for it.
    box(canvas) {
      if (!this.isThere) return null;
      const [outer, own] = [canvas, this.frame].map(element => element.getBoundingClientRect());
      const { clientLeft, clientTop, clientWidth: width, clientHeight: height } = this.frame;
      if (!(width > 0 && height > 0)) return null;
      const y = outer.bottom - own.top - clientTop - height;
      return { x: own.left + clientLeft - outer.left, y, width, height };
    }

    // render: draws the scene as this camera sees it
    draw(renderer, canvas, render) {
      const box = this.box(canvas);
      if (!box) return;
      const { x, y, width, height } = box;
      if (this.width !== width || this.height !== height) {
        Object.assign(this, { width, height });
        this.camera.resize(width, height);
        this.camera.height = FINE * height;
      }
      renderer.setScissorTest(true);
      renderer.setScissor(x, y, width, height);
      renderer.setViewport(x, y, width, height);
      render();
      renderer.setScissorTest(false);
      renderer.setViewport(0, 0, canvas.clientWidth, canvas.clientHeight);
    }
  }

  return { Inset };
})();
