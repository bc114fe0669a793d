// One mission in one canvas: camera, light, building, team, layers, labels, and clicks.

import {
  DirectionalLight, HemisphereLight, OrbitControls, PerspectiveCamera, Plane, Raycaster, Scene, Vector2, Vector3,
  WebGLRenderer,
} from "three";
import { Annotations } from "viewer/annotations";
import { Beliefs } from "viewer/beliefs";
import { Building, CUT_M } from "viewer/building";
import { Hazards } from "viewer/hazards";
import { Layers } from "viewer/layers";
import { People } from "viewer/people";
import { Team, enlarged } from "viewer/team";

const CLICK_PX = 5, FINGER_PX = 24;
const TILT_RAD = 0.5; // from the vertical
const FILLED = { x: 0.96, y: 0.93 }; // of the picture by a building that fits

export class View {
  selected = null;
  selectedVictim = null; // by name

  /** Args: callbacks: onSelect(robot), onDoor(name), onFloor(x, y), onDraw(), and in a live mission onGoal(robot, [x, y]). */
  constructor(container, mission, callbacks) {
    Object.assign(this, { container, mission, callbacks });
    this.renderer = new WebGLRenderer({ antialias: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    container.append(this.renderer.domElement);
    this.camera = new PerspectiveCamera(42, 1, 0.1, 5000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.maxPolarAngle = 1.5;
    this.controls.addEventListener("change", () => callbacks.onDraw());
    this.annotations = new Annotations(container);
    this._build();
    this._listen();
    new ResizeObserver(() => this._resize()).observe(container);
    this._resize();
  }

  _build() {
    const { scene, palette } = this.mission;
    this.scene = new Scene();
    const style = getComputedStyle(document.documentElement);
    const sky = style.getPropertyValue("--sky-light").trim(), ground = style.getPropertyValue("--ground-light").trim();
    this.scene.add(new HemisphereLight(sky, ground, 2.2));
    const sun = new DirectionalLight(sky, 1.6);
    sun.position.set(-0.5, -0.3, 1);
    this.scene.add(sun);
    this.building = new Building(scene, palette);
    this.team = new Team(scene, palette);
    this.layers = new Layers(palette, scene.robots);
    this.people = new People(scene, palette, enlarged);
    this.hazards = new Hazards(palette);
    this.beliefs = new Beliefs(scene, palette);
    this.scene.add(
      this.building.group, this.team.group, this.people.group, this.layers.group, this.hazards.group, this.beliefs.group);
    this.annotations.explain(scene, palette);
    this.paint();
    this.fit();
  }

  /** Draw another scene, such as after a restart with other settings. */
  rebuild() {
    this.selected = this.selectedVictim = null;
    this._build();
  }

  paint() {
    const style = getComputedStyle(document.documentElement);
    this.renderer.setClearColor(style.getPropertyValue("--back").trim());
    this.building.paint(style);
    this.team.ink = style.getPropertyValue("--ink").trim();
  }

  /** Place the camera so that the whole building fills the picture, tilted or from above. */
  fit(fromAbove = false) {
    const [x0, y0, x1, y1] = this.mission.scene.bounds, { camera } = this;
    const tilt = fromAbove ? 0.001 : TILT_RAD;
    const back = new Vector3(0, -Math.sin(tilt), Math.cos(tilt)); // from the floor to the camera
    this.fittedFromAbove = fromAbove;
    camera.aspect = Math.max(this.container.clientWidth, 1) / Math.max(this.container.clientHeight, 1);
    camera.updateProjectionMatrix();
    camera.position.copy(back);
    camera.lookAt(0, 0, 0);
    camera.updateMatrixWorld();
    const corners = [0, CUT_M].flatMap((z) => [[x0, y0, z], [x1, y0, z], [x0, y1, z], [x1, y1, z]]).map((corner) =>
      new Vector3(...corner).applyMatrix4(camera.matrixWorldInverse)); // right, up, backwards
    const slopeUp = Math.tan(camera.fov * Math.PI / 360), slopes = { x: FILLED.x * slopeUp * camera.aspect, y: FILLED.y * slopeUp };
    // From (right, up, away), a corner (x, y, z) is in the picture if |x - right| <= slope (away - z), and so for y.
    const limits = (axis) => {
      const low = Math.min(...corners.map((corner) => corner[axis] - slopes[axis] * corner.z));
      const high = Math.max(...corners.map((corner) => corner[axis] + slopes[axis] * corner.z));
      return { middle: (low + high) / 2, away: (high - low) / (2 * slopes[axis]) };
    };
    const right = limits("x"), up = limits("y");
    camera.translateX(right.middle);
    camera.translateY(up.middle);
    camera.translateZ(Math.max(right.away, up.away));
    this.controls.target.copy(camera.position).addScaledVector(back, -camera.position.z / back.z);
    this.controls.update();
    this.moved = false;
  }

  _resize() {
    const { clientWidth, clientHeight } = this.container, size = `${clientWidth} ${clientHeight}`;
    if (!clientWidth || !clientHeight || size === this.size) return;
    this.size = size;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    if (!this.moved) this.fit(this.fittedFromAbove);
    this.callbacks.onDraw();
  }

  _listen() {
    const canvas = this.renderer.domElement;
    let down = null;
    const isFar = (event) => Math.hypot(event.clientX - down[0], event.clientY - down[1]) > CLICK_PX;
    const end = () => {
      down = this.drag = null;
      this.controls.enabled = true;
      this.callbacks.onDraw();
    };
    canvas.addEventListener("pointerdown", (event) => {
      document.activeElement.blur(); // keys are for the mission
      down = [event.clientX, event.clientY];
      const { robot } = this.callbacks.onGoal && event.button === 0 ? this._hit(event) : {};
      this.drag = robot === undefined ? null : { robot, goal: null };
      this.controls.enabled = !this.drag;
      if (this.drag) canvas.setPointerCapture(event.pointerId);
    }, { capture: true }); // before the controls of the camera
    canvas.addEventListener("pointermove", (event) => {
      if (!this.drag || !isFar(event)) return;
      this.drag.goal = this._floor(this._ray(event));
      this.callbacks.onDraw();
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!down) return; // the drag began elsewhere
      const { drag } = this, far = isFar(event);
      end();
      if (far && drag?.goal) this.callbacks.onGoal(drag.robot, drag.goal);
      else if (far) this.moved ||= !drag;
      else if (event.button === 0) this._click(event);
    });
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("wheel", () => { this.moved = true; }, { passive: true });
  }

  /** A ray from the eye through a place of the window. */
  _ray(event) {
    const box = this.renderer.domElement.getBoundingClientRect();
    const place = new Vector2(
      2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(place, this.camera);
    return ray;
  }

  /** Where a ray meets the floor, [x, y], or null. */
  _floor(ray) {
    const place = ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), 0), new Vector3());
    return place && [place.x, place.y];
  }

  /** What is at a place of the window: {robot} or {victim}, an index of the frame, or {}. A finger need not be exact. */
  _hit(event, ray = this._ray(event)) {
    const body = ray.intersectObjects(this.team.bodies)[0], person = this.people.hit(ray);
    if (person && !(body?.distance < person.distance)) return person;
    if (body) return { robot: body.object.userData.ids[body.instanceId] };
    if (event.pointerType !== "touch") return {};
    const { left, top, width, height } = this.renderer.domElement.getBoundingClientRect();
    const far = this.frame.poses.map((pose) => {
      const at = pose && this._project([pose[0], pose[1], 0]);
      return at ? Math.hypot(left + at[0] * width - event.clientX, top + at[1] * height - event.clientY) : Infinity;
    });
    const robot = far.indexOf(Math.min(...far));
    return far[robot] < FINGER_PX ? { robot } : {};
  }

  _click(event) {
    const ray = this._ray(event), floor = this._floor(ray);
    if (floor && this.callbacks.onFloor(...floor)) return;
    const { robot, victim } = this._hit(event, ray);
    this.selectedVictim = this.frame.victims[victim]?.name ?? null;
    if (victim !== undefined || robot !== undefined) return this.callbacks.onSelect(this, robot ?? null);
    const door = ray.intersectObjects(this.building.doors.map(({ leaf }) => leaf))[0];
    if (door && this.callbacks.onDoor(door.object.userData.door)) return;
    this.callbacks.onSelect(this, null);
  }

  /** Draw a time. Args: shown: which layers are. */
  show(time, shown) {
    const frame = this.mission.at(time);
    this.frame = frame;
    this.building.show(frame.doors);
    this.team.show(frame, this.mission, shown, this.camera);
    this.people.show(frame, this.camera);
    this.hazards.show(this.mission, frame, shown);
    this.team.mark(frame, this.selected, this.camera);
    this.team.showGoals(frame, { ...this.mission.status?.driven, ...(this.drag?.goal && { [this.drag.robot]: this.drag.goal }) });
    this.layers.show(this.mission, frame, shown, this.selected);
    this.beliefs.show(this.mission, frame, shown, this.selected, this.camera);
    this._follow(frame);
    this.renderer.render(this.scene, this.camera);
    this.annotations.show(this.mission, frame, shown, {
      project: (place) => this._project(place), selected: this.selected, cells: { ...this.hazards.counts, ...this.beliefs.counts },
    });
  }

  _project(place) {
    const point = new Vector3(...place).project(this.camera);
    return point.z > 1 ? null : [(point.x + 1) / 2, (1 - point.y) / 2];
  }

  /** Wait until everything is drawn: reading a pixel does. What is compiled for the first picture would delay the first seek. */
  finish() {
    const context = this.renderer.getContext();
    context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** Keep the selected robot in the middle of the view. */
  _follow(frame) {
    const pose = this.selected === null ? null : frame.poses[this.selected];
    if (!pose) return;
    const shift = new Vector3(pose[0], pose[1], 0).sub(this.controls.target);
    if (shift.lengthSq() < 1e-8) return;
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.camera.updateMatrixWorld();
    this.controls.update();
  }
}
