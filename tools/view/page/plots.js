// SPDX-License-Identifier: BSD-3-Clause
// Plots over time, one above the other, with one axis of time. A column of pixels shows the least and the most of its
// ticks, so a peak of one tick is seen at any length of the axis.
"use strict";
const plots = (() => {
  // The values are shown in `unit`, of which there are `times` in the tick's own; an axis is never shorter than `least`.
  const KINDS = [
    { name: "force", label: "Force", unit: "N", times: 1, least: 0.1 },
    { name: "depth", label: "Depth", unit: "mm", times: 1e3, least: 0.1 },
    { name: "energy", label: "Energy", unit: "mJ", times: 1e3, least: 0.1 },
    { name: "late", label: "Lateness", unit: "ms", times: 1e3, least: 0.01 },
  ];
  // Pixels round the plots and between them.
  const LEFT = 46;
  const RIGHT = 10;
  const TOP = 22;
  const GAP = 16;
  const BOTTOM = 20;
  const SILENCE = 0.05; // s: ticks further apart than this, and than three usual steps, are not joined

  class Plots {
    constructor(canvas, history) {
      this.canvas = canvas;
      this.history = history;
      this.from = 0;
      this.to = 10;
      this.kinds = KINDS;
      this.readColours();
    }

    // Only those of these names, in the usual order.
    choose(names) {
      this.kinds = KINDS.filter(({ name }) => names.includes(name));
      this.stale = true;
    }

    readColours() {
      const style = getComputedStyle(document.documentElement);
      const read = name => style.getPropertyValue(`--${name}`).trim();
      this.colours = { text: read("faint"), strong: read("text"), grid: read("line"), cursor: read("accent") };
      for (const { name } of KINDS) this.colours[name] = read(`plot-${name}`);
      this.font = `11px ${style.fontFamily}`;
      this.stale = true;
    }

    // Of the plot of this name. True if it is new.
    setLabel(name, label) {
      const kind = KINDS.find(one => one.name === name);
      if (kind.label === label) return false;
      kind.label = label;
      this.stale = true;
      return true;
    }

    // What is plotted, in words.
    get words() {
      const labels = this.kinds.map(({ label }, i) => (i === 0 ? label : label.toLowerCase()));
      return `${new Intl.ListFormat("en-GB").format(labels)} over time`;
    }

    setWindow(from, to) {
      if (from === this.from && to === this.to) return;
      this.from = from;
      this.to = to;
      this.stale = true;
    }

    layout() {
      const { width, height, kinds } = this;
      const each = Math.max(8, (height - BOTTOM - kinds.length * TOP - (kinds.length - 1) * GAP + 4) / kinds.length);
      return kinds.map((kind, i) => ({
        ...kind,
        x: LEFT,
        y: TOP + i * (each + TOP + GAP - 4),
        w: Math.max(1, width - LEFT - RIGHT),
        h: each,
      }));
    }

    resize() {
      const width = this.canvas.clientWidth;
      const height = this.canvas.clientHeight;
      const ratio = Math.min(2, devicePixelRatio);
      if (width === this.width && height === this.height && ratio === this.ratio) return;
      Object.assign(this, { width, height, ratio, stale: true });
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
      this.under = document.createElement("canvas"); // the plots without the cursor
      this.under.width = this.canvas.width;
      this.under.height = this.canvas.height;
    }

    xOf(time) {
      return LEFT + ((time - this.from) / (this.to - this.from)) * (this.width - LEFT - RIGHT);
    }

    timeAt(x) {
      const part = (x - LEFT) / Math.max(1, this.width - LEFT - RIGHT);
      return this.from + Math.min(1, Math.max(0, part)) * (this.to - this.from);
    }

    // cursor: a time, or null
    draw(cursor) {
      this.resize();
      if (!this.width || !this.height) return;
      if (this.stale) this.drawUnder();
      this.stale = false;
      const context = this.canvas.getContext("2d");
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.clearRect(0, 0, this.canvas.width, this.canvas.height);
      context.drawImage(this.under, 0, 0);
      if (cursor === null || cursor < this.from || cursor > this.to) return;
      context.fillStyle = this.colours.cursor;
      context.globalAlpha = 0.6;
      context.fillRect(
        Math.round(this.xOf(cursor) * this.ratio),
        TOP * this.ratio,
        Math.max(1, this.ratio),
        (this.height - TOP - BOTTOM) * this.ratio,
      );
      context.globalAlpha = 1;
    }

    drawUnder() {
      const context = this.under.getContext("2d");
      context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      context.clearRect(0, 0, this.width, this.height);
      context.font = this.font;
      this.scales = {};
      const all = this.layout();
      for (const plot of all) this.drawPlot(context, plot);
      this.drawTimes(context, all[all.length - 1]);
    }

    drawPlot(context, plot) {
      const { name, label, unit, times, least, x, y, w, h } = plot;
      const columns = this.history.summary(name, this.from, this.to, Math.max(1, Math.round(w * this.ratio)));
      let low = 0;
      let high = 0;
      for (let i = 0; i < columns.most.length; i++) {
        if (columns.most[i] * times > high) high = columns.most[i] * times;
        if (columns.least[i] * times < low) low = columns.least[i] * times;
      }
      high = Math.max(scale.roundUp(high), low < 0 ? 0 : least);
      low = -scale.roundUp(-low);
      this.scales[name] = { low, high, x, y, w, h, times };
      const { values, decimals } = scale.ticks(low, high, h > 60 ? 4 : 2);
      const yOf = value => y + h * (1 - (value - low) / (high - low));
      context.textBaseline = "middle";
      context.textAlign = "right";
      for (const value of values) {
        const at = Math.round(yOf(value)) + 0.5;
        context.strokeStyle = this.colours.grid;
        context.lineWidth = 1;
        context.beginPath();
        context.moveTo(x, at);
        context.lineTo(x + w, at);
        context.stroke();
        context.fillStyle = this.colours.text;
        context.fillText(value.toFixed(decimals), x - 6, at);
      }
      context.textAlign = "left";
      context.textBaseline = "alphabetic";
      context.fillStyle = this.colours.strong;
      context.fillText(label, x, y - 7);
      const wide = context.measureText(label).width;
      context.fillStyle = this.colours.text;
      context.fillText(unit, x + wide + 6, y - 7);
      this.drawLine(context, columns, value => yOf(value * times), plot);
    }

    // Through each column's first, least, most and last value: the line looks as if every tick were joined.
    drawLine(context, { first, least, most, last, begins, ends }, yOf, { name, x, w }) {
      const step = w / first.length;
      const usual = (this.to - this.from) / Math.max(1, this.history.size);
      const silence = Math.max(SILENCE, 3 * Math.min(usual, 1));
      context.strokeStyle = this.colours[name];
      context.lineWidth = 1.25;
      context.lineJoin = "round";
      context.beginPath();
      let before = -Infinity;
      for (let i = 0; i < first.length; i++) {
        if (Number.isNaN(first[i])) continue;
        const at = x + (i + 0.5) * step;
        if (begins[i] - before > silence) context.moveTo(at - 0.5 * step, yOf(first[i]));
        for (const value of [first[i], least[i], most[i], last[i]]) context.lineTo(at, yOf(value));
        before = ends[i];
      }
      context.stroke();
    }

    drawTimes(context, { x, y, w, h }) {
      const { values, decimals } = scale.ticks(this.from, this.to, Math.max(2, w / 70));
      context.fillStyle = this.colours.text;
      context.textBaseline = "alphabetic";
      values.forEach((value, i) => {
        const at = this.xOf(value);
        const text = `${value.toFixed(decimals)}${i === values.length - 1 ? " s" : ""}`;
        context.textAlign = at > x + w - 14 ? "right" : at < x + 14 ? "left" : "center";
        context.fillText(text, Math.min(at, x + w), y + h + 16);
      });
    }

    // Where a value of a plot is drawn, in pixels of the canvas on the page.
    placeOf(name, time, value) {
      const { low, high, y, h, times } = this.scales[name];
      return [this.xOf(time), y + h * (1 - (value * times - low) / (high - low))];
    }
  }

  return { Plots };
})();
