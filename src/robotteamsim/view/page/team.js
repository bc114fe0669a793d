// What moves: robots, trails, links, areas and objects.

import {
  Color, ConeGeometry, CylinderGeometry, DoubleSide, DynamicDrawUsage, Group, InstancedMesh, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, Object3D, RingGeometry,
} from "three";
import { prism } from "viewer/building";
import { Lines } from "viewer/lines";

const TRAIL_S = 40, MOST_TRAILS = 60;
const TRAIL_STEP_M = 0.15; // nearer points of a trail are left out
const LINK_Z = 0.6, TRAIL_Z = 0.05, CROSS_M = 0.4;
const LEAST_SIZE = 0.0085; // of a robot's radius, as a share of its distance from the camera: far robots are enlarged
const [STRONG_DBM, WEAK_DBM, ENDANGERED_DBM] = [-50, -70, -80];

export const UNKNOWN_DBM = 5000; // the signal of a link in a recording without signals

/** Colour of a link by its signal [dBm]. */
export function linkColour(palette, signal) {
  const { strong, weak, endangered } = palette.links;
  if (signal === UNKNOWN_DBM) return new Color(palette.event);
  if (signal > STRONG_DBM) return new Color(strong);
  if (signal > WEAK_DBM) return new Color(weak).lerp(new Color(strong), (signal - WEAK_DBM) / (STRONG_DBM - WEAK_DBM));
  const share = Math.max((signal - ENDANGERED_DBM) / (WEAK_DBM - ENDANGERED_DBM), 0);
  return new Color(endangered).lerp(new Color(weak), share);
}

/** Factor by which a body of a radius [m] at a place is drawn larger, so that it can be seen from far away. */
export function enlarged(radius, place, camera) {
  return Math.max(1, LEAST_SIZE * camera.position.distanceTo(place) / radius);
}

export class Team {
  constructor(scene, palette) {
    this.group = new Group();
    this.palette = palette;
    this.robots = scene.robots;
    this.bodies = this._bodies();
    this.noses = this._instances(new ConeGeometry(0.5, 1, 4).rotateZ(-Math.PI / 2), scene.robots.length, false);
    this.noses.raycast = () => {};
    this.links = new Lines(0.9);
    this.linkColours = new Map(); // by signal [dBm]
    this.trails = new Lines(0.75);
    this.trailColours = scene.robots.slice(0, MOST_TRAILS).map((robot) => new Color(robot.colour));
    this.goals = new Lines(1);
    this.group.add(this.links.object, this.trails.object, this.goals.object);
    this.areas = scene.areas.map((area) => this._area(area));
    this.objects = scene.objects.map((object) => this._object(object));
    this.ring = new Mesh(new RingGeometry(1.15, 1.5, 40), new MeshBasicMaterial({ side: DoubleSide }));
    this.ring.visible = false;
    this.group.add(this.ring);
  }

  /** One instanced mesh for all robots of one shape. */
  _bodies() {
    const shapes = new Map();
    this.robots.forEach((robot, id) => {
      if (robot.role !== "robot") return; // see people.js
      const key = JSON.stringify([robot.radius_m, robot.outline, robot.height_m]);
      shapes.set(key, [...(shapes.get(key) ?? []), id]);
    });
    return [...shapes.values()].map((ids) => {
      const { radius_m, outline, height_m } = this.robots[ids[0]];
      const body = outline.length
        ? prism(outline, height_m)
        : new CylinderGeometry(radius_m, radius_m, height_m, 24).rotateX(Math.PI / 2).translate(0, 0, height_m / 2);
      const mesh = this._instances(body, ids.length, true);
      mesh.userData.ids = ids;
      return mesh;
    });
  }

  _instances(geometry, count, coloured) {
    const mesh = new InstancedMesh(geometry, new MeshLambertMaterial(coloured ? {} : { color: this.palette.nose }), count);
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  _area({ center_m: [x, y], radius_m }) {
    const material = new MeshBasicMaterial({ transparent: true, opacity: 0.75, side: DoubleSide });
    const ring = new Mesh(new RingGeometry(radius_m * 0.93, radius_m, 64), material);
    ring.position.set(x, y, 0.03);
    this.group.add(ring);
    return ring;
  }

  _object({ radius_m, outline, height_m, colour }) {
    const geometry = outline.length
      ? prism(outline, height_m)
      : new CylinderGeometry(radius_m, radius_m, height_m, 32).rotateX(Math.PI / 2).translate(0, 0, height_m / 2);
    const mesh = new Mesh(geometry, new MeshLambertMaterial({ color: colour }));
    this.group.add(mesh);
    return mesh;
  }

  /** Args: frame: of `mission`.  shown: which layers are.  camera: for the size of far robots. */
  show(frame, mission, shown, camera) {
    this._showRobots(frame, camera);
    this._showLinks(frame, shown.links);
    this._showTrails(frame, mission, shown.trails);
    const { open, target, explored } = this.palette.areas;
    this.areas.forEach((ring, index) => {
      const isTarget = !frame.explored[index] && index === frame.target;
      ring.material.color.set(frame.explored[index] ? explored : isTarget ? this.ink ?? target : open);
      ring.material.opacity = isTarget ? 1 : 0.75;
    });
    this.objects.forEach((mesh, index) => {
      const pose = frame.objects[index];
      mesh.visible = Boolean(pose);
      if (pose) { mesh.position.set(pose[0], pose[1], 0); mesh.rotation.z = pose[2]; }
    });
  }

  _showRobots(frame, camera) {
    const place = new Object3D(), colour = new Color();
    for (const mesh of this.bodies) {
      mesh.userData.ids.forEach((id, index) => {
        const pose = frame.poses[id];
        place.position.set(pose?.[0] ?? 0, pose?.[1] ?? 0, 0.03);
        place.rotation.z = pose?.[2] ?? 0;
        place.scale.setScalar(pose ? enlarged(this.robots[id].radius_m, place.position, camera) : 0);
        place.updateMatrix();
        mesh.setMatrixAt(index, place.matrix);
        mesh.setColorAt(index, colour.set(frame.swarms[id] === -1 ? this.palette.excluded : this.robots[id].colour));
      });
      mesh.instanceMatrix.needsUpdate = true;
      mesh.instanceColor.needsUpdate = true;
      mesh.boundingSphere = null; // raycasts use it
    }
    this.robots.forEach((robot, id) => {
      const [x, y, yaw] = frame.poses[id] ?? [0, 0, 0];
      const factor = enlarged(robot.radius_m, place.position.set(x, y, 0.03), camera);
      const size = frame.poses[id] && robot.role === "robot" ? 0.9 * robot.radius_m * factor : 0;
      place.position.set(
        x + 0.45 * size * Math.cos(yaw), y + 0.45 * size * Math.sin(yaw), 0.04 + factor * robot.height_m);
      place.rotation.z = yaw;
      place.scale.set(size, 0.9 * size, 0.12 * size);
      place.updateMatrix();
      this.noses.setMatrixAt(id, place.matrix);
    });
    this.noses.instanceMatrix.needsUpdate = true;
  }

  _showLinks(frame, visible) {
    this.links.clear();
    for (const [first, second, signal] of visible ? frame.links : []) {
      const a = frame.poses[first], b = frame.poses[second];
      if (a && b) this.links.add(a, b, LINK_Z, this._linkColour(signal));
    }
    this.links.finish();
  }

  _linkColour(signal) {
    if (!this.linkColours.has(signal)) this.linkColours.set(signal, linkColour(this.palette, signal));
    return this.linkColours.get(signal);
  }

  _showTrails(frame, mission, visible) {
    this.trails.clear();
    (visible ? this.trailColours : []).forEach((colour, robot) => {
      for (const piece of mission.trails(robot, frame.time - TRAIL_S, frame.time)) {
        let last = null;
        piece.forEach((point, index) => {
          const isNear = last && Math.hypot(point[0] - last[0], point[1] - last[1]) < TRAIL_STEP_M;
          if (isNear && index < piece.length - 1) return;
          if (last) this.trails.add(last, point, TRAIL_Z, colour);
          last = point;
        });
      }
    });
    this.trails.finish();
  }

  /** Draw lines to the goals of robots that are driven by hand, and crosses there. Args: goals: [x, y] or null, by id. */
  showGoals(frame, goals) {
    this.goals.clear();
    for (const [robot, goal] of Object.entries(goals)) {
      const pose = frame.poses[robot], colour = new Color(this.robots[robot].colour);
      if (!pose || !goal) continue;
      this.goals.add(pose, goal, LINK_Z, colour);
      const [x, y] = goal, r = CROSS_M;
      this.goals.add([x - r, y - r], [x + r, y + r], LINK_Z, colour);
      this.goals.add([x - r, y + r], [x + r, y - r], LINK_Z, colour);
    }
    this.goals.finish();
  }

  /** Mark the selected robot; null: none. */
  mark(frame, robot, camera) {
    const pose = robot === null ? null : frame.poses[robot];
    this.ring.visible = Boolean(pose);
    if (pose) {
      this.ring.position.set(pose[0], pose[1], 0.06);
      this.ring.scale.setScalar(
        this.robots[robot].radius_m * enlarged(this.robots[robot].radius_m, this.ring.position, camera));
    }
  }
}
