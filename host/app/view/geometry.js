// SPDX-License-Identifier: MIT
// Vectors, the camera that turns about a point, and where points of the scene lie in the picture.
'use strict';

const add = (a, b) => a.map((c, i) => c + b[i]);
const minus = (a, b) => a.map((c, i) => c - b[i]);
const times = (a, s) => a.map(c => c * s);
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = a => Math.sqrt(dot(a, a));
const unit = a => times(a, 1 / (length(a) || 1));
const degrees = Math.PI / 180;

// The text of a float32 that the server reads with the same bits.
const floatText = x => String(Number(Math.fround(x).toPrecision(9)));
const vectorText = v => v.map(floatText).join(',');
const vectorOf = text => text.split(',').map(Number);

// Turns v about the vertical.
function turned(v, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * v[0] + s * v[2], v[1], c * v[2] - s * v[0]];
}

// A camera that the page moves: it stands at `eye`, looks at `target`, and y points up.
class Orbit {
  constructor(eye, target, fovy) { Object.assign(this, {eye, target, fovy}); }

  // Of a camera as the server describes it. The point that it turns about lies in its view, as far as the scene's middle.
  static of(camera, bounds) {
    const low = bounds.slice(0, 3), high = bounds.slice(3), size = length(minus(high, low));
    const isWithin = camera.eye.every((c, i) => c > low[i] && c < high[i]);
    const ahead = dot(minus(times(add(low, high), 0.5), camera.eye), camera.forward);
    const distance = isWithin || !(ahead > 0.01 * size) ? 0.25 * size || 1 : ahead;
    return new Orbit(camera.eye.slice(), add(camera.eye, times(camera.forward, distance)), camera.fovy);
  }
  get distance() { return length(minus(this.target, this.eye)); }
  get forward() { return unit(minus(this.target, this.eye)); }
  get right() { return unit(cross(this.forward, [0, 1, 0])); }
  get up() { return cross(this.right, this.forward); }

  turn(yaw, pitch) {
    let from = turned(minus(this.eye, this.target), yaw);
    const distance = length(from), level = Math.hypot(from[0], from[2]);
    const slope = Math.max(-1.5, Math.min(1.5, Math.atan2(from[1], level) + pitch));
    const scale = distance * Math.cos(slope) / (level || 1);
    from = level > 0 ? [from[0] * scale, distance * Math.sin(slope), from[2] * scale]
                     : [0, distance * Math.sin(slope), distance * Math.cos(slope)];
    this.eye = add(this.target, from);
  }
  // Looks about from where the camera stands.
  look(yaw, pitch) {
    const eye = this.eye, target = this.target;
    this.eye = target;
    this.target = eye;
    this.turn(yaw, pitch);
    const moved = this.eye;
    this.eye = eye;
    this.target = moved;
  }
  move(step) {
    this.eye = add(this.eye, step);
    this.target = add(this.target, step);
  }
  // By parts of the picture's height.
  pan(x, y) {
    const scale = 2 * this.distance * Math.tan(this.fovy * degrees / 2);
    this.move(add(times(this.right, x * scale), times(this.up, y * scale)));
  }
  dolly(factor) { this.eye = add(this.target, times(minus(this.eye, this.target), factor)); }
  parameters() {
    return {eye: vectorText(this.eye), target: vectorText(this.target), fovy: floatText(this.fovy)};
  }
}

// Where a camera of the server sees points, in a picture of this size.
class Projection {
  constructor(camera, width, height) {
    Object.assign(this, camera, {width, height});
    this.scale = height / 2 / Math.tan(camera.fovy * degrees / 2);
  }
  // x, y and depth in the camera's own axes.
  seen(point) {
    const d = minus(point, this.eye);
    return [dot(d, this.right), dot(d, this.up), dot(d, this.forward)];
  }
  pixel([x, y, z]) { return [this.width / 2 + this.scale * x / z, this.height / 2 - this.scale * y / z]; }
  // The outline of a polygon, cut off where it comes too near to the eye; empty behind it.
  outline(points, isClosed = true) {
    const seen = points.map(p => this.seen(p));
    const near = 1e-4 * Math.max(...seen.map(p => Math.abs(p[2])), 1e-6);
    const out = [];
    for (let i = 0; i < seen.length; ++i) {
      const a = seen[i], b = seen[(i + 1) % seen.length];
      if (a[2] >= near) out.push(this.pixel(a));
      if (!isClosed && i + 1 === seen.length) break;
      if ((a[2] < near) !== (b[2] < near)) {
        const t = (near - a[2]) / (b[2] - a[2]);
        out.push(this.pixel(add(a, times(minus(b, a), t))));
      }
    }
    return out;
  }
}

// The way in which the light of a sun travels: azimuth clockwise from north, which is -z.
function sunDirection(azimuth, elevation) {
  const a = azimuth * degrees, e = elevation * degrees;
  return [-Math.sin(a) * Math.cos(e), -Math.sin(e), Math.cos(a) * Math.cos(e)];
}
function sunAngles(direction) {
  const d = unit(direction);
  return {azimuth: (Math.atan2(-d[0], d[2]) / degrees + 360) % 360, elevation: Math.asin(-d[1]) / degrees};
}
