// Drawing: the floor with its cells, figures whose sizes follow the picture, and the curve below.

class Scene {
  constructor(episode, canvas) {
    this.episode = episode;
    this.canvas = canvas;
    const data = episode.data;
    this.walls = new Walls(data.space, data.bounds);
    this.space = Scene.path(data.space);
    this.thin = Scene.path(data.thin);
    this.dotted = new Path2D();
    for (const path of data.dotted) Scene.lineTo(this.dotted, path);
    this.cells = data.cells.map((cell) => Scene.path(cell.rings));
    this.layers = { belief: true, sight: true, plans: true, trails: true, evader: true, numbers: false };
    this.theme = data.themes.light;
    this.base = document.createElement("canvas");
    this.painted = "";
    this.resize();
  }

  static lineTo(path, flat) {
    for (let k = 0; k < flat.length; k += 2) path[k ? "lineTo" : "moveTo"](flat[k], flat[k + 1]);
  }

  static path(rings) {
    const path = new Path2D();
    for (const ring of rings) { Scene.lineTo(path, ring); path.closePath(); }
    return path;
  }

  resize() {
    const { canvas, episode } = this, ratio = window.devicePixelRatio || 1;
    canvas.width = this.base.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    canvas.height = this.base.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    this.unit = ratio * Math.min(1.6, Math.max(0.7, Math.sqrt((canvas.clientWidth * canvas.clientHeight) / (1000 * 560))));
    const [x0, y0, x1, y1] = episode.data.bounds, edge = 6 * this.unit;
    this.scale = Math.min((canvas.width - 2 * edge) / (x1 - x0), (canvas.height - 2 * edge) / (y1 - y0));
    this.origin = [canvas.width / 2 - (this.scale * (x0 + x1)) / 2, canvas.height / 2 + (this.scale * (y0 + y1)) / 2];
    // Where cells are small, lines are fine.
    const area = episode.data.cells.reduce((sum, cell) => sum + cell.area, 0) / episode.data.cells.length;
    const side = 100 * this.scale * Math.sqrt(area);
    this.fine = this.unit * Math.min(1, Math.max(0.4, side / (60 * this.unit)));
    this.painted = "";
  }

  pixel([x, y]) { return [this.origin[0] + this.scale * x, this.origin[1] - this.scale * y]; }

  metric(context) { context.setTransform(this.scale, 0, 0, -this.scale, ...this.origin); }

  colour(share) {
    const ramp = this.theme.ramp, part = Math.sqrt(Math.min(1, share / this.episode.data.top));
    return ramp[Math.round(part * (ramp.length - 1))];
  }

  // Index of the cell under a place in CSS pixels of the canvas, -1 if there is none.
  cellAt(x, y) {
    const ratio = window.devicePixelRatio || 1, context = this.base.getContext("2d");
    this.metric(context);
    const found = this.cells.findIndex((cell) => context.isPointInPath(cell, x * ratio, y * ratio, "evenodd"));
    context.setTransform(1, 0, 0, 1, 0, 0);
    return found;
  }

  // Cells and walls change only with the belief, the layers, the theme and the size.
  paintBase(step) {
    const { belief, numbers } = this.layers;
    const key = [belief ? step : -1, numbers, this.theme.page, this.unit].join();
    if (key === this.painted) return;
    this.painted = key;
    const context = this.base.getContext("2d"), { theme, fine: unit, scale } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = theme.page;
    context.fillRect(0, 0, this.base.width, this.base.height);
    this.metric(context);
    context.lineJoin = "round";
    context.strokeStyle = context.fillStyle = theme.wall;
    context.lineWidth = (5 * unit) / scale;
    context.stroke(this.space);
    context.fill(this.thin, "evenodd");
    this.cells.forEach((cell, k) => {
      context.fillStyle = context.strokeStyle = this.colour(belief ? this.episode.share(step, k) : 0);
      context.fill(cell, "evenodd");
      context.lineWidth = unit / scale; // closes the seam between two cells
      context.stroke(cell);
    });
    context.strokeStyle = theme.dots;
    context.lineCap = "round";
    context.lineWidth = (1.9 * unit) / scale;
    context.setLineDash([0, (5 * unit) / scale]);
    context.stroke(this.dotted);
    context.setLineDash([]);
    this.wallLines(context);
    for (const portal of this.episode.data.portals) this.disc(context, this.pixel(portal), 2.6 * unit, theme.portal);
    if (numbers) {
      this.episode.data.cells.forEach((cell, k) => {
        const dark = belief && this.episode.share(step, k) > 0.3 * this.episode.data.top;
        this.text(context, `${k + 1}`, this.pixel(cell.at), 11 * (this.fine / this.unit), dark ? theme.page : theme.text);
      });
    }
  }

  wallLines(context) {
    this.metric(context);
    context.lineJoin = "round";
    context.strokeStyle = this.theme.wall;
    context.lineWidth = (3 * this.fine) / this.scale;
    context.stroke(this.space);
    context.setTransform(1, 0, 0, 1, 0, 0);
  }

  disc(context, [x, y], radius, colour) {
    context.fillStyle = colour;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fill();
  }

  text(context, text, [x, y], size, colour, weight = 600) {
    context.font = `${weight} ${size * this.unit}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillStyle = colour;
    context.fillText(text, x, y + 0.05 * size * this.unit);
  }

  polyline(context, points) {
    context.beginPath();
    points.forEach((point, k) => context[k ? "lineTo" : "moveTo"](...this.pixel(point)));
  }

  draw(t) {
    const { episode, theme, unit, layers } = this, context = this.canvas.getContext("2d");
    const where = episode.between(t), captured = episode.captured(t), data = episode.data;
    this.paintBase(episode.beliefStep(t));
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.globalAlpha = 1;
    context.drawImage(this.base, 0, 0);
    context.lineJoin = context.lineCap = "round";
    const team = [...Array(data.robots).keys()], colour = (r) => theme.robots[r % theme.robots.length];
    if (layers.sight) {
      for (const r of team) this.sight(context, r, where, theme.lit[r % theme.lit.length]);
      this.wallLines(context); // they lie above what is seen
    }
    if (layers.trails) for (const r of team) this.trail(context, episode.trail(r, where, t, 20), colour(r));
    if (layers.plans && !captured) for (const r of team) this.plan(context, episode.route(r, where, t), r, colour(r));
    if (captured && data.outcome.robot) {
      const last = episode.evader(data.outcome.evader, where);
      this.polyline(context, [episode.position(data.outcome.robot - 1, where), last]);
      context.strokeStyle = theme.evader;
      context.lineWidth = 2 * unit;
      context.stroke();
    }
    const bodies = team.map((r) => episode.position(r, where)), shown = [];
    for (let k = 0; k < data.evaders; k++) {
      if (layers.evader || episode.caught(k, t)) shown.push(k); // what is hidden must not push what is shown
    }
    const places = apart([...bodies, ...shown.map((k) => episode.evader(k, where))].map((body) => this.pixel(body)), 19 * unit);
    shown.forEach((k, n) => this.evader(context, places[data.robots + n], episode.caught(k, t), data.evaders > 1 ? `E${k + 1}` : "E"));
    const last = captured && data.outcome.robot ? data.outcome.robot - 1 : data.robots - 1;
    for (const r of [...team.filter((r) => r !== last), last]) this.robot(context, r, places[r], episode.heading(r, where), colour(r));
  }

  sight(context, robot, where, colour) {
    const { eyes, byCell } = this.episode.data.sight, { range, field } = eyes[robot];
    const eye = this.episode.position(robot, where);
    context.save();
    context.globalAlpha = 0.38;
    context.fillStyle = colour;
    if (byCell) {
      const [x, y] = this.pixel(eye);
      this.metric(context);
      const cell = this.cells.find((path) => context.isPointInPath(path, x, y, "evenodd"));
      if (cell) context.fill(cell, "evenodd");
    } else {
      const reach = range === null ? Infinity : range * 100;
      this.polyline(context, this.walls.seenFrom(eye, reach, this.episode.heading(robot, where), field));
      context.fill();
    }
    context.restore();
  }

  trail(context, points, colour) {
    context.strokeStyle = colour;
    const parts = 8;
    for (let k = 0; k < parts; k++) {
      const from = Math.floor((k * (points.length - 1)) / parts), to = Math.floor(((k + 1) * (points.length - 1)) / parts);
      if (to <= from) continue;
      this.polyline(context, points.slice(from, to + 1));
      context.lineWidth = (0.8 + (1.8 * k) / parts) * this.unit;
      context.stroke();
    }
  }

  // Ways that robots share are drawn side by side.
  plan(context, points, robot, colour) {
    if (points.length < 2) return;
    const { unit } = this, others = this.episode.data.robots - 1;
    const aside = (robot - others / 2) * Math.min(3, 9 / Math.max(others, 1)) * unit;
    let left = 0;
    for (let k = 1; k < points.length; k++) left += this.scale * Math.hypot(points[k][0] - points[k - 1][0], points[k][1] - points[k - 1][1]);
    context.save();
    context.lineCap = "butt";
    context.strokeStyle = colour;
    context.lineWidth = 1.8 * unit;
    context.setLineDash([7 * unit, 5 * unit]);
    context.lineDashOffset = -left; // dashes stand still while the robot moves
    context.translate(aside, aside);
    this.polyline(context, points);
    context.stroke();
    context.restore();
    const end = this.pixel(points[points.length - 1]).map((v) => v + aside);
    this.disc(context, end, 4.5 * unit, colour);
    this.disc(context, end, 2.6 * unit, this.theme.casing);
  }

  robot(context, number, [x, y], heading, colour) {
    const { unit, theme } = this, radius = 9.5 * unit;
    for (const [grown, fill] of [[1.8 * unit, theme.casing], [0, colour]]) {
      this.disc(context, [x, y], radius + grown, fill);
      context.beginPath();
      for (const [reach, turn] of [[(radius + grown) * 1.45, 0], [radius + grown, 0.62], [radius + grown, -0.62]]) {
        context.lineTo(x + reach * Math.cos(-heading + turn), y + reach * Math.sin(-heading + turn));
      }
      context.fill();
    }
    this.text(context, `${number + 1}`, [x, y], 12.5, theme.label, 700);
  }

  evader(context, [x, y], captured, name) {
    const { unit, theme } = this, radius = 12 * unit;
    if (captured) {
      context.beginPath();
      context.arc(x, y, radius + 6 * unit, 0, 2 * Math.PI);
      context.strokeStyle = theme.evader;
      context.lineWidth = 2.2 * unit;
      context.stroke();
    }
    for (const [grown, fill] of [[2.4 * unit, theme.casing], [0, theme.evader]]) {
      const reach = radius + grown;
      context.fillStyle = fill;
      context.beginPath();
      for (const [dx, dy] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) context.lineTo(x + reach * dx, y + reach * dy);
      context.fill();
    }
    this.text(context, name, [x, y], 11.5, theme.label, 700);
  }
}

// Places in pixels, moved away from each other until no two are nearer than a distance, or nearly so.
function apart(places, distance) {
  const turn = (2 * Math.PI) / places.length, nudge = 1e-3 * distance; // places that coincide part in directions of their own
  const moved = places.map(([x, y], k) => [x + nudge * Math.cos(k * turn), y + nudge * Math.sin(k * turn)]);
  for (let round = 0; round < 60; round++) {
    const shift = moved.map(() => [0, 0]);
    let most = 0;
    for (let i = 0; i < moved.length; i++) {
      for (let j = 0; j < i; j++) {
        const dx = moved[i][0] - moved[j][0], dy = moved[i][1] - moved[j][1], away = Math.hypot(dx, dy);
        if (away >= distance) continue;
        const push = (distance - away) / 4 / Math.max(away, 1e-9);
        shift[i][0] += dx * push; shift[i][1] += dy * push;
        shift[j][0] -= dx * push; shift[j][1] -= dy * push;
        most = Math.max(most, distance - away);
      }
    }
    if (most < 0.01 * distance) break;
    moved.forEach((place, k) => { place[0] += shift[k][0]; place[1] += shift[k][1]; });
  }
  return moved;
}

// The chance of capture over time: what is past drawn full, what is to come faint.
function drawCurve(canvas, episode, theme, t) {
  const ratio = window.devicePixelRatio || 1, context = canvas.getContext("2d");
  canvas.width = Math.round(canvas.clientWidth * ratio);
  canvas.height = Math.round(canvas.clientHeight * ratio);
  context.scale(ratio, ratio);
  const width = canvas.clientWidth, height = canvas.clientHeight, top = 16, bottom = height - 4;
  const x = (time) => 8 + (time / Math.max(episode.end, 1e-9)) * (width - 16);
  const y = (value) => bottom - value * (bottom - top);
  context.font = "12px system-ui, sans-serif";
  context.fillStyle = theme.muted;
  context.fillText("chance of capture by now, as the belief predicts", 8, 11);
  context.strokeStyle = theme.grid;
  for (const value of [0, 0.5, 1]) { context.beginPath(); context.moveTo(x(0), y(value)); context.lineTo(x(episode.end), y(value)); context.stroke(); }
  const curve = (until) => {
    context.beginPath();
    context.moveTo(x(0), y(episode.capture(0)));
    for (const time of episode.data.beliefTimes) if (time <= until) context.lineTo(x(time), y(episode.capture(time)));
    context.lineTo(x(until), y(episode.capture(until)));
  };
  context.strokeStyle = context.fillStyle = theme.curve;
  context.lineWidth = 1.5;
  context.globalAlpha = 0.35;
  curve(episode.end);
  context.stroke();
  context.globalAlpha = 0.2;
  curve(t);
  context.lineTo(x(t), y(0));
  context.lineTo(x(0), y(0));
  context.fill();
  context.globalAlpha = 1;
  context.lineWidth = 2.2;
  curve(t);
  context.stroke();
  const now = episode.capture(t), right = x(t) > width - 60;
  if (episode.data.outcome.captured) {
    context.fillStyle = theme.evader;
    context.fillRect(x(episode.data.outcome.time) - 1, y(1), 2, y(0) - y(1));
  }
  context.fillStyle = theme.curve;
  context.beginPath();
  context.arc(x(t), y(now), 4, 0, 2 * Math.PI);
  context.fill();
  context.fillStyle = theme.text;
  context.font = "600 13px system-ui, sans-serif";
  context.textAlign = right ? "right" : "left";
  context.fillText(`${Math.round(100 * now)} %`, x(t) + (right ? -9 : 9), Math.max(y(now) - 3, 24));
}
