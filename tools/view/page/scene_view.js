// SPDX-License-Identifier: BSD-3-Clause
// The picture: bodies, tools and the device's workspace, drawn by three.js when something has changed.
"use strict";
const sceneView = (() => {
  const { BodyView, Highlight } = bodyView;
  // Multisampling costs more than half of the pictures a second where a processor draws, and cannot be switched off.
  const SMOOTH = 20000; // triangles: a larger scene has no multisampling anywhere
  const SMOOTH_RATIO = 2; // pixels drawn for one of the picture, along each side, where edges are made smooth by that
  const PROCESSOR = /SwiftShader|llvmpipe|softpipe|Basic Render|Software/i;
  const SIDE = 24; // pixels that stay free at the left and at the right
  const ROOM = 12; // pixels between what is seen and the legend or the buttons
  const REST = 150; // ms without a move of the eye
  const NEAR = 2; // radii of the scene from its centre: what of the tool is farther away may leave the picture
  const LEAST_ASPECT = 1.2; // width to height: a narrower picture takes in as much from side to side
  const LEAST_MOVED = 1e-4; // m: the least end of the deformation's colours
  const UNIT_BOX = [-1, -1, -1, 1, 1, 1];
  const COLOURS = [
    "background",
    "organ",
    "cloth",
    "bone",
    "device",
    "proxy",
    "pair",
    "force",
    "rim",
    "steel",
    "grip",
    "trim",
    "glass",
    "strip",
    "picked",
    "workspace",
    "handle",
  ];

  let rendererName = null;

  function isDrawnByProcessor() {
    rendererName ??= nameOfRenderer();
    return PROCESSOR.test(rendererName);
  }

  function nameOfRenderer() {
    const gl = document.createElement("canvas").getContext("webgl2");
    const names = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : "";
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return name;
  }

  // null where the browser has no WebGL.
  function rendererOf(canvas, scene) {
    const triangles = scene.bodies.reduce((sum, body) => sum + scene.meshes[body.mesh].triangles, 0);
    const antialias = triangles <= SMOOTH && !isDrawnByProcessor();
    try {
      const renderer = new THREE.WebGLRenderer({ canvas, antialias, powerPreference: "high-performance" });
      return Object.assign(renderer, { userData: { antialias } });
    } catch {
      return null;
    }
  }

  class SceneView {
    // edges: () => { top, bottom }: pixels that legend and buttons have; frame: of a second view
    constructor(canvas, renderer, scene, edges, frame) {
      this.canvas = canvas;
      this.edges = edges;
      this.renderer = renderer;
      this.three = new THREE.Scene();
      this.camera = new camera.Camera(() => {
        this.dirty = true;
      });
      this.inset = new inset.Inset(frame);
      this.veiled = { main: new Set(), inset: new Set() }; // bodies that each view sees through
      this.eye = new THREE.Vector3(); // where it was when it last moved
      this.sun = new THREE.DirectionalLight(0xffffff, 2.1);
      this.three.add(new THREE.HemisphereLight(0xffffff, 0x8c92a4, 1.6), this.sun, this.sun.target);
      this.light = surfaceLight.sharedUniforms();
      this.materials = {
        strip: this.overlay(0.55, 1),
        picked: this.overlay(0.85, 2),
      };
      this.tools = new toolView.ToolView();
      this.strip = new Highlight(this.materials.strip);
      this.pickedMark = new Highlight(this.materials.picked);
      this.three.add(...this.tools.objects, this.strip.object, this.pickedMark.object);
      this.bodies = new Map();
      this.isSmooth = this.showsDeformation = false;
      this.scales = { radius: 1, force: 1, depth: 1, control: false };
      this.setScene(scene);
      canvas.addEventListener("webglcontextrestored", () => {
        this.dirty = true;
      });
    }

    overlay(opacity, order) {
      return Object.assign(
        new THREE.MeshBasicMaterial({
          transparent: true,
          opacity,
          side: THREE.DoubleSide,
          depthWrite: false,
          polygonOffset: true,
          polygonOffsetFactor: -2 * order,
          polygonOffsetUnits: -2 * order,
        }),
        { userData: { order: order - 3 } },
      );
    }

    // The camera stays where it is if the same scene comes again, from a server that was away.
    setScene(scene) {
      const again = this.scene?.title === scene.title && this.scene.up === scene.up;
      for (const view of this.bodies.values()) {
        this.three.remove(view.object);
        view.dispose();
      }
      const closed = scene.meshes.map(({ corners }) => rays.isClosed(corners));
      const edges = scene.meshes.map(surfaceLight.usualEdge);
      const faceted = scene.meshes.map(rays.isFaceted);
      this.bodies = new Map(
        scene.bodies.map((body, number) => {
          const isSheet = !closed[body.mesh];
          const [edge, isFaceted] = [edges[body.mesh], faceted[body.mesh]];
          const form = { look: body.look, bothSides: isSheet, edge, isFaceted, number };
          const material = surfaceLight.materialOf(this.light, form);
          return [body.id, new BodyView(body, scene.meshes[body.mesh], material, isSheet)];
        }),
      );
      this.bake = new occlusion.Bake(
        [...this.bodies.values()]
          .filter(view => view.rotation)
          .map(view => ({
            view,
            places: view.places(),
            normals: view.normalsInScene(),
            corners: view.mesh.corners,
            isClosed: !view.isSheet,
          })),
      );
      for (const view of this.bodies.values()) this.three.add(view.object);
      if (this.box) {
        this.three.remove(this.box);
        this.box.geometry.dispose();
        this.box.material.dispose();
      }
      this.box = this.workspaceBox(scene.device?.workspace);
      if (this.box) this.three.add(this.box);
      this.scene = scene;
      Object.assign(this, { snapshot: null, picked: null, mostMoved: 0 });
      Object.assign(this.scales, { control: scene.control, look: scene.look, hasDress: scene.dress.length > 0 });
      if (this.dress) {
        for (const object of this.dress.objects) this.three.remove(object);
        this.dress.dispose();
      }
      this.dress = new dress.Dress(scene.dress, scene.meshes);
      for (const object of this.dress.objects) this.three.add(object);
      this.scales.opening = 0.5;
      this.camera.up = scene.up;
      this.readColours();
      this.inset.set(scene.inset, scene.up, this.bounds().radius);
      this.show(null, new Map());
      if (!again) this.setCamera();
    }

    // As the scene has it, farther away where the picture is narrow; else so that all is seen.
    setCamera() {
      this.fit(false);
      if (this.scene.camera) {
        this.camera.place(this.scene.camera);
        if (this.width) this.camera.zoom(Math.max(1, (LEAST_ASPECT * this.height) / this.width));
      }
      this.isFresh = !this.scene.camera;
      this.fitted = { ...this.camera.state };
    }

    // The first frame says where the tool is: it is to be seen too, unless the camera has been moved meanwhile.
    fitTool() {
      const { fitted, camera } = this;
      this.isFresh = false;
      const isThere = ["distance", "azimuth", "elevation"].every(name => fitted[name] === camera.state[name]);
      if (isThere && fitted.target.every((value, k) => value === camera.state.target[k])) this.fit(false);
    }

    workspaceBox(box) {
      if (!box) return null;
      const [x, y, z, toX, toY, toZ] = box;
      const lines = new THREE.LineSegments(
        new THREE.EdgesGeometry(new THREE.BoxGeometry(toX - x, toY - y, toZ - z)),
        new THREE.LineBasicMaterial({ transparent: true, opacity: 0.7 }),
      );
      lines.position.set((x + toX) / 2, (y + toY) / 2, (z + toZ) / 2);
      return lines;
    }

    // The page's style has the colours.
    readColours() {
      const style = getComputedStyle(document.documentElement);
      const read = name => new THREE.Color(style.getPropertyValue(`--${name}`).trim());
      const colours = Object.fromEntries(COLOURS.map(name => [name, read(name)]));
      this.colours = Object.fromEntries(COLOURS.map(name => [name, colours[name].toArray()]));
      this.three.background = colours.background;
      for (const name of ["strip", "picked"]) this.materials[name].color = colours[name];
      // A body without a colour of its own has the page's for what it is.
      for (const { body, object } of this.bodies.values()) {
        const { value } = object.material.uniforms.colour;
        if (body.colour) value.setRGB(...body.colour, THREE.SRGBColorSpace);
        else value.copy(colours[body.look]);
      }
      this.dress.readColours(colours.steel);
      if (this.box) this.box.material.color = colours.workspace;
      this.dirty = true;
    }

    // own: a body's number, and its vertices where it has its own; opening: of the tool's jaws, 0 to 1.
    show(snapshot, own, opening = this.scales.opening) {
      this.snapshot = snapshot;
      this.scales.opening = opening;
      this.dress.place(toolView.frameOfDress(snapshot), opening);
      for (const body of snapshot?.bodies ?? []) this.bodies.get(body.id)?.setPose(body.pose, body.flags);
      for (const [id, view] of this.bodies) view.setVertices(own.get(id));
      const strip = [];
      for (const { body, triangle } of snapshot?.strips ?? []) {
        const view = this.bodies.get(body);
        const index = view?.triangleOf(triangle);
        if (index !== undefined && view.rotation) strip.push([view, index]);
      }
      this.strip.show(strip);
      this.showPicked();
      this.veilSheets();
      this.dirty = true;
      if (this.isFresh && snapshot?.segments.length > 0) this.fitTool();
    }

    showPicked() {
      const view = this.picked && this.bodies.get(this.picked.id);
      this.pickedMark.show(view?.rotation ? [[view, this.picked.triangle]] : []);
      this.dirty = true;
    }

    // What has to be seen: all bodies, without any the workspace, and without that a box round the origin.
    places() {
      const of = [...this.bodies.values()].map(view => view.places());
      if (of.every(({ length }) => length === 0)) of.push(Float32Array.from(this.scene.device?.workspace ?? UNIT_BOX));
      return of;
    }

    // The ball round what has to be seen.
    bounds(all = this.places()) {
      const least = [Infinity, Infinity, Infinity];
      const most = least.map(() => -Infinity);
      for (const places of all)
        for (let i = 0; i < places.length; i++) {
          if (places[i] < least[i % 3]) least[i % 3] = places[i];
          if (places[i] > most[i % 3]) most[i % 3] = places[i];
        }
      return {
        centre: least.map((value, k) => (value + most[k]) / 2),
        radius: Math.max(1e-6, rays.length(rays.sub(most, least)) / 2),
      };
    }

    // direction: { azimuth, elevation }, or what it is now. A picture without a size is fitted when it has one.
    fit(smooth, direction = this.camera.state) {
      this.resize();
      if (!this.width) {
        this.isUnfitted = true;
        return;
      }
      const all = this.places();
      const { centre, radius } = this.bounds(all);
      this.scales.radius = radius;
      const above = this.camera.turned([0, 0, 0.6 * toolView.ARROW * radius]);
      const ends = (this.snapshot?.segments ?? []).flatMap(({ proxyA, proxyB }) => [
        proxyA,
        proxyB,
        proxyA.map((value, k) => value + above[k]), // a force upward at the tip
      ]);
      for (const tool of this.snapshot?.tools ?? [])
        ends.push(...toolView.dressOf(this.snapshot, tool, this.scales.look).flatMap(({ a, b }) => [a, b]));
      const near = ends.filter(place => rays.isPlace(place) && rays.length(rays.sub(place, centre)) < NEAR * radius);
      const whole = Float32Array.from([...all.flatMap(places => [...places]), ...near.flat()]);
      const free = (pixels, of) => Math.max(0.3, 1 - (2 * pixels) / of);
      const { top, bottom } = this.edges();
      const { azimuth, elevation } = direction;
      this.camera.fit(
        whole,
        centre,
        radius,
        { azimuth, elevation },
        {
          left: free(SIDE, this.width),
          right: free(SIDE, this.width),
          top: free(top + ROOM, this.height),
          bottom: free(bottom + ROOM, this.height),
        },
        smooth,
      );
    }

    // Along an axis of the scene: a name of camera.VIEWS.
    look(name, smooth) {
      const [azimuth, elevation] = camera.VIEWS[name];
      this.fit(smooth, { azimuth, elevation });
    }

    // How many pixels long the arrow of the largest force is, at the camera's target.
    arrowPixels() {
      return (toolView.ARROW * this.scales.radius) / this.camera.pixelSize(this.camera.state.target);
    }

    get smoothRatio() {
      const { antialias } = this.renderer.userData;
      return antialias ? Math.min(2, devicePixelRatio) : Math.max(SMOOTH_RATIO, devicePixelRatio);
    }

    resize() {
      const width = this.canvas.clientWidth;
      const height = this.canvas.clientHeight;
      const ratio = this.isSmooth ? this.smoothRatio : Math.min(2, devicePixelRatio);
      if (width === 0 || height === 0 || (width === this.width && height === this.height && ratio === this.ratio))
        return;
      Object.assign(this, { width, height, ratio });
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.resize(width, height);
      if (!this.isUnfitted) return;
      this.isUnfitted = false;
      this.setCamera();
    }

    // Vertices of a frame, shown or not: the colours' scale is that of all frames so far.
    noteMoved(own) {
      for (const [id, vertices] of own)
        this.mostMoved = Math.max(this.mostMoved, this.bodies.get(id)?.mostMovedOf(vertices) ?? 0);
    }

    // Colours of how far the surfaces have moved, if they are asked for.
    showDeformation() {
      for (const view of this.bodies.values()) {
        if (this.showsDeformation) view.measureMoved();
        surfaceLight.setDeformation(view.object.material, this.showsDeformation);
      }
      this.scales.moved = scale.roundUp(Math.max(LEAST_MOVED, this.mostMoved));
      this.light.movedScale.value = this.scales.moved;
    }

    // A sheet that hides most of a tool that does not touch it is seen through.
    veilSheets() {
      this.isVeilDue = false;
      const segments = this.snapshot?.segments ?? [];
      const places = segments.flatMap(({ proxyA, proxyB }) => [0, 0.5, 1].map(s => rays.along(proxyA, proxyB, s)));
      const touched = new Set(this.snapshot?.contacts.map(({ body }) => body));
      const sheets = [...this.bodies].filter(([id, view]) => view.isSheet && !touched.has(id));
      const hiding = ({ object }) => {
        const eye = object.position.toArray();
        const hides = view => place => rays.isPlace(place) && view.pick(eye, rays.sub(place, eye))?.t < 1;
        const hidden = ([, view]) => places.filter(hides(view)).length;
        return new Set(sheets.filter(sheet => 2 * hidden(sheet) > places.length).map(([id]) => id));
      };
      const before = this.veiled.main;
      this.veiled = { main: hiding(this.camera), inset: this.inset.isThere ? hiding(this.inset.camera) : new Set() };
      if (before.size !== this.veiled.main.size || [...before].some(id => !this.veiled.main.has(id))) this.dirty = true;
    }

    // Looks on at what shades the bodies, for some ms; the shade is drawn when it is whole. True if it became so.
    bakeOn(most) {
      if (this.bake.isDone) return false;
      const end = performance.now() + most;
      do this.bake.advance();
      while (!this.bake.isDone && performance.now() < end);
      if (!this.bake.isDone) return false;
      const shades = this.bake.shades();
      this.bake.parts.forEach(({ view }, i) => view.setShades(shades[i]));
      this.bake.parts = [];
      this.dirty = true;
      return true;
    }

    // From the next picture on. Nothing happens where edges are smooth by multisampling.
    setSmooth(on) {
      if (!this.renderer.userData.antialias) this.isSmooth = on;
    }

    // Draws if something has changed, or must be drawn for a reader of pixels. True if it drew.
    draw(always) {
      this.resize();
      this.watchEye(always);
      if (!(this.dirty || always) || !this.width) return false;
      this.dirty = false;
      this.render(this.camera, this.veiled.main);
      const { arrows } = this.tools;
      this.inset.draw(this.renderer, this.canvas, () => this.render(this.inset.camera, this.veiled.inset));
      this.tools.arrows = arrows; // labels stand in the large view
      return true;
    }

    // As a camera sees it; veiled: numbers of the bodies that are seen through.
    render(camera, veiled) {
      this.tools.draw(this.snapshot, this.colours, camera, this.scales);
      const { right, above, back } = camera.axes();
      const { radius } = this.scales;
      const { target } = camera.state;
      this.sun.target.position.set(...target);
      const sun = back.map((value, k) => 1.1 * value + 1.2 * above[k] - 0.7 * right[k]);
      this.sun.position.set(...target.map((value, k) => value + radius * sun[k]));
      surfaceLight.setLight(this.light, sun, camera.turned([0, 0, 1]), back, this.tools.rods, radius);
      surfaceLight.setPatches(this.light, this.showsDeformation ? [] : this.patches()); // one meaning of a colour
      this.showDeformation();
      for (const [id, { object }] of this.bodies) {
        surfaceLight.setVeil(object, veiled.has(id));
        surfaceLight.fitTo(this.light, object.material);
      }
      this.renderer.render(this.three, camera.object);
    }

    // Whether a sheet hides the tool is asked when the eye has come to rest; of a frame it has been asked.
    watchEye(always) {
      const { position } = this.camera.object;
      if (!this.eye.equals(position)) {
        this.eye.copy(position);
        Object.assign(this, { isVeilDue: true, eyeMoved: performance.now() });
      }
      if (this.isVeilDue && (always || performance.now() - this.eyeMoved > REST)) this.veilSheets();
    }

    // The tools' contacts, with the numbers of their bodies.
    patches() {
      const numbers = new Map([...this.bodies.keys()].map((id, number) => [id, number]));
      return this.tools.patches.map(patch => ({ ...patch, number: numbers.get(patch.body) ?? -1 }));
    }

    // Pixels of the page from the picture's upper left corner; null behind the camera.
    project(place) {
      const p = new THREE.Vector3(...place).project(this.camera.object);
      return p.z < 1 ? [((p.x + 1) / 2) * this.width, ((1 - p.y) / 2) * this.height] : null;
    }

    ray([x, y]) {
      const eye = this.camera.object.position.toArray();
      const far = new THREE.Vector3((2 * x) / this.width - 1, 1 - (2 * y) / this.height, 0.5)
        .unproject(this.camera.object)
        .toArray();
      return { origin: eye, direction: rays.sub(far, eye) };
    }

    // { id, triangle } of the nearest triangle at a pixel; null if there is none. The picked one is marked.
    pick(at) {
      const { origin, direction } = this.ray(at);
      let nearest = null;
      for (const [id, view] of this.bodies) {
        const hit = view.pick(origin, direction);
        if (hit && !(nearest?.t <= hit.t)) nearest = { id, triangle: hit.triangle, t: hit.t };
      }
      this.picked = nearest && { id: nearest.id, triangle: nearest.triangle };
      this.showPicked();
      return this.picked;
    }

    // [red, green, blue] as drawn at a pixel. The buffer is gone after its frame, hence it is drawn here.
    pixel([x, y]) {
      const gl = this.renderer.getContext();
      const rgba = new Uint8Array(4);
      this.draw(true);
      gl.readPixels(
        Math.floor(x * this.ratio),
        Math.floor((this.height - y) * this.ratio),
        1,
        1,
        gl.RGBA,
        gl.UNSIGNED_BYTE,
        rgba,
      );
      return [...rgba.subarray(0, 3)];
    }

    // A promise of a PNG, with smooth edges. paint(context, ratio): what stands over the picture, with so many pixels for one
    // of the page.
    picture(paint = () => {}) {
      this.setSmooth(true);
      this.draw(true);
      this.dirty = true; // what stands beside the picture follows with the next one
      const { width, height } = this.canvas;
      const copy = Object.assign(document.createElement("canvas"), { width, height });
      const context = copy.getContext("2d");
      context.drawImage(this.canvas, 0, 0); // the buffer is gone after its frame
      paint(context, width / this.width);
      return new Promise(done => {
        copy.toBlob(done, "image/png");
      });
    }
  }

  return { rendererOf, isDrawnByProcessor, SceneView };
})();
