// Small curves over time with a cursor: areas explored, victims saved, links, Fiedler value.

import { lastIndex } from "viewer/mission";

const CURVES = [
  { key: "areas", name: "areas explored" },
  { key: "saved", name: "victims saved" },
  { key: "links", name: "links" },
  { key: "fiedler", name: "Fiedler value" },
];
const TOP = 20, LEFT = 36, RIGHT = 6, BOTTOM = 6;

export class Curves {
  constructor(container, onSeek, colours) {
    this.colours = colours;
    this.figures = CURVES.map((curve) => {
      const figure = document.createElement("figure"), canvas = document.createElement("canvas");
      const text = document.createElement("figcaption"), cursor = document.createElement("i");
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", curve.name);
      canvas.addEventListener("click", (event) => {
        const share = (event.offsetX - LEFT) / (canvas.clientWidth - LEFT - RIGHT);
        onSeek(this.start + Math.min(Math.max(share, 0), 1) * (this.end - this.start));
      });
      text.style.left = `${LEFT}px`;
      figure.append(canvas, text, cursor);
      container.append(figure);
      return { figure, canvas, text, cursor };
    });
  }

  /** Draw the curves themselves; `mark` then follows the time. Args: all: the curves of each mission that is shown. */
  draw(all, start, end) {
    Object.assign(this, { all, start, end });
    CURVES.forEach((curve, index) => {
      const series = all.map((one) => one[curve.key]), { figure, canvas } = this.figures[index];
      figure.hidden = series.every(({ values }) => values.every((value) => value === 0));
      this._draw(canvas, curve, series);
    });
  }

  /** Move the cursors to a time, and show the values there. */
  mark(time) {
    const share = (time - this.start) / Math.max(this.end - this.start, 1e-9);
    CURVES.forEach(({ key, name }, index) => {
      const { text, cursor } = this.figures[index];
      text.textContent = `${name}: ${this.all.map((one) => at(one[key], time)).join(" · ")}`;
      cursor.style.left = `calc(${LEFT}px + (100% - ${LEFT + RIGHT}px) * ${share})`;
    });
  }

  _draw(canvas, { key }, series) {
    const ratio = window.devicePixelRatio, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    const pen = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    pen.scale(ratio, ratio);
    const highest = Math.max(1, ...series.map(({ values }) => values.reduce((a, b) => Math.max(a, b), 0)));
    const span = Math.max(this.end - this.start, 1e-9);
    const x = (t) => LEFT + (width - LEFT - RIGHT) * (t - this.start) / span;
    const y = (value) => height - BOTTOM - (height - TOP - BOTTOM) * value / highest;
    pen.strokeStyle = style.getPropertyValue("--line");
    pen.beginPath();
    for (const value of [0, highest]) { pen.moveTo(LEFT, y(value)); pen.lineTo(width - RIGHT, y(value)); }
    pen.stroke();
    series.forEach(({ times, values }, index) => {
      pen.strokeStyle = this.colours[key];
      pen.lineWidth = 1.6;
      pen.setLineDash(index ? [4, 3] : []);
      pen.beginPath();
      times.forEach((t, i) => {
        if (i) pen.lineTo(x(t), y(values[i - 1]));
        if (i) pen.lineTo(x(t), y(values[i])); else pen.moveTo(x(t), y(values[i]));
      });
      if (times.length) pen.lineTo(x(this.end), y(values.at(-1)));
      pen.stroke();
    });
    pen.font = "12px system-ui, 'DejaVu Sans', sans-serif";
    pen.fillStyle = style.getPropertyValue("--soft");
    pen.textAlign = "right";
    for (const value of [0, highest]) pen.fillText(rounded(value), LEFT - 4, y(value) + 4);
  }
}

const rounded = (value) => (Number.isInteger(value) ? String(value) : value.toFixed(value < 10 ? 2 : 1));

function at({ times, values }, time) {
  return rounded(values[lastIndex(times, time)] ?? 0);
}
