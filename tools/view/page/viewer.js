// SPDX-License-Identifier: BSD-3-Clause
// Puts the parts together: messages come in, frames are kept, and with each picture of the browser the one that is due
// is shown.
"use strict";
const viewer = (() => {
  const { FrameHistory } = frameHistory;
  const { TickHistory } = tickHistory;
  const { Player } = player;
  const LIVE = { mostBytes: 400e6, mostSeconds: 30 };
  const RECORDING = { mostBytes: 1.5e9, mostSeconds: Infinity };
  const LIVE_TICKS = 1 << 17;
  const RECORDING_TICKS = 1 << 22;
  const WINDOW = 10; // s of the plots of a running world
  const NUMBERS_EVERY = 100; // ms, while it plays
  const PLOTS_EVERY = 33; // ms
  const LEAST_DEPTH = 1e-4; // m: the least end of the scale of colours
  const LEAST_FORCE = 0.1; // N: of the arrow's
  const FORCE_BAR = 70; // pixels: the most of the bar in the legend
  const BAKE = 4; // ms of a picture's time for the bodies' shade, while it is not whole
  const THEMES = ["system", "dark", "light"];
  const element = id => document.getElementById(id);

  const picture = element("picture");
  const slider = element("slider");
  const toolChoice = element("tool");
  const own = {
    scene: null,
    view: null,
    connection: null,
    frame: null,
    shown: null,
    owed: 0,
    refused: 0,
    ended: null,
    away: false,
    theme: 0,
    drawnRate: 0,
    drawn: 0,
    picked: null,
    deepest: 0,
    strongest: 0,
  };
  let history = new FrameHistory(RECORDING);
  let ticks = new TickHistory(RECORDING_TICKS);
  const play = new Player(history, () => {
    own.timeChanged = true;
  });
  const plot = new plots.Plots(element("plots"), ticks);
  const numbers = new readouts.Readouts(element("numbers"));
  const edges = new smoothing.Smoothing();
  const labels = new arrowLabels.ArrowLabels(element("labels"));
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  const darkSystem = matchMedia("(prefers-color-scheme: dark)");
  let drawings = [];
  let numbersAt = 0;
  let plotsAt = 0;
  let plotsDirty = true;

  // A sentence above the picture, or none; the live region says it once.
  function notice(sentence) {
    const place = element("notice");
    if (place.textContent === sentence) return;
    place.textContent = sentence;
    place.hidden = sentence === "";
    if (sentence) say(sentence);
  }

  function say(sentence) {
    element("status").textContent = sentence;
  }

  const selectedTool = () => Math.max(0, toolChoice.selectedIndex);

  function clearFrames() {
    const live = own.scene.mode === "live";
    history = play.history = new FrameHistory(live ? LIVE : RECORDING);
    ticks = plot.history = new TickHistory(live ? LIVE_TICKS : RECORDING_TICKS);
    Object.assign(own, { frame: null, shown: null, ended: null, deepest: 0, strongest: 0 });
    play.reset(live);
    if (!live) play.playing = !calm.matches;
    plotsDirty = own.timeChanged = true;
  }

  function takeScene(scene) {
    own.scene = scene;
    document.body.dataset.mode = scene.mode;
    document.title = `${scene.title} \u2013 dynpoint`;
    element("title").textContent = scene.title;
    element("program").textContent = scene.program;
    element("device").textContent = scene.device
      ? `${scene.device.name}${scene.device.simulated ? ", simulated" : ""}`
      : "";
    listMeshes(scene);
    numbers.reset();
    element("deformation").hidden = true;
    if (own.view?.showsDeformation) showDeformation(false);
    delete element("legend").dataset.strip;
    element("dressed").hidden = (!scene.look || scene.look === "none") && scene.dress.length === 0;
    beginEdges();
    clearFrames();
    unpick();
    showScene(scene);
    own.connection?.send("ready");
  }

  // Beside a running world a processor that draws is spared.
  function beginEdges() {
    edges.begin(own.scene.mode === "live" && sceneView.isDrawnByProcessor());
  }

  // Pixels of the picture that the legend and the buttons have.
  function edgesOfPicture() {
    const { top, bottom } = picture.getBoundingClientRect();
    const boxes = ids => ids.map(id => element(id).getBoundingClientRect()).filter(({ height }) => height > 0);
    return {
      top: Math.max(0, ...boxes(["legend"]).map(box => box.bottom - top)),
      bottom: Math.max(0, ...boxes(["deformation", "views"]).map(box => bottom - box.top)),
    };
  }

  function showScene(scene) {
    if (own.view) return own.view.setScene(scene);
    const renderer = sceneView.rendererOf(picture, scene);
    if (renderer) own.view = new sceneView.SceneView(picture, renderer, scene, edgesOfPicture, element("inset"));
    for (const id of ["views", "legend", "save", "picture"]) element(id).hidden = !renderer;
    element("blind").hidden = renderer !== null;
    if (!renderer) say(element("blind").textContent);
  }

  function listMeshes(scene) {
    const list = element("facts").querySelector("dl");
    list.replaceChildren();
    const add = (name, value) => {
      const row = document.createElement("div");
      row.append(document.createElement("dt"), document.createElement("dd"));
      row.firstChild.textContent = name;
      row.lastChild.textContent = value;
      list.append(row);
    };
    for (const [index, { name, triangles, vertices, positions }] of scene.meshes.entries()) {
      const lengths = rays.extent(positions).map(value => (1e3 * value).toFixed(1));
      add(name || (scene.bodies.find(({ mesh }) => mesh === index)?.name ?? ""), `${triangles.toLocaleString("en")} triangles, ${vertices.toLocaleString("en")} vertices`);
      add("", `${lengths.join(" \u00d7 ")} mm`);
    }
  }

  function takeFrame(frame, bytes) {
    // In a pause of a running world the frames at hand stay as they are.
    if (play.live && !play.playing && history.size > 0) return;
    const before = history.last?.own;
    history.add(frame, bytes);
    if (history.last.own !== before) own.view?.noteMoved(history.last.own);
    for (const tick of frame.ticks) ticks.add(tick);
    for (const contact of frame.snapshot.contacts)
      own.deepest = Math.max(own.deepest, depths.ofContact(frame.snapshot, contact));
    for (const { force } of frame.ticks) if (force > own.strongest && force < Infinity) own.strongest = force;
    for (const { wrench } of frame.snapshot.tools) {
      const force = rays.length(wrench.slice(0, 3));
      if (force > own.strongest && force < Infinity) own.strongest = force;
    }
    plotsDirty = own.timeChanged = true;
  }

  function takeEnd(text) {
    own.ended = text;
    play.whole = true;
    if (play.live) {
      play.live = play.playing = false;
      document.body.dataset.mode = "recording";
      play.index = play.last;
    }
    own.timeChanged = plotsDirty = true;
    own.connection?.end();
    if (own.connection) say(text);
  }

  function refuse(sentence) {
    own.refused++;
    notice(`A message was refused. ${sentence}`);
  }

  function take(bytes) {
    const message = messageReader.readMessage(bytes);
    if (message.kind === "scene") {
      own.away = false;
      notice("");
      takeScene(message);
    } else if (message.kind === "end") takeEnd(message.text);
    else if (!message.refused) {
      const sentence = own.scene ? messageReader.misfit(message, own.scene) : "It came before the scene.";
      if (sentence) refuse(sentence);
      else takeFrame(message, bytes);
    } else if (!own.scene) {
      notice(`The scene was refused. ${message.refused}`);
      own.connection?.end();
    } else refuse(message.refused);
    if (own.connection && bytes[0] === 2) answerFrame();
  }

  // Of a running world a frame is answered when the picture has been drawn, of a recording when it is kept.
  function answerFrame() {
    if (play.live) own.owed++;
    else own.connection.send("drawn");
  }

  function showFrame() {
    const entry = history.get(play.index);
    if (!entry || entry === own.shown) return;
    own.shown = entry;
    own.frame = messageReader.readMessage(entry.bytes);
    if (own.frame.snapshot.strips.length > 0) element("legend").dataset.strip = "";
    if (entry.own.size > 0) element("deformation").hidden = false;
    const opening = own.scene.hasJaws ? own.frame.ticks.at(-1)?.opening : 0.5;
    own.view?.show(own.frame.snapshot, entry.own, opening);
    tellDepth(readouts.depthWord(own.frame.snapshot.tools[0]));
    listTools(own.frame.snapshot.tools);
    showFound();
    own.timeChanged = true;
  }

  function tellDepth(word) {
    if (plot.setLabel("depth", word)) element("plots").setAttribute("aria-label", plot.words);
  }

  function listTools(tools) {
    element("which").hidden = tools.length < 2;
    if (toolChoice.length === tools.length) return;
    toolChoice.replaceChildren(...tools.map(({ id }) => new Option(String(id))));
  }

  function showNumbers(now) {
    if (!own.frame || (play.playing && now - numbersAt < NUMBERS_EVERY)) return;
    numbersAt = now;
    numbers.show(readouts.texts(own.frame, selectedTool(), { drawnRate: own.drawnRate }));
    const { depth, moved } = own.view?.scales ?? {};
    element("deepest").textContent = own.view ? `${Number((1e3 * depth).toPrecision(1))} mm` : "";
    if (own.view?.showsDeformation) element("most-moved").textContent = `${Number((1e3 * moved).toPrecision(1))} mm`;
  }

  const modeWords = () =>
    own.ended && own.scene.mode === "live"
      ? "Ended"
      : play.live
        ? play.playing
          ? "Live"
          : "Paused: the run goes on"
        : own.scene?.mode === "recording"
          ? "Recording"
          : own.scene
            ? "Mesh"
            : "";

  function showTime() {
    if (!own.timeChanged) return;
    own.timeChanged = false;
    const chip = element("mode");
    const words = own.away ? "Away" : modeWords();
    const total = history.last?.time ?? 0;
    chip.textContent = words;
    chip.title = own.ended ?? "";
    chip.dataset.state = words === "Live" ? "live" : "";
    element("play").textContent = play.playing ? "Pause" : "Play";
    slider.max = String(play.last);
    slider.value = String(play.index);
    const at = own.shown?.time ?? 0;
    const text = play.following
      ? readouts.time(at)
      : play.live
        ? `${readouts.time(at)} (${(at - total).toFixed(2)} s)`
        : `${readouts.time(at)} of ${readouts.time(total)}`;
    element("clock").textContent = text;
    if (!play.playing)
      slider.setAttribute("aria-valuetext", `${readouts.time(at)}, frame ${play.index + 1} of ${history.size}`);
    element("speed").value = String(play.speed);
  }

  function showPlots(now) {
    if (document.body.dataset.mode === "mesh" || !own.scene) return;
    if (play.live) {
      const late = Math.max(ticks.to, own.shown?.time ?? 0);
      const early = own.shown?.time ?? late;
      const to = play.playing
        ? late
        : Math.min(late, Math.max(late - WINDOW, early) === early ? late : early + WINDOW / 2);
      plot.setWindow(to - WINDOW, to);
    } else
      plot.setWindow(
        Math.min(ticks.from, history.get(0)?.time ?? ticks.from),
        Math.max(ticks.to, history.last?.time ?? 0, ticks.from + 1e-3),
      );
    if (plotsDirty && now - plotsAt >= PLOTS_EVERY) {
      plot.stale = true;
      plotsDirty = false;
      plotsAt = now;
    }
    plot.draw(own.shown && !play.following ? own.shown.time : null);
  }

  function showScales() {
    if (!own.view) return;
    const depth = scale.roundUp(Math.max(LEAST_DEPTH, own.deepest));
    const force = scale.roundUp(Math.max(LEAST_FORCE, own.strongest));
    const { scales } = own.view;
    if (scales.depth === depth && scales.force === force) return;
    Object.assign(scales, { depth, force });
    own.view.dirty = true;
  }

  // The legend's bar is as long as an arrow of its force is at the camera's target.
  function showForceScale() {
    const full = own.view.arrowPixels();
    const force = scale.roundDown((own.view.scales.force * FORCE_BAR) / full);
    element("force-bar").style.width = `${((full * force) / own.view.scales.force).toFixed(1)}px`;
    element("force-scale").textContent = `${Number(force.toPrecision(1))} N`;
  }

  function countDrawing(now) {
    own.drawn++;
    drawings.push(now);
    while (drawings[0] < now - 1000) drawings.shift();
    own.drawnRate = drawings.length > 1 ? (1000 * (drawings.length - 1)) / (now - drawings[0]) : 0;
  }

  function everyPicture(now) {
    own.view?.camera.advance(now);
    play.advance(now);
    if (own.view?.bakeOn(BAKE)) beginEdges(); // it was slow for that
    showFrame();
    if (own.scene) showScales();
    const drew = own.view?.draw(false) ?? false;
    if (drew) {
      labels.show(own.view);
      showForceScale();
      countDrawing(now);
    }
    if (own.view) edges.tick(now, drew, on => own.view.setSmooth(on));
    showPlots(now);
    showNumbers(now);
    showTime();
    theHand.flush(now);
    for (; own.owed > 0; own.owed--) own.connection.send("drawn");
    requestAnimationFrame(everyPicture);
  }

  function handlePlace() {
    const snapshot = own.frame?.snapshot;
    const tool = snapshot?.tools[selectedTool()];
    return own.scene?.control && play.following && tool ? toolView.handleOf(snapshot, tool) : null;
  }
  const theHand = new hand.Hand(handlePlace, text => own.connection?.send(text));

  function pick(at) {
    own.picked = own.view?.pick(at) ?? null;
    showFound();
    if (!own.picked) return;
    say(`Body ${element("found-body").textContent}, triangle ${element("found-triangle").textContent}`);
  }

  function unpick() {
    if (own.view) {
      own.view.picked = null;
      own.view.showPicked();
    }
    own.picked = null;
    showFound();
  }

  function showFound() {
    const body = own.picked && own.view.bodies.get(own.picked.id);
    element("found").hidden = !body?.rotation;
    if (!body?.rotation) return;
    element("found-body").textContent = `${body.body.name} (${body.body.id})`;
    element("found-triangle").textContent = String(body.mesh.sources[own.picked.triangle]);
    element("found-corners").textContent = body.cornersOf(own.picked.triangle).map(readouts.coordinates).join("\n");
  }

  function setTheme(theme) {
    own.theme = theme;
    const name = THEMES[theme];
    const dark = name === "dark" || (name === "system" && darkSystem.matches);
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    element("theme-name").textContent = name;
    element("theme").setAttribute("aria-label", `Theme: ${name}`);
    own.view?.readColours();
    plot.readColours();
  }

  async function save() {
    const blob = await own.view?.picture((context, ratio) => {
      labels.show(own.view);
      savedPicture.paint(context, ratio, picture, ["inset", "labels", "legend"].map(element));
    });
    if (!blob) return;
    const link = document.createElement("a");
    const address = URL.createObjectURL(blob);
    link.href = address;
    link.download = `${own.scene.title.replace(/[^\w.-]+/g, "-") || "picture"}-${play.index}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }

  const actions = {
    camera: () => own.view?.camera ?? null,
    radius: () => own.view.scales.radius,
    hand: theHand,
    handFirst: connection.handFirst,
    controls: () => handlePlace() !== null,
    handle: () => handlePlace() && own.view?.project(handlePlace()),
    pick,
    unpick,
    save,
    fit: () => own.view?.fit(!calm.matches),
    view: name => own.view?.look(name, !calm.matches),
    toggle: () => play.toggle(),
    back: () => play.step(-1),
    forward: () => play.step(1),
    begin: () => play.seek(0),
    end: () => (play.live ? play.play() : play.seek(play.last)),
    slower: () => changeSpeed(-1),
    faster: () => changeSpeed(1),
    theme: () => setTheme((own.theme + 1) % THEMES.length),
    deformation: () => showDeformation(!own.view?.showsDeformation),
    help: () => element("panel").showModal(),
  };

  // Where a body deforms; else there is nothing to show.
  function showDeformation(on) {
    if (!own.view || (on && element("deformation").hidden)) return;
    own.view.showsDeformation = on;
    own.view.dirty = true;
    element("deformation").setAttribute("aria-pressed", String(on));
    element("moved").hidden = !on;
    say(on ? "Colours say how far the surface has moved." : "Colours of the deformation are off.");
  }

  function changeSpeed(by) {
    const speeds = [...element("speed").options].map(option => Number(option.value));
    play.setSpeed(speeds[Math.min(speeds.length - 1, Math.max(0, speeds.indexOf(play.speed) + by))]);
  }

  function listen() {
    keys.attach({ ...actions, pick: () => own.view && pick([own.view.width / 2, own.view.height / 2]) });
    pointers.attach(picture, actions);
    for (const [id, name] of [
      ["begin", "begin"],
      ["back", "back"],
      ["play", "toggle"],
      ["forward", "forward"],
      ["end", "end"],
      ["save", "save"],
      ["theme", "theme"],
      ["deformation", "deformation"],
      ["help", "help"],
      ["unpick", "unpick"],
    ])
      element(id).addEventListener("click", () => actions[name]());
    for (const button of element("views").children) {
      const { view } = button.dataset;
      button.addEventListener("click", () => (view === "fit" ? actions.fit() : actions.view(view)));
    }
    slider.addEventListener("input", () => play.seek(Number(slider.value)));
    element("speed").addEventListener("change", event => play.setSpeed(Number(event.target.value)));
    toolChoice.addEventListener("change", () => {
      numbersAt = -Infinity;
    });
    const scrub = event => {
      if (event.buttons & 1)
        play.seekTime(plot.timeAt(event.clientX - event.currentTarget.getBoundingClientRect().left));
    };
    element("plots").addEventListener("pointerdown", event => {
      event.currentTarget.setPointerCapture(event.pointerId);
      scrub(event);
    });
    element("plots").addEventListener("pointermove", scrub);
    darkSystem.addEventListener("change", () => setTheme(own.theme));
    addEventListener("resize", () => {
      plotsDirty = true;
    });
  }

  // The stream in the page's own data, if there is one; else the server that sent the page.
  function start() {
    for (const ramp of document.querySelectorAll(".ramp")) ramp.style.background = scale.gradient();
    setTheme(0);
    listen();
    requestAnimationFrame(everyPicture);
    const text = element("data").textContent;
    if (text !== "" && !text.startsWith("@")) return playData(text);
    const lacking = connection.lack();
    if (lacking) return notice(lacking);
    own.connection = new connection.Connection({
      message: take,
      refused: sentence => {
        own.away = own.timeChanged = true;
        notice(sentence);
      },
      away: sentence => {
        own.owed = 0;
        own.away = own.timeChanged = true;
        notice(sentence);
      },
    });
  }

  function playData(text) {
    const { bytes, refused } = messageReader.decodeText(text);
    const stream = bytes ? messageReader.splitStream(bytes) : { refused };
    element("data").textContent = ""; // the bytes are kept, not their text
    if (stream.refused) return notice(`The page's data were refused. ${stream.refused}`);
    stream.messages.forEach(take);
    play.whole = true;
  }

  start();
  return {
    own,
    actions,
    notice,
    say,
    play,
    plot,
    element,
    theHand,
    get history() {
      return history;
    },
    get ticks() {
      return ticks;
    },
  };
})();
