// SPDX-License-Identifier: BSD-3-Clause
// What tests and the console may ask of the page: window.dynpoint. Nothing here changes what is shown.
"use strict";
window.dynpoint = (() => {
  const { own, play, plot, element } = viewer;
  const pictureOf = ask => place => (own.view ? ask(place) : null);

  return {
    state: () => ({
      mode: own.scene?.mode ?? null,
      frames: viewer.history.size,
      ticks: viewer.ticks.size,
      index: play.index,
      playing: play.playing,
      live: play.live,
      steps: own.frame?.snapshot.steps ?? null,
      number: own.frame?.number ?? null,
      time: own.shown?.time ?? null,
      drawn: own.drawn,
      drawnRate: own.drawnRate,
      refused: own.refused,
      ended: own.ended,
      opened: own.connection?.opened ?? 0,
      picked: own.picked,
      theme: document.documentElement.dataset.theme,
      notice: element("notice").textContent,
      bytes: viewer.history.bytes,
      speed: play.speed,
    }),
    scales: () => own.view && { ...own.view.scales },
    camera: () =>
      own.view && { ...own.view.camera.state, up: own.view.camera.up, gliding: own.view.camera.glide !== null },
    arrows: () => own.view?.tools.arrows ?? [],
    project: pictureOf(place => own.view.project(place)), // pixels of the picture from its upper left corner
    pixel: pictureOf(place => own.view.pixel(own.view.project(place))), // the colour at a place of the scene
    pixelAt: pictureOf(at => own.view.pixel(at)), // the colour at a pixel of the picture
    plotScale: name => ({ ...plot.scales[name], from: plot.from, to: plot.to }),
    plotPlace: (name, time, value) => plot.placeOf(name, time, value),
    plotPixel,
    picture: async () => {
      const { width, height } = await createImageBitmap(await own.view.picture());
      return { width, height, wanted: [own.view.width, own.view.height].map(size => size * own.view.smoothRatio) };
    },
    // ms a picture takes when each is waited for, over `count` pictures with the vertices that `change` wrote
    timeDrawing: (count, moving) => own.view && timeDrawing(count, moving),
  };

  function plotPixel([x, y]) {
    const context = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d");
    context.drawImage(element("plots"), -Math.floor(x * plot.ratio), -Math.floor(y * plot.ratio));
    return [...context.getImageData(0, 0, 1, 1).data];
  }

  function timeDrawing(count, moving) {
    const { view } = own;
    const bodies = [...view.bodies.values()];
    view.setSmooth(false);
    const begun = performance.now();
    const before = bodies.map(body => body.positions);
    for (let i = 0; i < count; i++) {
      if (moving) bodies.forEach(body => body.setVertices(body.positions.slice()));
      view.pixel([1, 1]);
    }
    bodies.forEach((body, i) => body.setVertices(before[i]));
    return (performance.now() - begun) / count;
  }
})();
