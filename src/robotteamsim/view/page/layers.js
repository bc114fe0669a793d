// Transparent layers on the floor: voice level, radio coverage, lasers.

import {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, Group, Mesh, MeshBasicMaterial, NearestFilter,
  PlaneGeometry, RGBAFormat, SRGBColorSpace,
} from "three";
import { linkColour } from "viewer/team";

const HEIGHT = { voice: 0.012, radio: 0.01, laser: 0.3 };

/** Colour of a value on a scale of ascending [value, colour] stops. */
function gradient(stops, value) {
  if (value <= stops[0][0]) return new Color(stops[0][1]);
  for (let i = 1; i < stops.length; i++) {
    const [low, lowColour] = stops[i - 1], [high, highColour] = stops[i];
    if (value < high) return new Color(lowColour).lerp(new Color(highColour), (value - low) / (high - low));
  }
  return new Color(stops.at(-1)[1]);
}

/** Ends and colours of a layer's scale. */
export function scale(palette, name) {
  const [low, high] = name === "voice" ? [palette.voice[0][0], palette.voice.at(-1)[0]] : [-90, -40];
  const stops = Array.from({ length: 9 }, (_, i) => `#${colourOf(palette, name, low + (high - low) * i / 8).getHexString()}`);
  const unit = name === "voice" ? "dB" : "dBm";
  return { low: String(low), high: `${high} ${unit}`, css: `linear-gradient(90deg, ${stops.join(", ")})` };
}

/** The colour of a cell; null: it is not drawn, as it is silent or cannot be reached. */
function colourOf(palette, name, value) {
  if (name === "voice") return value > 0 ? gradient(palette.voice, value) : null;
  return value > -100 ? linkColour(palette, value) : null;
}

export class Layers {
  constructor(palette, robots) {
    this.group = new Group();
    this.palette = palette;
    this.robots = robots;
    this.planes = {};
    this.fans = new Mesh(
      new BufferGeometry(),
      new MeshBasicMaterial({ color: palette.laser, transparent: true, opacity: 0.28, side: DoubleSide, depthWrite: false }),
    );
    this.fans.frustumCulled = false;
    this.group.add(this.fans);
  }

  show(mission, frame, shown, selected) {
    for (const name of ["voice", "radio"]) {
      const map = shown[name] ? mission.layerAt(name, frame.time) : null;
      if (this.planes[name]) this.planes[name].visible = Boolean(map);
      if (map && this.planes[name]?.userData.map !== map) this._replace(name, map);
    }
    this.fans.visible = shown.laser;
    if (shown.laser) this._showLasers(frame, frame.scans_m, selected);
  }

  _replace(name, map) {
    const old = this.planes[name];
    if (old) {
      this.group.remove(old);
      old.material.map.dispose();
      old.geometry.dispose();
    }
    const pixels = new Uint8Array(4 * map.rows * map.columns), cache = new Map();
    for (let i = 0; i < map.rows * map.columns; i++) {
      const value = map.values[i];
      if (!cache.has(value)) {
        const colour = colourOf(this.palette, name, value);
        cache.set(value, colour && [...colour.convertLinearToSRGB().toArray().map((part) => 255 * part), 190]);
      }
      if (cache.get(value)) pixels.set(cache.get(value), 4 * i);
    }
    const texture = new DataTexture(pixels, map.columns, map.rows, RGBAFormat);
    texture.colorSpace = SRGBColorSpace;
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.needsUpdate = true;
    const [width, height] = [map.columns * map.cell_m, map.rows * map.cell_m];
    const plane = new Mesh(
      new PlaneGeometry(width, height), new MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false }));
    plane.position.set(map.origin_m[0] + width / 2, map.origin_m[1] + height / 2, HEIGHT[name]);
    plane.userData.map = map;
    this.planes[name] = plane;
    this.group.add(plane);
  }

  _showLasers(frame, scans, selected) {
    const corners = [];
    (scans ?? []).forEach((ranges, id) => {
      const pose = frame.poses[id];
      if (!pose || !ranges.length || (selected !== null && selected !== id)) return;
      const { angle_min_rad, angle_step_rad, forward_m, left_m, range_max_m } = this.robots[id];
      const [x, y, yaw] = pose;
      const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
      const eye = [x + forward_m * cos - left_m * sin, y + forward_m * sin + left_m * cos, HEIGHT.laser];
      const ends = Array.from(ranges, (range, beam) => {
        const angle = yaw + angle_min_rad + beam * angle_step_rad;
        const reach = Math.min(range, range_max_m);
        return [eye[0] + reach * Math.cos(angle), eye[1] + reach * Math.sin(angle), HEIGHT.laser];
      });
      for (let beam = 1; beam < ends.length; beam++) corners.push(...eye, ...ends[beam - 1], ...ends[beam]);
    });
    this.fans.geometry.dispose();
    this.fans.geometry = new BufferGeometry();
    this.fans.geometry.setAttribute("position", new BufferAttribute(new Float32Array(corners), 3));
  }
}
