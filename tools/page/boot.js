// SPDX-License-Identifier: BSD-3-Clause
// Unpacks what the page carries, and starts its scripts: the element `pack` has them in base64, deflated. First a u32,
// the length of a JSON that tells name: [offset, length] of each part, then the JSON, then the parts. A script that was
// changed does not run: the page's policy has the hash of each.
"use strict";
const pack = { bytes: null, text: null };
(async () => {
  const SCRIPTS = ["three.js", "page.js"];
  const notice = document.getElementById("notice");

  async function unpack(text) {
    const packed = Uint8Array.from(atob(text), sign => sign.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
    const all = new Uint8Array(await new Response(stream).arrayBuffer());
    const from = 4 + new DataView(all.buffer).getUint32(0, true);
    const places = JSON.parse(new TextDecoder().decode(all.subarray(4, from)));
    pack.bytes = name => all.slice(from + places[name][0], from + places[name][0] + places[name][1]);
    pack.text = name => new TextDecoder().decode(pack.bytes(name));
  }

  try {
    if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined")
      throw new Error("it lacks DecompressionStream or WebAssembly. Chrome 103, Firefox 113 and Safari 16.4 have both");
    const element = document.getElementById("pack");
    await unpack(element.textContent);
    element.remove();
    for (const name of SCRIPTS)
      document.body.append(Object.assign(document.createElement("script"), { textContent: pack.text(name) }));
  } catch (error) {
    notice.textContent = `This browser cannot run the page: ${error.message}.`;
    notice.hidden = false;
  }
})();
