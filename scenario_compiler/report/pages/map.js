// The bird's-eye view: roads, vehicles, what blocks the path; zoomed by wheel, pinch and keys, moved by dragging.

import { points, shown } from "pages/data.js";

const LEAST = 0.2; // pixels a metre
const MOST = 60;
const TRAIL = 5; // seconds
const AHEAD = 0.28; // how far behind the middle the followed vehicle is, as a share of the picture

export class MapView {
  /**
   * @param canvas Where it is drawn.
   * @param run The run that it shows.
   * @param tip Element that what the pointer is over is written into.
   */
  constructor(canvas, run, tip) {
    this.canvas = canvas;
    this.run = run;
    this.tip = tip;
    this.following = true;
    this.turned = false;
    this.scale = 6;
    this.centre = [0, 0];
    this.angle = 0;
    this.row = 0;
    this.pointers = new Map();
    this.#prepare();
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    this.#resize();
  }

  /** Show a row. */
  show(row) {
    this.row = row;
    this.draw();
  }

  /** Let the view follow the first vehicle, or stay where it is. */
  follow(on) {
    this.following = on;
    this.draw();
    this.canvas.dispatchEvent(new Event("viewchange"));
  }

  /** Turn the view so that the first vehicle points up, or north is up. */
  turn(on) {
    this.turned = on;
    this.draw();
  }

  /** Zoom by a factor about a point of the canvas, its middle by default. */
  zoom(factor, at = [this.width / 2, this.height / 2]) {
    const before = this.#world(at);
    this.scale = Math.min(MOST, Math.max(LEAST, this.scale * factor));
    if (!this.following) {
      const after = this.#world(at);
      this.centre = [this.centre[0] + before[0] - after[0], this.centre[1] + before[1] - after[1]];
    }
    this.draw();
  }

  /** Show the whole path of the first vehicle. */
  fit() {
    this.following = false;
    this.turned = false;
    this.angle = 0;
    const { x, y } = this.run.columns;
    const xs = x.data[0].filter(Number.isFinite);
    const ys = y.data[0].filter(Number.isFinite);
    if (!xs.length) return;
    const [[left, right], [bottom, top]] = [extent(xs), extent(ys)];
    this.centre = [(left + right) / 2, (bottom + top) / 2];
    const room = 40;
    this.scale = Math.min(
      MOST,
      Math.max(LEAST, Math.min(this.width / (right - left + room), this.height / (top - bottom + room))),
    );
    this.draw();
    this.canvas.dispatchEvent(new Event("viewchange"));
  }

  #prepare() {
    const { step, strips, marks } = this.run.roadmap;
    this.strips = new Map();
    for (const [kind, steps] of strips) {
      const path = this.strips.get(kind) ?? new Path2D();
      trace(path, points(steps, step), true);
      this.strips.set(kind, path);
    }
    this.marks = new Map();
    for (const [colour, broken, quality, steps] of marks) {
      const look = `${colour}|${broken}|${quality}`;
      const mark = this.marks.get(look) ?? { colour, broken, quality, path: new Path2D() };
      trace(mark.path, points(steps, step), false);
      this.marks.set(look, mark);
    }
  }

  #listen() {
    const canvas = this.canvas;
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(Math.exp(-event.deltaY * 0.0015), this.#at(event));
      },
      { passive: false },
    );
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, this.#at(event));
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = this.pointers.get(event.pointerId);
      const now = this.#at(event);
      if (!before) return this.#point(now);
      if (this.pointers.size === 1) this.#drag(before, now);
      else this.#pinch(event.pointerId, before, now);
      this.pointers.set(event.pointerId, now);
    });
    for (const kind of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(kind, (event) => this.pointers.delete(event.pointerId));
    }
    canvas.addEventListener("pointerleave", () => this.#point(null));
  }

  #drag(before, now) {
    if (this.following) {
      this.centre = this.#focus();
      this.follow(false);
    }
    const [a, b] = [this.#world(before), this.#world(now)];
    this.centre = [this.centre[0] + a[0] - b[0], this.centre[1] + a[1] - b[1]];
    this.draw();
  }

  #pinch(moved, before, now) {
    const other = [...this.pointers].find(([id]) => id !== moved)[1];
    const factor = distance(now, other) / Math.max(distance(before, other), 1);
    this.zoom(factor, [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
  }

  #point(at) {
    const over = at ? this.#entityAt(at) : -1;
    this.tip.hidden = over < 0;
    this.pointed = over;
    if (over >= 0) {
      this.tip.textContent = this.#told(over);
      this.tip.style.left = `${Math.min(at[0] + 14, Math.max(0, this.width - this.tip.offsetWidth - 4))}px`;
      this.tip.style.top = `${Math.min(at[1] + 14, Math.max(0, this.height - this.tip.offsetHeight - 4))}px`;
    }
  }

  #told(entity) {
    const { run, row } = this;
    const road = run.roads[run.value("road", row, entity)];
    const lines = [
      run.entities[entity].id,
      `speed ${shown(run.value("v", row, entity), "m/s")} (${shown(3.6 * run.value("v", row, entity), "km/h", 0)})`,
      `acceleration ${shown(run.value("a", row, entity), "m/s²")}`,
      road === undefined
        ? "off every road"
        : `road ${road}, lane ${run.value("lane", row, entity).toFixed(0)}, s ${shown(run.value("s", row, entity), "m", 1)}`,
    ];
    if (entity > 0 && run.present(row, 0)) {
      const dx = run.value("x", row, entity) - run.value("x", row, 0);
      const dy = run.value("y", row, entity) - run.value("y", row, 0);
      lines.push(`${shown(Math.hypot(dx, dy), "m", 1)} from ${run.entities[0].id}`);
    }
    if (run.blocked.by[row] === entity) lines.push("blocks the path");
    return lines.join("\n");
  }

  #entityAt(at) {
    const [x, y] = this.#world(at);
    const slack = 6 / this.scale;
    for (let i = 0; i < this.run.entities.length; i++) {
      if (!this.run.present(this.row, i)) continue;
      const { length, width, center } = this.run.entities[i];
      const h = this.run.value("h", this.row, i);
      const dx = x - this.run.value("x", this.row, i);
      const dy = y - this.run.value("y", this.row, i);
      const along = dx * Math.cos(h) + dy * Math.sin(h) - center;
      const across = dy * Math.cos(h) - dx * Math.sin(h);
      if (Math.abs(along) < length / 2 + slack && Math.abs(across) < width / 2 + slack) return i;
    }
    return -1;
  }

  /** Centre of the view while it follows: ahead of the vehicle, which stays within the rear part of the view. */
  #focus() {
    const i = this.run.entities.findIndex((_, k) => this.run.present(this.row, k));
    if (i < 0) return this.centre;
    const h = this.run.value("h", this.row, i);
    const [c, s] = [Math.cos(h), Math.sin(h)];
    const seen = this.turned ? this.height : this.width * Math.abs(c) + this.height * Math.abs(s);
    const ahead = (AHEAD * seen) / this.scale;
    return [this.run.value("x", this.row, i) + ahead * c, this.run.value("y", this.row, i) + ahead * s];
  }

  #at(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  #world([u, v]) {
    const [x, y] = [(u - this.width / 2) / this.scale, (this.height / 2 - v) / this.scale];
    const [c, s] = [Math.cos(this.angle), Math.sin(this.angle)];
    return [this.centre[0] + x * c - y * s, this.centre[1] + x * s + y * c];
  }

  #pixel(x, y) {
    const [dx, dy] = [x - this.centre[0], y - this.centre[1]];
    const [c, s] = [Math.cos(this.angle), Math.sin(this.angle)];
    return [this.width / 2 + (dx * c + dy * s) * this.scale, this.height / 2 - (dy * c - dx * s) * this.scale];
  }

  #resize() {
    const box = this.canvas.getBoundingClientRect();
    if (!box.width) return;
    this.width = box.width;
    this.height = box.height;
    this.dots = globalThis.devicePixelRatio || 1;
    this.canvas.width = Math.round(box.width * this.dots);
    this.canvas.height = Math.round(box.height * this.dots);
    this.draw();
  }

  draw() {
    if (!this.width) return;
    if (this.following && this.turned && this.run.present(this.row, 0)) {
      this.angle = this.run.value("h", this.row, 0) - Math.PI / 2;
    } else if (!this.turned) {
      this.angle = 0;
    }
    if (this.following) this.centre = this.#focus();
    const style = getComputedStyle(this.canvas);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    const ink = this.canvas.getContext("2d");
    ink.setTransform(this.dots, 0, 0, this.dots, 0, 0);
    ink.fillStyle = colour("page");
    ink.fillRect(0, 0, this.width, this.height);
    this.#drawRoads(ink, colour);
    this.#drawTrails(ink, colour);
    this.#drawBlock(ink, colour);
    this.#drawEntities(ink, colour);
    this.#drawScale(ink, colour);
  }

  /** Set the unit of lengths to metres, with x east and y north. */
  #inMetres(ink) {
    ink.setTransform(this.dots, 0, 0, this.dots, 0, 0);
    ink.translate(this.width / 2, this.height / 2);
    ink.scale(this.scale, -this.scale);
    ink.rotate(-this.angle);
    ink.translate(-this.centre[0], -this.centre[1]);
  }

  #drawRoads(ink, colour) {
    ink.save();
    this.#inMetres(ink);
    for (const kind of ["verge", "pavement", "asphalt"]) {
      const path = this.strips.get(kind);
      if (!path) continue;
      ink.fillStyle = ink.strokeStyle = colour(kind);
      ink.lineWidth = 0.5 / this.scale;
      ink.fill(path);
      ink.stroke(path);
    }
    for (const mark of this.marks.values()) {
      ink.strokeStyle = mark.colour || colour("paint");
      ink.globalAlpha = 0.15 + 0.85 * mark.quality;
      ink.lineWidth = Math.max(0.15, 0.7 / this.scale);
      ink.setLineDash(mark.broken ? [3, 3] : []);
      ink.stroke(mark.path);
    }
    ink.restore();
  }

  #drawTrails(ink, colour) {
    const { x, y } = this.run.columns;
    const since = this.run.row(this.run.t[this.row] - TRAIL);
    ink.save();
    ink.lineWidth = 2;
    ink.globalAlpha = 0.55;
    for (let i = 0; i < this.run.entities.length; i++) {
      ink.strokeStyle = i === 0 ? colour("ego") : colour("ink");
      ink.beginPath();
      let open = false;
      for (let row = since; row <= this.row; row++) {
        if (!Number.isFinite(x.data[i][row])) {
          open = false;
          continue;
        }
        const [u, v] = this.#pixel(x.data[i][row], y.data[i][row]);
        if (open) ink.lineTo(u, v);
        else ink.moveTo(u, v);
        open = true;
      }
      ink.stroke();
    }
    ink.restore();
  }

  /** Mark where the path is blocked: a bar across the lane, as wide as a lane. */
  #drawBlock(ink, colour) {
    const { x, y, h } = this.run.blocked;
    if (!Number.isFinite(x[this.row])) return;
    const [s, c] = [Math.sin(h[this.row]), Math.cos(h[this.row])];
    const a = this.#pixel(x[this.row] - 1.7 * s, y[this.row] + 1.7 * c);
    const b = this.#pixel(x[this.row] + 1.7 * s, y[this.row] - 1.7 * c);
    ink.save();
    ink.lineCap = "round";
    for (const [width, name] of [[7, "paper"], [4, "block"]]) {
      ink.lineWidth = width;
      ink.strokeStyle = colour(name);
      ink.beginPath();
      ink.moveTo(...a);
      ink.lineTo(...b);
      ink.stroke();
    }
    ink.restore();
  }

  #drawEntities(ink, colour) {
    const blocker = this.run.blocked.by[this.row];
    const state = this.run.states.length ? this.run.state(this.run.t[this.row]) : null;
    const boxes = [];
    for (let i = this.run.entities.length - 1; i >= 0; i--) {
      if (!this.run.present(this.row, i)) continue;
      const box = this.#outline(i);
      if (box.every(([u, v]) => u < -40 || v < -40 || u > this.width + 40 || v > this.height + 40)) continue;
      ink.beginPath();
      box.forEach(([u, v], k) => (k ? ink.lineTo(u, v) : ink.moveTo(u, v)));
      ink.closePath();
      ink.fillStyle = i === 0 ? (state?.[3] ?? colour("ego")) : colour("paper");
      ink.strokeStyle = i === blocker ? colour("block") : colour("ink");
      ink.lineWidth = i === blocker ? 3 : i === 0 ? 2 : 1.2;
      ink.fill();
      ink.stroke();
      boxes.push({ entity: i, box });
    }
    this.#writeLabels(ink, colour, boxes, blocker);
  }

  #outline(i) {
    const { length, width, center } = this.run.entities[i];
    const h = this.run.value("h", this.row, i);
    const [c, s] = [Math.cos(h), Math.sin(h)];
    const grown = Math.max(1, 9 / (length * this.scale));
    const x = this.run.value("x", this.row, i) + center * c;
    const y = this.run.value("y", this.row, i) + center * s;
    const [a, b] = [(grown * length) / 2, (grown * width) / 2];
    const corners = [[a, 0], [0.62 * a, b], [-a, b], [-a, -b], [0.62 * a, -b]];
    return corners.map(([u, v]) => this.#pixel(x + u * c - v * s, y + u * s + v * c));
  }

  /** Label the first vehicle, then the blocking object, then the nearest ones; no text covers another. */
  #writeLabels(ink, colour, boxes, blocker) {
    ink.font = "12px system-ui, sans-serif";
    ink.textAlign = "center";
    ink.textBaseline = "middle";
    const middle = [this.width / 2, this.height / 2];
    const rank = ({ entity, box }) => (entity === 0 ? -2 : entity === blocker ? -1 : distance(box[0], middle));
    const taken = boxes.map(({ box }) => bounds(box));
    this.labels = [];
    for (const { entity, box } of boxes.sort((one, other) => rank(one) - rank(other))) {
      const id = this.run.entities[entity].id;
      const text = entity === blocker ? `${id}: blocks the path` : id;
      const [w, h] = [ink.measureText(text).width / 2 + 4, 9];
      const [left, top, right, bottom] = bounds(box);
      const [u, v] = [(left + right) / 2, (top + bottom) / 2];
      const spots = [
        [u, top - h - 3],
        [u, bottom + h + 3],
        [right + w + 3, v],
        [left - w - 3, v],
        [right + w, top - h],
        [left - w, bottom + h],
      ];
      const own = bounds(box);
      const spot = spots.find(([a, b]) => {
        const place = [a - w, b - h, a + w, b + h];
        const whole = place[0] >= 0 && place[1] >= 0 && place[2] <= this.width && place[3] <= this.height;
        return whole && !taken.some((other) => !same(other, own) && overlap(place, other));
      });
      if (!spot) continue;
      const place = [spot[0] - w, spot[1] - h, spot[0] + w, spot[1] + h];
      taken.push(place);
      this.labels.push({ text, place });
      ink.fillStyle = colour("paper");
      ink.globalAlpha = 0.85;
      ink.fillRect(place[0], place[1], 2 * w, 2 * h);
      ink.globalAlpha = 1;
      ink.fillStyle = entity === blocker ? colour("block") : colour("ink");
      ink.fillText(text, ...spot);
    }
  }

  #drawScale(ink, colour) {
    if (this.width < 120) return; // no room beside what is driven on
    const about = this.width / 5 / this.scale;
    const power = 10 ** Math.floor(Math.log10(about));
    const length = [5, 2, 1].map((step) => step * power).find((step) => step <= about);
    const [u, v] = [12, this.height - 12];
    ink.strokeStyle = ink.fillStyle = colour("ink");
    ink.lineWidth = 2;
    ink.beginPath();
    ink.moveTo(u, v);
    ink.lineTo(u + length * this.scale, v);
    ink.stroke();
    ink.font = "11px system-ui, sans-serif";
    ink.textAlign = "left";
    ink.textBaseline = "bottom";
    ink.fillText(`${length} m`, u, v - 4);
  }
}

function trace(path, flat, closed) {
  path.moveTo(flat[0], flat[1]);
  for (let k = 2; k < flat.length; k += 2) path.lineTo(flat[k], flat[k + 1]);
  if (closed) path.closePath();
}

/** Return the least and the greatest of any number of values; a call has room for some ten thousand arguments only. */
function extent(values) {
  return values.reduce(([least, most], value) => [Math.min(least, value), Math.max(most, value)], [Infinity, -Infinity]);
}

function distance(a, b) {
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}

function bounds(corners) {
  const [us, vs] = [corners.map((one) => one[0]), corners.map((one) => one[1])];
  return [Math.min(...us), Math.min(...vs), Math.max(...us), Math.max(...vs)];
}

function overlap(a, b) {
  return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}

function same(a, b) {
  return a.every((value, k) => value === b[k]);
}
