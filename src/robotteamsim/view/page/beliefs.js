// What robots believe: where they are, as ghosts, and what they have found of the building, over the true one.

import {
  Color, CylinderGeometry, DataTexture, DynamicDrawUsage, Group, InstancedMesh, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, NearestFilter, Object3D, PlaneGeometry, RGBAFormat, SRGBColorSpace,
} from "three";
import { CUT_M, prism } from "viewer/building";
import { Lines } from "viewer/lines";
import { enlarged } from "viewer/team";

const FREE = 1, WALL = 2, WRONG = 3; // values of cells, see found.py
const FLOOR_Z = 0.014, FLOOR_OPACITY = 0.24, GHOST_Z = 0.02, LINE_Z = 0.3;
const BEYOND_M = 0.03; // found walls cover the true ones

export class Beliefs {
  constructor(scene, palette) {
    Object.assign(this, { robots: scene.robots, palette });
    this.group = new Group();
    this.lines = new Lines(0.9);
    this.counts = { found: 0, wrong: 0, ghosts: 0 };
    this.group.add(this.lines.object);
    this.maps = []; // that are drawn
  }

  /** Args: selected: the robot whose map is drawn; null: what anybody has found. */
  show(mission, frame, shown, selected, camera) {
    this.group.visible = shown.belief;
    if (!shown.belief) return;
    this._showGhosts(frame, camera);
    const ids = selected === null ? [...this.robots.keys()] : [selected];
    const maps = ids.map((id) => mission.layerAt(`found_${id}`, frame.time)).filter(Boolean);
    const isSame = maps.length === this.maps.length && maps.every((map, index) => map === this.maps[index]);
    if (isSame && this.selected === selected) return;
    Object.assign(this, { maps, selected });
    this._showFound(maps, new Color(selected === null ? this.palette.found.wall : this.robots[selected].colour));
  }

  /** A translucent body at each place where a robot may be, and a line to it from where the robot is. */
  _showGhosts({ poses, beliefs }, camera) {
    const ghosts = (beliefs ?? []).flatMap((belief, id) => (belief && poses[id] ? belief.poses.map((pose) => [id, pose]) : []));
    if (!this.ghosts || this.ghosts.instanceMatrix.count < ghosts.length) this.ghosts = this._ghostsFor(2 * ghosts.length + 4);
    const place = new Object3D(), colour = new Color();
    this.lines.clear();
    ghosts.forEach(([id, [x, y, yaw]], index) => {
      const { radius_m, height_m } = this.robots[id];
      colour.set(this.robots[id].colour);
      place.position.set(x, y, GHOST_Z);
      place.rotation.z = yaw;
      const factor = 1.25 * enlarged(radius_m, place.position, camera);
      place.scale.set(factor * radius_m, factor * radius_m, 1.3 * factor * height_m);
      place.updateMatrix();
      this.ghosts.setMatrixAt(index, place.matrix);
      this.ghosts.setColorAt(index, colour);
      this.lines.add(poses[id], [x, y], LINE_Z, colour);
    });
    this.lines.finish();
    this.ghosts.count = this.counts.ghosts = ghosts.length;
    this.ghosts.instanceMatrix.needsUpdate = true;
    if (this.ghosts.instanceColor) this.ghosts.instanceColor.needsUpdate = true;
  }

  _ghostsFor(count) {
    this._remove(this.ghosts);
    const body = new CylinderGeometry(1, 1, 1, 24).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    const material = new MeshBasicMaterial({ transparent: true, opacity: 0.4, depthWrite: false });
    return this._add(new InstancedMesh(body, material, count));
  }

  _add(mesh) {
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  _remove(mesh) {
    if (!mesh) return;
    this.group.remove(mesh);
    mesh.material.map?.dispose();
    mesh.geometry.dispose();
    mesh.dispose?.();
  }

  /** Colour the floor that was found, and the walls; what one robot has found wrong counts, whatever others say. */
  _showFound(maps, colour) {
    for (const old of [this.floor, this.walls]) this._remove(old);
    this.floor = this.walls = null;
    this.counts = { ...this.counts, found: 0, wrong: 0 };
    if (!maps.length) return;
    const [{ rows, columns, origin_m, cell_m }] = maps;
    const values = Int8Array.from({ length: rows * columns }, (_, cell) => Math.max(...maps.map((map) => map.values[cell])));
    values.forEach((value) => { this.counts.found += value >= WALL; this.counts.wrong += value === WRONG; });
    const place = { rows, columns, x: origin_m[0], y: origin_m[1], cell_m };
    this.floor = this._floor(values, place, colour);
    this.walls = this._walls(values, place, { [WALL]: colour, [WRONG]: new Color(this.palette.found.wrong) });
  }

  _floor(values, { rows, columns, x, y, cell_m }, colour) {
    const pixels = new Uint8Array(4 * values.length), tint = colour.clone().convertLinearToSRGB().toArray().map((part) => 255 * part);
    values.forEach((value, cell) => { if (value === FREE) pixels.set([...tint, 255 * FLOOR_OPACITY], 4 * cell); });
    const texture = new DataTexture(pixels, columns, rows, RGBAFormat);
    texture.colorSpace = SRGBColorSpace;
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.needsUpdate = true;
    const [width, height] = [columns * cell_m, rows * cell_m];
    const plane = new Mesh(
      new PlaneGeometry(width, height), new MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false }));
    plane.position.set(x + width / 2, y + height / 2, FLOOR_Z);
    this.group.add(plane);
    return plane;
  }

  /** Boxes over the cells that are walls: one for each run of equal cells of a row. */
  _walls(values, { rows, columns, x, y, cell_m }, colours) {
    const runs = [];
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < columns; column++) {
        const value = values[row * columns + column], first = column;
        if (value < WALL) continue;
        while (column + 1 < columns && values[row * columns + column + 1] === value) column++;
        runs.push([row, first, column + 1 - first, value]);
      }
    }
    if (!runs.length) return null;
    const box = prism([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], 1);
    const mesh = this._add(new InstancedMesh(box, new MeshLambertMaterial(), runs.length)), at = new Object3D();
    runs.forEach(([row, first, length, value], index) => {
      at.position.set(x + (first + length / 2) * cell_m, y + (row + 0.5) * cell_m, 0);
      at.scale.set(length * cell_m + BEYOND_M, cell_m + BEYOND_M, CUT_M + BEYOND_M);
      at.updateMatrix();
      mesh.setMatrixAt(index, at.matrix);
      mesh.setColorAt(index, colours[value]);
    });
    return mesh;
  }
}
