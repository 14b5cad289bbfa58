// SPDX-License-Identifier: BSD-3-Clause
// dynpoint for browsers and bundlers: the layer, with the modules that lie beside it where no other is given.
const module = { exports: {} };
/*@LAYER@*/
async function fetched(url) {
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
  return answer.arrayBuffer();
}

// Bundlers look for URLs written like these.
const own = {
  core: () => fetched(new URL("./dynpoint.wasm", import.meta.url)),
  compiler: () => fetched(new URL("./dynpoint_compile.wasm", import.meta.url)),
};
const layer = module.exports;
export const { constants, layouts, DynpointError, Pace, Loop } = layer;
export const openCore = async source => layer.openCore(source ?? (await own.core()));
export const openCompiler = async source => layer.openCompiler(source ?? (await own.compiler()));
export default { ...layer, openCore, openCompiler };
