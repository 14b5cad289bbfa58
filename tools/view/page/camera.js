// SPDX-License-Identifier: BSD-3-Clause
// A camera that looks at a target from a distance, with the scene's up axis upright.
"use strict";
const camera = (() => {
  const VIEW_ANGLE = 35; // degrees
  const STEEPEST = Math.PI / 2 - 1e-4; // radians
  const GLIDE = 220; // ms
  // Azimuth and elevation of the views along the axes; azimuth 0 looks along +y with z up, along -z with y up.
  const VIEWS = {
    front: [0, 0],
    back: [Math.PI, 0],
    right: [Math.PI / 2, 0],
    left: [-Math.PI / 2, 0],
    top: [0, STEEPEST],
    bottom: [0, -STEEPEST],
  };

  class Camera {
    constructor(changed) {
      this.changed = changed;
      this.object = new THREE.PerspectiveCamera(VIEW_ANGLE, 1, 0.01, 10);
      this.state = { target: [0, 0, 0], distance: 1, azimuth: 0.6, elevation: 0.42 };
      this.radius = 1;
      this.up = "z";
      this.glide = null;
      this.apply();
    }

    // From the frame in which z is up to the scene's.
    turned([x, y, z]) {
      return this.up === "z" ? [x, y, z] : [x, z, -y];
    }

    apply() {
      const { target, distance, azimuth, elevation } = this.state;
      const flat = Math.cos(elevation);
      const out = this.turned([Math.sin(azimuth) * flat, -Math.cos(azimuth) * flat, Math.sin(elevation)]);
      this.object.position.set(...target.map((value, k) => value + distance * out[k]));
      this.object.up.set(...this.turned([0, 0, 1]));
      this.object.lookAt(...target);
      this.object.near = Math.max(distance / 500, distance - 4 * this.radius);
      this.object.far = distance + 20 * this.radius;
      this.object.updateProjectionMatrix();
      this.object.updateMatrixWorld();
      this.changed();
    }

    resize(width, height) {
      this.height = height;
      this.object.aspect = width / height;
      this.apply();
    }

    move(change, smooth) {
      if (!smooth) {
        this.glide = null;
        Object.assign(this.state, change);
        this.apply();
        return;
      }
      const from = { ...this.state };
      const to = { ...this.state, ...change };
      const turns = Math.round((from.azimuth - to.azimuth) / (2 * Math.PI)); // the short way round
      to.azimuth += 2 * Math.PI * turns;
      this.glide = { from, to, begun: null };
      this.changed();
    }

    // Moves on in a glide; true while it lasts.
    advance(now) {
      if (!this.glide) return false;
      const { from, to } = this.glide;
      const part = Math.min(1, (now - (this.glide.begun ??= now)) / GLIDE);
      const s = part * part * (3 - 2 * part);
      const mix = (a, b) => a + s * (b - a);
      this.state = {
        target: from.target.map((value, k) => mix(value, to.target[k])),
        distance: mix(from.distance, to.distance),
        azimuth: mix(from.azimuth, to.azimuth),
        elevation: mix(from.elevation, to.elevation),
      };
      if (part === 1) this.glide = null;
      this.apply();
      return true;
    }

    rotate(aside, up) {
      const elevation = Math.min(STEEPEST, Math.max(-STEEPEST, this.state.elevation + up));
      this.move({ azimuth: this.state.azimuth + aside, elevation });
    }

    // By pixels of the picture, so that what is under the pointer stays there.
    pan(aside, up) {
      const by = this.pixelSize(this.state.target);
      const { right, above } = this.axes();
      this.move({ target: this.state.target.map((value, k) => value - by * (aside * right[k] - up * above[k])) });
    }

    zoom(times) {
      const distance = Math.min(100 * this.radius, Math.max(0.01 * this.radius, this.state.distance * times));
      this.move({ distance });
    }

    // The picture's axes in the scene.
    axes() {
      const m = this.object.matrixWorld.elements;
      return { right: [m[0], m[1], m[2]], above: [m[4], m[5], m[6]], back: [m[8], m[9], m[10]] };
    }

    // How long a pixel is at a place of the scene.
    pixelSize(place) {
      const { back } = this.axes();
      const eye = this.object.position.toArray();
      const depth = Math.max(1e-9, rays.dot(rays.sub(eye, place), back));
      return (2 * depth * Math.tan((VIEW_ANGLE * Math.PI) / 360)) / this.height;
    }

    // The whole of a ball in the picture.
    fit(centre, radius, smooth) {
      this.radius = radius;
      const up = (VIEW_ANGLE * Math.PI) / 360;
      const aside = Math.atan(Math.tan(up) * this.object.aspect);
      this.move({ target: centre, distance: radius / Math.sin(Math.min(up, aside)) }, smooth);
    }

    // From a place to a target: their numbers one behind the other. The scene's up axis stays upright.
    place(numbers) {
      const [position, target] = [numbers.slice(0, 3), numbers.slice(3, 6)];
      const [x, y, z] = rays.sub(position, target);
      const distance = rays.length([x, y, z]);
      if (!(distance > 0)) return;
      const [east, north, above] = this.up === "z" ? [x, y, z] : [x, -z, y];
      const elevation = Math.asin(Math.min(1, Math.max(-1, above / distance)));
      this.move({
        target,
        distance,
        azimuth: Math.atan2(east, -north),
        elevation: Math.min(STEEPEST, Math.max(-STEEPEST, elevation)),
      });
    }

    view(name, smooth) {
      const [azimuth, elevation] = VIEWS[name];
      this.move({ azimuth, elevation }, smooth);
    }
  }

  return { Camera, VIEWS: Object.keys(VIEWS) };
})();
