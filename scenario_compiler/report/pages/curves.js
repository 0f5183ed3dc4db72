// Curves over time, one chart above the other with one axis: uPlot, a playhead, and values under the pointer.

import { shown } from "pages/data.js";

const LEFT = 58; // room for the axis's numbers, pixels; the timeline has the same
const RIGHT = 12;
const HEIGHT = 104;
const RUN_COLOURS = ["ego", "#D55E00"];

export const ROOM = { left: LEFT, right: RIGHT };

export class Curves {
  /**
   * @param root Element that the charts go into.
   * @param runs One run, or two whose curves are laid over each other.
   * @param seek Called with the time that was clicked.
   * @param zoomed Called with the times [from, to] that are shown.
   */
  constructor(root, runs, seek, zoomed) {
    this.root = root;
    this.runs = runs;
    this.seek = seek;
    this.zoomed = zoomed;
    this.range = [Math.min(...runs.map((run) => run.begin)), Math.max(...runs.map((run) => run.end))];
    this.whole = [...this.range];
    this.charts = [];
    this.time = this.range[0];
    this.#build();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#build());
    new ResizeObserver(() => this.#resize()).observe(root);
  }

  /** Put the playhead at a time. */
  show(t) {
    this.time = t;
    for (const chart of this.charts) {
      const at = chart.valToPos(t, "x");
      chart.playhead.style.transform = `translateX(${at}px)`;
      chart.playhead.hidden = at < 0 || at > chart.over.clientWidth;
      if (!chart.hovered) chart.setLegend({ idx: lastNotAfter(chart.data[0], t) });
    }
  }

  /** Show the times from and to, all of them without arguments. */
  zoom(from = this.whole[0], to = this.whole[1]) {
    this.range = [from, to];
    for (const chart of this.charts) chart.setScale("x", { min: from, max: to });
    this.zoomed(this.range);
    this.show(this.time);
  }

  #build() {
    for (const chart of this.charts) chart.destroy();
    const titles = [...new Set(this.runs.flatMap((run) => run.curves.map((curve) => curve.title)))];
    this.charts = titles.map((title, k) => this.#chart(title, k === titles.length - 1));
    this.show(this.time);
  }

  #resize() {
    const width = this.root.clientWidth;
    if (!width) return;
    for (const chart of this.charts) chart.setSize({ width, height: chart.height });
    this.show(this.time);
  }

  #chart(title, last) {
    const style = getComputedStyle(this.root);
    const colour = (name) => (name.startsWith("#") ? name : style.getPropertyValue(`--${name}`).trim());
    const tables = [];
    const series = [{ label: "time", value: (_, t) => shown(t, "s") }];
    let curve = null;
    this.runs.forEach((run, number) => {
      const found = run.curves.find((one) => one.title === title);
      if (!found) return;
      curve ??= found;
      const columns = found.series.map(([, name]) => Array.from(run.columns[name].data[0], orNull));
      tables.push([Array.from(run.t), ...columns]);
      for (const [words, name, hue, dashed] of found.series) {
        const unit = run.columns[name].unit;
        const several = this.runs.length > 1;
        series.push({
          label: several ? `${words} (${number + 1})` : words,
          stroke: colour(several ? RUN_COLOURS[number] : hue),
          dash: dashed ? [5, 3] : undefined,
          width: 1.5,
          points: { show: false },
          value: (chart, _, __, at) => shown(at === null ? NaN : valueAt(run, name, chart.data[0][at]), unit),
        });
      }
    });
    const [name] = curve.series.map((one) => one[1]);
    const unit = this.runs[0].columns[name].unit;
    const axis = {
      stroke: colour("quiet"),
      grid: { stroke: colour("line"), width: 1 },
      ticks: { show: false },
      font: "11px system-ui, sans-serif",
    };
    const options = {
      width: Math.max(this.root.clientWidth, 200),
      height: HEIGHT + (last ? 26 : 0),
      padding: [6, RIGHT, last ? 0 : 6, 0],
      title: unit && unit !== "1" ? `${title} (${unit})` : title,
      series,
      scales: {
        x: { time: false, min: this.range[0], max: this.range[1] },
        y: { range: (_, low, high) => limits(curve.range, low, high) },
      },
      axes: [
        { ...axis, show: last, size: 26, values: (_, times) => times.map((t) => `${t} s`), space: 60 },
        { ...axis, size: LEFT, space: 18, values: (_, values) => values.map((value) => `${value}`.replace("-", "−")) },
      ],
      cursor: { sync: { key: this.key }, drag: { x: true, y: false, setScale: false }, points: { size: 7 } },
      legend: { live: true },
      hooks: {
        draw: [(chart) => drawLevels(chart, curve.levels, colour("quiet"))],
        setSelect: [(chart) => this.#select(chart)],
      },
    };
    const chart = new globalThis.uPlot(options, globalThis.uPlot.join(tables), this.root);
    chart.playhead = document.createElement("div");
    chart.playhead.className = "playhead";
    chart.over.append(chart.playhead);
    chart.over.addEventListener("click", (event) => {
      if (this.selected) {
        this.selected = false;
        return;
      }
      this.seek(chart.posToVal(event.clientX - chart.over.getBoundingClientRect().left, "x"));
    });
    this.root.addEventListener("pointerenter", () => (chart.hovered = true));
    this.root.addEventListener("pointerleave", () => {
      chart.hovered = false;
      this.show(this.time);
    });
    chart.over.addEventListener("dblclick", () => this.zoom());
    return chart;
  }

  get key() {
    this.syncKey ??= globalThis.uPlot.sync(Symbol("player")).key;
    return this.syncKey;
  }

  #select(chart) {
    const { left, width } = chart.select;
    if (width < 4) return;
    this.selected = true;
    const [from, to] = [chart.posToVal(left, "x"), chart.posToVal(left + width, "x")];
    chart.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.zoom(from, to);
  }
}

/** Return the number of the last time that is not after t. */
function lastNotAfter(times, t) {
  const after = times.findIndex((one) => one > t + 1e-6);
  return after < 0 ? times.length - 1 : Math.max(0, after - 1);
}

/** Return a run's value in its last row that is not after a time: two runs may have rows at different times. */
function valueAt(run, name, t) {
  return t < run.begin - 1e-6 || t > run.end + 1e-6 ? NaN : run.value(name, run.row(t));
}

function orNull(value) {
  return Number.isFinite(value) ? value : null;
}

/** Return an axis's limits: those that are given, else those of the values with room. */
function limits([least, most], low, high) {
  const [a, b] = [Math.min(low ?? 0, least ?? Infinity), Math.max(high ?? 1, most ?? -Infinity)];
  const room = 0.06 * Math.max(b - a, 0.1);
  return [least === null || a < least ? a - room : least, b + room];
}

function drawLevels(chart, levels, colour) {
  const ink = chart.ctx;
  const dots = globalThis.devicePixelRatio || 1;
  ink.save();
  ink.strokeStyle = ink.fillStyle = colour;
  ink.lineWidth = dots;
  ink.setLineDash([dots, 3 * dots]);
  ink.font = `${10 * dots}px system-ui, sans-serif`;
  ink.textAlign = "right";
  ink.textBaseline = "bottom"; // uPlot leaves that of its axes
  for (const [words, value] of levels) {
    const y = chart.valToPos(value, "y", true);
    ink.beginPath();
    ink.moveTo(chart.bbox.left, y);
    ink.lineTo(chart.bbox.left + chart.bbox.width, y);
    ink.stroke();
    ink.fillText(words, chart.bbox.left + chart.bbox.width - 3 * dots, y - 2 * dots);
  }
  ink.restore();
}
