// SPDX-License-Identifier: BSD-3-Clause
// What is drawn of the tools: rods at the device's pose and at the proxy's, contacts as bands on the proxy, the nearest
// pair as a line, the force as an arrow, the handle by which a simulated hand is dragged.
"use strict";
const toolView = (() => {
  const { CapsuleBatch } = capsuleBatch;
  const ARROW = 0.3; // its length at the largest force, in radii of the scene

  const material = (Type, order, options) =>
    Object.assign(new Type({ vertexColors: true, ...options }), { userData: { order } });

  // Where the force is felt: on the proxy's axis, at the part of it that is nearest on the device's. Null without it.
  function forcePlace(snapshot, tool) {
    const segment = snapshot.segments[tool.firstSegment + tool.nearestSegment];
    if (!segment || tool.nearestSegment >= tool.segments) return null;
    const { a, b, p, proxyA, proxyB } = segment;
    const place = rays.along(proxyA, proxyB, rays.isPlace(p) ? rays.nearestPart(a, b, p) : 0);
    return rays.isPlace(place) ? place : null;
  }

  // Where the hand holds a tool: the origin of its frame, or end a of one whose segments are set in the scene.
  const handleOf = (snapshot, tool) =>
    tool.isFree ? snapshot.segments[tool.firstSegment].a : tool.pose.slice(0, 3);

  // The rods of a tool's instrument; opening: of its jaws.
  function dressOf(snapshot, tool, look, opening) {
    const segment = snapshot.segments[tool.firstSegment];
    if (!look || !segment || tool.segments === 0) return [];
    const { proxyA, proxyB, radius } = segment;
    return instruments.rodsOf(look, proxyA, proxyB, radius, tool.isFree ? null : tool.proxy, opening);
  }

  // The part of the first segment, from its end a, that is seen through: all where meshes stand for it, or where jaws move.
  function clearOf({ proxyA, proxyB, radius }, { look, hasDress }) {
    const long = rays.length(rays.sub(proxyB, proxyA));
    return hasDress ? 1 : long > 0 ? Math.min(1, (instruments.clearOf(look) * Math.max(0, radius || 0)) / long) : 0;
  }

  // The frame of the first tool's own meshes, or null.
  function frameOfDress(snapshot) {
    const tool = snapshot?.tools[0];
    const segment = tool && snapshot.segments[tool.firstSegment];
    if (!segment || tool.segments === 0) return null;
    return instruments.frameOf(segment.proxyA, segment.proxyB, tool.isFree ? null : tool.proxy);
  }

  class ToolView {
    constructor() {
      // All are among the translucent, to be drawn in this order: what of the device's tool is hidden shines through
      // the organ, but not through the proxy and its bands, whose colours say something.
      const clear = { transparent: true, depthWrite: false };
      const solid = { transparent: true };
      const hidden = material(THREE.MeshBasicMaterial, 0, { ...clear, opacity: 0.16, depthFunc: THREE.GreaterDepth });
      const front = material(THREE.MeshLambertMaterial, 3, { ...clear, opacity: 0.4 });
      const steel = { ...solid, shininess: 60, specular: 0x999999 };
      this.proxy = new CapsuleBatch([material(THREE.MeshPhongMaterial, 1, steel)]);
      this.clearProxy = new CapsuleBatch([material(THREE.MeshLambertMaterial, 3, { ...clear, opacity: 0.3 })]);
      this.dress = new CapsuleBatch([material(THREE.MeshPhongMaterial, 1, steel)]); // for the eye alone
      this.bands = new CapsuleBatch([
        material(THREE.MeshBasicMaterial, 2, solid),
        material(THREE.MeshBasicMaterial, 4, { ...clear, opacity: 0.35, depthFunc: THREE.GreaterDepth }),
      ]);
      this.device = new CapsuleBatch([hidden, front]);
      this.marks = new CapsuleBatch([
        material(THREE.MeshBasicMaterial, 6, { transparent: true, depthTest: false, depthWrite: false }),
      ]);
      this.channels = new channelView.ChannelView();
      this.batches = [
        this.dress,
        this.proxy,
        this.clearProxy,
        this.bands,
        this.device,
        this.marks,
        ...this.channels.batches,
      ];
      this.objects = this.batches.flatMap(batch => batch.meshes);
      this.arrows = [];
      this.rods = []; // what casts shadows
      this.patches = []; // where it is in contact
    }

    // snapshot: or null; colours by name, linear; camera: for the length of a pixel
    // scales: { radius of the scene, force, depth, control }
    draw(snapshot, colours, camera, scales) {
      for (const batch of this.batches) batch.begin();
      this.arrows = [];
      this.rods = [];
      this.patches = [];
      if (snapshot) {
        const first = snapshot.segments[snapshot.tools[0]?.firstSegment];
        for (const segment of snapshot.segments)
          this.addSegment(segment, colours, camera, segment === first ? clearOf(segment, scales) : 0);
        if (scales.look) for (const tool of snapshot.tools) this.addDress(snapshot, tool, colours, scales);
        for (const contact of snapshot.contacts) this.addContact(snapshot, contact, camera, scales);
        this.channels.add(snapshot, colours, camera);
        for (const tool of snapshot.tools) this.addTool(snapshot, tool, colours, camera, scales);
      }
      for (const batch of this.batches) batch.end();
    }

    // clear: the part of it from end a, 0 to 1, that is seen through
    addSegment({ a, b, radius, proxyA, proxyB, p, q }, colours, camera, clear) {
      const thick = place => Math.max(Math.max(0, radius || 0), 1.5 * camera.pixelSize(place));
      this.device.add(a, b, thick(a), thick(b), 1, colours.device);
      const from = clear > 0 ? rays.along(proxyA, proxyB, clear) : proxyA;
      if (clear > 0) this.clearProxy.add(proxyA, proxyB, thick(proxyA), thick(proxyB), 1, colours.proxy);
      if (clear < 1) this.proxy.add(from, proxyB, thick(from), thick(proxyB), 1, colours.proxy);
      if (rays.isPlace(proxyA) && rays.isPlace(proxyB)) this.rods.push({ a: proxyA, b: proxyB, radius: thick(proxyA) });
      if (!rays.isPlace(p) || !rays.isPlace(q)) return;
      const line = 0.9 * camera.pixelSize(p);
      this.marks.add(p, q, line, line, 1, colours.pair);
      for (const end of [p, q]) this.marks.add(end, end, 2.6 * line, 2.6 * line, 1, colours.pair);
    }

    // The instrument on the tool's first segment.
    addDress(snapshot, tool, colours, { look, opening }) {
      const segment = snapshot.segments[tool.firstSegment];
      if (!segment || tool.segments === 0) return;
      const { proxyA, proxyB } = segment;
      for (const rod of dressOf(snapshot, tool, look, opening))
        this.dress.add(rod.a, rod.b, rod.radiusA, rod.radiusB, rod.round, colours[rod.of], rod.flat, rod.side);
      const own = this.rods.find(({ a }) => a === proxyA);
      const long = rays.length(rays.sub(proxyB, proxyA));
      if (own && long > 0) own.b = rays.along(proxyA, proxyB, 1 + (instruments.shaftOf(look) * own.radius) / long);
    }

    addContact(snapshot, contact, camera, scales) {
      const segment = depths.segmentOf(snapshot, contact);
      const { proxyA, proxyB } = segment;
      const middle = rays.along(proxyA, proxyB, (contact.s0 + contact.s1) / 2);
      if (!rays.isPlace(middle)) return;
      const pixel = camera.pixelSize(middle);
      const long = rays.length(rays.sub(proxyB, proxyA));
      const more = long > 0 ? (1.5 * pixel) / long : 0; // a contact in one point is seen too
      const thick = Math.max(0, segment.radius || 0) + 2 * pixel;
      const depth = depths.ofContact(snapshot, contact);
      const [a, b] = [contact.s0, contact.s1].map(s => rays.along(proxyA, proxyB, s));
      const normal = rays.isPlace(contact.normal) ? contact.normal : null;
      if (depth > 0 && normal && rays.isPlace(a) && rays.isPlace(b))
        this.patches.push({ a, b, normal, radius: thick, depth, part: depth / scales.depth, body: contact.body });
      const rgb = new THREE.Color(`rgb(${scale.colour(depth / scales.depth).join(",")})`).toArray();
      this.bands.add(
        rays.along(proxyA, proxyB, contact.s0 - more),
        rays.along(proxyA, proxyB, contact.s1 + more),
        thick,
        thick,
        long > 0 ? 0 : 1,
        rgb,
      );
    }

    addTool(snapshot, tool, colours, camera, scales) {
      const handle = handleOf(snapshot, tool);
      if (scales.control && rays.isPlace(handle)) {
        const size = 7 * camera.pixelSize(handle);
        this.marks.add(handle, handle, size, size, 1, colours.handle);
      }
      const from = forcePlace(snapshot, tool);
      const force = tool.wrench.slice(0, 3);
      const newtons = rays.length(force);
      if (!from || !(newtons > 0) || !Number.isFinite(newtons)) return;
      const length = ARROW * scales.radius * Math.min(1.5, newtons / scales.force);
      const to = from.map((value, k) => value + (length * force[k]) / newtons);
      const pixel = camera.pixelSize(from);
      // The rim first: it is drawn below, so that the arrow stands out from whatever is behind it.
      this.addArrow(from, to, pixel, 1.4, colours.rim);
      this.addArrow(from, to, pixel, 0, colours.force);
      this.arrows.push({ from, to, newtons });
    }

    // more: pixels by which it is larger, all round
    addArrow(from, to, pixel, more, colour) {
      const long = rays.length(rays.sub(to, from));
      const at = along => rays.along(from, to, along / long);
      const size = Math.min(1, long / (20 * pixel)) * pixel; // a short arrow is thinner, and has a smaller head
      const neck = long - 13 * size;
      const thick = 2.6 * size + more * pixel;
      this.marks.add(at(-more * pixel), at(neck), thick, thick, 0, colour);
      this.marks.add(at(neck - more * pixel), at(long + 2 * more * pixel), 6.2 * size + 1.5 * more * pixel, 0, 0, colour);
    }
  }

  return { ToolView, handleOf, dressOf, frameOfDress, ARROW };
})();
