// The person's inputs: keys, gamepad or steering wheel, touch, combined to one steering angle, throttle and brake.

const STEERS = 1.1; // share of the full lock a second, by keys at a standstill
const RETURNS = 1.8;
const PEDAL = { throttle: 1.6, brake: 2.4, up: 4 }; // shares a second
const DEAD = { stick: 0.04, wheel: 0.005, pedal: 0.04 }; // share of the way of an input about its rest
const SETTLED = 500; // milliseconds after which an input that has been let go is at rest
const NAMES = ["steer", "throttle", "brake", "take over", "hand back"];

const WORDS = { steer: "steer", throttle: "throttle", brake: "brake", "take over": "take_over", "hand back": "give_back" };

const KEYS = {
  ArrowLeft: "left", KeyA: "left",
  ArrowRight: "right", KeyD: "right",
  ArrowUp: "throttle", KeyW: "throttle",
  ArrowDown: "brake", KeyS: "brake",
  Enter: "take", KeyH: "back",
};

// The standard mapping of the Gamepad API: left stick, right and left trigger, A and B.
const USUAL = {
  steer: { axis: 0, rest: 0, full: -1 },
  throttle: { button: 7, rest: 0, full: 1 },
  brake: { button: 6, rest: 0, full: 1 },
  "take over": { button: 0, rest: 0, full: 1 },
  "hand back": { button: 1, rest: 0, full: 1 },
};

export class Wheel {
  constructor() {
    this.held = new Set();
    this.steer = 0;
    this.throttle = 0;
    this.brake = 0;
    this.pressed = { take: false, back: false };
    this.speed = 0;
    this.before = performance.now();
    addEventListener("keydown", (event) => this.#key(event, true));
    addEventListener("keyup", (event) => this.#key(event, false));
    addEventListener("blur", () => this.held.clear());
    document.addEventListener("visibilitychange", () => this.release());
  }

  /** Let buttons of the page work like keys: data-hold while they are held, data-press once. */
  listen(buttons) {
    for (const button of buttons) {
      const { hold, press } = button.dataset;
      button.addEventListener("pointerdown", (event) => {
        event.preventDefault();
        if (hold) this.held.add(hold);
        else this.pressed[press] = true;
      });
      for (const kind of ["pointerup", "pointercancel", "pointerleave"]) {
        button.addEventListener(kind, () => this.held.delete(hold));
      }
    }
  }

  /** Return the person's present inputs; a press counts once. */
  read() {
    const now = performance.now();
    const time = Math.min(0.1, (now - this.before) / 1000);
    this.before = now;
    this.#turn(time);
    const pad = this.#pad();
    const told = {
      throttle: Math.max(this.throttle, pad.throttle),
      brake: Math.max(this.brake, pad.brake),
      steer: Math.abs(pad.steer) > Math.abs(this.steer) ? pad.steer : this.steer,
      take_over: this.pressed.take || pad.take,
      hand_back: this.pressed.back || pad.back,
    };
    this.pressed = { take: false, back: false };
    for (const name of ["throttle", "brake", "steer"]) told[name] = Number(told[name].toFixed(4));
    return told;
  }

  /** Reset all inputs, as at the start of a run and in a page that is hidden or shown again. */
  release() {
    this.held.clear();
    this.steer = this.throttle = this.brake = 0;
    this.forget();
  }

  /** Forget buttons that were pressed while no run was in progress. */
  forget() {
    this.pressed = { take: false, back: false };
  }

  #key(event, down) {
    const name = KEYS[event.code];
    if (!name) return;
    if (!down) this.held.delete(name); // also beside a modifier that was pressed meanwhile
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (down && event.target.closest?.("button, a, input")) return;
    event.preventDefault();
    if (name === "take" || name === "back") {
      if (down && !event.repeat) this.pressed[name] = true;
    } else if (down) {
      this.held.add(name);
    }
  }

  /** Update the inputs from keys: the faster the vehicle, the less and the slower they steer. */
  #turn(time) {
    const most = this.#most();
    const wanted = (this.held.has("left") ? 1 : 0) - (this.held.has("right") ? 1 : 0);
    const rate = (wanted === 0 ? RETURNS : STEERS) * Math.max(most, 0.08);
    this.steer = toward(this.steer, wanted * most, rate * time);
    for (const name of ["throttle", "brake"]) {
      const held = this.held.has(name);
      this[name] = toward(this[name], held ? 1 : 0, (held ? PEDAL[name] : PEDAL.up) * time);
    }
  }

  /** Return the share of the full lock that keys and sticks can reach at the present speed. */
  #most() {
    return Math.min(1, 9 / Math.max(this.speed, 1) ** 1.4);
  }

  #pad() {
    const found = document.hidden ? [] : devices(); // the browser keeps the last values for a page that nobody sees
    if (!found.length) return { steer: 0, throttle: 0, brake: 0, take: false, back: false };
    const value = (name) => share(assigned(found, name));
    const stick = isStick(assigned(found, "steer")?.device);
    const [take, back] = [value("take over") > 0.5, value("hand back") > 0.5];
    const once = { take: take && !this.padTake, back: back && !this.padBack };
    [this.padTake, this.padBack] = [take, back];
    return {
      steer: stick ? this.#most() * squared(dead(value("steer"), DEAD.stick)) : dead(value("steer"), DEAD.wheel),
      throttle: Math.max(0, dead(value("throttle"), DEAD.pedal)),
      brake: Math.max(0, dead(value("brake"), DEAD.pedal)),
      ...once,
    };
  }
}

/** The page in which a gamepad's or a wheel's axes and buttons are assigned. */
export class Calibration {
  constructor(dialog, words) {
    this.dialog = dialog;
    this.words = words;
    this.body = dialog.querySelector("tbody");
    this.chosen = NAMES[0];
    dialog.querySelector("#forget").addEventListener("click", () => devices().forEach((one) => keep(one, {})));
  }

  open() {
    this.dialog.showModal();
    this.extremes = null;
    const tick = () => {
      if (!this.dialog.open) return;
      this.#show();
      requestAnimationFrame(tick);
    };
    tick();
  }

  #show() {
    const found = devices();
    this.dialog.querySelector("#device").textContent = found.map(({ name }) => name).join(", ") || this.words.press;
    if (!found.length) return;
    if (!this.body.children.length) this.#build();
    NAMES.forEach((name, k) => {
      const row = this.body.children[k];
      const input = assigned(found, name);
      const numbers = input ? [input.rest, input.full, share(input)].map((value) => value.toFixed(2)) : ["–", "–", "–"];
      [this.words[WORDS[name]], this.#place(found, input), ...numbers].forEach((text, n) => (row.children[n].textContent = text));
      row.classList.toggle("chosen", name === this.chosen);
    });
    this.#watch(found);
  }

  /** Name the axis or button of an input, and its device if there are several. */
  #place(found, input) {
    if (!input) return "–";
    const { device, axis, button } = input;
    const place = axis === undefined ? `${this.words.button} ${button}` : `${this.words.axis} ${axis}`;
    return found.length > 1 ? `${device.name}: ${place}` : place;
  }

  #build() {
    for (const name of NAMES) {
      const row = this.body.insertRow();
      for (let k = 0; k < 5; k++) row.insertCell();
      row.tabIndex = 0;
      const choose = () => {
        this.chosen = name;
        this.extremes = null;
      };
      row.addEventListener("click", choose);
      row.addEventListener("focus", choose);
    }
  }

  /** Find the axis or button that has moved most since the input was chosen, and its rest and extreme positions. */
  #watch(found) {
    const now = found.flatMap((device) => [
      ...device.pad.axes.map((value, axis) => ({ device, value, place: { axis } })),
      ...device.pad.buttons.map(({ value }, button) => ({ device, value, place: { button } })),
    ]);
    if (this.extremes?.length !== now.length) this.extremes = null; // a device has come or gone
    this.extremes ??= now.map(({ value }) => ({ first: value, rest: value, far: value, least: value, most: value, last: value, since: 0 }));
    now.forEach(({ value }, k) => follow(this.extremes[k], value, performance.now()));
    const moved = this.extremes.map((one) => Math.abs(one.far - one.rest));
    const most = moved.indexOf(Math.max(...moved));
    if (moved[most] < 0.5) return;
    const { rest, far } = this.extremes[most];
    const { device, place } = now[most];
    assign(found, this.chosen, device, { ...place, rest, full: far });
  }
}

/**
 * Follow an input that is moved fully and let go. Browsers give 0 for an axis until it first moves; one that was at 0 and
 * then on both sides of it is at rest where it stays.
 */
function follow(one, value, time) {
  if (Math.abs(value - one.rest) > Math.abs(one.far - one.rest)) one.far = value;
  one.least = Math.min(one.least, value);
  one.most = Math.max(one.most, value);
  if (Math.abs(value - one.last) > 0.02) [one.last, one.since] = [value, time];
  if (one.first !== 0 || one.least > -0.5 || one.most < 0.5 || time - one.since < SETTLED) return;
  one.rest = value;
  if (Math.abs(value) > 0.5) one.far = value > 0 ? one.least : one.most;
}

const names = []; // of the devices, by their places in the browser's list, also of those that are unplugged meanwhile

/** Return the devices. Those of the same model are named in the order in which the browser found them. */
function devices() {
  const slots = [...(navigator.getGamepads?.() ?? [])];
  slots.forEach((pad, slot) => {
    if (!pad || names[slot]?.id === pad.id) return;
    names[slot] = null;
    let name = pad.id;
    for (let number = 2; names.some((one) => one?.name === name); number++) name = `${pad.id} (${number})`;
    names[slot] = { id: pad.id, name };
  });
  return slots.map((pad, slot) => pad?.connected && { pad, name: names[slot].name }).filter(Boolean);
}

/** Return the assigned inputs of a device, by their names; the browser keeps them by the name of the device. */
function kept({ name }) {
  return JSON.parse(localStorage.getItem(`profile of ${name}`) ?? "{}");
}

function keep({ name }, profile) {
  localStorage.setItem(`profile of ${name}`, JSON.stringify(profile));
}

/**
 * Return the device, axis or button of an input: the assigned one, otherwise the usual one of the first device of which
 * nothing is assigned; undefined if there is none, as when a wheel is unplugged and its pedals are not.
 */
function assigned(devices, input) {
  const own = devices.find((one) => kept(one)[input]);
  const usual = own ?? devices.find((one) => isStick(one) || !Object.keys(kept(one)).length);
  return usual && { device: usual, ...(own ? kept(own)[input] : USUAL[input]) };
}

/** Assign an axis or button of a device to an input; the other inputs keep theirs. */
function assign(devices, input, device, place) {
  const profile = {};
  for (const one of NAMES) {
    const { device: from, ...before } = assigned(devices, one) ?? {};
    if (from?.name === device.name) profile[one] = before;
  }
  keep(device, { ...profile, [input]: place });
  for (const other of devices) if (other.name !== device.name) keep(other, { ...kept(other), [input]: undefined });
}

/** Return how far an input is moved: 0 at rest, 1 fully, -1 fully the other way. */
function share(input) {
  if (!input) return 0;
  const { device, axis, button, rest, full } = input;
  const { pad } = device;
  const value = axis === undefined ? (pad.buttons[button]?.value ?? rest) : (pad.axes[axis] ?? rest);
  return full === rest ? 0 : Math.min(1, Math.max(-1, (value - rest) / (full - rest)));
}

/** Return whether a device steers with a thumb: browsers map gamepads to the standard layout, and wheels to none. */
function isStick(device) {
  return device?.pad.mapping === "standard";
}

/** Return a value with fine control about the rest. */
function squared(value) {
  return value * Math.abs(value);
}

/** Return a value outside the dead zone about its rest, from 0 at the edge of the zone. */
function dead(value, zone) {
  return Math.abs(value) < zone ? 0 : (value - Math.sign(value) * zone) / (1 - zone);
}

function toward(value, wanted, step) {
  return value < wanted ? Math.min(wanted, value + step) : Math.max(wanted, value - step);
}
