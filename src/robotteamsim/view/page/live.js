// A live mission: frames arrive from the server as they are computed; commands go back.

import { decodeMap, isSaved, lastIndex } from "viewer/recording";

export class LiveMission {
  isLive = true;
  events = [];
  frames = [];
  scans = null;
  layers = { fire: null, smoke: null, voice: null, radio: null };

  /** Follow the frames of the server; the first update contains the scene. */
  static async connect() {
    const mission = new LiveMission();
    await new Promise((resolve, reject) => {
      const source = new EventSource("/frames");
      source.onmessage = (message) => { mission._receive(JSON.parse(message.data)); resolve(); };
      source.onerror = () => {
        mission.onclose?.();
        if (!mission.frames.length) reject(new Error("the simulation does not answer"));
      };
    });
    return mission;
  }

  get start() { return this.frames[0]?.time_s ?? 0; }
  get end() { return this.frames.at(-1)?.time_s ?? 0; }

  /** Send a command, such as {command: "pause"}; the server's complaint is shown. */
  async send(command) {
    const answer = await fetch("/command", {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(command),
    });
    this.onanswer?.((await answer.json()).error ?? "");
  }

  _receive(update) {
    if (update.restarted) {
      this.frames = [];
      this.events = [];
      this.layers = { fire: null, smoke: null, voice: null, radio: null };
      this.viewer = update.viewer;
      this.title = update.title;
      this.scene = update.scene;
      this.palette = update.palette;
      this.onrestart?.();
    }
    this.status = update.status;
    for (const event of update.events) this.events.push(event);
    for (const frame of update.frames) {
      frame.fiedler = frame.fiedler_value;
      if (frame.scans_m.length) this.scans = frame.scans_m;
      frame.scans_m = [];
      if (this.frames.at(-1)?.time_s === frame.time_s) this.frames.pop(); // changed while paused
      this.frames.push(frame);
    }
    for (const name of Object.keys(update.layers)) this.layers[name] = decodeMap(update.layers[name]);
    this.onupdate?.();
  }

  at(time) {
    const frame = this.frames[lastIndex(this.frames, time, (one) => one.time_s)];
    return { ...frame, time: frame.time_s };
  }

  scansAt() { return this.scans; }
  layerAt(name) { return this.layers[name]; }

  trail(robot, from, to) {
    const key = (frame) => frame.time_s;
    const first = lastIndex(this.frames, from, key), last = lastIndex(this.frames, to, key);
    return this.frames.slice(first, last + 1).map((frame) => frame.poses[robot]).filter(Boolean);
  }

  curves() {
    const stride = Math.max(Math.floor(this.frames.length / 600), 1);
    const chosen = this.frames.filter((_, index) => index % stride === 0);
    const times = chosen.map((frame) => frame.time_s);
    const curve = (value) => ({ times, values: chosen.map(value) });
    return {
      areas: curve((frame) => frame.explored.filter(Boolean).length),
      saved: curve((frame) => frame.victims.filter((victim) => isSaved(victim)).length),
      links: curve((frame) => frame.links.length),
      fiedler: curve((frame) => frame.fiedler),
    };
  }
}
