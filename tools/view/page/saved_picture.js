// SPDX-License-Identifier: BSD-3-Clause
// What stands over the picture, painted into one that is saved: values of the force, colours, scales. Boxes, their edges and
// their texts are painted where the page has them.
"use strict";
const savedPicture = (() => {
  const isSeen = colour => colour !== "transparent" && !/^rgba\(.*, 0\)$/.test(colour);

  function paintBox(context, element, box, style) {
    const { left, top, width, height } = box;
    const isRamp = element.classList.contains("ramp");
    if (width === 0 || height === 0) return;
    context.globalAlpha = Number(style.opacity);
    context.beginPath();
    context.roundRect(left, top, width, height, parseFloat(style.borderTopLeftRadius) || 0);
    if (isRamp) {
      context.fillStyle = context.createLinearGradient(left, 0, left + width, 0);
      for (let i = 0; i <= 16; i++) context.fillStyle.addColorStop(i / 16, `rgb(${scale.colour(i / 16).join(",")})`);
    } else context.fillStyle = style.backgroundColor;
    if (isRamp || isSeen(style.backgroundColor)) context.fill();
    const edge = parseFloat(style.borderTopWidth);
    if (edge > 0) {
      Object.assign(context, { strokeStyle: style.borderTopColor, lineWidth: edge });
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  function paintText(context, node, style, from) {
    const range = document.createRange();
    range.selectNodeContents(node);
    const { left, top, width, height } = range.getBoundingClientRect();
    if (width === 0) return;
    context.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
    context.fillStyle = style.color;
    const text = node.textContent.trim();
    const { fontBoundingBoxAscent: above, fontBoundingBoxDescent: below } = context.measureText(text);
    context.fillText(text, left - from.left, top - from.top + (height + above - below) / 2, width + 1);
  }

  // context: of the saved picture; ratio: its pixels for one of the page; canvas: the picture; roots: elements over it
  function paint(context, ratio, canvas, roots) {
    const from = canvas.getBoundingClientRect();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const walk = element => {
      if (!element.checkVisibility()) return;
      const style = getComputedStyle(element);
      const { left, top, width, height } = element.getBoundingClientRect();
      paintBox(context, element, { left: left - from.left, top: top - from.top, width, height }, style);
      for (const node of element.childNodes)
        if (node.nodeType === Node.TEXT_NODE) {
          if (node.textContent.trim()) paintText(context, node, style, from);
        } else if (node.nodeType === Node.ELEMENT_NODE) walk(node);
    };
    roots.forEach(walk);
  }

  return { paint };
})();
