// SPDX-License-Identifier: BSD-3-Clause
// node tools/page/make_touch_page.js BUILD PROGRAM: writes BUILD/page/dynpoint.html, one file that asks the network for
// nothing: the viewer (tools/view), the core and the compiler as WebAssembly, and meshes. BUILD/view/node_modules has
// three.js, BUILD/wasm the modules and their layer; the program makes the meshes that touch_scenes.js names.
"use strict";
const fs = require("fs");
const path = require("path");
const vm = require("vm");
const zlib = require("zlib");
const { execFileSync } = require("child_process");
const parts = require("../view/page/page_parts.js");
const [build, program] = process.argv.slice(2);
const root = path.join(__dirname, "../..");
const folders = [__dirname, path.join(__dirname, "../view/page")];
const own = name => parts.part(name, folders);

// What the workers run, in this order; the first is the layer.
const WORKER = ["held_device", "touch_world", "touch_messages", "touch_loop", "compile_job", "touch_worker"];

function bytesOf(file) {
  try {
    return fs.readFileSync(file);
  } catch (error) {
    return parts.fail(`${file} cannot be read (${error.code}); make page makes it`);
  }
}

// [name, bytes] of each shape of the scenes
function shapes() {
  const context = vm.createContext({});
  const { SCENES, shapeOf } = vm.runInContext(`${own("touch_scenes.js")}\ntouchScenes`, context);
  const made = new Map();
  for (const scene of Object.values(SCENES)) {
    const file = path.join(build, "page", shapeOf(scene));
    execFileSync(program, ["make", scene.shape, String(scene.triangles), "-o", file]);
    made.set(shapeOf(scene), bytesOf(file));
  }
  return [...made];
}

// As boot.js reads it.
function packed(list) {
  const places = {};
  let end = 0;
  for (const [name, bytes] of list) {
    places[name] = [end, bytes.length];
    end += bytes.length;
  }
  const table = Buffer.from(JSON.stringify(places));
  const head = Buffer.alloc(4);
  head.writeUInt32LE(table.length);
  const all = Buffer.concat([head, table, ...list.map(([, bytes]) => bytes)]);
  return zlib.deflateRawSync(all, { level: 9 }).toString("base64");
}

function make() {
  const three = parts.threeAsScript(path.join(build, "view"));
  const notices = [
    fs.readFileSync(path.join(root, "LICENSE"), "utf8"),
    own("c_library_notice.txt"),
    `three.js: ${three.notice}`,
  ];
  const assembled = parts.assemble({
    folders,
    texts: {
      CSP: "@CSP@",
      DATA: "",
      THREE: "three",
      NOTICE: parts.escaped(notices.join("\n")),
      LICENCES: "Licences: dynpoint, three.js, and the C library in the compiler",
      STAGE: `\n${own("touch_stage.html")}`,
      PANEL: `\n${own("touch_panel.html")}`,
    },
    instead: {
      "page.css": ["page.css", "touch.css"],
      "gestures.html": ["touch_gestures.html"],
      "connection.js": ["worker_link.js"],
      "questions.js": ["questions.js", "held_device.js", "touch_scenes.js", "touch_panel.js"],
    },
  });
  // The two scripts of the page go into the pack, and one that unpacks them stands in their place.
  const scripts = parts.textsOf(assembled, "script");
  if (scripts.length !== 2 || scripts[0] !== "three")
    parts.fail("page.html has other scripts than three.js and its own");
  const boot = own("boot.js");
  const worker = [bytesOf(path.join(build, "wasm/dynpoint.js")).toString(), ...WORKER.map(name => own(`${name}.js`))];
  const pack = packed([
    ["three.js", Buffer.from(three.script)],
    ["page.js", Buffer.from(scripts[1])],
    ["worker.js", Buffer.from(worker.join("\n"))],
    ...["dynpoint.wasm", "dynpoint_compile.wasm"].map(name => [name, bytesOf(path.join(build, "wasm", name))]),
    ...shapes(),
  ]);
  const policy = parts.policyOf({
    scripts: [boot, three.script, scripts[1]],
    styles: parts.textsOf(assembled, "style"),
    more: " 'wasm-unsafe-eval'",
    rest: "worker-src blob:; connect-src 'none'",
  });
  return assembled
    .replace("<script>three</script>", () => `<script type="text/plain" id="pack">${pack}</script>`)
    .replace(`<script>${scripts[1]}</script>`, () => `<script>${boot}</script>`)
    .replace("@CSP@", () => policy);
}

fs.mkdirSync(path.join(build, "page"), { recursive: true });
const page = make();
const file = path.join(build, "page/dynpoint.html");
fs.writeFileSync(`${file}.new`, page);
fs.renameSync(`${file}.new`, file);
console.log(`${file}: ${Buffer.byteLength(page)} bytes`);
