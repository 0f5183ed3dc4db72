// The takeover's states and the events on the charts' axis of time, and a slider over both.

import { ROOM } from "pages/curves.js";
import { shown } from "pages/data.js";

export class Timeline {
  /**
   * @param root Element that it goes into.
   * @param runs The runs, a bar of states for each.
   * @param seek Called with the time that was chosen.
   */
  constructor(root, runs, seek) {
    this.runs = runs;
    this.range = [Math.min(...runs.map((run) => run.begin)), Math.max(...runs.map((run) => run.end))];
    root.style.paddingLeft = `${ROOM.left}px`;
    root.style.paddingRight = `${ROOM.right}px`;
    this.parts = [];
    for (const run of runs) {
      const bar = element("div", "states", root);
      for (const [begin, end, words, colour] of run.states) {
        const part = element("button", "state", bar);
        part.type = "button";
        part.style.background = colour;
        part.title = `${words}, ${shown(begin, "s")} to ${shown(end, "s")}`;
        part.setAttribute("aria-label", part.title);
        part.addEventListener("click", () => seek(begin));
        this.parts.push([part, begin, end]);
      }
      const events = element("div", "events", root);
      for (const event of run.events) {
        const mark = element("button", event.moment ? "event moment" : "event", events);
        mark.type = "button";
        if (event.colour) mark.style.setProperty("--mark", event.colour);
        const about = [event.entity, event.cause, event.message].filter(Boolean).join(", ");
        mark.title = `${shown(event.t, "s")}: ${event.words}${about ? ` (${about})` : ""}`;
        mark.setAttribute("aria-label", mark.title);
        mark.addEventListener("click", () => seek(event.t));
        this.parts.push([mark, event.t, event.t]);
      }
    }
    this.slider = element("input", "slider", root);
    Object.assign(this.slider, { type: "range", min: this.range[0], max: this.range[1], step: "any" });
    this.slider.setAttribute("aria-label", "time, s");
    this.slider.addEventListener("input", () => seek(Number(this.slider.value)));
    this.scale(this.range);
  }

  /** Show a time. */
  show(t) {
    this.slider.value = t;
    this.slider.setAttribute("aria-valuetext", shown(t, "s"));
  }

  /** Let the bar reach from one time to another. */
  scale([from, to]) {
    Object.assign(this.slider, { min: from, max: to });
    const share = (t) => (100 * (t - from)) / Math.max(to - from, 1e-6);
    for (const [part, begin, end] of this.parts) {
      const [left, right] = [Math.max(0, share(begin)), Math.min(100, share(end))];
      part.hidden = right < 0 || left > 100;
      part.style.left = `${left}%`;
      if (end > begin) part.style.width = `${Math.max(0, right - left)}%`;
    }
  }
}

export function element(tag, name, parent) {
  const made = document.createElement(tag);
  if (name) made.className = name;
  parent?.append(made);
  return made;
}
