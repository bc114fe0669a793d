// Fire and smoke: flames and burnt ground, and two sheets of smoke, one on the floor and one above the robots.

import {
  BufferAttribute, BufferGeometry, Color, ConeGeometry, DoubleSide, Group, InstancedMesh, Mesh, MeshBasicMaterial, Object3D,
} from "three";

const HOT = 1, BURNT = 2, BURNING = 3; // values of the layer `fire`, see layers.py
const OPACITY = { [HOT]: 0.4, [BURNT]: 0.95, [BURNING]: 0.95 };
const GROUND_Z = 0.025, FLAME_M = 1.2;
const SHEETS = [[0.04, 0.55], [1.25, 0.5]]; // height [m] and opacity of smoke without any visibility

/** Numbers of cells in maps of fire and smoke, which may be null. */
function countCells(fire, smoke) {
  const count = { [HOT]: 0, [BURNT]: 0, [BURNING]: 0 };
  fire?.values.forEach((value) => { if (value) count[value] += 1; });
  const smoky = smoke?.values.reduce((sum, value) => sum + (value > 0), 0) ?? 0;
  return { burning: count[BURNING], burnt: count[BURNT], hot: count[HOT], smoky };
}

export class Hazards {
  constructor(palette) {
    this.palette = palette;
    this.group = new Group();
    this.counts = countCells(null, null);
    this.ground = this._film(true);
    this.flames = this.tips = null;
    this.sheets = SHEETS.map(([z, opacity]) => ({ mesh: this._film(), z, opacity }));
  }

  /** Draw the maps of a time; unchanged ones stay. */
  show(mission, frame, shown) {
    const fire = mission.layerAt("fire", frame.time), smoke = mission.layerAt("smoke", frame.time);
    if (fire !== this.fire || smoke !== this.smoke) this.counts = countCells(fire, smoke);
    if (fire !== this.fire) this._showFire(fire);
    if (smoke !== this.smoke) this._showSmoke(smoke);
    for (const mesh of [this.ground, this.flames, this.tips]) if (mesh) mesh.visible = shown.fire && Boolean(fire);
    for (const { mesh } of this.sheets) mesh.visible = shown.smoke && Boolean(smoke);
  }

  _film() {
    const material = new MeshBasicMaterial({ vertexColors: true, transparent: true, side: DoubleSide, depthWrite: false });
    const mesh = new Mesh(new BufferGeometry(), material);
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  _showFire(map) {
    this.fire = map;
    const { burning, burnt, hot } = this.palette.fire;
    const tints = { [HOT]: new Color(hot), [BURNT]: new Color(burnt), [BURNING]: new Color(burning).multiplyScalar(0.6) };
    const positions = [], colours = [], flames = [];
    map?.values.forEach((value, cell) => {
      if (!value) return;
      const row = Math.floor(cell / map.columns), column = cell % map.columns;
      const colour = tints[value], opacity = OPACITY[value];
      for (const [i, j] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) {
        positions.push(...place(map, column + i, row + j), GROUND_Z);
        colours.push(colour.r, colour.g, colour.b, opacity);
      }
      if (value === BURNING) flames.push([...place(map, column + 0.5, row + 0.5), (3 * row + 5 * column) % 7]);
    });
    fill(this.ground, positions, colours);
    this._showFlames(flames, map?.cell_m ?? 0);
  }

  /** Cones of different heights, the inner ones brighter; their height depends on the cell only. */
  _showFlames(places, cell) {
    if (!this.flames || this.flames.instanceMatrix.count < places.length) {
      for (const old of [this.flames, this.tips]) if (old) { this.group.remove(old); old.dispose(); }
      this.flames = this._cones(2 * places.length + 64, this.palette.fire.burning, 0.85);
      this.tips = this._cones(2 * places.length + 64, this.palette.fire.tip, 0.95);
    }
    const at = new Object3D();
    for (const [mesh, width, height] of [[this.flames, 0.8, 0.8], [this.tips, 0.42, 1.15]]) {
      mesh.count = places.length;
      places.forEach(([x, y, kind], index) => {
        at.position.set(x, y, GROUND_Z);
        at.rotation.z = kind;
        at.scale.set(width * cell, width * cell, height * FLAME_M * (0.55 + 0.12 * kind));
        at.updateMatrix();
        mesh.setMatrixAt(index, at.matrix);
      });
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  _cones(count, colour, opacity) {
    const cone = new ConeGeometry(1, 1, 6).rotateX(Math.PI / 2).translate(0, 0, 0.5);
    const mesh = new InstancedMesh(cone, new MeshBasicMaterial({ color: colour, transparent: true, opacity }), count);
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  /** Sheets whose opacity at a corner is the mean of the cells around it. */
  _showSmoke(map) {
    this.smoke = map;
    const { r, g, b } = new Color(this.palette.smoke);
    const positions = [], shares = [];
    const value = (column, row) => (map.values[
      Math.min(Math.max(row, 0), map.rows - 1) * map.columns + Math.min(Math.max(column, 0), map.columns - 1)]) / 400;
    const corner = (column, row) =>
      value(column - 1, row - 1) + value(column, row - 1) + value(column - 1, row) + value(column, row);
    map?.values.forEach((here, cell) => {
      if (!here) return;
      const row = Math.floor(cell / map.columns), column = cell % map.columns;
      for (const [i, j] of [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]]) {
        positions.push(place(map, column + i, row + j));
        shares.push(corner(column + i, row + j));
      }
    });
    for (const { mesh, z, opacity } of this.sheets) {
      fill(mesh, positions.flatMap(([x, y]) => [x, y, z]), shares.flatMap((share) => [r, g, b, opacity * share]));
    }
  }
}

const place = ({ origin_m: [x, y], cell_m }, column, row) => [x + column * cell_m, y + row * cell_m];

function fill(mesh, positions, colours) {
  mesh.geometry.dispose();
  mesh.geometry = new BufferGeometry();
  mesh.geometry.setAttribute("position", new BufferAttribute(new Float32Array(positions), 3));
  mesh.geometry.setAttribute("color", new BufferAttribute(new Float32Array(colours), 4));
}
