// What has happened to a victim: each state with the time since when.

import { make, table } from "viewer/panel";
import { shownState } from "viewer/people";

function* lists(mission) {
  if (mission.isLive) for (const frame of mission.frames) yield [frame.time_s, frame.victims];
  else for (const [index, victims] of mission.changes.victims) yield [mission.times[index], victims];
}

/** The states of a victim up to a time: [[state, time of its begin], ...]. */
export function history(mission, name, until) {
  const found = [];
  for (const [time, victims] of lists(mission)) {
    if (time > until) break;
    const victim = victims.find((one) => one.name === name), state = victim && shownState(victim);
    if (state && state !== found.at(-1)?.[0]) found.push([state, time]);
  }
  return found;
}

/** Show the history of the victim that a view has selected, if any. */
export function showVictim(section, view, start) {
  const victim = view?.frame.victims?.find((one) => one.name === view.selectedVictim);
  section.hidden = !victim;
  if (!victim) return;
  const rows = history(view.mission, victim.name, view.frame.time).map(([state, time]) => [state, `${(time - start).toFixed(1)} s`]);
  const [x, y] = victim.position_m;
  rows.push(["position", `${x.toFixed(2)}, ${y.toFixed(2)} m`]);
  section.replaceChildren(make("h2", victim.name), table(rows));
}
