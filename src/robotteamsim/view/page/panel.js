// The panel at the side: the selected robot, curves, and events.

import { Curves } from "viewer/curves";
import { lastIndex } from "viewer/mission";
import { UNKNOWN_DBM } from "viewer/team";

const element = (id) => document.getElementById(id);

/** A new element with text; never HTML, because names come from files. */
export function make(tag, text = "", attributes = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  Object.assign(made, attributes);
  return made;
}

/** A table of rows [name, value]. */
export function table(rows) {
  const made = make("table");
  for (const [name, value] of rows) {
    const row = make("tr");
    row.append(make("td", name), make("td", value));
    made.append(row);
  }
  return made;
}

/** What an event is about, such as "victim" of victim_saved. */
const topic = (event) => event.kind.split("_")[0];

/** Events of which those about links that follow each other are one, so that they do not hide the others. */
function summarised(events) {
  const shown = [];
  for (const event of events) {
    const last = shown.at(-1);
    if (topic(event) === "link" && last && topic(last) === "link") {
      last.count++;
      last.text = `${last.count} links endangered`;
    } else shown.push({ ...event, count: 1 });
  }
  return shown;
}

const seconds = (time) => (time === null ? "not reached" : `${time.toFixed(1)} s`);

/** Rows [name, value] on fire, exits and doses in a frame. */
function egressRows({ egress }) {
  const { ignition_s, aset_s, rset_s, out, exposures } = egress;
  const rows = ignition_s === null ? [] : [["fire began", seconds(ignition_s)]];
  for (const [name, count] of Object.entries(out)) rows.push([`out: ${name}`, String(count)]);
  if (Object.keys(out).length) {
    if (ignition_s !== null) rows.push(["ASET", seconds(aset_s)]);
    rows.push(["RSET", seconds(rset_s)]);
  }
  if (exposures.length) rows.push(["largest FED", Math.max(...exposures.flatMap(([gas, heat]) => [gas, heat])).toFixed(2)]);
  return rows;
}

/** Rows [name, value] on where a robot believes that it is. */
function beliefRows(pose, belief) {
  if (!pose || !belief) return [];
  const [[x, y, yaw]] = belief.poses, turn = Math.abs(yaw - pose[2]) % (2 * Math.PI);
  const error = `${Math.hypot(x - pose[0], y - pose[1]).toFixed(2)} m, ${(Math.min(turn, 2 * Math.PI - turn) * 180 / Math.PI).toFixed(1)}°`;
  return [["believes", `${x.toFixed(2)}, ${y.toFixed(2)} m`], ["wrong by", error], ["localisation", belief.state]];
}

export class Panel {
  constructor(onSeek, colours) {
    this.onSeek = onSeek;
    this.curves = new Curves(element("curves"), onSeek, colours);
    this.events = [];
    this.shown = []; // those of the list
    this.items = []; // of the list, one for each event shown
    this.hidden = new Set(); // topics
    this.topics = make("p");
    this.list = make("ol");
    element("events").replaceChildren(make("h2", "Events"), this.topics, this.list);
  }

  /** List the events of missions, and mark them on the slider. A list that is the same stays, with clicks on it. */
  setEvents(missions, start, end, colours) {
    const lists = missions.map((mission) => mission.events), count = lists.flat().length;
    const isSame = this.lists?.length === lists.length && lists.every((list, index) => list === this.lists[index]);
    if (!isSame || count !== this.events.length) this._listEvents(lists);
    this.lists = lists;
    this._drawMarks(start, end, colours);
  }

  /** One canvas: thousands of elements would make each frame slow. */
  _drawMarks(start, end, colours) {
    const canvas = element("marks"), ratio = window.devicePixelRatio;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    const pen = canvas.getContext("2d");
    for (const event of this.events) {
      const share = (event.time_s - start) / Math.max(end - start, 1e-9);
      pen.fillStyle = colours(event.kind);
      pen.fillRect(Math.round(share * canvas.width - 1.5 * ratio), 0, 3 * ratio, canvas.height);
    }
  }

  _listEvents(lists) {
    this.events = lists.flatMap((events, index) =>
      events.map((event) => ({ ...event, text: lists.length > 1 ? `${"AB"[index] ?? index}: ${event.text}` : event.text })));
    this.events.sort((a, b) => a.time_s - b.time_s);
    this._listTopics();
    this._listShown();
  }

  /** A box for each topic, with the number of its events, that shows or hides them. */
  _listTopics() {
    const counts = new Map();
    for (const event of this.events) counts.set(topic(event), (counts.get(topic(event)) ?? 0) + 1);
    this.topics.replaceChildren(...[...counts].map(([name, count]) => {
      const label = make("label"), box = make("input", "", { type: "checkbox", checked: !this.hidden.has(name) });
      box.addEventListener("change", () => {
        if (box.checked) this.hidden.delete(name); else this.hidden.add(name);
        this._listShown();
      });
      label.append(box, ` ${name} ${count}`);
      return label;
    }));
  }

  _listShown() {
    this.shown = summarised(this.events.filter((event) => !this.hidden.has(topic(event))));
    this.items = this.shown.map((event) => {
      const item = make("li");
      item.append(make("time", event.time_s.toFixed(1)), make("span", event.text));
      item.addEventListener("click", () => this.onSeek(event.time_s));
      return item;
    });
    this.list.replaceChildren(...this.items);
    this._markLatest();
  }

  _markLatest() {
    this.latest?.classList.remove("latest");
    const isBefore = !(this.shown[0]?.time_s <= this.time);
    this.latest = isBefore ? null : this.items[lastIndex(this.shown, this.time, (event) => event.time_s)];
    this.latest?.classList.add("latest");
  }

  show(views, start, time) {
    this.time = time;
    this._markLatest();
    this.curves.mark(time);
    this._showRobot(views.find((view) => view.selected !== null));
    this._showVictim(views.find((view) => view.selectedVictim !== null), start);
    this._showEgress(views);
  }

  /** Show how many people are out by each exit, and available against required safe egress time. */
  _showEgress(views) {
    const section = element("egress"), shown = views.filter(({ frame }) => frame.egress);
    section.hidden = !shown.length;
    const rows = shown.flatMap(({ frame }) => egressRows(frame)), text = JSON.stringify(rows);
    if (section.dataset.rows === text) return;
    section.dataset.rows = text;
    section.replaceChildren(make("h2", "People and fire"), table(rows));
  }

  _showRobot(view) {
    const section = element("robot");
    section.hidden = !view;
    if (!view) return;
    const { frame, selected, mission } = view, pose = frame.poses[selected], robots = mission.scene.robots;
    const links = frame.links.filter(([a, b]) => a === selected || b === selected).map(([a, b, signal]) =>
      `${robots[a === selected ? b : a].number}${signal === UNKNOWN_DBM ? "" : ` (${signal} dBm)`}`);
    const swarm = frame.swarms[selected];
    const rows = [
      ["position", pose ? `${pose[0].toFixed(2)}, ${pose[1].toFixed(2)} m` : "absent"],
      ["heading", pose ? `${Math.round(((pose[2] * 180 / Math.PI) % 360 + 360) % 360)}°` : "–"],
      ["swarm", swarm === undefined ? "–" : swarm < 0 ? "excluded" : String(swarm)],
      ["links", links.join(", ") || "none"],
      ...beliefRows(pose, frame.beliefs?.[selected]),
      ...Object.entries(frame.sensors?.[selected] ?? {}),
    ];
    section.replaceChildren(make("h2", robots[selected].name), table(rows));
  }

  /** Show what has happened to a victim: each state with the time since when. */
  _showVictim(view, start) {
    const section = element("victim");
    const victim = view?.frame.victims.find((one) => one.name === view.selectedVictim);
    section.hidden = !victim;
    if (!victim) return;
    const history = view.mission.history(victim.name, view.frame.time);
    const rows = history.map(([state, time]) => [state, `${(time - start).toFixed(1)} s`]);
    const [x, y] = victim.position_m;
    rows.push(["position", `${x.toFixed(2)}, ${y.toFixed(2)} m`]);
    const exposure = view.frame.egress?.exposures[view.frame.victims.indexOf(victim)];
    if (exposure) {
      const [gas, heat, visibility] = exposure;
      rows.push(["FED by gas", gas.toFixed(2)], ["FED by heat", heat.toFixed(2)], ["visibility", `${visibility.toFixed(1)} m`]);
    }
    section.replaceChildren(make("h2", victim.name), table(rows));
  }
}
