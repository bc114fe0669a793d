// What is written over a picture: names, key, scales of colours, and the numbers of what is drawn.

import { showKey } from "viewer/key";
import { Labels } from "viewer/labels";
import { scale } from "viewer/layers";
import { shownState } from "viewer/people";
import { isSaved } from "viewer/recording";

export class Annotations {
  constructor(container) {
    this.container = container;
    this.labels = new Labels(container);
    this.legend = document.createElement("div");
    this.legend.className = "legend";
    this.key = document.createElement("div");
    this.key.className = "key";
    container.append(this.legend, this.key);
  }

  /** Explain the colours and shapes of a scene. */
  explain(scene, palette) {
    showKey(this.key, scene, palette);
  }

  /**
   * Args: project: where a place [x, y, z] is, as shares of the width and height of the picture; null: not in it.
   *       cells: how many cells burn, are burnt, hot or smoky.
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
      const { low, high, css } = scale(palette, name), row = document.createElement("div");
      const bar = document.createElement("i");
      bar.style.background = css;
      row.append(`${name} ${low}`, bar, high);
      return row;
    }));
  }

  /** Numbers of what is drawn, as attributes, for tests and screen readers. */
  _report(frame, cells) {
    const victims = frame.victims ?? [];
    Object.assign(this.container.dataset, {
      time: frame.time.toFixed(1), robots: frame.poses.filter(Boolean).length, links: frame.links.length,
      victims: victims.length, saved: victims.filter((victim) => isSaved(victim)).length, ...cells,
      states: victims.map(shownState).join(" "),
    });
  }
}
