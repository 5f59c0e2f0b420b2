// The exact visibility polygon: between two neighbouring wall corners, in angle around the eye, one wall is nearest.

class Walls {
  constructor(rings, bounds) {
    this.walls = [];
    for (const ring of rings) {
      for (let k = 0; k < ring.length; k += 2) {
        const x0 = ring[k], y0 = ring[k + 1], x1 = ring[(k + 2) % ring.length], y1 = ring[(k + 3) % ring.length];
        const length = Math.hypot(x1 - x0, y1 - y0);
        if (length > 0) this.walls.push({ x0, y0, x1, y1, nx: (y0 - y1) / length, ny: (x1 - x0) / length });
      }
    }
    this.reach = 2 * Math.hypot(bounds[2] - bounds[0], bounds[3] - bounds[1]) + 1;
  }

  seenFrom([ex, ey], range, heading, field) {
    const limit = Math.min(range, this.reach), turn = 2 * Math.PI;
    const facing = [], angles = [];
    const wrapped = (a) => Math.atan2(Math.sin(a), Math.cos(a));
    for (const { x0, y0, x1, y1, nx, ny } of this.walls) {
      const distance = Math.max(nx * (ex - x0) + ny * (ey - y0), 1e-6);
      if (nx * (ex - x0) + ny * (ey - y0) < -1e-6 || distance >= limit) continue;
      const first = Math.atan2(y0 - ey, x0 - ex), last = Math.atan2(y1 - ey, x1 - ex);
      const span = (((last - first) % turn) + turn) % turn;
      if (span === 0 || span > Math.PI + 1e-6) continue; // seen edge-on
      facing.push({ first, last, sx: -nx / distance, sy: -ny / distance });
      angles.push(first, last);
      const foot = Math.atan2(-ny, -nx), half = Math.acos(distance / limit);
      if (limit < this.reach) angles.push(wrapped(foot - half), wrapped(foot + half));
    }
    for (let a = -Math.PI; a < Math.PI; a += Math.PI / 45) angles.push(a);
    const whole = field > turn - 1e-9;
    if (!whole) angles.push(wrapped(heading - field / 2), wrapped(heading + field / 2));
    const rays = Float64Array.from(new Set(angles)).sort();
    const count = rays.length, order = new Map();
    rays.forEach((a, k) => order.set(a, k));
    const width = (k) => (k + 1 < count ? rays[k + 1] : rays[0] + turn) - rays[k];
    const cos = new Float64Array(count), sin = new Float64Array(count);
    for (let k = 0; k < count; k++) { const m = rays[k] + width(k) / 2; cos[k] = Math.cos(m); sin[k] = Math.sin(m); }
    // Nearness, one over the distance along a ray, is linear in the ray's direction.
    const nearest = new Float64Array(count).fill(1 / limit), winner = new Int32Array(count).fill(-1);
    facing.forEach((wall, w) => {
      const end = order.get(wall.last);
      for (let k = order.get(wall.first); k !== end; k = (k + 1) % count) {
        const near = wall.sx * cos[k] + wall.sy * sin[k];
        if (near > nearest[k]) { nearest[k] = near; winner[k] = w; }
      }
    });
    const corner = (k, angle) => {
      const c = Math.cos(angle), s = Math.sin(angle), w = winner[k];
      const near = Math.max(w < 0 ? 0 : facing[w].sx * c + facing[w].sy * s, 1 / limit);
      return [ex + c / near, ey + s / near];
    };
    const points = whole ? [] : [[ex, ey]];
    const inside = [];
    for (let k = 0; k < count; k++) {
      const turned = (((rays[k] + width(k) / 2 - heading + field / 2) % turn) + turn) % turn;
      if (whole || turned < field) inside.push([whole ? k : turned, k]);
    }
    inside.sort((a, b) => a[0] - b[0]);
    for (const [, k] of inside) points.push(corner(k, rays[k]), corner(k, rays[k] + width(k)));
    return points;
  }
}
