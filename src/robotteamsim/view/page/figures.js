// Shapes of people and of the command centre, as few meshes each. z points up, people look along x.

import {
  BufferAttribute, BufferGeometry, ConeGeometry, CylinderGeometry, Group, Mesh, MeshLambertMaterial, SphereGeometry,
} from "three";

const HEAD_Z = 1.62;

const upright = (geometry) => geometry.rotateX(Math.PI / 2);
const tube = (top, bottom, length, z) => upright(new CylinderGeometry(top, bottom, length, 14)).translate(0, 0, z);

/** One geometry of several. */
function merged(parts) {
  const flat = parts.map((part) => part.toNonIndexed()), whole = new BufferGeometry();
  for (const name of ["position", "normal"]) {
    const values = flat.flatMap((part) => Array.from(part.getAttribute(name).array));
    whole.setAttribute(name, new BufferAttribute(new Float32Array(values), 3));
  }
  return whole;
}

function limb(side, { length, radius, angle, from, wide }) {
  return tube(radius, radius, length, -length / 2).rotateX(side * angle).translate(0, side * wide, from);
}

/** Legs, trunk and arms. */
function body() {
  const sides = [-1, 1];
  return merged([
    ...sides.map((side) => limb(side, { length: 0.85, radius: 0.1, angle: 0.1, from: 0.88, wide: 0.11 })),
    ...sides.map((side) => limb(side, { length: 0.68, radius: 0.075, angle: 0.35, from: 1.42, wide: 0.24 })),
    tube(0.25, 0.2, 0.66, 1.13).scale(0.75, 1, 1),
  ]);
}

const BODY = body(), HEAD = new SphereGeometry(0.16, 14, 10).translate(0, 0, HEAD_Z);
const STRIPES = merged([
  tube(0.262, 0.252, 0.09, 1.3).scale(0.76, 1, 1), tube(0.225, 0.222, 0.09, 0.95).scale(0.78, 1, 1),
  ...[-1, 1].map((side) => tube(0.115, 0.115, 0.09, -0.55).rotateX(side * 0.1).translate(0, side * 0.11, 0.88)),
]);
const HELMET = merged([
  new SphereGeometry(0.2, 14, 8, 0, 2 * Math.PI, 0, Math.PI / 2).rotateX(Math.PI / 2).translate(0, 0, HEAD_Z + 0.04),
  tube(0.29, 0.29, 0.04, HEAD_Z + 0.04),
]);
const TANK = tube(0.09, 0.09, 0.5, 1.2).translate(-0.26, 0, 0);
const POSTS = merged([
  ...[[-1, -1], [-1, 1], [1, -1], [1, 1]].map(([x, y]) => tube(0.05, 0.05, 1.5, 0.75).translate(0.8 * x, 0.8 * y, 0)),
  tube(0.035, 0.035, 3.4, 1.7), // the antenna
]);
const ROOF = upright(new ConeGeometry(1.25, 0.7, 4)).rotateZ(Math.PI / 4).translate(0, 0, 1.85);
const FLOOR = merged([upright(new CylinderGeometry(1.4, 1.4, 0.06, 4)).rotateZ(Math.PI / 4).translate(0, 0, 0.03)]);
const BALL = new SphereGeometry(0.16, 12, 8).translate(0, 0, 3.4);

function figure(parts) {
  const group = new Group();
  for (const [geometry, colour] of parts) group.add(new Mesh(geometry, new MeshLambertMaterial({ color: colour })));
  return group;
}

/** A person whose clothes are the first part, coloured by state. */
export const person = ({ skin }) => figure([[BODY, skin], [HEAD, skin]]);

export const firefighter = ({ coat, stripe, skin, helmet }) =>
  figure([[BODY, coat], [STRIPES, stripe], [HEAD, skin], [HELMET, helmet], [TANK, stripe]]);

/** A tent with an antenna, on a ground of the colour of its trail and links. */
export const centre = ({ tent }, colour) => figure([[FLOOR, colour], [POSTS, tent], [ROOF, tent], [BALL, colour]]);
