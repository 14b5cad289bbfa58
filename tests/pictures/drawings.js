// SPDX-License-Identifier: BSD-3-Clause
// node drawings.js FOLDER ROOM: the drawings of a folder, as a headless Chromium lays them out: they are XML with a title and
// a description; no text lies on another one or leaves the panel; none is too small.
"use strict";
const fs = require("fs");
const path = require("path");
const { launch } = require("../view/chromium.js");
const { check, finish, assert } = require("../view/verdicts.js");
const [folder, room] = process.argv.slice(2);
const LEAST_PX = 12;
const WIDEST = 760;
const EDGE = 4; // px from a text to the panel's edge

// In the page: the texts with their boxes, or what is wrong with the XML.
function layOut(source) {
  const parsed = new DOMParser().parseFromString(source, "image/svg+xml");
  const fault = parsed.querySelector("parsererror");
  if (fault || parsed.documentElement.localName !== "svg") return { fault: fault?.textContent ?? "no svg" };
  const holder = document.createElement("div");
  const shadow = holder.attachShadow({ mode: "open" });
  document.body.replaceChildren(holder);
  const svg = shadow.appendChild(document.importNode(parsed.documentElement, true));
  const word = name => [...svg.children].find(({ localName }) => localName === name)?.textContent ?? "";
  const box = part => {
    const { x, y, width, height } = part.getBBox();
    return [x, y, x + width, y + height];
  };
  return {
    title: word("title"),
    desc: word("desc"),
    width: svg.width.baseVal.value,
    panel: box(svg.querySelector(".panel")),
    texts: [...svg.querySelectorAll("text")].map(text => ({
      text: text.textContent,
      box: box(text),
      px: parseFloat(getComputedStyle(text).fontSize),
      family: getComputedStyle(text).fontFamily,
    })),
  };
}

const meet = (one, other) => one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3];

function judge({ fault, title, desc, width, panel, texts }) {
  assert(!fault, fault);
  assert(title.length > 10 && desc.length > 60, `title '${title}', description '${desc}'`);
  assert(width <= WIDEST, `${width} px wide`);
  assert(texts.length > 1, "it says nothing");
  const [left, top, right, bottom] = panel;
  texts.forEach(({ text, box, px, family }, k) => {
    assert(px >= LEAST_PX && /sans-serif/.test(family), `'${text}': ${px} px of ${family}`);
    const isInside = box[0] >= left + EDGE && box[1] >= top && box[2] <= right - EDGE && box[3] <= bottom;
    assert(isInside, `'${text}' leaves the panel: ${box.map(Math.round)}`);
    for (const other of texts.slice(k + 1)) assert(!meet(box, other.box), `'${text}' lies on '${other.text}'`);
  });
}

(async () => {
  const names = fs.readdirSync(folder).filter(name => /^concepts-.*\.svg$/.test(name));
  const blank = path.resolve(room, "blank.html");
  fs.writeFileSync(blank, "<!doctype html><body>");
  const browser = launch(room);
  try {
    const page = await browser.visit(`file://${blank}`);
    await check("there are drawings", () => assert(names.length >= 12, `${names.length}`));
    for (const name of names)
      await check(`${name}: XML, title, description; its texts lie apart, inside`, async () =>
        judge(await page.call(layOut, fs.readFileSync(path.join(folder, name), "utf8"))),
      );
  } finally {
    await browser.close();
  }
  finish();
})().catch(error => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
