// The player of one run, or of two beside each other: one clock that map, pictures, curves and timeline follow.
//
// Keys: space plays and pauses; left and right go a recorded step, with shift a second; home and end; up and down change
// the speed; + and - zoom, F follows the vehicle, R turns the map with it, A shows all. The page's address keeps the moment:
// #t=8.2, and #run-2&t=8.2 where there are several runs.

import { Curves } from "pages/curves.js";
import { Run, shown, unpack } from "pages/data.js";
import { MapView } from "pages/map.js";
import { element, Timeline } from "pages/timeline.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];

/** The moment that the page's address names: {anchor, t}; t is NaN without one. */
export function moment() {
  const parts = location.hash.slice(1).split("&");
  const time = parts.find((part) => part.startsWith("t="));
  return { anchor: parts.find((part) => part && !part.includes("=")) ?? "", t: time ? Number(time.slice(2)) : NaN };
}

export class Player {
  /**
   * @param root Element that the player goes into; its id is that of the run in the page's address.
   * @param runs One run, or two.
   * @param pictures For each run its first-person pictures, ordered by time: [{t, label, src}].
   */
  constructor(root, runs, pictures) {
    this.root = root;
    this.runs = runs;
    this.pictures = pictures;
    this.begin = Math.min(...runs.map((run) => run.begin));
    this.end = Math.max(...runs.map((run) => run.end));
    this.speed = 1;
    this.playing = false;
    this.t = this.begin;
    root.replaceChildren();
    root.classList.add("ready");
    root.classList.toggle("two", runs.length > 1);
    this.#buildStage();
    this.#buildControls();
    this.timeline = new Timeline(element("div", "timeline", root), runs, (t) => this.seek(t));
    this.curves = new Curves(
      element("div", "curves", root),
      runs,
      (t) => this.seek(t),
      (range) => this.timeline.scale(range),
    );
    root.addEventListener("keydown", (event) => this.#key(event));
    this.show(this.begin);
  }

  /** Continue, from the start if the run is over. */
  play() {
    if (this.t >= this.end - 1e-6) this.show(this.begin);
    this.playing = true;
    this.#label();
    cancelAnimationFrame(this.ticking); // of a play that was paused since the last frame
    let before = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      this.show(this.t + ((now - before) / 1000) * this.speed);
      before = now;
      if (this.t >= this.end - 1e-6) this.pause();
      else this.ticking = requestAnimationFrame(tick);
    };
    this.ticking = requestAnimationFrame(tick);
  }

  /** Pause, and keep the moment in the page's address. */
  pause() {
    this.playing = false;
    this.#label();
    this.#keep();
  }

  /** Go to a time and stay there if the player is paused. */
  seek(t) {
    this.show(t);
    if (!this.playing) this.#keep();
  }

  /** Move by a number of recorded rows of the first run, or of the other one where the first is over. */
  step(rows) {
    this.playing = false;
    this.#label();
    const end = this.t + (rows > 0 ? 1e-6 : -1e-6);
    const run = this.runs.find((one) => one.end > end) ?? this.runs[0];
    const row = Math.min(run.t.length - 1, Math.max(0, run.row(this.t) + rows));
    this.seek(run.t[row]);
  }

  /** Show a time: each part shows the last recorded row that is not after it. */
  show(t) {
    this.t = Math.min(this.end, Math.max(this.begin, Number.isFinite(t) ? t : this.begin));
    this.runs.forEach((run, number) => {
      const row = run.row(this.t);
      this.maps[number].show(row);
      this.#showPicture(number);
      this.#tell(number, row);
    });
    this.clock.textContent = shown(this.t, "s");
    this.timeline?.show(this.t);
    this.curves?.show(this.t);
  }

  #buildStage() {
    const stage = element("div", "stage", this.root);
    this.maps = [];
    this.views = [];
    this.told = [];
    this.runs.forEach((run, number) => {
      const pane = element("div", "pane", stage);
      if (this.runs.length > 1) element("h2", "part", pane).textContent = `${number + 1}: ${run.name}`;
      const sights = element("div", "sights", pane);
      if (run.pictured) {
        const figure = element("figure", "view", sights);
        const image = element("img", "", figure);
        image.alt = "View ahead";
        this.views.push({ figure, image, caption: element("figcaption", "", figure) });
      } else {
        this.views.push(null);
      }
      const chart = element("div", "chart", sights);
      const canvas = element("canvas", "", chart);
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", `Map of ${run.name}, seen from above`);
      const tip = element("div", "tip", chart);
      tip.hidden = true;
      this.#buildMapButtons(chart, number);
      this.maps.push(new MapView(canvas, run, tip));
      canvas.addEventListener("viewchange", () => this.#label());
      this.told.push(element("dl", "values", pane));
    });
  }

  #buildMapButtons(chart, number) {
    const bar = element("div", "mapbar", chart);
    const map = () => this.maps[number];
    button(bar, "+", "Zoom in (+)", () => map().zoom(1.4));
    button(bar, "−", "Zoom out (-)", () => map().zoom(1 / 1.4));
    button(bar, "All", "Show the whole run (A)", () => map().fit());
    const follow = button(bar, "Follow", "Follow the vehicle (F)", () => map().follow(!map().following));
    const turn = button(bar, "Turn", "Turn the map with the vehicle (R)", () => {
      map().turn(!map().turned);
      this.#label();
    });
    this.toggles = [...(this.toggles ?? []), { follow, turn, number }];
  }

  #buildControls() {
    const bar = element("div", "controls", this.root);
    button(bar, "|‹", "To the start (home)", () => this.seek(this.begin));
    button(bar, "‹", "A step back (left)", () => this.step(-1));
    this.button = button(bar, "Play", "Play (space)", () => this.toggle());
    this.button.classList.add("main");
    button(bar, "›", "A step on (right)", () => this.step(1));
    button(bar, "›|", "To the end (end)", () => this.seek(this.end));
    this.clock = element("output", "clock", bar);
    const label = element("label", "", bar);
    label.append("Speed ");
    this.select = element("select", "", label);
    for (const speed of SPEEDS) this.select.add(new Option(`${speed} ×`, speed, speed === 1, speed === 1));
    this.select.addEventListener("change", () => {
      this.speed = Number(this.select.value);
    });
    button(bar, "All times", "Show all times in the curves", () => this.curves.zoom());
    element("span", "hint", bar).textContent = "Space plays, ← → step, drag in a curve zooms, double click shows all";
  }

  /** Play or pause. */
  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  #label() {
    if (!this.button) return;
    this.button.textContent = this.playing ? "Pause" : "Play";
    this.button.title = this.playing ? "Pause (space)" : "Play (space)";
    this.button.setAttribute("aria-label", this.button.title);
    for (const { follow, turn, number } of this.toggles) {
      follow.setAttribute("aria-pressed", this.maps[number].following);
      turn.setAttribute("aria-pressed", this.maps[number].turned);
    }
  }

  #showPicture(number) {
    const view = this.views[number];
    if (!view) return;
    const list = this.pictures[number];
    let at = 0;
    while (at + 1 < list.length && list[at + 1].t <= this.t + 1e-6) at++;
    const picture = list[at];
    if (view.shown === picture) return;
    view.shown = picture;
    view.image.src = picture.src;
    view.caption.textContent = `View ahead at ${shown(picture.t, "s")}${picture.label ? `: ${picture.label}` : ""}`;
  }

  #tell(number, row) {
    const run = this.runs[number];
    const value = (name) => run.value(name, row);
    const state = run.states.length ? run.state(this.t) : null;
    const speed = value("v");
    const rows = [
      ...(state ? [["state", state[2]]] : []),
      ["speed", `${shown(speed, "m/s", 1)} (${shown(3.6 * speed, "km/h", 0)})`],
      ["acceleration", shown(value("a"), "m/s²", 1)],
    ];
    if (run.automated) {
      rows.push(["confidence left, right", `${shown(value("confidence_left"))}, ${shown(value("confidence_right"))}`]);
      rows.push(["path", this.#path(run, row)]);
    }
    if (this.t > run.end + 1e-6) rows[0][1] += ` (the run ended at ${shown(run.end, "s")})`;
    const list = this.told[number];
    while (list.children.length < rows.length) {
      const item = element("div", "", list);
      element("dt", "", item);
      element("dd", "", item);
    }
    rows.forEach(([name, text], k) => {
      const [term, told] = list.children[k].children;
      if (term.textContent !== name) term.textContent = name;
      if (told.textContent !== text) told.textContent = text;
    });
  }

  #path(run, row) {
    const away = run.value("blocked_distance", row);
    if (!Number.isFinite(away)) return "free";
    const by = run.entities[run.blocked.by[row]]?.id;
    return `blocked${by ? ` by ${by}` : ""} in ${shown(away, "m", 1)}`;
  }

  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const within = event.target;
    if (within instanceof HTMLSelectElement) return;
    if (within instanceof HTMLButtonElement && (event.key === " " || event.key === "Enter")) return;
    const speed = (change) => {
      const at = SPEEDS.indexOf(this.speed) + change;
      this.speed = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, at))];
      this.select.value = this.speed;
    };
    const each = (action) => () => this.maps.forEach(action);
    const actions = {
      " ": () => this.toggle(),
      ArrowLeft: () => (event.shiftKey ? this.seek(this.t - 1) : this.step(-1)),
      ArrowRight: () => (event.shiftKey ? this.seek(this.t + 1) : this.step(1)),
      Home: () => this.seek(this.begin),
      End: () => this.seek(this.end),
      ArrowUp: () => speed(1),
      ArrowDown: () => speed(-1),
      "+": each((map) => map.zoom(1.4)),
      "-": each((map) => map.zoom(1 / 1.4)),
      f: each((map) => map.follow(!map.following)),
      r: each((map) => map.turn(!map.turned)),
      a: each((map) => map.fit()),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
    this.#label();
  }

  #keep() {
    if (location.protocol === "about:") return; // a page in a notebook has no address
    const anchor = this.root.dataset.anchor;
    const time = `t=${Number(this.t.toFixed(4))}`;
    history.replaceState(null, "", `#${anchor ? `${anchor}&` : ""}${time}`);
  }
}

function button(parent, text, title, action) {
  const made = element("button", "", parent);
  made.type = "button";
  made.textContent = text;
  made.title = title;
  made.setAttribute("aria-label", title);
  made.addEventListener("click", action);
  return made;
}

/** Fill a place in the page: unpack its runs and pictures and put a player there. */
async function fill(place) {
  const texts = [...place.querySelectorAll("script.run")].map((one) => one.textContent);
  const runs = (await Promise.all(texts.map(unpack))).map((one) => new Run(one));
  const pictures = [...place.querySelectorAll("script.pictures")].map((one) =>
    JSON.parse(one.textContent).map((picture) => ({
      ...picture,
      src: picture.src.startsWith("#") ? document.querySelector(picture.src).src : picture.src,
    })),
  );
  place.player = new Player(place, runs, pictures);
  return place.player;
}

/** Fill every place for a player, each when it comes into view, and go to the moment that the address names. */
export function start() {
  const places = [...document.querySelectorAll(".player")];
  const filled = new Map();
  const once = (place) => {
    if (!filled.has(place)) filled.set(place, fill(place));
    return filled.get(place);
  };
  const watch = new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) once(entry.target);
  });
  places.forEach((place) => watch.observe(place));
  const follow = async () => {
    const named = location.hash;
    const { anchor, t } = moment();
    const place = places.find((one) => one.dataset.anchor === anchor) ?? (places.length === 1 ? places[0] : null);
    if (!place || !Number.isFinite(t)) return;
    const player = await once(place);
    if (location.hash !== named) return; // another moment was chosen while this run was unpacked
    player.show(t);
    place.scrollIntoView({ block: "start" });
  };
  addEventListener("hashchange", follow);
  // A key that nothing else handles goes to the only player of the page.
  document.addEventListener("keydown", (event) => {
    const player = places.length === 1 ? places[0].player : null;
    if (player && (event.target === document.body || event.target === document.documentElement)) {
      if (!player.root.dispatchEvent(new KeyboardEvent("keydown", event))) event.preventDefault();
    }
  });
  follow();
}

start();
