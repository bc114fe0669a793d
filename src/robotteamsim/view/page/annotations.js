// What is written over a picture: names, key, scales of colours, and the numbers of what is drawn.

import { Labels, MARK } from "viewer/labels";
import { scale } from "viewer/layers";
import { isSaved } from "viewer/mission";
import { make } from "viewer/panel";

/** Rows of the key of a scene, for people, fire, smoke and beliefs: [colour, text]. */
function keyRows(scene, palette) {
  const rows = scene.victim_states.map((state) => [palette.victims[state], `${MARK[state] ?? ""} ${state}`.trim()]);
  const has = (role) => scene.robots.some((robot) => robot.role === role);
  if (has("firefighter")) rows.push([palette.people.helmet, "firefighter"]);
  if (has("command_centre")) rows.push([palette.people.tent, "command centre"]);
  if (scene.has_fire) {
    const { burning, hot, burnt } = palette.fire;
    rows.push([burning, "burning"], [hot, "hot"], [burnt, "burnt out"], [palette.smoke, "smoke"]);
  }
  if (scene.has_beliefs) rows.push([palette.found.wall, "found by the team"], [palette.found.wrong, "found, but not there"]);
  return rows;
}

export class Annotations {
  constructor(container) {
    this.container = container;
    this.labels = new Labels(container);
    this.legend = make("div", "", { className: "legend" });
    this.key = make("div", "", { className: "key" });
    container.append(this.legend, this.key);
  }

  /** Explain the colours and shapes of a scene, if there is something to explain. */
  explain(scene, palette) {
    const rows = keyRows(scene, palette);
    this.key.hidden = !rows.length;
    this.key.replaceChildren(...rows.map(([colour, text]) => {
      const row = make("span"), swatch = make("i");
      swatch.style.background = colour;
      row.append(swatch, text);
      return row;
    }));
  }

  /**
   * Args: project: where a place [x, y, z] is, as shares of the width and height of the picture; null: not in it.
   *       cells: how many cells burn, are burnt, hot, smoky, found as walls, or wrongly; and how many ghosts there are.
   */
  show(mission, frame, shown, { project, selected, cells }) {
    this._showLegend(shown, mission.palette);
    this.labels.show(frame, mission.scene, project, shown.names, selected);
    this._report(frame, cells);
  }

  /** A scale of colours for each layer that has one. */
  _showLegend(shown, palette) {
    const names = ["voice", "radio"].filter((name) => shown[name]);
    this.legend.hidden = !names.length;
    if (this.legend.dataset.names === names.join()) return;
    this.legend.dataset.names = names.join();
    this.legend.replaceChildren(...names.map((name) => {
      const { low, high, css } = scale(palette, name), row = make("div"), bar = make("i");
      bar.style.background = css;
      row.append(`${name} ${low}`, bar, high);
      return row;
    }));
  }

  /** Numbers of what is drawn, as attributes, for tests and screen readers. */
  _report(frame, cells) {
    const { victims } = frame;
    Object.assign(this.container.dataset, {
      time: frame.time.toFixed(1), robots: frame.poses.filter(Boolean).length, links: frame.links.length,
      victims: victims.length, saved: victims.filter(isSaved).length, ...cells,
      states: victims.map((victim) => victim.state).join(" "),
    });
  }
}
