/* SPDX-License-Identifier: BSD-3-Clause */
{ "hello", "05 01 01 34 12 a8 b6 8d d4 81 00" }, { "order to enable", "06 05 01 34 12 01 f2 e0 c7 f4 8d 00" },
    { "command 7 to sample 1000: force 1.5, -0.25, 0 N, torque 0, 0, 0.125 Nm",
      "06 04 01 34 12 07 01 01 03 e8 03 01 01 01 03 c0 3f 01 03 80 be 01 01 01 01 01 01 01 01 01 "
      "01 01 01 01 01 02 3e fb c3 a0 f1 8d 00" },
    { "state of 3 freedoms and a joint",
      "0c 03 01 34 12 13 01 ff 05 04 02 2a 02 03 04 02 01 09 03 e8 03 01 06 98 ba dc fe 07 01 01 "
      "05 cd cc cc 3d 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 01 03 80 bf 01 01 02 40 a4 d5 dc be 8d 00" },
