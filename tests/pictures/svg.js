// SPDX-License-Identifier: BSD-3-Clause
// Drawings in SVG: a light panel, and on it shapes, arrows, dimension lines and labels. Places are [x, y] in pixels. Nothing
// here asks for a clock, a font or the machine, so the same calls write the same bytes.
"use strict";

// Okabe and Ito's colours, which the colour-blind tell apart, and greys.
const INK = "#222222";
const COLOURS = {
  tool: "#0072b2",
  proxy: "#009e73",
  force: "#d55e00",
  contact: "#e69f00",
  other: "#cc79a7",
  device: "#56b4e9",
  body: "#e6e2da",
  edge: "#5c574f",
  faint: "#8c877d",
};

const STYLE = `
text { font-family: "Helvetica Neue", Helvetica, Arial, "DejaVu Sans", sans-serif; font-size: 14px; fill: ${INK} }
.halo { paint-order: stroke; stroke: #fbfaf6; stroke-width: 4px; stroke-linejoin: round }
.strong { font-weight: bold }
.small { font-size: 12.5px; fill: #45413b }
`;

const escape = text => String(text).replace(/[&<>"]/g, c => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
// A number with so many decimals, a true minus, and no minus before zero.
const number = (value, decimals) => {
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
};
const px = value => String(Number(value.toFixed(2)) || 0);
const at = ([x, y]) => `${px(x)} ${px(y)}`;
// A closed line, in SVG's words.
const lineOf = places => `M${places.map(at).join("L")}Z`;
const add = ([x, y], [u, v], by = 1) => [x + by * u, y + by * v];
const toward = (from, to) => {
  const [x, y] = add(to, from, -1);
  const length = Math.sqrt(x * x + y * y);
  return [x / length, y / length];
};

class Drawing {
  // description: what one would see, for those who do not
  constructor({ width, height, title, description }) {
    Object.assign(this, { width, height, title, description, parts: [] });
  }

  put(tag, attributes, content) {
    const list = Object.entries(attributes)
      .filter(([, value]) => value !== undefined)
      .map(([name, value]) => ` ${name}="${escape(typeof value === "number" ? px(value) : value)}"`)
      .join("");
    this.parts.push(content === undefined ? `<${tag}${list}/>` : `<${tag}${list}>${content}</${tag}>`);
  }

  // What a function puts, with attributes that all of it shares.
  group(attributes, fill) {
    const outside = this.parts;
    this.parts = [];
    fill();
    const content = this.parts.join("\n");
    this.parts = outside;
    this.put("g", attributes, content);
  }

  path(places, { closed = false, stroke = INK, width = 1.5, fill = "none", ...more } = {}) {
    const d = closed ? lineOf(places) : lineOf(places).slice(0, -1);
    this.put("path", { d, fill, stroke, "stroke-width": width, "stroke-linejoin": "round", "stroke-linecap": "round", ...more });
  }

  // All points within a radius of a line from a to b.
  capsule(a, b, radius, { stroke = COLOURS.tool, width = 2, fill = "none", ...more } = {}) {
    const [x, y] = toward(a, b);
    const side = [-y * radius, x * radius];
    const r = px(radius);
    const d =
      `M${at(add(a, side))}A${r} ${r} 0 0 1 ${at(add(a, side, -1))}` +
      `L${at(add(b, side, -1))}A${r} ${r} 0 0 1 ${at(add(b, side))}Z`;
    this.put("path", { d, fill, stroke, "stroke-width": width, ...more });
  }

  dot(place, { radius = 4, fill = INK, stroke = "#fbfaf6", width = 1.2 } = {}) {
    this.put("circle", { cx: place[0], cy: place[1], r: radius, fill, stroke, "stroke-width": width });
  }

  arrow(from, to, { stroke = INK, width = 2, head = 9, ...more } = {}) {
    const way = toward(from, to);
    const across = [-way[1], way[0]];
    const neck = add(to, way, -head);
    this.path([from, add(neck, way, 1)], { stroke, width, ...more });
    this.path([to, add(neck, across, 0.42 * head), add(neck, across, -0.42 * head)], {
      closed: true,
      stroke,
      width: 0.5,
      fill: stroke,
    });
  }

  // What lies between two places, as on an engineer's drawing: two arrows, moved aside by `offset` pixels.
  dimension(from, to, { offset = 0, stroke = INK } = {}) {
    const way = toward(from, to);
    const across = [way[1], -way[0]];
    const [a, b] = [from, to].map(place => add(place, across, offset));
    if (offset !== 0) {
      const over = offset + 5 * Math.sign(offset);
      for (const place of [from, to])
        this.path([add(place, across, 3 * Math.sign(offset)), add(place, across, over)], { stroke: COLOURS.faint, width: 1 });
    }
    const middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
    const head = Math.min(7, 0.45 * Math.abs((b[0] - a[0]) * way[0] + (b[1] - a[1]) * way[1]));
    this.arrow(middle, a, { stroke, width: 1.2, head });
    this.arrow(middle, b, { stroke, width: 1.2, head });
  }

  // anchor: start, middle or end. kind: "", "strong" or "small"
  label(text, [x, y], { anchor = "start", kind = "", fill } = {}) {
    const style = fill && `fill: ${fill}`;
    this.put("text", { x, y, "text-anchor": anchor, class: `halo ${kind}`.trim(), style }, escape(text));
  }

  // A label that a thin line ties to what it names. side: of the text where the line begins, below, above, left or right
  callout(text, place, target, { side = "below", ...options } = {}) {
    const [shift, anchor] = {
      below: [[0, 6], "middle"],
      above: [[0, -15], "middle"],
      left: [[-5, -5], "start"],
      right: [[5, -5], "end"],
    }[side];
    this.path([add(place, shift), target], { stroke: COLOURS.faint, width: 1 });
    this.label(text, place, { anchor, ...options });
  }

  // A coil between two places.
  spring(from, to, { turns = 7, amplitude = 7, stroke = INK, width = 1.8 } = {}) {
    const way = toward(from, to);
    const across = [-way[1], way[0]];
    const span = add(to, from, -1);
    const places = [from];
    for (let k = 0; k <= 2 * turns; k++) {
      const part = 0.12 + (0.76 * k) / (2 * turns);
      const swing = k === 0 || k === 2 * turns ? 0 : k % 2 ? amplitude : -amplitude;
      places.push(add(add(from, span, part), across, swing));
    }
    this.path([...places, to], { stroke, width });
  }

  toString() {
    const { width, height } = this;
    return [
      `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" role="img">`,
      `<!-- SPDX-License-Identifier: BSD-3-Clause. Made by make pictures. -->`,
      `<title>${escape(this.title)}</title>`,
      `<desc>${escape(this.description)}</desc>`,
      `<style>${STYLE}</style>`,
      `<rect class="panel" x="1" y="1" width="${width - 2}" height="${height - 2}" rx="12" fill="#fbfaf6" stroke="#d5d0c4"/>`,
      `<clipPath id="panel"><rect x="2" y="2" width="${width - 4}" height="${height - 4}" rx="11"/></clipPath>`,
      `<g clip-path="url(#panel)">`,
      ...this.parts,
      `</g>`,
      `</svg>`,
      ``,
    ].join("\n");
  }
}

module.exports = { Drawing, COLOURS, INK, number, add, toward, lineOf };
