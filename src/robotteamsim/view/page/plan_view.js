// One mission from above, drawn without WebGL. It has the methods of View, but no camera and fewer layers.

import { Annotations } from "viewer/annotations";
import { leafAt } from "viewer/building";
import { BURNING, BURNT, HOT, OPACITY, countCells } from "viewer/hazards";
import { shownState } from "viewer/people";
import { PlanPen } from "viewer/plan_pen";
import { MOST_TRAILS, TRAIL_S, linkColour } from "viewer/team";

const LEAST_PX = 6, PERSON_M = 0.34; // smaller bodies are enlarged
const NEAR_PX = 14; // of a click
const SMOKE_OPACITY = 0.75; // where one sees nothing, about as that of both sheets of the 3D view together
const FILLED = 0.92; // share of the view that the building takes

export class PlanView {
  selected = null;
  selectedVictim = null; // by name
  lacks = ["voice", "radio", "laser"];

  /** Args: callbacks: those of View. */
  constructor(container, mission, callbacks) {
    Object.assign(this, { container, mission, callbacks });
    this.canvas = document.createElement("canvas");
    this.pen = new PlanPen(this.canvas);
    container.append(this.canvas);
    this.annotations = new Annotations(container);
    this.canvas.addEventListener("click", (event) => this._click([event.offsetX, event.offsetY]));
    new ResizeObserver(() => this.fit()).observe(container);
    this.rebuild();
  }

  /** Show another scene, such as after a restart with other settings. */
  rebuild() {
    this.selected = this.selectedVictim = null;
    this.annotations.explain(this.mission.scene, this.mission.palette);
    this.fit();
  }

  paint() {} // each drawing has the colours of the theme

  finished() {} // at the end of `show`

  fit() {
    const [x0, y0, x1, y1] = this.mission.scene.bounds, { clientWidth: width, clientHeight: height } = this.container;
    this.canvas.width = width * window.devicePixelRatio;
    this.canvas.height = height * window.devicePixelRatio;
    const free = height - this.annotations.key.offsetHeight; // the key is below the building
    this.metre = FILLED * Math.min(width / (x1 - x0), free / (y1 - y0)); // [px]
    this.origin = [(width - this.metre * (x0 + x1)) / 2, (free + this.metre * (y0 + y1)) / 2]; // [px]
    this.callbacks.onDraw();
  }

  /** Draw a time. Args: shown: which layers are. */
  show(time, shown) {
    const { mission, metre, origin: [left, bottom], selected } = this, frame = mission.at(time);
    const fire = mission.layerAt("fire", frame.time), smoke = mission.layerAt("smoke", frame.time);
    const style = getComputedStyle(document.documentElement), colour = (name) => style.getPropertyValue(name).trim();
    Object.assign(this, { frame, ink: colour("--ink") });
    this.pen.begin(metre, this.origin, colour("--back"));
    this._building(frame, colour("--floor"));
    this._places(frame);
    if (shown.fire && fire) this.pen.cells(fire, this._fireLooks());
    if (shown.trails) this._trails(frame);
    if (shown.links) this._links(frame);
    this._team(frame);
    this._victims(frame);
    if (shown.smoke && smoke) this.pen.cells(smoke, (value) => [mission.palette.smoke, SMOKE_OPACITY * value / 100]);
    const { clientWidth: width, clientHeight: height } = this.container, cells = countCells(fire, smoke);
    const project = ([x, y]) => [(left + metre * x) / width, (bottom - metre * y) / height];
    this.annotations.show(mission, frame, shown, { project, selected, cells });
  }

  _building(frame, ground) {
    const { palette, scene: { bounds: [x0, y0, x1, y1], bays, solids, doors } } = this.mission;
    this.pen.path([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]).fill(ground);
    for (const bay of bays) this.pen.path(bay).stroke(palette.bay);
    for (const { outline, colour } of solids) this.pen.path(outline, true).fill(colour).stroke(palette.edge);
    doors.forEach((door, index) => {
      const { pose, opacity } = leafAt(door, frame.doors?.[index] ?? 1), [x, y] = door.hinge_m;
      this.pen.body(pose, door.outline.map(([px, py]) => [px - x, py - y]), 0).fill(door.colour, opacity);
    });
  }

  /** Areas, exits and objects. */
  _places(frame) {
    const { palette, scene } = this.mission;
    for (const { center_m, radius_m } of scene.exits) this.pen.body(center_m, [], radius_m).fill(palette.victims.safe, 0.35);
    scene.areas.forEach(({ center_m, radius_m }, index) => {
      const colour = index === frame.target ? this.ink : palette.areas.open;
      this.pen.body(center_m, [], radius_m).stroke(frame.explored?.[index] ? palette.areas.explored : colour, 2);
    });
    scene.objects.forEach(({ outline, radius_m, colour }, index) => {
      if (frame.objects?.[index]) this.pen.body(frame.objects[index], outline, radius_m).fill(colour);
    });
  }

  _fireLooks() {
    const { burning, burnt, hot } = this.mission.palette.fire;
    const colours = { [HOT]: hot, [BURNT]: burnt, [BURNING]: burning };
    return (value) => [colours[value], OPACITY[value]];
  }

  _trails(frame) {
    this.mission.scene.robots.slice(0, MOST_TRAILS).forEach(({ colour }, robot) =>
      this.pen.path(this.mission.trail(robot, frame.time - TRAIL_S, frame.time)).stroke(colour));
  }

  _links({ links, poses }) {
    for (const [a, b, signal] of links) {
      if (poses[a] && poses[b]) this.pen.path([poses[a], poses[b]]).stroke(linkColour(this.mission.palette, signal).getStyle());
    }
  }

  _team(frame) {
    const { palette, scene: { robots } } = this.mission;
    robots.forEach(({ role, outline, radius_m, colour }, id) => {
      if (!frame.poses[id]) return;
      const [x, y, yaw] = frame.poses[id], factor = Math.max(1, LEAST_PX / this.metre / radius_m), r = factor * radius_m;
      const body = this.pen.body([x, y, yaw], outline.map(([px, py]) => [factor * px, factor * py]), r);
      body.fill(frame.swarms?.[id] === -1 ? palette.excluded : colour);
      if (role === "firefighter") body.stroke(palette.people.helmet, 2);
      if (id === this.selected) this.pen.body([x, y], [], 1.5 * r).stroke(this.ink, 2);
      if (role === "command_centre") return;
      this.pen.path([[x, y], [x + r * Math.cos(yaw), y + r * Math.sin(yaw)]]).stroke(palette.nose, 2);
    });
  }

  _victims(frame) {
    const { palette } = this.mission, radius = Math.max(PERSON_M, LEAST_PX / this.metre);
    for (const victim of frame.victims ?? []) {
      this.pen.body(victim.position_m, [], radius).fill(palette.victims[shownState(victim)] ?? palette.excluded).stroke(this.ink);
    }
  }

  _click([x_px, y_px]) {
    const place = [(x_px - this.origin[0]) / this.metre, (this.origin[1] - y_px) / this.metre];
    const near = (points) => nearest(place, points, NEAR_PX / this.metre);
    const { poses, victims = [] } = this.frame, { doors } = this.mission.scene;
    const robot = near(poses), victim = robot < 0 ? near(victims.map((one) => one.position_m)) : -1;
    this.selectedVictim = victims[victim]?.name ?? null;
    if (robot >= 0 || victim >= 0) return this.callbacks.onSelect(this, robot < 0 ? null : robot);
    const door = near(doors.map(({ outline }) => middle(outline)));
    if (door >= 0 && this.callbacks.onDoor(doors[door].name)) return;
    if (!this.callbacks.onFloor(...place)) this.callbacks.onSelect(this, null);
  }
}

const middle = (corners) => [0, 1].map((i) => corners.reduce((sum, corner) => sum + corner[i], 0) / corners.length);

/** Index of the nearest point, some of which are null, within a reach; -1: none. */
function nearest([x, y], points, reach) {
  const distances = points.map((point) => (point ? Math.hypot(point[0] - x, point[1] - y) : Infinity));
  const least = Math.min(...distances);
  return least < reach ? distances.indexOf(least) : -1;
}
