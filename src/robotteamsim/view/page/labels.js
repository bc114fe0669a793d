// Names next to robots, victims, areas, levels and stops. A label that would cover another one or a robot is left out.

export const MARK = {
  waiting: "!", heard: "?", located: "◎", reported: "◉", reached: "●", carried: "▲", fleeing: "→", collapsed: "↓",
  saved: "✓", safe: "✓", dead: "✝",
};
const NAMES = { firefighter: (id) => `F${id}`, command_centre: () => "centre" };
const GAP_PX = 2, NEAR_PX = 9, BODY_PX = 8;

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
    const bodies = frame.poses.map((pose) => pose && project([pose[0], pose[1], 0.1])).filter(Boolean).map(([x, y]) =>
      [x * view[0] - BODY_PX, y * view[1] - BODY_PX, x * view[0] + BODY_PX, y * view[1] + BODY_PX]);
    wanted.forEach(({ key, kind, at, boxesAt = boxesNextTo }, index) => {
      const boxes = boxesAt(project(at), view, sizes[index]), others = kind === "robot" ? taken : [...taken, ...bodies];
      const box = boxes.find((one) => !others.some((other) => overlap(one, other)));
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
    const levels = scene.levels.map(([text, place], index) => ({
      key: `level ${index}`, text, kind: "level", at: [...place, 0], boxesAt: boxesAbove,
    }));
    const stops = scene.stops.map(({ name, center_m: [x, y], radius_m }, index) => ({
      key: `stop ${index}`, text: name, kind: "area", at: [x, y - radius_m, 0], boxesAt: boxesBelow,
    }));
    return [
      ...robots.slice(0, 60), ...levels.slice(0, 60), ...exits, ...victims.slice(0, 60), ...areas.slice(0, 60),
      ...stops.slice(0, 60),
    ];
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
function boxesNextTo(point, view, size) {
  return boxesAt(point, view, size, (width, height) => [
    [-width / 2, -height - NEAR_PX], [NEAR_PX, -height / 2], [-width - NEAR_PX, -height / 2], [-width / 2, NEAR_PX],
  ]);
}

/** The rectangle for a label whose lower left corner is near a point, such as the corner of a floor. */
function boxesAbove(point, view, size) {
  return boxesAt(point, view, size, (width, height) => [[NEAR_PX, -height - GAP_PX]]);
}

/** As `boxesNextTo`, below a point first, such as the edge of a disc. */
function boxesBelow(point, view, size) {
  return boxesAt(point, view, size, (width, height) => [
    [-width / 2, GAP_PX], [NEAR_PX, -height], [-width - NEAR_PX, -height], [-width / 2, -height - 2 * NEAR_PX],
  ]);
}

/** Rectangles that are inside the view. Args: shifts: returns their upper left corners from a point. */
function boxesAt(point, [viewWidth, viewHeight], [width, height], shifts) {
  if (!point) return [];
  const x = Math.round(point[0] * viewWidth), y = Math.round(point[1] * viewHeight);
  const corners = shifts(width, height).map(([right, down]) => [x + right, y + down]);
  return corners.map(([left, top]) => [left, top, left + width, top + height]).filter(([left, top, right, bottom]) =>
    left >= 0 && top >= 0 && right <= viewWidth && bottom <= viewHeight);
}

function overlap([ax0, ay0, ax1, ay1], [bx0, by0, bx1, by1]) {
  return ax0 < bx1 + GAP_PX && bx0 < ax1 + GAP_PX && ay0 < by1 + GAP_PX && by0 < ay1 + GAP_PX;
}
