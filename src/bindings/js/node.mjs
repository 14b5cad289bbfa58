// SPDX-License-Identifier: BSD-3-Clause
// The same objects as `require` gives: errors of one are those of the other.
import dynpoint from "./node.js";

export const { openCore, openCompiler, constants, layouts, DynpointError, Pace, Loop } = dynpoint;
export default dynpoint;
