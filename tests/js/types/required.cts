// SPDX-License-Identifier: BSD-3-Clause
// The same types where a program requires the package.
import dynpoint = require("dynpoint");

dynpoint.openCore().then(core => {
  const info: dynpoint.WorldInfo = core.createWorld().getInfo();
  console.log(info.bodies, dynpoint.constants.DPT_LAW_PROXY);
  // @ts-expect-error: it has no default
  dynpoint.default;
});
