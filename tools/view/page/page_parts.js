// SPDX-License-Identifier: BSD-3-Clause
// What makes pages of page.html: slots and files that go into it, three.js as a classic script, and the policy that
// allows the page's own scripts alone. make_page.js writes the viewer, tools/page/make_touch_page.js the page with the
// core in it.
//
// In page.html a slot @NAME@ takes a text, and @FILE name@ the file of that name, less its SPDX line.
"use strict";
const fs = require("fs");
const path = require("path");
const crypto = require("crypto");
const vm = require("vm");
const MARKER = "@DATA@";
const VERSION = "0.187.0";
const ENDING = /<\/(script|style)|<!--/i;

function fail(sentence) {
  console.error(`make_page: ${sentence}`);
  process.exit(1);
}

// advice: what brings the file
function read(file, advice) {
  try {
    return fs.readFileSync(file, "utf8");
  } catch (error) {
    return fail(`${file} cannot be read (${error.code}); ${advice}`);
  }
}

// [[own name, outer name]] of `a, b as c`
const namesOf = list =>
  list
    .split(",")
    .map(item => item.trim().split(/\s+as\s+/))
    .filter(([own]) => own);

// three's build is two modules, and the second imports the first. Each becomes a function of what it imports, which
// returns what it exports: that needs neither a server nor an import map. folder: has node_modules/three
function threeAsScript(folder) {
  const three = path.join(folder, "node_modules/three");
  const bring = `npm ci in ${folder} brings three.js`;
  const { version } = JSON.parse(read(path.join(three, "package.json"), bring));
  if (version !== VERSION) fail(`three.js is ${version}; this page is made for ${VERSION}`);
  const module = name => {
    const text = read(path.join(three, "build", name), bring);
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
  return { script, notice: read(path.join(three, "LICENSE"), bring) };
}

const escaped = text => text.replace(/[&<>]/g, sign => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;" })[sign]);
const withoutLicenceLine = text => text.replace(/^[^\n]*SPDX-License-Identifier[^\n]*\n/, "");

// The text of a file for an element of a page. folders: where it is looked for, the first one first
function part(name, folders) {
  const folder = folders.find(one => fs.existsSync(path.join(one, name))) ?? folders[0];
  return withoutLicenceLine(read(path.join(folder, name), "a page has it as a part"));
}

/*
 * page.html with its slots filled, but for those that `texts` has as they are: @CSP@, @DATA@.
 *   texts    of slots, by name
 *   instead  by the name of a file that page.html asks for: a list of the files that come in its place
 */
function assemble({ texts, instead = {}, folders = [__dirname] }) {
  return read(path.join(__dirname, "page.html")).replace(/@(FILE ([\w.]+)|[A-Z]+)@/g, (slot, name, file) => {
    const text = file ? (instead[file] ?? [file]).map(one => part(one, folders)).join("") : texts[name];
    if (text === undefined) fail(`page.html has a slot ${slot} that nothing fills`);
    if (file?.endsWith(".js") && ENDING.test(text)) fail(`${file} has a tag that ends its element`);
    return text;
  });
}

const hashOf = text => `'sha256-${crypto.createHash("sha256").update(text).digest("base64")}'`;
const textsOf = (page, tag) => [...page.matchAll(new RegExp(`<${tag}>([^]*?)</${tag}>`, "g"))].map(([, text]) => text);

// scripts, styles: texts; more: what script-src has besides; rest: what a page needs beyond them
const policyOf = ({ scripts, styles, more = "", rest }) =>
  `default-src 'none'; script-src ${scripts.map(hashOf).join(" ")}${more}; ` +
  `style-src ${styles.map(hashOf).join(" ")}; ${rest}; img-src data:; base-uri 'none'; form-action 'none'`;

module.exports = { MARKER, assemble, escaped, fail, part, policyOf, read, textsOf, threeAsScript };
