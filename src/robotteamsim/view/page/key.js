// The key: what colours and shapes mean, for people, fire and smoke.

import { MARK } from "viewer/labels";
import { make } from "viewer/panel";

/** Rows of the key of a scene: [colour, text]. */
function entries(scene, palette) {
  const rows = scene.victim_states.map((state) => [palette.victims[state], `${MARK[state] ?? ""} ${state}`.trim()]);
  const has = (role) => scene.robots.some((robot) => robot.role === role);
  if (has("firefighter")) rows.push([palette.people.helmet, "firefighter"]);
  if (has("command_centre")) rows.push([palette.people.tent, "command centre"]);
  if (scene.has_fire) {
    const { burning, hot, burnt } = palette.fire;
    rows.push([burning, "burning"], [hot, "hot"], [burnt, "burnt out"], [palette.smoke, "smoke"]);
  }
  return rows;
}

/** Fill an element with the key; it is hidden if there is nothing to explain. */
export function showKey(container, scene, palette) {
  const rows = entries(scene, palette);
  container.hidden = !rows.length;
  container.replaceChildren(...rows.map(([colour, text]) => {
    const row = make("span"), swatch = make("i");
    swatch.style.background = colour;
    row.append(swatch, text);
    return row;
  }));
}
