// The secondary task: one circle is larger than the others; each press on a circle is sent with its time.

const SVG = "http://www.w3.org/2000/svg";

export class SearchTask {
  /** Show the task in a box; `tell` sends the answers. */
  constructor(box, { words }, tell) {
    this.box = box;
    this.tell = tell;
    this.drawn = document.createElementNS(SVG, "svg");
    this.drawn.setAttribute("viewBox", "-1 -1 302 102");
    this.drawn.setAttribute("role", "img");
    this.drawn.setAttribute("aria-label", words);
    box.replaceChildren(Object.assign(document.createElement("p"), { textContent: words }), this.drawn);
  }

  /** Ask for a picture. */
  ask() {
    this.tell({ kind: "search" });
  }

  /** Take a picture: its number, and the circles as [x, y, radius]. */
  show({ number, circles }) {
    this.number = number;
    this.drawn.replaceChildren(
      ...circles.map(([x, y, r], k) => {
        const circle = document.createElementNS(SVG, "circle");
        for (const [name, value] of Object.entries({ cx: x, cy: y, r })) circle.setAttribute(name, value);
        circle.addEventListener("pointerdown", (event) => this.#answer(event, k));
        return circle;
      }),
    );
    this.shownAt = performance.now();
    this.answered = false;
  }

  /** Enable or disable the task: it is disabled while the person drives by hand. */
  allow(allowed) {
    if (allowed === !this.box.hidden) return;
    this.box.hidden = !allowed;
    this.shownAt = performance.now();
  }

  hide() {
    this.allow(false);
  }

  #answer(event, chosen) {
    event.preventDefault(); // the keys still control the vehicle
    if (this.answered) return; // the next picture has been requested
    this.answered = true;
    this.tell({ kind: "search", number: this.number, chosen, seconds: (performance.now() - this.shownAt) / 1000 });
  }
}
