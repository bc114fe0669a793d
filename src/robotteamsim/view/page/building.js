// The building: floor, painted bays, walls and doors. Lengths in metres, z points up.

import {
  BufferAttribute, BufferGeometry, EdgesGeometry, ExtrudeGeometry, Group, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry, RingGeometry, Shape,
} from "three";

const FLOOR_MARGIN_M = 1.0;
export const CUT_M = 1.2; // taller walls would hide the robots behind them

/** A prism over an outline of corners [x, y]. */
export function prism(outline, height) {
  const shape = new Shape();
  outline.forEach(([x, y], index) => (index ? shape.lineTo(x, y) : shape.moveTo(x, y)));
  return new ExtrudeGeometry(shape, { depth: height, bevelEnabled: false });
}

export function segments(points, material) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  return new LineSegments(geometry, material);
}

export class Building {
  constructor(scene, palette) {
    this.group = new Group();
    const floors = scene.floors.length ? scene.floors : [scene.bounds];
    [this.floor, this.edge] = [new MeshBasicMaterial(), new MeshBasicMaterial()];
    floors.forEach((floor) => this._floor(floor));
    this.stops = scene.stops.flatMap((stop) => this._stop(stop));
    this.doors = scene.doors.map((door) => this._door(door));
    const edge = new LineBasicMaterial({ color: palette.edge });
    for (const solid of scene.solids) {
      const mesh = new Mesh(
        prism(solid.outline, Math.min(solid.height_m, CUT_M)), new MeshLambertMaterial({ color: solid.colour }));
      mesh.add(new LineSegments(new EdgesGeometry(mesh.geometry, 30), edge));
      this.group.add(mesh);
    }
    const bays = scene.bays.flatMap(([[x0, y0], [x1, y1]]) => [x0, y0, 0.02, x1, y1, 0.02]);
    if (bays.length) this.group.add(segments(bays, new LineBasicMaterial({ color: palette.bay })));
  }

  _floor([x0, y0, x1, y1]) {
    const rectangle = (margin, z, material) => {
      const mesh = new Mesh(new PlaneGeometry(x1 - x0 + 2 * margin, y1 - y0 + 2 * margin), material);
      mesh.position.set((x0 + x1) / 2, (y0 + y1) / 2, z);
      this.group.add(mesh);
    };
    rectangle(FLOOR_MARGIN_M, -0.05, this.edge);
    rectangle(0, 0, this.floor);
  }

  /** A disc with a rim: where one gets into a lift, or onto stairs or a ramp. */
  _stop({ center_m: [x, y], radius_m }) {
    return [[0, 0.25], [0.86, 1]].map(([inner, opacity]) => {
      const material = new MeshBasicMaterial({ opacity, transparent: opacity < 1 });
      const disc = new Mesh(new RingGeometry(inner * radius_m, radius_m, 48), material);
      disc.position.set(x, y, 0.02);
      this.group.add(disc);
      return material;
    });
  }

  _door(door) {
    const hinge = new Group(), [x, y] = door.hinge_m;
    const outline = door.outline.map(([px, py]) => [px - x, py - y]);
    const leaf = new Mesh(
      prism(outline, Math.min(door.height_m, CUT_M)), new MeshLambertMaterial({ color: door.colour }));
    leaf.userData.door = door.name;
    hinge.add(leaf);
    this.group.add(hinge);
    return { door, hinge, leaf };
  }

  /** Colour the floor and the stops on it as the theme asks. */
  paint(style) {
    this.floor.color.set(style.getPropertyValue("--floor").trim());
    this.edge.color.set(style.getPropertyValue("--floor-edge").trim());
    for (const material of this.stops) material.color.set(style.getPropertyValue("--soft").trim());
  }

  /** Move the doors. */
  show(openings) {
    this.doors.forEach(({ door, hinge, leaf }, index) => {
      const { pose: [x, y, angle], opacity } = leafAt(door, openings?.[index] ?? 1), { material } = leaf;
      hinge.position.set(x, y, 0);
      hinge.rotation.z = angle;
      if (material.opacity === opacity) return;
      Object.assign(material, { opacity, transparent: opacity < 1, needsUpdate: true });
    });
  }
}

/** Pose of a door's hinge, and opacity of its leaf: the open leaf of an instant door does not exist, and is transparent. */
function leafAt({ hinge_m: [x, y], shift_m: [dx, dy], angle_rad, is_instant }, opening) {
  const angle = opening * (is_instant ? Math.PI / 2 : angle_rad);
  return { pose: [x + dx * opening, y + dy * opening, angle], opacity: is_instant && opening > 0 ? 0.45 : 1 };
}
