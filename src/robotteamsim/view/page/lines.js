// Coloured line segments in one object whose buffers are kept from one drawing to the next.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage, LineBasicMaterial, LineSegments } from "three";

export class Lines {
  count = 0;

  constructor(opacity) {
    const material = new LineBasicMaterial({ vertexColors: true, transparent: true, opacity });
    this.object = new LineSegments(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this._allocate(256);
  }

  _allocate(capacity) {
    const geometry = new BufferGeometry(), old = this.object.geometry;
    for (const name of ["position", "color"]) {
      const values = new Float32Array(6 * capacity);
      if (old.attributes[name]) values.set(old.attributes[name].array);
      geometry.setAttribute(name, new BufferAttribute(values, 3).setUsage(DynamicDrawUsage));
    }
    old.dispose();
    this.object.geometry = geometry;
    this.capacity = capacity;
  }

  clear() { this.count = 0; }

  /** Add a segment between two points [x, y] at a height. */
  add([ax, ay], [bx, by], z, { r, g, b }) {
    if (this.count === this.capacity) this._allocate(2 * this.capacity);
    const { position, color } = this.object.geometry.attributes, at = 6 * this.count++;
    position.array.set([ax, ay, z, bx, by, z], at);
    color.array.set([r, g, b, r, g, b], at);
  }

  /** Hand what was added to the graphics processor. */
  finish() {
    const { geometry } = this.object;
    geometry.setDrawRange(0, 2 * this.count);
    for (const attribute of Object.values(geometry.attributes)) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, 6 * this.count);
      attribute.needsUpdate = true;
    }
  }
}
