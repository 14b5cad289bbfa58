// SPDX-License-Identifier: BSD-3-Clause
// The core and its meshes.
"use strict";

// The core. `exports` has the functions of the C headers, for what this layer has no method for.
class Core {
  constructor(exports) {
    this.exports = exports;
    this.memory = new Memory(exports.memory);
    this.heap = new Heap(exports.memory, exports.__heap_base.value);
    this.scratch = this.heap.allocate(SCRATCH);
    this.version = this.memory.text(exports.dpt_version());
    const best = exports.dpt_kernel_best();
    this.kernels = [...new Set([CONSTANTS.DPT_KERNEL_SCALAR, best])].map(kernel => this.kernelName(kernel));
  }

  kernelName(kernel) {
    return this.memory.text(this.exports.dpt_kernel_name(kernel));
  }

  check(result, more) {
    if (result === CONSTANTS.DPT_OK) return;
    const code = this.memory.text(this.exports.dpt_result_name(result));
    throw new DynpointError(code, more ?? this.memory.text(this.exports.dpt_result_text(result)));
  }

  // Calls work(place); then force and torque there, N and N m.
  wrench(work) {
    this.check(work(this.place(0)));
    const at = this.place(0);
    return { force: this.memory.doublesAt(at, 3), torque: this.memory.doublesAt(at + 3 * 8, 3) };
  }

  // A place for a struct in the scratch, that counts from 0; they do not overlap.
  place(k) {
    return this.scratch + k * LONG;
  }

  // The struct that a function fills in, as an object.
  get(name, call) {
    const at = this.memory.begin(name, this.place(0));
    this.check(call(at));
    return this.memory.read(name, at);
  }

  // A def with the library's defaults, and what `values` has.
  def(name, values, k, own) {
    const at = this.memory.begin(name, this.place(k));
    this.exports[`${name}_defaults`](at, layouts[name].bytes);
    this.memory.write(name, at, values, own);
    return at;
  }

  // A struct without room for growth, such as a pose; 0 for none.
  plain(name, values, k) {
    const { bytes } = layouts[name];
    if (values === undefined || values === null) return 0;
    if (values.length * 8 !== bytes || !Array.prototype.every.call(values, value => typeof value === "number"))
      throw new TypeError(`a ${name.slice(4)} is ${bytes / 8} numbers`);
    this.memory.look().doubles.set(values, this.place(k) / 8);
    return this.place(k);
  }

  // file: the bytes of a .dpa. They are copied.
  openMesh(source) {
    const file = bytesOf(source, "a .dpa");
    const bytes = this.heap.allocate(file.byteLength);
    try {
      this.memory.put(bytes, file);
      const fault = this.memory.begin("dpt_mesh_fault", this.place(0));
      const result = this.exports.dpt_mesh_open(bytes, file.byteLength, this.place(1));
      if (result !== CONSTANTS.DPT_OK) {
        this.exports.dpt_mesh_verify(bytes, file.byteLength, fault);
        const { byte, section } = this.memory.read("dpt_mesh_fault", fault);
        const text = this.memory.text(this.exports.dpt_result_text(result));
        this.check(result, `byte ${byte}${section ? ` (${section})` : ""}: ${text}`);
      }
      return new Mesh(this, bytes, this.memory.view.getUint32(this.place(1), true));
    } catch (error) {
      this.heap.release(bytes);
      throw error;
    }
  }

  createWorld(def = {}) {
    return new World(this, def);
  }

  // The stiffest coupling that a device holds; the fields of dpt_coupling_def.
  couplingForDevice(def) {
    const from = this.def("dpt_coupling_def", def, 1);
    return this.get("dpt_coupling", at => this.exports.dpt_coupling_for_device(from, at));
  }

  stableStiffness(mass, damping, period, delay, virtualDamping) {
    return this.exports.dpt_stable_stiffness(mass, damping, period, delay, virtualDamping);
  }
}

class Mesh {
  constructor(core, bytes, pointer) {
    this.core = core;
    this.bytes = bytes;
    this.pointer = pointer;
    this.users = 0;
    this.info = core.get("dpt_mesh_info", at => core.exports.dpt_mesh_get_info(pointer, at));
  }

  // Copies of arrays that lie in the mesh: Type, the places of their pointers, how many items there are of each.
  array(Type, pointer, count) {
    return new Type(this.core.memory.look().buffer, pointer, count).slice();
  }

  words(call) {
    const { core } = this;
    core.check(call(core.place(0), core.place(0) + 4, core.place(0) + 8));
    return new Uint32Array(core.memory.look().buffer, core.place(0), 3);
  }

  // Float32Array, 3 a vertex
  getVertices() {
    const [xyz, count] = this.words((a, b) => this.core.exports.dpt_mesh_get_vertices(this.in(this.core), a, b));
    return this.array(Float32Array, xyz, 3 * count);
  }

  // corners: 3 vertices a triangle; numbers: of the source
  getTriangles() {
    const [corners, numbers, count] = this.words((a, b, c) =>
      this.core.exports.dpt_mesh_get_triangles(this.in(this.core), a, b, c),
    );
    return {
      corners: this.array(Uint32Array, corners, 3 * count),
      numbers: this.array(Uint32Array, numbers, count),
    };
  }

  // Its place in this core's memory
  in(core) {
    if (this.pointer === 0) throw new DynpointError("DPT_E_HANDLE", "this mesh is closed");
    if (this.core !== core) throw new DynpointError("DPT_E_HANDLE", "this mesh is another core's");
    return this.pointer;
  }

  // Nothing may use it any more. Once more does nothing.
  close() {
    if (this.users > 0) throw new DynpointError("DPT_E_ARGUMENT", "a world still uses this mesh");
    if (this.pointer !== 0) this.core.heap.release(this.bytes);
    this.pointer = 0;
  }
}
