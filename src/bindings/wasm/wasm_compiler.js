// SPDX-License-Identifier: BSD-3-Clause
// The compiler.
"use strict";

const FORMATS = ["auto", "obj", "stl", "ply", "off"];
const NETS = { sheet: CONSTANTS.DPT_NET_SHEET, volume: CONSTANTS.DPT_NET_VOLUME };

// The compiler of meshes, with a memory of its own.
class Compiler {
  constructor(exports) {
    this.exports = exports;
    this.memory = new Memory(exports.memory);
    this.version = this.memory.text(exports.dpt_version());
  }

  // Blocks for one call, which are freed after it.
  withBlocks(work) {
    const blocks = [];
    const allocate = bytes => {
      const at = this.exports.malloc(Math.max(1, bytes));
      if (at === 0) throw new DynpointError("DPT_E_MEMORY", `there is no room for ${bytes} bytes`);
      blocks.push(at);
      return at;
    };
    const copy = array => {
      const at = allocate(array.byteLength);
      this.memory.put(at, array);
      return at;
    };
    try {
      return work(allocate, copy);
    } finally {
      blocks.forEach(at => this.exports.free(at));
    }
  }

  /*
   * source: the bytes of a file. To the bytes of a .dpa. options: scale, crease; format: "obj", "stl", "ply" or "off", if
   * the content does not tell it; springs: the fields of dpt_spring_net_def, with kind "sheet" or "volume", `fixed` a
   * list of vertices, and `regions` a list of objects.
   */
  compile(source, options = {}) {
    return this.withBlocks((allocate, copy) => {
      const file = bytesOf(source, "a mesh's file");
      const from = copy(file);
      return this.run(allocate, copy, options, (...rest) =>
        this.exports.dpt_compile_bytes(from, file.byteLength, ...rest),
      );
    });
  }

  // vertices: Float64Array, 3 each; corners: Uint32Array, 3 a triangle
  compileArrays(vertices, corners, options = {}) {
    checkArray(vertices, Float64Array, 3, "a list of vertices");
    checkArray(corners, Uint32Array, 3, "a list of triangles");
    return this.withBlocks((allocate, copy) => {
      const [xyz, numbers] = [copy(vertices), copy(corners)];
      return this.run(allocate, copy, options, (...rest) =>
        this.exports.dpt_compile_arrays(xyz, vertices.length / 3, numbers, corners.length / 3, ...rest),
      );
    });
  }

  run(allocate, copy, { format = "auto", springs, ...options }, call) {
    const struct = name => this.memory.begin(name, allocate(layouts[name].bytes));
    const number = FORMATS.indexOf(format);
    if (number < 0) throw new TypeError(`no format ${format}; there are ${FORMATS.join(", ")}`);
    const def = struct("dpt_compile_def");
    this.exports.dpt_compile_def_defaults(def, layouts.dpt_compile_def.bytes);
    const net = springs ? this.springs(allocate, copy, struct, springs) : 0;
    this.memory.write("dpt_compile_def", def, options, { format: number, springs: net });
    const [out, diag] = [struct("dpt_compiled"), struct("dpt_diag")];
    const result = call(def, out, diag);
    if (result !== CONSTANTS.DPT_OK) throw this.fault(result, this.memory.read("dpt_diag", diag));
    const { bytes, size } = this.memory.read("dpt_compiled", out);
    const file = this.memory.look().bytes.slice(bytes, bytes + size);
    this.exports.dpt_compiled_free(out);
    return file;
  }

  fault(result, { line, byte, text }) {
    const code = this.memory.text(this.exports.dpt_result_name(result));
    if (line > 0) return new DynpointError(code, `line ${line}: ${text}`, { line });
    return new DynpointError(code, byte > 0 ? `byte ${byte}: ${text}` : text, { byte });
  }

  springs(allocate, copy, struct, { kind, fixed = [], regions = [], ...values }) {
    const net = struct("dpt_spring_net_def");
    this.exports.dpt_spring_net_def_defaults(net, layouts.dpt_spring_net_def.bytes);
    if (!(kind in NETS)) throw new TypeError('springs are of kind "sheet" or "volume"');
    const held = Array.from(fixed);
    if (!held.every(HOLDS.u32)) throw new RangeError("fixed vertices are whole numbers from 0 on");
    const { bytes } = layouts.dpt_spring_region;
    const at = allocate(bytes * regions.length);
    regions.forEach((region, k) => {
      const place = this.memory.begin("dpt_spring_region", at + k * bytes);
      this.memory.write("dpt_spring_region", place, region);
    });
    this.memory.write("dpt_spring_net_def", net, values, {
      kind: NETS[kind],
      fixed: copy(Uint32Array.from(held)),
      fixedCount: held.length,
      regions: at,
      regionCount: regions.length,
    });
    return net;
  }
}
