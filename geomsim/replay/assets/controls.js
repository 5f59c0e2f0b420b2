// The page: playing, scrubbing, keys, layers, and telling in words what is seen.

const percent = (share) => (share < 0.1 ? `${Number((100 * share).toPrecision(2))} %` : `${Math.round(100 * share)} %`);

class Player {
  constructor(episode) {
    this.episode = episode;
    this.time = 0;
    this.playing = false;
    this.last = 0;
    this.hovered = -1;
    this.element = (id) => document.getElementById(id);
    this.scene = new Scene(episode, this.element("floor"));
    this.step = episode.end / Math.max(episode.times.length - 1, 1);
    this.element("name").textContent = episode.data.name;
    this.element("scrub").max = episode.end;
    this.switchTheme(window.matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    this.listen();
    this.tell();
    document.documentElement.dataset.ready = "yes";
  }

  listen() {
    const on = (id, event, act) => this.element(id).addEventListener(event, act);
    on("play", "click", () => this.play(!this.playing));
    on("start", "click", () => this.jump(0));
    on("end", "click", () => this.jump(this.episode.end));
    on("back", "click", () => this.jump(this.time - this.step));
    on("ahead", "click", () => this.jump(this.time + this.step));
    on("scrub", "input", (event) => this.jump(Number(event.target.value), false));
    on("scrub", "change", () => this.tell());
    on("theme", "click", () => this.switchTheme());
    on("table", "toggle", () => this.list());
    on("floor", "pointermove", (event) => this.hover(event));
    on("floor", "pointerdown", (event) => this.hover(event));
    on("floor", "pointerleave", (event) => { if (event.pointerType !== "touch") this.hover(null); });
    const seek = (event) => {
      if (event.buttons) this.jump(((event.offsetX - 8) / (event.target.clientWidth - 16)) * this.episode.end);
    };
    on("curve", "pointerdown", seek);
    on("curve", "pointermove", seek);
    for (const box of document.querySelectorAll("[data-layer]")) {
      box.addEventListener("change", () => { this.scene.layers[box.dataset.layer] = box.checked; this.show(); });
    }
    document.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => { this.scene.resize(); this.show(); }).observe(this.element("stage"));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { target, key } = event;
    // A focused control keeps the keys that it needs itself.
    if (target.tagName === "SELECT" || (key === " " && /BUTTON|SUMMARY|INPUT/.test(target.tagName) && target.type !== "range")) return;
    const stride = this.step * (event.shiftKey ? 10 : 1), speed = this.element("speed");
    const slower = () => { speed.selectedIndex = Math.max(speed.selectedIndex - 1, 0); };
    const faster = () => { speed.selectedIndex = Math.min(speed.selectedIndex + 1, speed.length - 1); };
    const acts = {
      " ": () => this.play(!this.playing), ArrowLeft: () => this.jump(this.time - stride), ArrowRight: () => this.jump(this.time + stride),
      Home: () => this.jump(0), End: () => this.jump(this.episode.end), "<": slower, ">": faster, ",": slower, ".": faster,
      d: () => this.switchTheme(), D: () => this.switchTheme(),
    };
    const box = document.querySelectorAll("[data-layer]")[Number(key) - 1];
    if (key >= "1" && key <= "6" && box) box.click();
    else if (acts[key]) acts[key]();
    else return;
    event.preventDefault();
  }

  switchTheme(name) {
    const root = document.documentElement;
    root.dataset.theme = name || (root.dataset.theme === "dark" ? "light" : "dark");
    this.scene.theme = this.episode.data.themes[root.dataset.theme];
    const ramp = this.element("ramp"), context = ramp.getContext("2d"), colours = this.scene.theme.ramp;
    ramp.width = colours.length;
    ramp.height = 1;
    colours.forEach((colour, k) => { context.fillStyle = colour; context.fillRect(k, 0, 1, 1); });
    const top = this.episode.data.top;
    this.element("ticks").replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map((part) => {
      const tick = document.createElement("span");
      tick.textContent = percent(top * part * part);
      return tick;
    }));
    this.show();
  }

  play(playing) {
    if (playing && this.time >= this.episode.end) this.time = 0;
    this.playing = playing;
    this.element("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    this.element("play").classList.toggle("on", playing);
    if (playing) { this.last = performance.now(); requestAnimationFrame((now) => this.tick(now)); } else this.tell();
  }

  tick(now) {
    if (!this.playing) return;
    this.time = Math.min(this.time + (Math.max(now - this.last, 0) / 1000) * Number(this.element("speed").value), this.episode.end);
    this.last = now;
    this.show();
    if (this.time >= this.episode.end) this.play(false);
    else requestAnimationFrame((next) => this.tick(next));
  }

  jump(time, tell = true) {
    this.time = Math.min(Math.max(time, 0), this.episode.end);
    this.show();
    if (tell && !this.playing) this.tell();
  }

  show() {
    const { time, episode } = this, clock = `${time.toFixed(1)} s`;
    this.scene.draw(time);
    drawCurve(this.element("curve"), episode, this.scene.theme, time);
    this.element("clock").textContent = clock;
    this.element("scrub").value = time;
    this.element("scrub").setAttribute("aria-valuetext", clock);
    this.tip();
    if (!this.listed || performance.now() - this.listed > 500) this.list();
  }

  // Said aloud when the picture rests, not at every frame.
  tell() {
    const { episode, time } = this, { outcome } = episode.data, step = episode.beliefStep(time);
    const most = this.probable(step)[0];
    const words = [`${time.toFixed(1)} seconds. Chance of capture by now ${percent(episode.capture(time))}.`];
    if (episode.captured(time)) words.push(`Captured by robot ${outcome.robot} in cell ${outcome.cell}.`);
    else if (most) words.push(`If not captured, the evader is most probably in cell ${most.cell + 1}: ${percent(most.share)}.`);
    this.element("told").textContent = words.join(" ");
    this.list();
  }

  probable(step) {
    const shares = this.episode.data.cells.map((_, cell) => ({ cell, share: this.episode.share(step, cell) }));
    return shares.sort((a, b) => b.share - a.share);
  }

  list() {
    this.listed = performance.now();
    if (!this.element("table").open) return;
    const rows = this.probable(this.episode.beliefStep(this.time)).slice(0, 10).map(({ cell, share }) => {
      const row = document.createElement("tr");
      for (const told of [this.name(cell), percent(share), `${this.episode.data.cells[cell].area.toFixed(1)} m\u00B2`]) {
        row.insertCell().textContent = told;
      }
      return row;
    });
    document.querySelector("#table tbody").replaceChildren(...rows);
  }

  name(cell) {
    const { name } = this.episode.data.cells[cell];
    return name ? `${cell + 1} ${name}` : `${cell + 1}`;
  }

  hover(event) {
    this.pointer = event && [event.offsetX, event.offsetY];
    this.hovered = event ? this.scene.cellAt(...this.pointer) : -1;
    this.tip();
  }

  tip() {
    const tip = this.element("tip"), stage = this.element("stage");
    tip.hidden = this.hovered < 0;
    if (tip.hidden) return;
    const share = this.episode.share(this.episode.beliefStep(this.time), this.hovered);
    tip.textContent = `cell ${this.name(this.hovered)}: ${percent(share)} if not captured`;
    const [x, y] = this.pointer;
    tip.style.left = `${Math.max(0, Math.min(x + 14, stage.clientWidth - tip.offsetWidth))}px`;
    tip.style.top = `${y > tip.offsetHeight + 14 ? y - tip.offsetHeight - 10 : y + 18}px`;
  }
}

unpack(document.getElementById("record")).then((data) => { window.player = new Player(new Episode(data)); });
