// A mission over time: its frames, events and maps, as document.py writes them into a page or live.py sends them.

const NO_LINK = 10000; // instead of a signal [dBm]
const FASTEST_MPS = 20, SHORTEST_JUMP_M = 0.5; // as in trial.py

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

/** Numbers of which only the differences are stored. */
function sums(differences) {
  let sum = 0;
  return Int32Array.from(differences, (difference) => (sum += difference));
}

/** Maps of whole numbers of which only the changes are stored. */
class Film {
  /** Args: packed: see `film` in document.py. */
  constructor({ times_s, cells, changes, ...place }) {
    Object.assign(this, { times_s, cells, changes, place });
    this.values = new Int16Array(place.rows * place.columns);
    this.shown = -1; // index of the map that `values` contains; -1 is before the first one
    this.map = null;
  }

  /** The map at a time, or null before the first one; its values are overwritten by the next call. */
  at(time) {
    const wanted = this.times_s[0] <= time ? lastIndex(this.times_s, time) : -1;
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

/** Whether a robot jumps from one pose to another, such as to another level: no robot is so fast. */
function jumps(pose, next, seconds) {
  return Math.hypot(next[0] - pose[0], next[1] - pose[1]) > Math.max(FASTEST_MPS * seconds, SHORTEST_JUMP_M);
}

/** A pose between two others that are some seconds apart; null if the robot is absent. */
function between(pose, next, share, seconds) {
  if (!pose || !next || jumps(pose, next, seconds)) return pose;
  const turn = next[2] - pose[2], shortest = turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI));
  return [pose[0] + share * (next[0] - pose[0]), pose[1] + share * (next[1] - pose[1]), pose[2] + share * shortest];
}

export class Mission {
  isLive = false;

  /** Begin with what does not change. */
  begin({ title, scene, palette }) {
    Object.assign(this, { title, scene, palette, events: [], frames: [], layers: {}, pairs: null });
  }

  /** Add events, frames and maps; the first frame may replace the last one. What a frame lacks is as before it. */
  add({ events, frames, layers, links }) {
    for (const event of events) this.events.push(event);
    for (const frame of frames) {
      const last = this.frames.at(-1);
      if (last?.time_s === frame.time_s) this.frames.pop();
      this.frames.push({ ...last, ...frame });
    }
    for (const [name, packed] of Object.entries(layers)) this.layers[name] = packed && new Film(packed);
    // A frame of a file lacks links; the signals of each pair change in the frames of these indices.
    this.pairs = links?.map(([first, second, indices, signals]) => [first, second, sums(indices), sums(signals)]);
  }

  get start() { return this.frames[0]?.time_s ?? 0; }
  get end() { return this.frames.at(-1)?.time_s ?? 0; }

  _indexAt(time) { return lastIndex(this.frames, time, (frame) => frame.time_s); }

  /** The state at a time [s]; poses are interpolated between frames. */
  at(time) {
    const index = this._indexAt(time), frame = this.frames[index], next = this.frames[index + 1];
    const seconds = next ? next.time_s - frame.time_s : 0, share = next ? Math.max((time - frame.time_s) / seconds, 0) : 0;
    const poses = frame.poses.map((pose, robot) => (next ? between(pose, next.poses[robot], share, seconds) : pose));
    const beliefs = frame.beliefs?.map((belief, robot) => belief && next
      ? { ...belief, poses: belief.poses.map((pose, i) => between(pose, next.beliefs[robot]?.poses[i], share, seconds)) } : belief);
    return { ...frame, time, poses, beliefs, links: frame.links ?? this._linksAt(index) };
  }

  /** The links of a frame of a file: [[robot, other robot, signal in dBm], ...]. */
  _linksAt(index) {
    const links = [];
    for (const [first, second, indices, signals] of this.pairs) {
      const signal = indices[0] <= index ? signals[lastIndex(indices, index)] : NO_LINK;
      if (signal !== NO_LINK) links.push([first, second, signal]);
    }
    return links;
  }

  /** How many links each frame has. */
  _linkCounts() {
    if (!this.pairs) return this.frames.map((frame) => frame.links.length);
    const changes = new Int32Array(this.frames.length);
    for (const [, , indices, signals] of this.pairs) {
      indices.forEach((index, i) => {
        const wasLinked = i > 0 && signals[i - 1] !== NO_LINK;
        changes[index] += (signals[i] !== NO_LINK) - wasLinked;
      });
    }
    return sums(changes);
  }

  /** The map of a layer at a time, or null. */
  layerAt(name, time) { return this.layers[name]?.at(time) ?? null; }

  /** The path of a robot between two times: lists of its poses, a new one after each absence and jump. */
  trails(robot, from, to) {
    const pieces = [];
    let last = null;
    for (const { time_s, poses } of this.frames.slice(this._indexAt(from), this._indexAt(to) + 1)) {
      const pose = poses[robot];
      if (pose && (!last || jumps(last.pose, pose, time_s - last.time_s))) pieces.push([]);
      if (pose) pieces.at(-1).push(pose);
      last = pose && { pose, time_s };
    }
    return pieces;
  }

  /** The states of a victim up to a time: [[state, time of its begin], ...]. */
  history(name, until) {
    const found = [];
    for (const { time_s, victims } of this.frames.slice(0, this._indexAt(until) + 1)) {
      const state = victims.find((one) => one.name === name)?.state;
      if (state && state !== found.at(-1)?.[0]) found.push([state, time_s]);
    }
    return found;
  }

  /** Curves over time: {name: {times, values}}. */
  curves() {
    const stride = Math.max(Math.floor(this.frames.length / 600), 1);
    const isChosen = (_, index) => index % stride === 0 || index === this.frames.length - 1, chosen = this.frames.filter(isChosen);
    const times = chosen.map((frame) => frame.time_s);
    const curve = (value) => ({ times, values: chosen.map(value) });
    return {
      areas: curve((frame) => frame.explored.filter(Boolean).length),
      saved: curve((frame) => frame.victims.filter(isSaved).length),
      links: { times, values: this._linkCounts().filter(isChosen) },
      fiedler: curve((frame) => frame.fiedler_value),
    };
  }
}

/** Decode all missions of a page: base64 text of deflated JSON. */
export async function decodeMissions(text) {
  const bytes = Uint8Array.from(atob(text.trim()), (character) => character.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const documents = JSON.parse(await new Response(stream).text());
  return documents.map((document) => {
    const mission = new Mission();
    mission.begin(document);
    mission.add(document);
    return mission;
  });
}
