// The people of a rescue: victims by state, firefighters, and the command centre.

import { CylinderGeometry, DoubleSide, Group, Mesh, MeshBasicMaterial, RingGeometry } from "three";
import { centre, firefighter, person } from "viewer/figures";

const BODY_M = 0.34; // people are enlarged like robots of this radius
const SHOULDER_M = 1.35, RING_Z = 0.03;
const DASHES = 8;
const FALLEN = ["collapsed", "dead"];

const isUpright = (victim) => victim.gait !== "lies" && !FALLEN.includes(victim.state);

export class People {
  /** Args: enlarged: factor by which a body of a radius at a place is drawn larger for a camera. */
  constructor(scene, palette, enlarged) {
    Object.assign(this, { palette, enlarged });
    this.group = new Group();
    this.victims = [];
    for (const way of scene.exits) this._exit(way);
    this.crew = scene.robots.flatMap((robot, id) => (robot.role === "robot" ? [] : [this._member(robot, id)]));
  }

  /** A green ground in front of each exit. */
  _exit({ center_m: [x, y], radius_m }) {
    const ground = disc(radius_m, 0.35, this.palette.victims.safe);
    ground.position.set(x, y, RING_Z - 0.01);
    this.group.add(ground);
  }

  _member(robot, id) {
    const isCentre = robot.role === "command_centre";
    const figure = isCentre ? centre(this.palette.people, robot.colour) : firefighter(this.palette.people);
    Object.assign(figure.userData, { robot: id, isCentre });
    if (!isCentre) figure.add(disc(0.46, 0.7, robot.colour));
    this.group.add(figure);
    return figure;
  }

  show(frame, camera) {
    for (const figure of this.crew) {
      const pose = frame.poses[figure.userData.robot];
      figure.visible = Boolean(pose);
      if (!pose) continue;
      figure.position.set(pose[0], pose[1], 0);
      figure.rotation.z = pose[2];
      figure.scale.setScalar(figure.userData.isCentre ? 1 : this.enlarged(BODY_M, figure.position, camera));
    }
    const { victims } = frame;
    while (this.victims.length < victims.length) this.victims.push(this._victim(this.victims.length));
    this.victims.forEach((figure, index) => {
      figure.visible = index < victims.length;
      if (figure.visible) this._showVictim(figure, victims[index], index, camera);
    });
  }

  _victim(index) {
    const figure = new Group(), { person: body, marks } = figure.userData = {
      person: person(this.palette.people), marks: { dashed: ring(DASHES), whole: ring(1), disc: disc(0.95, 0.55) },
    };
    body.userData.victim = index;
    figure.add(body, ...Object.values(marks));
    this.group.add(figure);
    return figure;
  }

  _showVictim(figure, victim, index, camera) {
    const { person: body, marks } = figure.userData, { state } = victim;
    const colour = this.palette.victims[state] ?? this.palette.excluded;
    figure.position.set(victim.position_m[0], victim.position_m[1], 0);
    figure.scale.setScalar(this.enlarged(BODY_M, figure.position, camera));
    body.children[0].material.color.set(colour);
    const isCarried = state === "carried" && victim.gait === "lies";
    if (isUpright(victim)) {
      body.rotation.set(0, 0, 0);
      body.position.set(0, 0, 0);
    } else { // on the back, each in another direction
      body.rotation.set(0, -Math.PI / 2, 0.6 + 1.9 * index, "ZYX");
      const along = 0.85, yaw = body.rotation.z;
      body.position.set(along * Math.cos(yaw), along * Math.sin(yaw), isCarried ? SHOULDER_M : 0.2);
    }
    const isSafe = state === "safe" || state === "saved";
    marks.disc.visible = isSafe;
    marks.dashed.visible = state === "waiting";
    marks.whole.visible = !isSafe && !["waiting", "fleeing", "carried", "dead"].includes(state);
    for (const mark of Object.values(marks)) mark.material.color.set(colour);
  }

  /** What a click hits: {robot} or {victim}, an index of the frame, or null. */
  hit(ray) {
    const found = ray.intersectObjects(this.group.children, true).find(({ object }) => visible(object));
    for (let part = found?.object; part; part = part.parent) {
      if ("robot" in part.userData || "victim" in part.userData) return { ...part.userData, distance: found.distance };
    }
    return null;
  }
}

function visible(object) {
  for (let part = object; part; part = part.parent) if (!part.visible) return false;
  return true;
}

function disc(radius, opacity, colour = undefined) {
  const material = new MeshBasicMaterial({ transparent: true, opacity, depthWrite: false });
  if (colour) material.color.set(colour);
  const mesh = new Mesh(new CylinderGeometry(radius, radius, 0.01, 28).rotateX(Math.PI / 2), material);
  mesh.position.z = RING_Z;
  return mesh;
}

/** A ring on the floor in some parts; 1 makes it whole. */
function ring(parts) {
  const group = new Group(), material = new MeshBasicMaterial({ side: DoubleSide });
  const length = (parts > 1 ? 0.6 : 1) * 2 * Math.PI / parts;
  for (let i = 0; i < parts; i++) {
    group.add(new Mesh(new RingGeometry(0.98, 1.15, Math.ceil(36 / parts), 1, 2 * Math.PI * i / parts, length), material));
  }
  group.position.z = RING_Z;
  group.material = material;
  return group;
}
