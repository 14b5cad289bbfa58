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

    // Those of a direction that it may not look in yet.
    axesOf({ azimuth, elevation }) {
      const [sa, ca, se, ce] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
      return {
        right: this.turned([ca, sa, 0]),
        above: this.turned([-sa * se, ca * se, ce]),
        back: this.turned([sa * ce, -ca * ce, se]),
      };
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

    /*
     * All places in the picture, as near as that allows.
     *   places     x, y, z one behind the other
     *   direction  { azimuth, elevation }
     *   free       { left, right, top, bottom }: parts of the half picture, 0 to 1, that places may reach to
     */
    fit(places, centre, radius, direction, free, smooth) {
      this.radius = radius;
      const { right, above, back } = this.axesOf(direction);
      const up = Math.tan((VIEW_ANGLE * Math.PI) / 360);
      const aside = up * this.object.aspect;
      const slopes = { right: aside * free.right, left: aside * free.left, top: up * free.top, bottom: up * free.bottom };
      const most = { right: -Infinity, left: -Infinity, top: -Infinity, bottom: -Infinity };
      for (let i = 0; i < places.length; i += 3) {
        const x = places[i] - centre[0];
        const y = places[i + 1] - centre[1];
        const z = places[i + 2] - centre[2];
        const across = x * right[0] + y * right[1] + z * right[2];
        const high = x * above[0] + y * above[1] + z * above[2];
        const near = x * back[0] + y * back[1] + z * back[2];
        most.right = Math.max(most.right, across / slopes.right + near);
        most.left = Math.max(most.left, -across / slopes.left + near);
        most.top = Math.max(most.top, high / slopes.top + near);
        most.bottom = Math.max(most.bottom, -high / slopes.bottom + near);
      }
      // The target lies so that left and right, top and bottom, are reached at the same distance.
      const shift = (a, b) => (most[a] - most[b]) / (1 / slopes[a] + 1 / slopes[b]);
      const byX = shift("right", "left");
      const byY = shift("top", "bottom");
      const distance = Math.max(most.right - byX / slopes.right, most.top - byY / slopes.top, 0.05 * radius);
      const target = centre.map((value, k) => value + byX * right[k] + byY * above[k]);
      this.move({ ...direction, target, distance }, smooth);
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

  }

  return { Camera, VIEWS };
})();
