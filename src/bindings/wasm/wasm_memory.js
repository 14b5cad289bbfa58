// SPDX-License-Identifier: BSD-3-Clause
// Structs in the memory of a module, and blocks of it. A part of dynpoint.js, as the other files here.
"use strict";

const SCRATCH = 16384; // bytes for structs on their way in and out
const LONG = 4096; // bytes: the most that a struct has
const PAGE = 65536;
const BLOCK = 64; // bytes: what every block of memory is aligned to

// What a call of the library says. code: as "DPT_E_HANDLE"; line, byte: of a source, where it is known.
class DynpointError extends Error {
  constructor(code, message, place = {}) {
    super(message);
    this.name = "DynpointError";
    this.code = code;
    Object.assign(this, place);
  }
}

const camel = name => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());

// The structs' fields by their names in JavaScript.
const layouts = {};
for (const [name, [bytes, fields]] of Object.entries(STRUCTS)) {
  const list = fields.split(",").map(text => {
    const [field, type, offset, count] = text.split(" ");
    const isOwnSize = text.startsWith("size u32 0 ");
    return { name: camel(field), type, offset: Number(offset), count: Number(count), isOwnSize };
  });
  const byName = new Map(list.map(field => [field.name, field]));
  layouts[name] = { bytes, fields: list, byName, hasSize: list[0].isOwnSize };
}

const SIZE = { u32: 4, i32: 4, f32: 4, u64: 8, i64: 8, f64: 8, bits: 8, p: 4 };
const isNumber = value => typeof value === "number" || typeof value === "bigint";
// Whole numbers that a field holds as they are; another would lose bits without a word.
const HOLDS = {
  u32: value => Number.isInteger(value) && value >= 0 && value < 2 ** 32,
  i32: value => Number.isInteger(value) && value >= -(2 ** 31) && value < 2 ** 31,
  u64: value => Number.isSafeInteger(Number(value)) && value >= 0,
  i64: value => Number.isSafeInteger(Number(value)),
  bits: value => typeof value === "bigint" && BigInt.asUintN(64, value) === value,
};

// The bytes of an ArrayBuffer or of a view of one.
function bytesOf(source, what) {
  if (Object.prototype.toString.call(source) === "[object ArrayBuffer]") return new Uint8Array(source);
  if (ArrayBuffer.isView(source)) return new Uint8Array(source.buffer, source.byteOffset, source.byteLength);
  throw new TypeError(`${what} is a Uint8Array or an ArrayBuffer`);
}

// A typed array of `group` numbers each.
function checkArray(array, Type, group, what) {
  if (!(array instanceof Type) || array.length % group !== 0)
    throw new TypeError(`${what} is a ${Type.name} of ${group} numbers each`);
}

// What stands in the place of a module's functions where nothing may be called any more.
const closed = what =>
  new Proxy(
    {},
    {
      get() {
        throw new DynpointError("DPT_E_HANDLE", `this ${what} is closed`);
      },
    },
  );
const READ = {
  u32: (view, at) => view.getUint32(at, true),
  i32: (view, at) => view.getInt32(at, true),
  f32: (view, at) => view.getFloat32(at, true),
  f64: (view, at) => view.getFloat64(at, true),
  u64: (view, at) => Number(view.getBigUint64(at, true)),
  i64: (view, at) => Number(view.getBigInt64(at, true)),
  bits: (view, at) => view.getBigUint64(at, true),
  p: (view, at) => view.getUint32(at, true),
};
const WRITE = {
  u32: (view, at, value) => view.setUint32(at, value, true),
  i32: (view, at, value) => view.setInt32(at, value, true),
  f32: (view, at, value) => view.setFloat32(at, value, true),
  f64: (view, at, value) => view.setFloat64(at, value, true),
  u64: (view, at, value) => view.setBigUint64(at, BigInt(value), true),
  i64: (view, at, value) => view.setBigInt64(at, BigInt(value), true),
  bits: (view, at, value) => view.setBigUint64(at, value, true),
  p: (view, at, value) => view.setUint32(at, value, true),
};

// The memory of a module: views that are made anew when it has grown, and structs in it.
class Memory {
  constructor(memory) {
    this.memory = memory;
    this.refresh();
  }

  refresh() {
    this.buffer = this.memory.buffer;
    this.view = new DataView(this.buffer);
    this.bytes = new Uint8Array(this.buffer);
    this.doubles = new Float64Array(this.buffer);
  }

  look() {
    if (this.buffer !== this.memory.buffer) this.refresh();
    return this;
  }

  put(at, array) {
    this.look().bytes.set(bytesOf(array, "an array"), at);
  }

  // `at` is a multiple of 8.
  doublesAt(at, count) {
    const { doubles } = this.look();
    const list = new Array(count);
    for (let k = 0; k < count; k++) list[k] = doubles[at / 8 + k];
    return list;
  }

  text(at) {
    const { bytes } = this.look();
    let end = at;
    while (bytes[end] !== 0) end++;
    return new TextDecoder().decode(bytes.slice(at, end));
  }

  read(name, at) {
    const { view } = this.look();
    const item = {};
    for (const field of layouts[name].fields) {
      const place = at + field.offset;
      if (field.isOwnSize || field.name.startsWith("reserved")) continue;
      if (field.type === "text") item[field.name] = this.text(place);
      else if (field.count === 1) item[field.name] = READ[field.type](view, place);
      else item[field.name] = this.numbers(field, place);
    }
    return item;
  }

  numbers({ type, count }, at) {
    const list = new Array(count);
    for (let k = 0; k < count; k++) list[k] = READ[type](this.view, at + k * SIZE[type]);
    return list;
  }

  // Sets the fields that `values` has; the others stay. An address is the layer's own to give.
  write(name, at, values, own = {}) {
    for (const key of Object.keys(values))
      if (layouts[name].byName.get(key)?.type === "p")
        throw new TypeError(`${name}.${key} is an address, which ${name} has from elsewhere`);
    this.set(name, at, values);
    this.set(name, at, own);
  }

  set(name, at, values) {
    const { view } = this.look();
    for (const [key, value] of Object.entries(values)) {
      if (value === undefined) continue;
      const field = layouts[name].byName.get(key);
      if (!field || field.type === "text") throw new TypeError(`${name} has no field ${key}`);
      const list = field.count === 1 ? [value] : value;
      if (list.length !== field.count || !Array.prototype.every.call(list, isNumber))
        throw new TypeError(`${name}.${key} takes ${field.count === 1 ? "a number" : `${field.count} numbers`}`);
      if (
        !Array.prototype.every.call(list, HOLDS[field.type] ?? (item => typeof item === "number" || field.type === "p"))
      )
        throw new RangeError(`${name}.${key} does not hold ${String(value)}`);
      for (let k = 0; k < field.count; k++) WRITE[field.type](view, at + field.offset + k * SIZE[field.type], list[k]);
    }
  }

  // An empty struct that says its own size, if it has a field for it.
  begin(name, at) {
    const { bytes, hasSize } = layouts[name];
    this.look().bytes.fill(0, at, at + bytes);
    if (hasSize) this.view.setUint32(at, bytes, true);
    return at;
  }
}

// Blocks of the core's memory. The core itself never allocates.
class Heap {
  constructor(memory, from) {
    this.memory = memory;
    this.end = Math.ceil(from / BLOCK) * BLOCK;
    this.used = new Map(); // place: bytes
    this.free = []; // [place, bytes], by place; no two touch
  }

  allocate(size) {
    if (!Number.isSafeInteger(size) || size < 0) throw new RangeError(`${size} is no count of bytes`);
    const bytes = Math.max(BLOCK, Math.ceil(size / BLOCK) * BLOCK);
    const k = this.free.findIndex(block => block[1] >= bytes);
    const at = k < 0 ? this.grow(bytes) : this.free[k][0];
    if (k >= 0) {
      this.free[k] = [at + bytes, this.free[k][1] - bytes];
      if (this.free[k][1] === 0) this.free.splice(k, 1);
    }
    this.used.set(at, bytes);
    return at;
  }

  grow(bytes) {
    const at = this.end;
    const lacking = at + bytes - this.memory.buffer.byteLength;
    try {
      if (lacking > 0) this.memory.grow(Math.ceil(lacking / PAGE));
    } catch {
      throw new DynpointError("DPT_E_MEMORY", `there is no room for ${bytes} bytes more`);
    }
    this.end = at + bytes;
    return at;
  }

  release(at) {
    const bytes = this.used.get(at);
    if (!bytes) return;
    this.used.delete(at);
    this.free.push([at, bytes]);
    this.free.sort((one, other) => one[0] - other[0]);
    const joined = [];
    for (const block of this.free) {
      const last = joined[joined.length - 1];
      if (last && last[0] + last[1] === block[0]) last[1] += block[1];
      else joined.push(block);
    }
    const last = joined[joined.length - 1];
    if (last && last[0] + last[1] === this.end) this.end = joined.pop()[0];
    this.free = joined;
  }
}
