// A live mission: frames arrive from the server as they are computed; commands go back: noise, seed, doors, victims.

import { Mission } from "viewer/mission";
import { make } from "viewer/panel";

export class LiveMission extends Mission {
  isLive = true;

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

  /** Send a command, such as {command: "pause"}; the server's complaint is shown. */
  async send(command) {
    const answer = await fetch("command", {
      method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(command),
    });
    this.onanswer?.((await answer.json()).error ?? "");
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

/** The part of the panel with the commands. */
export class LiveControls {
  constructor(section, mission, player) {
    Object.assign(this, { mission, player });
    this.moving = null;
    section.hidden = false;
    this.answer = make("p");
    this.victims = make("select", "", { title: "Move this victim: choose one, then click on the floor" });
    section.replaceChildren(
      make("h2", "Live"),
      this._row("noise [dB]", this._number("noise"), "set", "expected a number", Number.isFinite, (value) =>
        ({ command: "set_noise", noise_db: value })),
      this._row("seed", this._number("seed"), "restart", "expected a whole number from 0 on", isSeed, (value) =>
        ({ command: "restart", seed: value })),
      this._victimRow(),
      make("p", mission.scene.doors.length ? "Click on a door to open or close it." : ""),
      this.answer,
    );
    this.refreshNumbers();
    mission.onanswer = (error) => { this.answer.textContent = error; };
    player.onplay = (playing) => mission.send({ command: playing ? "play" : "pause" });
    player.onspeed = (speed) => mission.send({ command: "set_speed", speed });
    player.onstep = () => mission.send({ command: "step" });
    player.onlayers = (shown) => mission.send({
      command: "set_layers", viewer: mission.viewer,
      layers: ["fire", "smoke", "voice", "radio", "laser"].filter((name) => shown[name]),
    });
  }

  _number(name) {
    this[name] = make("input", "", { type: "number", step: "any", ariaLabel: name, id: `live-${name}` });
    return this[name];
  }

  /** A row with a number and a button that sends it if it is right, or else says what is expected. */
  _row(text, input, verb, expected, isRight, command) {
    const row = make("p"), button = make("button", verb);
    button.addEventListener("click", () => {
      if (isRight(input.valueAsNumber)) this.mission.send(command(input.valueAsNumber));
      else this.answer.textContent = `${text}: ${expected}`;
    });
    row.append(make("span", text), input, button);
    return row;
  }

  /** Show noise and seed of the mission, such as after a restart. */
  refreshNumbers() {
    this.noise.value = this.mission.status.noise_db;
    this.seed.value = this.mission.status.seed;
  }

  _victimRow() {
    const row = make("p"), button = make("button", "move");
    this.refreshVictims();
    button.addEventListener("click", () => {
      this.moving = this.victims.value || null;
      this.answer.textContent = this.moving ? `Click on the floor to place ${this.moving}.` : "";
    });
    row.append(make("span", "victim"), this.victims, button);
    return row;
  }

  refreshVictims() {
    const names = this.mission.frames.at(-1).victims.map((victim) => victim.name);
    if (names.join("\n") !== this.names) {
      this.names = names.join("\n");
      this.victims.replaceChildren(...names.map((name) => make("option", name, { value: name })));
    }
  }

  /** A click on a door: open or close it. */
  door(name) {
    const index = this.mission.scene.doors.findIndex((door) => door.name === name);
    const opening = this.mission.frames.at(-1)?.doors[index] ?? 0;
    this.mission.send({ command: "set_door", name, closed: opening > 0 });
    return true;
  }

  /** A click on the floor: place the chosen victim there. Returns whether there was one. */
  floor(x, y) {
    if (!this.moving) return false;
    this.mission.send({ command: "set_victim", name: this.moving, position_m: [x, y] });
    this.moving = null;
    return true;
  }
}
