// Names next to robots, victims and areas. A label that would cover another one is left out.

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

  /** Args: project: see Annotations. */
  show(frame, scene, project, visible, selected) {
    const wanted = visible ? this._wanted(frame, scene, selected) : [];
    const sizes = this._sizes(wanted), taken = [], places = new Map();
    const view = [this.container.clientWidth, this.container.clientHeight];
    wanted.forEach(({ key, at }, index) => {
      const boxes = boxesNextTo(project(at), view, sizes[index]);
      const box = boxes.find((one) => !taken.some((other) => overlap(one, other)));
      if (!box) return;
      taken.push(box);
      places.set(key, `translate(${box[0]}px, ${box[1]}px)`);
    });
    for (const [key, element] of this.elements) {
      const place = places.get(key);
      element.hidden = !place;
      if (place && element.style.transform !== place) element.style.transform = place;
    }
  }

  /** Write the texts, and return the size of each label. All are written before one is measured: a single layout. */
  _sizes(wanted) {
    const elements = wanted.map(({ key, text, kind }) => {
      const element = this._element(key, kind);
      if (element.shownText !== text) {
        element.textContent = element.shownText = text;
        element.size = null;
        element.hidden = false;
      }
      return element;
    });
    return elements.map((element) => element.size ??= [element.offsetWidth, element.offsetHeight]);
  }

  /** Labels in the order of their importance. */
  _wanted(frame, scene, selected) {
    const robots = scene.robots.flatMap((robot, id) => {
      const pose = frame.poses[id];
      return pose ? [{ key: `robot ${id}`, text: NAMES[robot.role]?.(robot.number) ?? String(robot.number), kind: "robot", id,
        at: [pose[0], pose[1], robot.role === "robot" ? 0.3 : 1.8] }] : [];
    });
    robots.sort((a, b) => Number(b.id === selected) - Number(a.id === selected));
    const victims = frame.victims.map((victim, index) => ({
      key: `victim ${index}`, text: `${MARK[victim.state] ?? ""} ${victim.name}`, kind: "victim",
      at: [...victim.position_m, 1.7],
    }));
    const areas = scene.areas.map((area, index) => ({
      key: `area ${index}`, text: area.name, kind: "area", at: [...area.center_m, 0],
    }));
    const exits = scene.exits.map((exit, index) => ({
      key: `exit ${index}`, text: `exit ${exit.name}`, kind: "area", at: [...exit.center_m, 0],
    }));
    const marks = scene.marks.map(([text, place], index) => ({ key: `mark ${index}`, text, kind: "area", at: [...place, 0] }));
    return [...robots.slice(0, 60), ...marks.slice(0, 60), ...exits, ...victims.slice(0, 60), ...areas.slice(0, 60)];
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
}

/** Rectangles for a label of a size next to a point, above it first, that are inside the view. */
function boxesNextTo(point, [viewWidth, viewHeight], [width, height]) {
  if (!point) return [];
  const x = Math.round(point[0] * viewWidth), y = Math.round(point[1] * viewHeight);
  const corners = [
    [x - width / 2, y - height - NEAR_PX], [x + NEAR_PX, y - height / 2], [x - width - NEAR_PX, y - height / 2],
    [x - width / 2, y + NEAR_PX],
  ];
  return corners.map(([left, top]) => [left, top, left + width, top + height]).filter(([left, top, right, bottom]) =>
    left >= 0 && top >= 0 && right <= viewWidth && bottom <= viewHeight);
}

function overlap([ax0, ay0, ax1, ay1], [bx0, by0, bx1, by1]) {
  return ax0 < bx1 + GAP_PX && bx0 < ax1 + GAP_PX && ay0 < by1 + GAP_PX && by0 < ay1 + GAP_PX;
}
