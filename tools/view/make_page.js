// SPDX-License-Identifier: BSD-3-Clause
// node tools/view/make_page.js [FOLDER=build/view]: writes FOLDER/page.html, one file that asks the network for
// nothing, and FOLDER/page.csp, the value of the header Content-Security-Policy with which a server sends it.
// FOLDER/node_modules has three.js, by `npm ci` with the package-lock.json that lies here.
//
// In page.html a slot @NAME@ takes a text, and @FILE name@ the file of that name, less its SPDX line. One slot stays in
// the written page, once: @DATA@. A page that plays by itself has the stream there, in base64; elsewhere it may stay.
"use strict";
const fs = require("fs");
const path = require("path");
const crypto = require("crypto");
const vm = require("vm");
const source = __dirname;
const folder = process.argv[2] ?? path.join(__dirname, "../../build/view");
const MARKER = "@DATA@";
const VERSION = "0.187.0";
const ENDING = /<\/(script|style)|<!--/i;

function fail(sentence) {
  console.error(`make_page: ${sentence}`);
  process.exit(1);
}

function read(file) {
  try {
    return fs.readFileSync(file, "utf8");
  } catch (error) {
    return fail(`${file} cannot be read (${error.code}); npm ci in ${folder} brings three.js`);
  }
}

// [[own name, outer name]] of `a, b as c`
const namesOf = list =>
  list
    .split(",")
    .map(item => item.trim().split(/\s+as\s+/))
    .filter(([own]) => own);

// three's build is two modules, and the second imports the first. Each becomes a function of what it imports, which
// returns what it exports: that needs neither a server nor an import map.
function threeAsScript() {
  const three = path.join(folder, "node_modules/three");
  const { version } = JSON.parse(read(path.join(three, "package.json")));
  if (version !== VERSION) fail(`three.js is ${version}; this page is made for ${VERSION}`);
  const module = name => {
    const text = read(path.join(three, "build", name));
    const own = [];
    const body = text
      .replace(
        /^import\s*\{([^}]*)\}\s*from\s*'\.\/three\.core\.js';$/gm,
        (_, list) =>
          `const { ${namesOf(list)
            .map(([outer, inner = outer]) => `${outer}: ${inner}`)
            .join(", ")} } = core;`,
      )
      .replace(/^export\s*\{[^}]*\}\s*from\s*'\.\/three\.core\.js';$/gm, "")
      .replace(/^export\s*\{([^}]*)\};$/gm, (_, list) => {
        own.push(...namesOf(list).map(([inner, outer = inner]) => `${outer}: ${inner}`));
        return "";
      });
    if (own.length === 0 || /^(import|export)\b/m.test(body))
      fail(`three's ${name} is built otherwise than ${VERSION} is`);
    return `(core => {\n"use strict";\n${body}\nreturn { ...core, ${own.join(", ")} };\n})`;
  };
  const script = `const THREE = ${module("three.module.js")}(${module("three.core.js")}({}));`;
  try {
    new vm.Script(script);
  } catch (error) {
    fail(`three.js does not become a classic script: ${error.message}`);
  }
  if (ENDING.test(script)) fail("three.js has a tag that ends its element");
  return { script, notice: read(path.join(three, "LICENSE")) };
}

const escaped = text => text.replace(/[&<>]/g, sign => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[sign]);
const withoutLicenceLine = text => text.replace(/^[^\n]*SPDX-License-Identifier[^\n]*\n/, "");

function assemble() {
  const { script, notice } = threeAsScript();
  const texts = { THREE: script, NOTICE: escaped(notice) };
  return read(path.join(source, "page.html")).replace(/@(FILE ([\w.]+)|[A-Z]+)@/g, (slot, name, file) => {
    if (slot === MARKER || slot === "@CSP@") return slot;
    const text = file ? withoutLicenceLine(read(path.join(source, file))) : texts[name];
    if (text === undefined) fail(`page.html has a slot ${slot} that nothing fills`);
    if (file && ENDING.test(text)) fail(`${file} has a tag that ends its element`);
    return text;
  });
}

function policyOf(page) {
  const hashes = tag =>
    [...page.matchAll(new RegExp(`<${tag}>([^]*?)</${tag}>`, "g"))]
      .map(([, text]) => `'sha256-${crypto.createHash("sha256").update(text).digest("base64")}'`)
      .join(" ");
  return (
    `default-src 'none'; script-src ${hashes("script")}; style-src ${hashes("style")}; connect-src 'self'; ` +
    "img-src data:; base-uri 'none'; form-action 'none'"
  );
}

const assembled = assemble();
if (assembled.split(MARKER).length !== 2) fail(`${MARKER} must occur once in the page`);
const policy = policyOf(assembled);
const page = assembled.replace("@CSP@", () => policy);
fs.mkdirSync(folder, { recursive: true });
fs.writeFileSync(path.join(folder, "page.html"), page);
fs.writeFileSync(path.join(folder, "page.csp"), `${policy}; frame-ancestors 'none'`);
console.log(`${path.join(folder, "page.html")}: ${Buffer.byteLength(page)} bytes`);
