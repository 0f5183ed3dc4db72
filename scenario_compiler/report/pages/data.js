// A run as the page holds it: columns of whole steps, unpacked into arrays (see report/replay.py).

/** Return the JSON that text holds as gzip in base64. */
export async function unpack(text) {
  const bytes = Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return JSON.parse(await new Response(stream).text());
}

/** Return numbers from differences in steps; null becomes NaN. */
export function numbers(differences, step) {
  const out = new Float64Array(differences.length);
  let sum = 0;
  for (let k = 0; k < differences.length; k++) {
    if (differences[k] === null) {
      out[k] = NaN;
    } else {
      sum += differences[k];
      out[k] = sum * step;
    }
  }
  return out;
}

/** Return the points of a line from their differences, as a flat array x, y, x, y in metres. */
export function points(steps, step) {
  const out = new Float64Array(steps.length);
  let x = 0;
  let y = 0;
  for (let k = 0; k < steps.length; k += 2) {
    x += steps[k];
    y += steps[k + 1];
    out[k] = x * step;
    out[k + 1] = y * step;
  }
  return out;
}

/** One run: `t` in seconds, `columns[name].data[entity][row]`, everything else as the page holds it. */
export class Run {
  constructor(packed) {
    Object.assign(this, packed);
    this.t = numbers(packed.t.data, packed.t.step);
    this.columns = {};
    for (const [name, column] of Object.entries(packed.columns)) {
      this.columns[name] = { ...column, data: column.data.map((one) => numbers(one, column.step)) };
    }
    const { step, x, y, h, by } = packed.blocked;
    this.blocked = { x: numbers(x, step), y: numbers(y, step), h: numbers(h, 1e-3), by: numbers(by, 1) };
  }

  get begin() {
    return this.t[0];
  }

  get end() {
    return this.t[this.t.length - 1];
  }

  /** Return the number of the last row whose time is not after t, and the first row before all of them. */
  row(t) {
    let low = 0;
    let high = this.t.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.t[middle] <= t + 1e-6) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Return a column's value in a row; NaN if there is none. */
  value(name, row, entity = 0) {
    return this.columns[name].data[entity]?.[row] ?? NaN;
  }

  /** Return whether an entity is in the world in a row. */
  present(row, entity) {
    return Number.isFinite(this.columns.x.data[entity][row]);
  }

  /** Return the takeover's state at a time: [begin, end, words, colour]. */
  state(t) {
    let found = this.states[0];
    for (const state of this.states) if (state[0] <= t + 1e-6) found = state;
    return found;
  }
}

/** Return a number as a text for people: with decimals, a minus sign, and its unit. */
export function shown(value, unit = "", decimals = 2) {
  if (!Number.isFinite(value)) return "–";
  const text = value.toFixed(decimals).replace(/^-(?=0*\.?0*$)/, "").replace("-", "−");
  return unit ? `${text} ${unit}` : text;
}
