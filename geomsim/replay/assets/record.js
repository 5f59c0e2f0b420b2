// The record: unpacked, and asked for any time of it.

async function unpack(element) {
  const bytes = Uint8Array.from(atob(element.textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return JSON.parse(await new Response(stream).text());
}

// Rows were written as differences; one flat array of them is quicker than an array of arrays.
function summed(rows, unit) {
  const width = rows[0].length;
  const flat = new Float32Array(rows.length * width);
  const sum = new Float64Array(width);
  rows.forEach((row, i) => row.forEach((d, j) => { sum[j] += d; flat[i * width + j] = sum[j] * unit; }));
  return { width, length: rows.length, at: (i, j) => flat[i * width + j], column: (j) => rows.map((_, i) => flat[i * width + j]) };
}

class Episode {
  constructor(data) {
    this.data = data;
    this.times = summed(data.times, 0.001).column(0);
    this.moves = summed(data.moves, 1);
    this.headings = summed(data.headings, Math.PI / 180);
    this.roots = summed(data.chances, 1e-4);
    this.end = this.times[this.times.length - 1];
    this.gone = [];
    this.plans = [];
    for (let r = 0; r < data.robots; r++) {
      const gone = new Float32Array(this.times.length);
      for (let i = 1; i < gone.length; i++) {
        gone[i] = gone[i - 1] + Math.hypot(this.moves.at(i, 2 * r) - this.moves.at(i - 1, 2 * r), this.moves.at(i, 2 * r + 1) - this.moves.at(i - 1, 2 * r + 1));
      }
      this.gone.push(gone);
      this.plans.push(data.plans.filter((plan) => plan.robot === r));
    }
  }

  // Last index whose time is not after t.
  static index(times, t) {
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= t + 1e-9) low = middle; else high = middle - 1;
    }
    return low;
  }

  between(t) {
    const i = Math.min(Episode.index(this.times, t), Math.max(this.times.length - 2, 0));
    const j = Math.min(i + 1, this.times.length - 1);
    return { i, j, part: j > i ? (t - this.times[i]) / (this.times[j] - this.times[i]) : 0 };
  }

  position(body, { i, j, part }) {
    const mix = (k) => (1 - part) * this.moves.at(i, k) + part * this.moves.at(j, k);
    return [mix(2 * body), mix(2 * body + 1)];
  }

  evader(number, where) { return this.position(this.data.robots + number, where); }

  heading(robot, { i, j, part }) { return (1 - part) * this.headings.at(i, robot) + part * this.headings.at(j, robot); }

  caught(number, t) { return this.data.outcome.captures.some((one) => one.evader === number && t >= one.time - 1e-6); }

  captured(t) { return this.data.outcome.captured && t >= this.data.outcome.time - 1e-6; }

  beliefStep(t) { return Episode.index(this.data.beliefTimes, t); }

  // Chance that the evader is in a cell, counted from 0, if it has not been captured.
  share(step, cell) { return this.roots.at(step, cell + 1) ** 2; }

  capture(t) {
    const times = this.data.beliefTimes, i = this.beliefStep(t), j = Math.min(i + 1, times.length - 1);
    const a = this.roots.at(i, 0) ** 2, b = this.roots.at(j, 0) ** 2;
    return j > i ? a + (b - a) * Math.min(1, (t - times[i]) / (times[j] - times[i])) : a;
  }

  trail(robot, where, t, seconds) {
    const first = Episode.index(this.times, t - seconds);
    const points = [];
    for (let i = first; i <= where.i; i++) points.push([this.moves.at(i, 2 * robot), this.moves.at(i, 2 * robot + 1)]);
    points.push(this.position(robot, where));
    return points;
  }

  // The way that a robot still means to go: what lies beyond the length that it has gone since it chose it.
  route(robot, where, t) {
    const plans = this.plans[robot];
    let k = plans.length - 1;
    while (k >= 0 && plans[k].time > t + 1e-9) k--;
    if (k < 0) return [];
    const { way, time } = plans[k];
    const gone = this.gone[robot];
    const now = (1 - where.part) * gone[where.i] + where.part * gone[where.j];
    const left = now - gone[Episode.index(this.times, time)];
    const points = [this.position(robot, where)];
    let along = 0;
    for (let m = 0; m < way.length; m += 2) {
      if (m) along += Math.hypot(way[m] - way[m - 2], way[m + 1] - way[m - 1]);
      if (along > left + 1e-6) points.push([way[m], way[m + 1]]);
    }
    return points.length > 1 ? points : [];
  }
}
