// SPDX-License-Identifier: BSD-3-Clause
// The value of each force, at the end of its arrow. Labels stay within the picture, clear of what stands at its edges.
"use strict";
const arrowLabels = (() => {
  const BEYOND = 12; // pixels from the arrow's end
  const SIDE = 4; // pixels to the picture's edge
  const LEAST = 0.005; // N: less has no value
  const clamp = (value, least, most) => Math.max(least, Math.min(most, value));
  const valueOf = newtons => `${newtons.toFixed(newtons < 10 ? 2 : 1)} N`;

  class ArrowLabels {
    constructor(root) {
      this.root = root;
    }

    // view: a SceneView that has drawn
    show(view) {
      const arrows = view.tools.arrows.filter(({ newtons }) => newtons >= LEAST);
      const { top, bottom } = view.edges();
      while (this.root.children.length < arrows.length) this.root.append(document.createElement("span"));
      while (this.root.children.length > arrows.length) this.root.lastChild.remove();
      arrows.forEach((arrow, i) => this.place(this.root.children[i], arrow, view, top, bottom));
    }

    place(label, { from, to, newtons }, view, top, bottom) {
      const [begin, end] = [from, to].map(place => view.project(place));
      label.hidden = !begin || !end;
      if (label.hidden) return;
      const text = valueOf(newtons);
      if (label.textContent !== text) label.textContent = text;
      const way = [end[0] - begin[0], end[1] - begin[1]];
      const by = 1 / Math.max(1e-6, Math.hypot(...way));
      const half = [label.offsetWidth / 2, label.offsetHeight / 2];
      const out = BEYOND + Math.abs(way[0] * by) * half[0] + Math.abs(way[1] * by) * half[1];
      const high = end[1] + out * way[1] * by;
      const y = clamp(high, top + half[1], view.height - bottom - half[1]);
      const aside = y === high ? 0 : half[0] + BEYOND; // beside an arrow that reaches the edge
      const x = clamp(end[0] + out * way[0] * by + aside, SIDE + half[0], view.width - SIDE - half[0]);
      label.style.transform = `translate(${(x - half[0]).toFixed(1)}px, ${(y - half[1]).toFixed(1)}px)`;
    }
  }

  return { ArrowLabels, valueOf };
})();
