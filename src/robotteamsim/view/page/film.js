// Maps of which only the changes are stored, as columns.py writes them: fire and smoke.

import { lastIndex } from "viewer/recording";

export class Film {
  /** Args: packed: see `_film` in columns.py. */
  constructor({ origin_m, cell_m, rows, columns, time_ms, cells, changes }) {
    this.place = { origin_m, cell_m, rows, columns };
    let sum = 0;
    this.times = time_ms.map((delta) => (sum += delta) / 1e3);
    Object.assign(this, { cells, changes });
    this.values = new Uint8Array(rows * columns);
    this.shown = -1; // index of the map that `values` contains; -1 is before the first one
    this.map = null;
  }

  /** The map at a time, or null before the first one; its values are overwritten by the next call. */
  at(time) {
    const wanted = this.times[0] <= time ? lastIndex(this.times, time) : -1;
    if (wanted === this.shown) return this.map;
    while (this.shown < wanted) this._change(++this.shown, 1);
    while (this.shown > wanted) this._change(this.shown--, -1);
    this.map = wanted < 0 ? null : { ...this.place, values: this.values };
    return this.map;
  }

  _change(index, sign) {
    let cell = 0;
    this.cells[index].forEach((step, i) => {
      cell += step;
      this.values[cell] += sign * this.changes[index][i];
    });
  }
}
