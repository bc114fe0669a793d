// Names next to robots, victims and areas. A label that would cover another one is left out.

import { Vector3 } from "three";
import { shownState } from "viewer/people";

export const MARK = {
  waiting: "!", heard: "?", located: "◎", reported: "◉", reached: "●", carried: "▲", fleeing: "→", collapsed: "↓",
  saved: "✓", safe: "✓", dead: "✝",
};
const NAMES = { firefighter: (id) => `F${id}`, command_centre: () => "centre" };
const GAP_PX = 2, NEAR_PX = 9;

export class Labels {
  constructor(container) {
    this.container = container;
    this.elements = new Map();
  }

  show(frame, scene, camera, visible, selected) {
    const wanted = visible ? this._wanted(frame, scene, selected) : [];
    const taken = [], used = new Set();
    for (const { key, text, kind, at } of wanted) {
      const element = this._element(key, kind);
      if (element.textContent !== text) {
        element.textContent = text;
        element.size = null;
      }
      element.hidden = false;
      element.size ??= [element.offsetWidth, element.offsetHeight];
      const box = this._boxes(at, camera, element.size).find((one) => !taken.some((other) => overlap(one, other)));
      if (!box) { element.hidden = true; continue; }
      element.style.transform = `translate(${box[0]}px, ${box[1]}px)`;
      taken.push(box);
      used.add(key);
    }
    for (const [key, element] of this.elements) if (!used.has(key)) element.hidden = true;
  }

  /** Labels in the order of their importance. */
  _wanted(frame, scene, selected) {
    const robots = scene.robots.flatMap((robot, id) => {
      const pose = frame.poses[id];
      return pose ? [{ key: `robot ${id}`, text: NAMES[robot.role]?.(id) ?? String(id), kind: "robot", id,
        at: [pose[0], pose[1], robot.role === "robot" ? 0.3 : 1.8] }] : [];
    });
    robots.sort((a, b) => Number(b.id === selected) - Number(a.id === selected));
    const victims = (frame.victims ?? []).map((victim, index) => ({
      key: `victim ${index}`, text: `${MARK[shownState(victim)] ?? ""} ${victim.name}`, kind: "victim",
      at: [...victim.position_m, 1.7],
    }));
    const areas = scene.areas.map((area, index) => ({
      key: `area ${index}`, text: area.name, kind: "area", at: [...area.center_m, 0],
    }));
    const exits = scene.exits.map((exit, index) => ({
      key: `exit ${index}`, text: `exit ${exit.name}`, kind: "area", at: [...exit.center_m, 0],
    }));
    return [...robots.slice(0, 60), ...exits, ...victims.slice(0, 60), ...areas.slice(0, 60)];
  }

  _element(key, kind) {
    if (!this.elements.has(key)) {
      const element = document.createElement("div");
      element.className = `label ${kind}`;
      this.container.append(element);
      this.elements.set(key, element);
    }
    return this.elements.get(key);
  }

  /** Rectangles for a label next to a point, above it first, that are inside the view. */
  _boxes(at, camera, [width, height]) {
    const point = new Vector3(...at).project(camera);
    if (point.z > 1) return [];
    const { clientWidth, clientHeight } = this.container;
    const x = Math.round((point.x + 1) / 2 * clientWidth), y = Math.round((1 - point.y) / 2 * clientHeight);
    const corners = [
      [x - width / 2, y - height - NEAR_PX], [x + NEAR_PX, y - height / 2], [x - width - NEAR_PX, y - height / 2],
      [x - width / 2, y + NEAR_PX],
    ];
    return corners.map(([left, top]) => [left, top, left + width, top + height]).filter(([left, top, right, bottom]) =>
      left >= 0 && top >= 0 && right <= clientWidth && bottom <= clientHeight);
  }
}

function overlap([ax0, ay0, ax1, ay1], [bx0, by0, bx1, by1]) {
  return ax0 < bx1 + GAP_PX && bx0 < ax1 + GAP_PX && ay0 < by1 + GAP_PX && by0 < ay1 + GAP_PX;
}
