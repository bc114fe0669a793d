// The panel at the side: the selected robot, curves, and events.

import { Curves } from "viewer/curves";
import { showVictim } from "viewer/history";
import { lastIndex } from "viewer/recording";
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

const PART = 40; // events of a list that the browser lays out only when it is visible

function setPast(item, isPast) {
  if (item.classList.contains("past") !== isPast) item.classList.toggle("past", isPast);
}

export class Panel {
  constructor(onSeek, colours) {
    this.onSeek = onSeek;
    this.curves = new Curves(element("curves"), onSeek, colours);
    this.events = [];
    this.parts = [];
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
    const items = this.events.map((event) => {
      const item = make("li");
      item.append(make("time", event.time_s.toFixed(1)), make("span", event.text));
      item.addEventListener("click", () => this.onSeek(event.time_s));
      return item;
    });
    this.parts = [];
    for (let i = 0; i < items.length; i += PART) {
      const list = make("ol");
      list.append(...items.slice(i, i + PART));
      this.parts.push({ list, items: items.slice(i, i + PART) });
    }
    element("events").replaceChildren(make("h2", "Events"), ...this.parts.map(({ list }) => list));
  }

  /** Mark the first events as past: a part of the list as a whole where that is possible. */
  _markPast(count) {
    this.parts.forEach(({ list, items }, index) => {
      const inPart = Math.min(Math.max(count - index * PART, 0), items.length);
      setPast(list, inPart === items.length);
      items.forEach((item, place) => setPast(item, inPart < items.length && place < inPart));
    });
  }

  show(views, start, time) {
    const past = this.events.length && this.events[0].time_s <= time
      ? lastIndex(this.events, time, (event) => event.time_s) + 1 : 0;
    this._markPast(past);
    this.curves.mark(time);
    this._showRobot(views.find((view) => view.selected !== null));
    showVictim(element("victim"), views.find((view) => view.selectedVictim !== null), start);
  }

  _showRobot(view) {
    const section = element("robot");
    section.hidden = !view;
    if (!view) return;
    const { frame, selected, mission } = view, pose = frame.poses[selected];
    const links = frame.links.filter(([a, b]) => a === selected || b === selected).map(([a, b, signal]) =>
      `${a === selected ? b : a}${signal === UNKNOWN_DBM ? "" : ` (${signal} dBm)`}`);
    const swarm = frame.swarms?.[selected];
    const rows = [
      ["position", pose ? `${pose[0].toFixed(2)}, ${pose[1].toFixed(2)} m` : "absent"],
      ["heading", pose ? `${Math.round(((pose[2] * 180 / Math.PI) % 360 + 360) % 360)}°` : "–"],
      ["swarm", swarm === undefined ? "–" : swarm < 0 ? "excluded" : String(swarm)],
      ["links", links.join(", ") || "none"],
    ];
    section.replaceChildren(make("h2", mission.scene.robots[selected].name), table(rows));
  }
}
