// Time: play, pause, seek, speed; it draws all views of the page at the same time.

import { Panel } from "viewer/panel";
import { isSaved } from "viewer/mission";

const SPEEDS = [0.5, 1, 2, 5, 10, 20, 50];
const element = (id) => document.getElementById(id);
const LAYERS = { links: true, trails: true, names: true, fire: true, smoke: true, belief: true, voice: false, radio: false, laser: false };

const EVENT_COLOURS = {
  victim_saved: "victims.saved", victim_safe: "victims.safe", victim_located: "victims.located",
  victim_reported: "victims.reported", victim_reached: "victims.reached", victim_carried: "victims.carried",
  victim_collapsed: "victims.collapsed", victim_dead: "victims.dead", victim_heard: "victims.heard", area_explored: "areas.explored",
  link_endangered: "links.endangered", robot_excluded: "excluded", end: "curves.links",
  ignition: "fire.burning", door_burnt: "fire.burning", visibility_lost: "smoke", exit_untenable: "fire.hot",
};

export class Player {
  constructor(views) {
    this.views = views;
    this.time = this.start;
    this.playing = false;
    this.speed = 10;
    this.shown = { ...LAYERS };
    this.dirty = true;
    this.panel = new Panel((time) => this.seek(time), views[0].mission.palette.curves);
    this._controls();
    this.refresh();
    requestAnimationFrame((now) => this._tick(now, now));
  }

  get missions() { return this.views.map((view) => view.mission); }
  get isLive() { return this.missions.some((mission) => mission.isLive); }
  get start() { return Math.min(...this.views.map((view) => view.mission.start)); }
  get end() { return Math.max(...this.views.map((view) => view.mission.end)); }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.following = this.isLive && this.time >= this.end - 0.5;
    this.dirty = true;
  }

  draw() { this.dirty = true; }

  /** Whether the page moves the time itself: in a recording, and in a live mission that has ended. */
  get replays() { return !this.isLive || this.missions.every((mission) => mission.frames.at(-1).state === "ended"); }

  /** Show what a live mission reports about itself. */
  follow(status) {
    if (!this.replays || !this.replayed) this._setPlaying(status.playing && !this.replays);
    this.replayed = this.replays;
    this.speed = status.speed;
    const speeds = element("speed");
    if (![...speeds.options].some((option) => Number(option.value) === status.speed)) {
      speeds.add(new Option(`${status.speed}×`, status.speed));
    }
    speeds.value = status.speed;
  }

  toggle(playing = !this.playing) {
    if (playing && this.replays && this.time >= this.end) this.seek(this.start);
    this._setPlaying(playing);
    if (!this.replays) this.onplay?.(playing);
  }

  _setPlaying(playing) {
    this.playing = playing;
    element("play").classList.toggle("playing", playing);
    this.dirty = true;
  }

  /** New frames or another mission: the range of time, curves and events have changed. */
  refresh() {
    const slider = element("time");
    slider.min = this.start;
    slider.max = this.end;
    this.curves = this.missions.map((mission) => mission.curves());
    this._drawPanel();
  }

  /** Draw what stays the same while the time changes: curves, list of events and their marks. */
  _drawPanel() {
    this.panel.setEvents(this.missions, this.start, this.end, (kind) => this._eventColour(kind));
    this.panel.curves.draw(this.curves, this.start, this.end);
    this.dirty = true;
  }

  _eventColour(kind) {
    const path = EVENT_COLOURS[kind];
    return path ? path.split(".").reduce((part, key) => part[key], this.views[0].mission.palette) : this.views[0].mission.palette.event;
  }

  _tick(now, before) {
    if (this.playing && this.replays) {
      this.time = Math.min(this.time + this.speed * Math.min((now - before) / 1000, 0.25), this.end);
      this.dirty = true;
      if (this.time >= this.end) this.toggle(false);
    }
    if (this.dirty) this.show();
    requestAnimationFrame((next) => this._tick(next, now));
  }

  /** Draw all views at the current time. */
  show() {
    this.dirty = false;
    for (const view of this.views) view.show(Math.min(this.time, view.mission.end), this.shown);
    this.panel.show(this.views, this.start, this.time);
    element("time").value = this.time;
    element("clock").textContent = `${(this.time - this.start).toFixed(1)} / ${(this.end - this.start).toFixed(1)} s`;
    element("state").textContent = this.views.map((view) => statusText(view.frame, this._stateOf(view))).join("   |   ");
  }

  /** The state of a view's mission; one that is live and waits for "play" is paused. */
  _stateOf(view) {
    const { state } = view.frame;
    return view.mission.isLive && !this.playing && state === "running" ? "paused" : state;
  }

  _controls() {
    element("play").addEventListener("click", () => this.toggle());
    element("step").addEventListener("click", () => this._step());
    element("time").addEventListener("input", (event) => this.seek(Number(event.target.value)));
    const speeds = element("speed");
    for (const speed of SPEEDS) speeds.add(new Option(`${speed}×`, speed, false, speed === this.speed));
    speeds.addEventListener("change", () => {
      this.speed = Number(speeds.value);
      this.onspeed?.(this.speed);
    });
    element("camera").addEventListener("click", () => this._each((view) => { view.selected = null; view.fit(); }));
    element("above").addEventListener("click", () => this._each((view) => { view.selected = null; view.fit(true); }));
    element("theme").addEventListener("click", () => {
      const root = document.documentElement;
      root.dataset.theme = root.dataset.theme === "dark" ? "light" : "dark";
      this._each((view) => view.paint());
      this._drawPanel();
    });
    element("side").addEventListener("click", () => {
      document.body.classList.toggle("narrow");
      this._drawPanel();
    });
    for (const name of Object.keys(LAYERS)) this._layerBox(name);
    document.addEventListener("keydown", (event) => this._key(event));
    window.addEventListener("resize", () => this._drawPanel());
  }

  _layerBox(name) {
    const label = document.createElement("label"), box = document.createElement("input");
    box.type = "checkbox";
    box.id = `layer-${name}`;
    box.checked = this.shown[name];
    box.addEventListener("change", () => {
      this.shown[name] = box.checked;
      this.onlayers?.(this.shown);
      this.dirty = true;
    });
    label.append(box, ` ${name}`);
    label.hidden = !this._has(name);
    element("layers").append(label);
  }

  /** Whether there are data of a layer; a live mission computes all but fire, smoke and beliefs. */
  _has(name) {
    if (name === "fire" || name === "smoke") return this.missions.some((mission) => mission.scene.has_fire);
    if (name === "belief") return this.missions.some((mission) => mission.scene.has_beliefs);
    if (this.isLive) return true;
    if (name === "laser") return this.missions.some((mission) => mission.frames.some((frame) => frame.scans_m?.length));
    if (name === "voice" || name === "radio") return this.missions.some((mission) => mission.layers[name]);
    return true;
  }

  _key(event) {
    if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
    if (this.onkey?.(event)) return;
    if (event.key === " ") { event.preventDefault(); this.toggle(); }
    if (event.key === ".") this._step();
    if (event.key === "ArrowLeft") this.seek(this.time - 1);
    if (event.key === "ArrowRight") this.seek(this.time + 1);
  }

  _step() {
    if (this.onstep && !this.replays) this.onstep(); else this.seek(this.time + 0.2);
  }

  _each(action) {
    this.views.forEach(action);
    this.dirty = true;
  }
}

function statusText(frame, state) {
  const { victims, explored } = frame, parts = [];
  if (explored.length) parts.push(`${explored.filter(Boolean).length} of ${explored.length} areas`);
  if (victims.length) {
    parts.push(`${victims.filter(isSaved).length} of ${victims.length} victims saved`);
    const dead = victims.filter((victim) => victim.state === "dead").length;
    if (dead) parts.push(`${dead} dead`);
  }
  if (state) parts.push(`${frame.noise_db} dB noise`, state);
  return parts.join(", ");
}
