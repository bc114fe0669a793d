// A live mission: frames arrive from the server as they are computed; commands go back: noise, seed, doors, victims, robots.

import { Mission } from "viewer/mission";
import { make } from "viewer/panel";

export class LiveMission extends Mission {
  isLive = true;
  sent = Promise.resolve();

  /** Follow the frames of the server; the first update contains the scene. */
  static async connect() {
    const mission = new LiveMission();
    await new Promise((resolve, reject) => {
      const source = new EventSource("frames");
      source.onmessage = (message) => { mission._receive(JSON.parse(message.data)); resolve(); };
      source.onerror = () => {
        mission.onclose?.();
        if (!mission.frames) reject(new Error("the simulation does not answer"));
      };
    });
    return mission;
  }

  /** Send a command, such as {command: "pause"}, after those before it; the server's error is shown. */
  send(command) {
    this.sent = this.sent.then(async () => {
      const answer = await fetch("command", {
        method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(command),
      });
      this.onanswer?.((await answer.json()).error ?? "");
    }).catch((error) => this.onanswer?.(error.message));
  }

  /** The last map of a layer, for the server sends no older ones. */
  layerAt(name) { return super.layerAt(name, Infinity); }

  _receive(update) {
    this.status = update.status;
    if (update.restarted) {
      this.viewer = update.viewer;
      this.begin(update);
      this.onrestart?.();
    } else this.frames.at(-1).scans_m = []; // hours of scans would fill the memory
    this.add(update);
    this.onupdate?.();
  }
}

const isSeed = (value) => Number.isSafeInteger(value) && value >= 0;

// Shares of the greatest speeds, forward and to the left, by key.
const [AHEAD, BACK, LEFT, RIGHT] = [[1, 0], [-1, 0], [0, 1], [0, -1]];
const KEYS = {
  KeyW: AHEAD, KeyS: BACK, KeyA: LEFT, KeyD: RIGHT,
  ArrowUp: AHEAD, ArrowDown: BACK, ArrowLeft: LEFT, ArrowRight: RIGHT,
};
const HINT = "Drag a robot to a goal; or click on it, and hold W A S D or the arrow keys to drive it.";

/** Show options [value, text] in a select, which keeps its value if it can. */
function fill(select, options) {
  const { value } = select;
  select.replaceChildren(...options.map(([one, text]) => new Option(text, one, false, String(one) === value)));
}

/** The part of the panel with the commands. */
export class LiveControls {
  constructor(section, mission, player) {
    Object.assign(this, { mission, player });
    this.placing = null; // what a click on the floor sends, by its place
    this.held = new Set(); // keys
    section.hidden = false;
    this.answer = make("p");
    this.driven = make("p");
    this.victims = make("select", "", { ariaLabel: "victim" });
    this.name = make("input", "", { type: "text", maxLength: 100, ariaLabel: "name of a new victim", id: "live-name" });
    this.absent = make("select", "", { ariaLabel: "absent robot", id: "live-absent" });
    const robot = () => ({ robot: Number(this.absent.value) });
    const atStart = make("button", "at start", { type: "button", onclick: () => this._command("spawn_robot", robot()) });
    this.reserve = this._row("robot", [this.absent], "add", () => this._place("the robot", "spawn_robot", robot()));
    this.reserve.append(atStart);
    const commands = [
      this._numberRow("noise [dB]", "noise", "set", "expected a number", Number.isFinite, "set_noise", "noise_db"),
      this._numberRow("seed", "seed", "restart", "expected a whole number from 0 on", isSeed, "restart", "seed"),
      this._row("victim", [this.victims], "move", () => this._placeVictim(this.victims.value)),
      this._row("new victim", [this.name], "add", () => this._placeVictim(this.name.value.trim())),
      this.reserve,
      this.driven,
      make("p", mission.scene.doors.length ? `${HINT} Click on a door to open or close it.` : HINT),
    ];
    // A mission that a program steps has none of these.
    section.replaceChildren(make("h2", "Live"), ...("driven" in mission.status ? commands : []), this.answer);
    this.refreshNumbers();
    this.refresh();
    mission.onanswer = (error) => { this.answer.textContent = error; };
    player.onplay = (playing) => this._command(playing ? "play" : "pause");
    player.onspeed = (speed) => this._command("set_speed", { speed });
    player.onstep = () => this._command("step");
    player.onlayers = (shown) => this._command("set_layers", {
      viewer: mission.viewer, layers: ["fire", "smoke", "belief", "voice", "radio", "laser"].filter((name) => shown[name]),
    });
    player.onkey = (event) => this._key(event);
    document.addEventListener("keyup", (event) => this._key(event));
    window.addEventListener("blur", () => this._drive(() => this.held.clear()));
  }

  _command(command, values = {}) { this.mission.send({ command, ...values }); }

  /** A row of the panel; Enter does what its button does. */
  _row(text, fields, verb, act) {
    const row = make("form", "", { noValidate: true });
    row.addEventListener("submit", (event) => {
      event.preventDefault();
      act();
    });
    row.append(make("span", text), ...fields, make("button", verb));
    return row;
  }

  /** A row with a number and a button that sends it if it is right, or else says what is expected. */
  _numberRow(text, name, verb, expected, isRight, command, key) {
    const input = this[name] = make("input", "", { type: "number", step: "any", ariaLabel: name, id: `live-${name}` });
    return this._row(text, [input], verb, () => {
      if (isRight(input.valueAsNumber)) this._command(command, { [key]: input.valueAsNumber });
      else this.answer.textContent = `${text}: ${expected}`;
    });
  }

  /** Show noise and seed of the mission, such as after a restart. */
  refreshNumbers() {
    this.noise.value = this.mission.status.noise_db;
    this.seed.value = this.mission.status.seed;
  }

  /** Let the next click on the floor send a command with its place. */
  _place(what, command, values) {
    this.placing = (position_m) => this._command(command, { ...values, position_m });
    this.answer.textContent = `Click on the floor to place ${what}.`;
  }

  _placeVictim(name) {
    if (name) this._place(name, "set_victim", { name }); else this.answer.textContent = "new victim: expected a name";
  }

  /** Show which victims there are, which robots are absent, and which are driven by hand. */
  refresh() {
    const { victims, poses } = this.mission.frames.at(-1), { robots } = this.mission.scene;
    const names = victims.map((victim) => victim.name), absent = [...poses.keys()].filter((robot) => !poses[robot]);
    const driven = Object.keys(this.mission.status.driven ?? {}), listed = JSON.stringify([names, absent, driven]);
    if (listed === this.listed) return;
    this.listed = listed;
    fill(this.victims, names.map((name) => [name, name]));
    fill(this.absent, absent.map((robot) => [robot, robots[robot].name]));
    if (!this.name.value || names.includes(this.name.value)) {
      let number = names.length + 1;
      while (names.includes(`victim ${number}`)) number++;
      this.name.value = `victim ${number}`;
    }
    this.reserve.hidden = !absent.length;
    this.driven.replaceChildren(...driven.map((robot) => {
      const title = "Leave it to its controller again", onclick = () => this._command("release", { robot: Number(robot) });
      return make("button", `release ${robots[robot].name}`, { title, onclick });
    }));
  }

  /** A click on a door: open or close it. */
  door(name) {
    const index = this.mission.scene.doors.findIndex((door) => door.name === name);
    const opening = this.mission.frames.at(-1)?.doors[index] ?? 0;
    this._command("set_door", { name, closed: opening > 0 });
    return true;
  }

  /** A click on the floor: place there what was chosen. Returns whether there was something. */
  floor(x, y) {
    const { placing } = this;
    this.placing = null;
    placing?.([x, y]);
    return Boolean(placing);
  }

  /** The end of a robot's drag: it drives there. */
  goal(robot, position_m) { this._command("set_goal", { robot, position_m }); }

  /** A key is pressed or released. Returns whether it drives the selected robot. */
  _key({ code, type, ctrlKey, altKey, metaKey }) {
    const { selected } = this.player.views[0], isDown = type === "keydown";
    if (!(code in KEYS) || isDown && (selected === null || ctrlKey || altKey || metaKey)) return false;
    if (!this.held.size) this.robot = selected;
    this._drive(() => (isDown ? this.held.add(code) : this.held.delete(code)));
    return true;
  }

  /** Change the keys that are held, and drive accordingly. */
  _drive(change) {
    const before = [...this.held].join();
    change();
    if ([...this.held].join() === before) return;
    const sum = (axis) => Math.sign([...this.held].reduce((total, code) => total + KEYS[code][axis], 0));
    this._command("drive", { robot: this.robot, forward: sum(0), turn: sum(1) });
  }
}
