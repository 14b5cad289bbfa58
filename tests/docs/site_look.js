// SPDX-License-Identifier: BSD-3-Clause
// node site_look.js SITE VERSION ROOM [SHOTS]: the site of `make docs` in a headless Chromium, at 1280 and 390 pixels, light and
// dark. No page is wider than its window, each follows the system's theme, and the organ in the tutorial ticks. SHOTS: a folder
// for pictures of what was seen. Whether a page is beautiful it cannot say.
"use strict";
const fs = require("fs");
const path = require("path");
const { launch, until } = require("../view/chromium.js");
const { serve } = require("../js/server.js");
const [site, version, room, shots] = process.argv.slice(2);

const PAGES = ["index", "docs/index", "docs/install", "docs/tutorial", "docs/output", "docs/abi", "docs/page", "docs/format", "api/tool",
  "python/dynpoint", "languages/csharp", "languages/rust", "languages/javascript", "search", "genindex", "../versions"];

function verdict(good, what) {
  console.log(`  ${good ? "ok  " : "FAIL"} ${what}`);
}

// What of the text sticks out of the window. A table or a block of code may scroll by itself.
function wide() {
  const column = node => node.matches("body, .page, .main, .content, .article-container, article, main, [role=main]");
  const isWithin = node =>
    !column(node.parentElement) && (getComputedStyle(node.parentElement).overflowX !== "visible" || isWithin(node.parentElement));
  const out = [...document.querySelectorAll("article *, [role=main] *")].filter(
    node => node.getBoundingClientRect().right > innerWidth + 1 && !column(node) && !isWithin(node),
  );
  if (document.documentElement.scrollWidth > innerWidth + 1) out.push(document.body);
  return out.slice(0, 3).map(node => `${node.tagName}.${node.className} ${node.textContent.trim().slice(0, 40)}`);
}

function brightness() {
  const canvas = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d");
  const [back] = [document.body, document.documentElement].map(node => getComputedStyle(node).backgroundColor)
    .filter(colour => !/, 0\)$/.test(colour)).concat(["Canvas"]);
  canvas.fillStyle = back;
  canvas.fillRect(0, 0, 1, 1);
  return canvas.getImageData(0, 0, 1, 1).data.slice(0, 3).reduce((sum, value) => sum + value, 0) / 765;
}

async function organ(browser, url) {
  const page = await browser.visit(`${url}/${version}/docs/tutorial.html`);
  await page.ask("document.querySelector('iframe.organ').scrollIntoView()");
  const ticks = () => page.ask("document.querySelector('iframe.organ').contentWindow.dynpoint?.state?.().time ?? 0");
  await until("the organ's first ticks", async () => (await ticks()) > 0);
  const before = await ticks();
  await until("more of them", async () => (await ticks()) > before);
  verdict(page.said.length === 0, `the organ in the tutorial ticks ${page.said}`);
  if (shots) await page.shoot(path.join(shots, "organ.png"));
  await browser.leave(page);
}

async function main() {
  const server = await serve(site, false);
  const browser = launch(room);
  try {
    for (const [width, height] of [[1280, 800], [390, 844]])
      for (const theme of ["light", "dark"]) {
        const bad = [];
        const pages = PAGES.filter(name => fs.existsSync(path.join(site, version, `${name}.html`)));
        for (const name of pages) {
          const page = await browser.visit(`${server.url}/${path.posix.join(version, name)}.html`,
            { width, height, features: { "prefers-color-scheme": theme } });
          const out = await page.call(wide);
          const light = await page.call(brightness);
          if (out.length) bad.push(`${name}: ${out.join("; ")}`);
          if (theme === "light" ? light < 0.7 : light > 0.3) bad.push(`${name} has a brightness of ${light.toFixed(2)}`);
          if (shots) await page.shoot(path.join(shots, `${name.replace(/\W+/g, "-")}-${width}-${theme}.png`));
          await browser.leave(page);
        }
        verdict(pages.length >= 12 && !bad.length, `${pages.length} pages at ${width} pixels, ${theme} ${bad.join(" | ")}`);
      }
    if (fs.existsSync(path.join(site, version, "dynpoint.html"))) await organ(browser, server.url);
    else console.log("  skip the organ in the tutorial: make page first");
  } finally {
    server.close();
    await browser.close();
  }
}

main().catch(error => {
  verdict(false, `the site in a browser: ${error.stack}`);
  process.exitCode = 1;
});
