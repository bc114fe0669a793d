// A recorded mission: decodes the columns that columns.py writes, and returns the state at any time.

import { Film } from "viewer/film";

const NO_LINK = 10000; // instead of a signal [dBm]

/** Decode all missions of a page: base64 text of deflated JSON. */
export async function decodeMissions(text) {
  const bytes = Uint8Array.from(atob(text.trim()), (character) => character.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const documents = JSON.parse(await new Response(stream).text());
  return documents.map((document) => new Recording(document));
}

function cumulated(deltas, scale, Numbers = Float32Array) {
  const values = new Numbers(deltas.length);
  let sum = 0;
  for (let i = 0; i < deltas.length; i++) values[i] = (sum += deltas[i]) * scale;
  return values;
}

/** Whether a victim is out of danger. */
export function isSaved(victim) {
  return victim.state === "saved" || victim.state === "safe";
}

/** Index of the last value that is at most `wanted` in an ascending array, or 0. `key` returns the value of an entry. */
export function lastIndex(entries, wanted, key = (entry) => entry) {
  let low = 0, high = entries.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (key(entries[middle]) <= wanted) low = middle + 1; else high = middle;
  }
  return Math.max(low - 1, 0);
}

const valueAt = (changes, index) => changes.length ? changes[lastIndex(changes, index, (change) => change[0])][1] : undefined;

/** Give a map its values, of which only the differences were written. */
export function decodeMap(map) {
  map.values = cumulated(map.values, 1);
  return map;
}

export class Recording {
  isLive = false;

  constructor(document) {
    Object.assign(this, { title: document.title, scene: document.scene, palette: document.palette });
    this.events = document.events;
    this.times = cumulated(document.time_ms, 1e-3, Float64Array);
    this.tracks = document.robots.map((track) => ({
      x: cumulated(track.x, 0.01), y: cumulated(track.y, 0.01), yaw: cumulated(track.yaw, 0.01),
    }));
    this.pairs = document.links.map(([first, second, indices, signals]) => ({
      first, second, indices: cumulated(indices, 1), signals: cumulated(signals, 1),
    }));
    this.changes = document.changes;
    this.scans = document.scans;
    this.layers = { voice: document.voice, radio: document.radio };
    for (const maps of Object.values(this.layers)) maps.forEach(decodeMap);
    for (const [name, packed] of Object.entries(document.films)) this.layers[name] = packed && new Film(packed);
  }

  get start() { return this.times[0] ?? 0; }
  get end() { return this.times[this.times.length - 1] ?? 0; }

  /** The state at a time [s]; poses are interpolated between frames. */
  at(time) {
    const index = lastIndex(this.times, time);
    const next = Math.min(index + 1, this.times.length - 1);
    const span = this.times[next] - this.times[index];
    const share = span > 0 ? Math.min(Math.max((time - this.times[index]) / span, 0), 1) : 0;
    const here = this._frame(index);
    const present = valueAt(this.changes.present, index), later = valueAt(this.changes.present, next);
    here.time = time;
    here.poses = this.tracks.map((track, robot) => {
      if (!present[robot]) return null;
      const part = later[robot] ? share : 0;
      const between = (column) => column[index] + part * (column[next] - column[index]);
      return [between(track.x), between(track.y), between(track.yaw)];
    });
    return here;
  }

  _frame(index) {
    const frame = { index };
    for (const key of Object.keys(this.changes)) frame[key] = valueAt(this.changes[key], index);
    frame.links = this.linksAt(index);
    return frame;
  }

  linksAt(index) {
    const links = [];
    for (const { first, second, indices, signals } of this.pairs) {
      const signal = indices[0] > index ? NO_LINK : signals[lastIndex(indices, index)];
      if (signal !== NO_LINK) links.push([first, second, signal]);
    }
    return links;
  }

  /** The last ranges of all lasers [m] at a time, or null. */
  scansAt(time) {
    const index = lastIndex(this.times, time);
    const found = this.scans.length ? this.scans[lastIndex(this.scans, index, (scan) => scan[0])] : null;
    return found && found[0] <= index ? found[1].map((deltas) => cumulated(deltas, 0.05)) : null;
  }

  /** The map of a layer at a time, or null. */
  layerAt(name, time) {
    const maps = this.layers[name];
    if (!maps || maps instanceof Film) return maps?.at(time) ?? null;
    return maps.length ? maps[lastIndex(maps, time, (map) => map.time_s)] : null;
  }

  /** The path of a robot between two times: [[x, y], ...]. */
  trail(robot, from, to) {
    const first = lastIndex(this.times, from), last = lastIndex(this.times, to), points = [];
    const { x, y } = this.tracks[robot], changes = this.changes.present;
    const isAlwaysThere = changes.length === 1 && changes[0][1][robot];
    for (let i = first; i <= last; i++) {
      if (isAlwaysThere || valueAt(changes, i)[robot]) points.push([x[i], y[i]]);
    }
    return points;
  }

  /** Curves over time: {name: {times, values}}. */
  curves() {
    const { explored, victims, fiedler } = this.changes;
    const counted = (changes, count) => ({
      times: changes.map(([index]) => this.times[index]), values: changes.map(([, value]) => count(value)),
    });
    const stride = Math.max(Math.floor(this.times.length / 600), 1), times = [], links = [];
    for (let i = 0; i < this.times.length; i += stride) {
      times.push(this.times[i]);
      links.push(this.linksAt(i).length);
    }
    return {
      areas: counted(explored, (flags) => flags.filter(Boolean).length),
      saved: counted(victims, (list) => list.filter((victim) => isSaved(victim)).length),
      links: { times, values: links },
      fiedler: counted(fiedler, (value) => value),
    };
  }
}
