// The page of a run in progress: it shows pictures and messages as they come, and sends the person's inputs.

import { allow, hush, load, speak, tone, vibrate } from "live/sounds.js";
import { SearchTask } from "live/search.js";
import { Calibration, Wheel } from "live/wheel.js";
import { MapView } from "pages/map.js";

const TELL_EVERY = 20; // milliseconds
const REPORT_EVERY = 1000;
const NO_PICTURE_AFTER = 1000; // milliseconds; a run that is behind still sends a picture every 200
const FOLLOWS_AFTER = 2000; // milliseconds, so that the page that drove is at the next step first, and drives again there
const base = document.body.dataset.base;
const one = (selector) => document.querySelector(selector);
const about = await described();

/** Return what the server says of the run, once it answers. A page whose step is over meanwhile is loaded again. */
async function described() {
  for (;;) {
    const answer = await fetch(`${base}/about`).catch(() => null);
    if (answer?.ok) return answer.json();
    await new Promise((later) => setTimeout(later, 1000));
    if (answer) location.reload();
  }
}

/** Return a text of the page in its language, with its placeholders filled. */
function words(key, ...values) {
  return values.reduce((text, value) => text.replace("{}", value), about.words[key]);
}

/** Write a text that may be read aloud, once for each of its values. */
function write(selector, text) {
  if (one(selector).textContent !== text) one(selector).textContent = text;
}

function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** The rows received so far, in the form that the map needs. */
class LiveRun {
  constructor(about) {
    Object.assign(this, { entities: about.entities, roadmap: about.roadmap, origin: about.origin, roads: [] });
    this.clear();
  }

  clear() {
    this.t = [];
    this.states = [];
    this.blocked = { x: [], y: [], h: [], by: [] };
    this.columns = Object.fromEntries(["x", "y", "h", "v"].map((name) => [name, { data: this.entities.map(() => []) }]));
  }

  add(about) {
    this.t.push(about.t);
    this.states = [[0, 0, words(about.state), about.colour]];
    this.blocked.x.push(NaN);
    this.blocked.by.push(-1);
    about.entities.forEach((place, i) => {
      const [x, y, h, v] = place ? [place[0] - this.origin[0], place[1] - this.origin[1], place[2], place[3]] : [NaN, NaN, NaN, NaN];
      Object.entries({ x, y, h, v }).forEach(([name, value]) => this.columns[name].data[i].push(value));
    });
  }

  row(t) {
    let row = this.t.length - 1;
    while (row > 0 && this.t[row] > t + 1e-6) row--;
    return Math.max(0, row);
  }

  value(name, row, entity = 0) {
    return this.columns[name]?.data[entity]?.[row] ?? NaN;
  }

  present(row, entity) {
    return Number.isFinite(this.columns.x.data[entity][row]);
  }

  state() {
    return this.states[0];
  }
}

class Page {
  constructor() {
    if (about.study) sessionStorage.clear(); // what was answered in the forms before has arrived
    this.about = about;
    this.wheel = new Wheel();
    this.run = new LiveRun(about);
    this.sent = new Map();
    this.seq = 0;
    this.seen = 0;
    this.stretch = 0; // of a run without a halt; pictures of an earlier one are not shown any more
    this.decoded = Promise.resolve(); // when the picture before is decoded
    this.samples = [];
    this.shown = [];
    this.offsets = [];
    this.map = null;
    this.told = [];
    this.mute = [];
    one("#summary").textContent = about.watched ? words("watched") : about.summary;
    one("#keys").hidden = one("#go").hidden = one("#calibrate").hidden = about.watched;
    this.wheel.listen(document.querySelectorAll("#touch button"));
    const calibration = new Calibration(one("#profile"), about.words);
    one("#calibrate").addEventListener("click", () => calibration.open());
    one("#go").addEventListener("click", () => (this.over ? location.reload() : this.start()));
    one("#held form").addEventListener("submit", (event) => this.answer(event));
    this.search = about.study?.search ? new SearchTask(one("#search"), about.study.search, (told) => this.say(told)) : null;
    load(about.sounds).finally(() => {
      this.loaded = true;
      this.allowStart();
    });
    for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, allow);
    document.addEventListener("visibilitychange", () => this.tell()); // what is let go: the next time is up to a second away
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${base}/socket${about.study ? `?step=${about.study.step}` : ""}`);
    this.socket.binaryType = "arraybuffer";
    this.socket.addEventListener("message", ({ data }) => {
      if (typeof data === "string") this.hear(JSON.parse(data));
      else this.take(data);
    });
    this.socket.addEventListener("close", () => {
      clearInterval(this.telling);
      clearInterval(this.reporting);
      one("#ended").textContent ||= words("gone");
      one("#start").hidden = false;
      this.role = undefined;
      this.allowStart();
      this.search?.hide();
      if (!this.about.watched) setTimeout(() => this.comeBack(), 1000);
    });
    this.socket.addEventListener("open", () => {
      this.say({ kind: "reports" }); // from now on, each picture that has been shown
      this.telling = setInterval(() => {
        this.tell();
        this.miss();
      }, TELL_EVERY);
      this.reporting = setInterval(() => this.report(), REPORT_EVERY);
    });
  }

  /** Load the page again once the server answers: it may have been started again, and stand at another step. */
  async comeBack() {
    const answer = await fetch(`${base}/about`).catch(() => null);
    if (answer) location.reload();
    else setTimeout(() => this.comeBack(), 1000);
  }

  say(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  start() {
    this.wheel.release();
    one("#start").hidden = true;
    one("#ended").textContent = "";
    one("#report").hidden = true;
    this.say({ kind: "start" });
    one("#go").blur();
  }

  hear(message) {
    if (message.role) this.seat(message.role);
    if (message.refused) location.reload(); // the session is paused, or at another step
    if (message.unwritten) this.finish({ end: `${words("broke_off")}: ${message.unwritten}`, kept: false });
    if (message.search) this.search.show(message.search);
    if (message.pong !== undefined) {
      const now = performance.now();
      this.offsets.push({ trip: now - message.pong, offset: message.at - (message.pong + now) / 2 });
      this.offsets = this.offsets.slice(-20);
    }
  }

  /** Drive, or watch; a page that watches drives when the one that drove is gone. */
  seat(role) {
    if (role === "driver" && this.over) setTimeout(() => location.reload(), FOLLOWS_AFTER); // the page that drove has gone on
    const ended = one("#ended");
    if (role === "viewer" && !this.about.watched) ended.textContent = words("other_page");
    else if (ended.textContent === words("other_page")) ended.textContent = "";
    one("#go").hidden = role === "viewer";
    one("#touch").hidden = role === "viewer" || !matchMedia("(pointer: coarse)").matches;
    this.role = role;
    this.allowStart();
    if (role === "driver") this.search?.ask();
    const reason = this.heldFor;
    if (!reason) return;
    this.heldFor = undefined; // whoever drives now is asked the questions
    this.hold(reason);
  }

  /** Let a run be started by the page that drives, once its sounds can be played. */
  allowStart() {
    one("#go").disabled = this.role !== "driver" || !this.loaded;
  }

  /** Forget the previous run: its rows, its messages, and the times of its inputs. */
  begin(run) {
    this.number = run;
    this.stretch += 1;
    this.run.clear();
    this.samples = [];
    this.sent.clear();
    this.told = [];
    this.mute = [];
    one("#told").hidden = true;
  }

  /** Send the person's inputs; every message has a number, which comes back with the picture that shows it. */
  tell() {
    if (this.role !== "driver" || !this.running) return;
    const told = this.wheel.read();
    this.seq += 1;
    this.sent.set(this.seq, performance.now());
    this.sent.delete(this.seq - 500);
    this.say({ kind: "input", seq: this.seq, ...told });
  }

  /** Say that pictures do not come any more: the road that is shown stands still, and inputs may not arrive. */
  miss() {
    const seconds = Math.floor((performance.now() - this.cameAt) / 1000);
    if (!this.running || 1000 * seconds < NO_PICTURE_AFTER) return;
    one("#behind").hidden = false;
    write("#behind", words("no_picture", seconds));
  }

  /** Take a message, and say when it has been dealt with: a page that is slow is sent fewer pictures. */
  async take(data) {
    try {
      await this.deal(data);
    } finally {
      this.say({ kind: "shown" });
    }
  }

  /** Take a picture, and show it when its files and those of the picture before it are decoded. */
  async deal(data) {
    const view = new DataView(data);
    const length = view.getUint32(0);
    const about = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
    if (about.end !== undefined) return this.finish(about);
    if (about.over) return this.wait();
    if (about.held !== undefined) return this.hold(about.held);
    if (about.run !== this.number) this.begin(about.run);
    const stretch = this.stretch;
    if (this.heldFor) this.wheel.forget(); // what was pressed meanwhile
    this.running = true;
    this.cameAt = performance.now();
    one("#start").hidden = true;
    const size = view.getUint32(4 + length);
    const files = [new Uint8Array(data, 8 + length, size), new Uint8Array(data, 8 + length + size)];
    const decoding = Promise.all(files.map((file) => (file.length ? createImageBitmap(new Blob([file])) : null)));
    const before = this.decoded;
    this.decoded = Promise.allSettled([before, decoding]); // a smaller picture is decoded sooner, and must wait
    const images = await decoding;
    await before;
    await frame();
    // a run that ended or was held meanwhile shows no more; a page that was hidden may have shown a later picture
    if (stretch === this.stretch && !(this.latest?.run === about.run && this.latest.k > about.k)) this.show(about, images);
  }

  /** Blank the pictures while the run stands still: for the experimenter, or for questions. */
  hold(reason) {
    if (this.heldFor === reason) return;
    this.heldFor = reason;
    this.running = false;
    this.stretch += 1;
    this.sent.clear(); // the time that the run stands still is no latency
    one("#start").hidden = true;
    one("#held").hidden = false;
    one("#scene").classList.add("blank");
    for (const canvas of document.querySelectorAll("#ahead, #mirror")) canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
    this.search?.hide();
    const { words: texts, queries } = this.about.study;
    one("#held-title").textContent = reason === "probe" ? texts.probe : texts.paused;
    const form = one("#held form");
    form.replaceChildren();
    if (reason !== "probe" || this.role !== "driver") return;
    for (const query of queries) form.append(questionOf(query));
    const go = document.createElement("button");
    go.textContent = texts.continue;
    form.append(go);
    this.probedAt = performance.now();
    form.querySelector("input").focus();
  }

  answer(event) {
    event.preventDefault();
    const answers = Object.fromEntries(new FormData(event.target));
    this.say({ kind: "answers", answers, seconds: (performance.now() - this.probedAt) / 1000 });
  }

  release() {
    this.heldFor = undefined;
    one("#held").hidden = true;
    one("#scene").classList.remove("blank");
    document.activeElement?.blur();
  }

  show(about, [ahead, mirror]) {
    if (this.heldFor) this.release();
    const canvas = one("#ahead");
    if (canvas.width !== ahead.width) [canvas.width, canvas.height] = [ahead.width, ahead.height];
    canvas.getContext("2d").drawImage(ahead, 0, 0);
    if (mirror) one("#mirror").getContext("2d").drawImage(mirror, 0, 0);
    const now = performance.now();
    this.shown = [...this.shown.slice(-50), now];
    if (about.seq > this.seen && this.sent.has(about.seq)) this.samples.push(now - this.sent.get(about.seq));
    this.seen = about.seq;
    this.wheel.speed = about.speed;
    this.latest = about;
    one("#speed b").textContent = Math.round(3.6 * about.speed);
    const state = one("#state");
    const byHand = about.available || this.about.study ? "you_drive" : "you_drive_alone"; // a hand-back would be refused
    state.textContent = words(about.byHand ? byHand : this.about.study ? "automated" : about.state);
    if (!this.about.study) state.style.background = about.colour; // in a trial, messages alone tell what is asked
    one("#conf-left").value = about.confidence[0];
    one("#conf-right").value = about.confidence[1];
    one("#behind").hidden = !about.late;
    write("#behind", words("behind", Math.round(about.late)));
    this.tellDriver(about);
    this.search?.allow(!about.byHand);
    this.run.add(about);
    this.map ??= new MapView(one("#map canvas"), this.run, one("#map .tip"));
    this.map.turned = true;
    this.map.scale = 2.2;
    this.map.show(this.run.t.length - 1);
  }

  /** Show, sound and speak the messages to the driver; a message ends with its reason. A new one is given once. */
  tellDriver({ told, left, state }) {
    one("#left").hidden = left === null;
    if (left !== null) one("#left span").textContent = left.toFixed(1);
    if (JSON.stringify(told) === JSON.stringify(this.told)) return;
    const before = new Set(this.told.map((message) => JSON.stringify(message)));
    const fresh = told.filter((one) => !before.has(JSON.stringify(one)));
    if (!told.some(([modality]) => modality === "speech")) hush();
    this.told = told;
    this.mute = this.mute.filter((text) => told.some(([, one]) => one === text));
    this.showTold(state);
    const heard = (message) => message[0] === "speech"; // after the tone of the same moment
    for (const message of [...fresh.filter((one) => !heard(one)), ...fresh.filter(heard)]) this.give(message, state);
  }

  /** Show the visible messages, and those that could not be spoken. */
  showTold(state) {
    const shown = this.told.filter(([modality, text]) => modality === "text" || (modality === "speech" && this.mute.includes(text)));
    const urgent = state !== "warning";
    const icons = this.told.some(([modality]) => modality === "icon") ? [icon(urgent)] : [];
    const box = one("#told");
    box.hidden = !shown.length && !icons.length;
    box.classList.toggle("urgent", urgent);
    box.replaceChildren(...icons, [...new Set(shown.map(([, text]) => text))].join(". "));
  }

  /** Give a message that is heard or felt, and report the channel to the server. */
  give([modality, text, language, files], state) {
    const run = this.number;
    const given = (by) => {
      const shown = by === "text" && run === this.number && this.told.some(([, one]) => one === text);
      if (shown) {
        this.mute.push(text);
        this.showTold(state);
      }
      const how = by === "text" && !shown ? "none" : by; // its reason ended before it could be spoken
      if (this.role === "driver") this.say({ kind: "given", run, modality, by: how });
    };
    if (modality === "tone") tone(files, given);
    if (modality === "speech") speak(text, language, files, given);
    if (modality === "vibration") vibrate(state !== "warning", given);
  }

  report() {
    this.say({ kind: "ping", t: performance.now() });
    if (!this.running || this.role !== "driver") return;
    const best = this.offsets.reduce((a, b) => (b.trip < a.trip ? b : a), { trip: Infinity, offset: 0 });
    const samples = this.samples.map((sample) => Number(sample.toFixed(2)));
    this.samples = [];
    this.say({ kind: "latency", samples: samples.slice(0, 200), offset: Number(best.offset.toFixed(2)) });
    const sorted = [...samples].sort((a, b) => a - b);
    const rate = this.shown.length > 1 ? (1000 * (this.shown.length - 1)) / (this.shown.at(-1) - this.shown[0]) : 0;
    const latency = sorted.length ? `${words("latency", Math.round(sorted[sorted.length >> 1]))}, ` : "";
    one("#measured").textContent = `${latency}${words("rate", rate.toFixed(0))}`;
  }

  /** Let the person wait while the files of a run that is over are written. */
  wait() {
    this.stand();
    if (!this.about.study) return;
    one("#ended").textContent = this.about.study.words.over;
    one("#go").textContent = this.about.study.words.continue;
    one("#go").disabled = true;
    one("#start").hidden = false;
  }

  /** Show and say nothing more of a run that is over. */
  stand() {
    this.running = false;
    this.stretch += 1;
    this.release();
    this.search?.hide();
    one("#told").hidden = one("#left").hidden = one("#behind").hidden = true;
    hush();
  }

  finish(about) {
    this.stand();
    this.over = Boolean(this.about.study && about.kept);
    one("#ended").textContent = this.about.study ? this.endOfTrial() : sentence(about.end);
    one("#go").textContent = this.over ? this.about.study.words.continue : words("again");
    const report = one("#report");
    report.hidden = !this.about.writes || !about.kept || Boolean(this.about.study);
    report.href = `/runs/${about.run}`;
    one("#start").hidden = false;
    this.allowStart();
  }

  /** Return what a participant reads: not the result of the trial, nor what went wrong on the server's machine. */
  endOfTrial() {
    const { over, wait } = this.about.study.words;
    return this.over ? over : `${sentence(words("broke_off"))}. ${wait}`;
  }
}

/** Wait until the screen shows the next frame; a hidden page has none, and does not wait for it. */
function frame() {
  if (document.hidden) return Promise.resolve();
  const hidden = new AbortController();
  return new Promise((resolve) => {
    requestAnimationFrame(resolve);
    document.addEventListener("visibilitychange", resolve, { signal: hidden.signal });
  }).finally(() => hidden.abort());
}

/** A question of a probe: answers to choose from, or a number. */
function questionOf({ name, text, choices }) {
  const field = document.createElement(choices.length ? "fieldset" : "label");
  if (!choices.length) {
    const input = Object.assign(document.createElement("input"), { name, type: "number", step: "any", required: true });
    field.append(text, input);
    return field;
  }
  field.append(Object.assign(document.createElement("legend"), { textContent: text }));
  for (const [value, words] of choices) {
    const label = document.createElement("label");
    label.append(Object.assign(document.createElement("input"), { name, value, type: "radio", required: true }), words);
    field.append(label);
  }
  return field;
}

/** A triangle with an exclamation mark, or two hands' place on a wheel for a request. */
function icon(urgent) {
  const drawn = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  drawn.setAttribute("viewBox", "0 0 24 24");
  drawn.setAttribute("aria-hidden", "true");
  drawn.innerHTML = urgent
    ? '<circle cx="12" cy="12" r="9" fill="none" stroke="currentColor" stroke-width="2.5"/><path d="M3 12h6m6 0h6M12 15v6" stroke="currentColor" stroke-width="2.5"/><circle cx="12" cy="12" r="3" fill="currentColor"/>'
    : '<path d="M12 2 23 21H1Z" fill="#ffd166"/><path d="M12 9v6m0 2v2" stroke="#10151b" stroke-width="2.4"/>';
  return drawn;
}

globalThis.page = new Page();
