// SPDX-License-Identifier: BSD-3-Clause
// Readers of bytes from outside refuse what does not hold together, with a sentence that the page can show.
"use strict";
const checkedReading = (() => {
  class Refusal extends Error {}

  const demand = (holds, sentence) => {
    if (!holds) throw new Refusal(sentence);
  };

  // What read() returns, or { refused: sentence }. Any other error is a mistake in the reader, and goes on.
  const attempt = read => {
    try {
      return read();
    } catch (error) {
      if (error instanceof Refusal) return { refused: error.message };
      throw error;
    }
  };

  // A view of the bytes; a u64 above 2^53 is rounded, and is then too large for any check that it must pass.
  const open = bytes => {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    return {
      bytes,
      size: bytes.byteLength,
      u32: at => view.getUint32(at, true),
      f32: at => view.getFloat32(at, true),
      f64: at => view.getFloat64(at, true),
      u64: at => view.getUint32(at, true) + 4294967296 * view.getUint32(at + 4, true),
    };
  };

  // Typed numbers in place where their address allows it, else a copy.
  const typed = (Type, bytes, at, count) => {
    const from = bytes.byteOffset + at;
    const size = count * Type.BYTES_PER_ELEMENT;
    if (from % Type.BYTES_PER_ELEMENT === 0) return new Type(bytes.buffer, from, count);
    return new Type(bytes.slice(at, at + size).buffer);
  };

  return { demand, attempt, open, typed };
})();
