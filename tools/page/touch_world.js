// SPDX-License-Identifier: BSD-3-Clause
// A world with one body and one tool, in a simulated hand: what a tick does, and what it tells.
"use strict";
const touchWorld = (() => {
  const { HeldDevice, PERIOD } = heldDevice;
  const RADIUS = 0.002; // m, of the tool
  const LENGTH = 0.12;
  const ALONG = [0.8, 0.5, 0.1]; // from the tip to where an instrument would be held
  const ROOM = 0.08; // m round the body in which the hand moves
  const ABOVE = 0.015; // m: where it begins
  const UPRIGHT = [1, 0, 0, 0];
  const SHOWN = 0.5; // s: how long vertices are still sent after they have come to rest
  const SENT_AGAIN = 2; // s

  const tip = (() => {
    const by = LENGTH / Math.hypot(...ALONG);
    return [0, 0, 0, ...ALONG.map(value => by * value), RADIUS];
  })();

  function turn([w, x, y, z], v) {
    const t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])];
    return [
      v[0] + w * t[0] + y * t[2] - z * t[1],
      v[1] + w * t[1] + z * t[0] - x * t[2],
      v[2] + w * t[2] + x * t[1] - y * t[0],
    ];
  }

  // The box of a body whose middle is at the origin.
  function boxOf({ boxMin, boxMax }, orientation) {
    const half = [0, 0, 0];
    for (let corner = 0; corner < 8; corner++) {
      const place = boxMin.map((low, k) => ((corner >> k) & 1 ? 1 : -1) * 0.5 * (boxMax[k] - low));
      turn(orientation, place).forEach((value, k) => (half[k] = Math.max(half[k], Math.abs(value))));
    }
    return half;
  }

  // m, of dpt_deformable_def: tool and tissue that are solved together share the load by themselves.
  const loadRadiusOf = ({ spread }, law) => (law === dynpoint.constants.DPT_LAW_PROXY ? 0 : (spread ?? 0));

  class TouchWorld {
    // file: the bytes of a .dpa; scene: as in touch_scenes.js; choices: { law, stiffness }, with the law's number
    constructor(core, file, scene, choices) {
      this.mesh = core.openMesh(file);
      const { info } = this.mesh;
      this.scene = scene;
      this.law = choices.law;
      this.stiffness = choices.stiffness;
      this.segment = tip;
      try {
        this.world = core.createWorld({ maxBodies: 1, maxTools: 1, maxSegments: 1, maxContacts: 32, ...choices });
      } catch (error) {
        this.mesh.close();
        throw error;
      }
      try {
        this.addAll(info);
      } catch (error) {
        this.close();
        throw error;
      }
    }

    addAll(info) {
      const orientation = this.scene.orientation ?? UPRIGHT;
      const middle = info.boxMin.map((low, k) => 0.5 * (low + info.boxMax[k]));
      this.pose = [...turn(orientation, middle).map(value => -value), ...orientation];
      this.half = boxOf(info, orientation);
      this.isSoft = info.springs > 0;
      if (this.isSoft) {
        this.loadRadius = loadRadiusOf(this.scene, this.law);
        this.body = this.world.addDeform(this.mesh, { loadRadius: this.loadRadius }, this.pose);
        this.world.addSprings(this.body, this.scene.net);
      } else this.body = this.world.addBody(this.mesh, this.pose);
      this.tool = this.world.addTool([tip]);
      this.world.setToolSettings(this.tool, { lockRotation: 1 }); // the hand takes no torque
      const room = this.half.map(value => value + ROOM);
      this.device = new HeldDevice([0, this.half[1] + RADIUS + ABOVE, 0], [...room.map(value => -value), ...room]);
      this.force = [0, 0, 0];
      this.ticks = 0;
      this.movedAt = 0;
      this.sentAt = -Infinity;
    }

    // Whether it can go on by another law.
    takes({ law }) {
      return !this.isSoft || loadRadiusOf(this.scene, law) === this.loadRadius;
    }

    setForce({ law, stiffness }) {
      this.world.setToolSettings(this.tool, { law, stiffness });
      this.law = law;
      this.stiffness = stiffness;
    }

    get time() {
      return this.ticks * PERIOD;
    }

    // The tool stands where the device is; the step says with what force; the device goes on under it.
    step() {
      this.toolPose = [...this.device.x, ...UPRIGHT];
      this.world.setToolPose(this.tool, this.toolPose);
      const { contact } = this.world.step(PERIOD);
      if (this.isSoft && this.world.stepSprings(this.body, PERIOD).active > 0) this.movedAt = this.time;
      const { wrench, energy, reason } = this.world.getForceInfo(this.tool);
      this.force = wrench.slice(0, 3);
      this.device.step(this.force);
      this.ticks++;
      const force = Math.hypot(...this.force);
      return { time: this.time, force, depth: this.depth(force), energy, contact, reason };
    }

    // As the program tells it: with a proxy the length of the spring.
    depth(force) {
      if (this.law === dynpoint.constants.DPT_LAW_PROXY && this.stiffness > 0) return force / this.stiffness;
      return this.world.getHit(this.tool).depth;
    }

    // The block of a snapshot, good until the next call. Vertices are in it while they move, and now and then.
    snapshot() {
      const { time } = this;
      const isDue = this.isSoft && (time - this.movedAt < SHOWN || time - this.sentAt > SENT_AGAIN);
      if (isDue) this.sentAt = time;
      return this.world.getSnapshot({ maxVertices: isDue ? this.mesh.info.vertices : 0 });
    }

    close() {
      this.world.close();
      this.mesh.close();
    }
  }

  return { TouchWorld, UPRIGHT };
})();
