// SPDX-License-Identifier: BSD-3-Clause
// node page_file.js FOLDER ROOM: what tools/view/page/make_page.js writes, and how it fails. FOLDER has three.js.
"use strict";
const fs = require("fs");
const path = require("path");
const crypto = require("crypto");
const { spawnSync } = require("child_process");
const { check, finish, assert, tools } = require("./verdicts.js");
const [, , folder, room] = process.argv;
const three = path.join(folder, "node_modules/three");

function make(where) {
  const { status, stderr } = spawnSync(process.execPath, [path.join(tools, "make_page.js"), where], {
    encoding: "utf8",
  });
  return { status, stderr };
}

// A folder with a copy of what the page needs of three, changed.
function altered(name, file, change) {
  const to = path.join(room, name, "node_modules/three");
  fs.mkdirSync(path.join(to, "build"), { recursive: true });
  for (const one of ["package.json", "LICENSE", "build/three.core.js", "build/three.module.js"]) {
    const text = fs.readFileSync(path.join(three, one), "utf8");
    fs.writeFileSync(path.join(to, one), one === file ? change(text) : text);
  }
  return path.join(room, name);
}

async function main() {
  const same = altered("same", "", text => text);
  const { status, stderr } = make(same);
  const page = fs.readFileSync(path.join(same, "page.html"), "utf8");
  const policy = fs.readFileSync(path.join(same, "page.csp"), "utf8");
  await check("the page is made, the same bytes each time", () => {
    assert.deepStrictEqual([status, stderr], [0, ""]);
    const sum = () =>
      crypto
        .createHash("sha256")
        .update(fs.readFileSync(path.join(same, "page.html")))
        .digest("hex");
    const first = sum();
    assert.strictEqual(make(same).status, 0);
    assert.strictEqual(sum(), first);
  });
  await check("its slot for data is there once, in an element that is no script to the browser", () => {
    assert.strictEqual(page.split("@DATA@").length, 2);
    assert(page.includes('<script type="text/plain" id="data">@DATA@</script>'));
    assert(!/@(CSP|THREE|NOTICE|FILE)/.test(page));
  });
  await check(
    "its policy names the hash of each script and style and nothing that is unsafe; the header adds frame-ancestors",
    () => {
      const allowed = new Set(policy.match(/sha256-[A-Za-z0-9+/=]+/g));
      const found = new Set();
      for (let at = 0; (at = page.indexOf("<s", at)) >= 0; at++) {
        const [tag] = /^<(script|style)>|^/.exec(page.slice(at, at + 8));
        if (!tag) continue;
        const text = page.slice(at + tag.length, page.indexOf(`</${tag.slice(1)}`, at));
        found.add(`sha256-${crypto.createHash("sha256").update(text).digest("base64")}`);
      }
      assert.deepStrictEqual([...allowed].sort(), [...found].sort());
      assert.strictEqual(found.size, 3);
      assert.match(policy, /^default-src 'none'; .*frame-ancestors 'none'$/);
      assert(!/unsafe|http|\*/.test(policy));
      assert(page.includes(`content="${policy.replace("; frame-ancestors 'none'", "")}"`));
    },
  );
  await check("it loads nothing, and carries three's notice", () => {
    const markup = page.replace(/<script[^]*?<\/script>|<style[^]*?<\/style>/g, "");
    assert.deepStrictEqual(markup.match(/\b(src|href|action|srcset|data)="(?!data:)[^"]*"|@import|url\(/g), null);
    assert(!/@import|url\(/.test(page.match(/<style>[^]*?<\/style>/)[0]));
    assert(markup.includes("The above copyright notice and this permission notice shall be included in"));
  });
  await check("a three.js that is another, or built otherwise, or not there, is an error that says so", () => {
    const fails = (name, file, change, words) => {
      const { status, stderr } = make(altered(name, file, change));
      assert.deepStrictEqual([status, fs.existsSync(path.join(room, name, "page.html"))], [1, false], name);
      assert.match(stderr, words);
    };
    fails("newer", "package.json", text => text.replace("0.187.0", "0.188.0"), /three\.js is 0\.188\.0/);
    fails(
      "bare",
      "build/three.core.js",
      text => text.replace(/^export \{/m, "module.exports = {"),
      /built otherwise/,
    );
    fails(
      "far",
      "build/three.module.js",
      text => text.replace(/'\.\/three\.core\.js'/g, "'./other.js'"),
      /built otherwise/,
    );
    fails("broken", "build/three.module.js", text => `${text}\nfunction {`, /classic script/);
    fails("ending", "build/three.module.js", text => `${text}\nconst tag = "</script>";`, /ends its element/);
    const { status, stderr } = make(path.join(room, "empty"));
    assert.strictEqual(status, 1);
    assert.match(stderr, /cannot be read.*npm ci/);
  });
  await check("the lock names no address, and pins three by its hash", () => {
    const lock = fs.readFileSync(path.join(tools, "package-lock.json"), "utf8");
    assert(!/https?:|resolved/.test(lock));
    assert.match(lock, /"version": "0\.187\.0",\s*"integrity": "sha512-/);
    assert.match(fs.readFileSync(path.join(tools, ".npmrc"), "utf8"), /^omit-lockfile-registry-resolved=true$/m);
  });
  finish();
}

main();
