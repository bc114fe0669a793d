// Starts the page: with the missions that it contains, or with the live mission of its server.

import { LiveControls, LiveMission } from "viewer/live";
import { decodeMissions } from "viewer/mission";
import { make } from "viewer/panel";
import { Player } from "viewer/player";
import { savePage, savePicture } from "viewer/saving";
import { View } from "viewer/view";

const NO_WEBGL = "This page needs WebGL 2, which this browser does not offer: turn on hardware acceleration, or use another browser.";
const element = (id) => document.getElementById(id);

export async function start() {
  try {
    document.documentElement.dataset.theme = "dark";
    if (window.innerWidth < 500) document.body.classList.add("narrow");
    if (!document.createElement("canvas").getContext("webgl2")) return fail(NO_WEBGL);
    const data = element("missions");
    const player = await (data ? startRecorded(data) : startLive());
    for (let i = 0; i < 3; i++) { // drawn, put into the page, shown
      await new Promise((done) => requestAnimationFrame(done));
      player.views.forEach((view) => view.finish());
    }
    offerFiles(player);
    document.body.dataset.ready = "true";
  } catch (error) {
    fail(`This page cannot be shown: ${error.message}`);
    console.error(error);
  }
}

/** Let the buttons save a picture, and the mission as a page unless this page is a file of its own. */
function offerFiles(player) {
  const title = () => player.missions.map((mission) => mission.title).join(" and ");
  // A live page hides its failure with the next frame.
  const complain = ({ message }) => (player.missions[0].onanswer ?? fail)(`This cannot be saved: ${message}`);
  element("picture").addEventListener("click", () => savePicture(player, title()).catch(complain));
  element("save").addEventListener("click", () =>
    savePage(player.isLive ? "mission.html" : location.href, title()).catch(complain));
  element("save").hidden = !location.protocol.startsWith("http");
}

function fail(text) {
  element("failure").hidden = false;
  element("failure").textContent = text;
}

function addView(mission, player, name, live = {}) {
  const container = make("div", "", { className: "view" });
  element("views").append(container);
  const callbacks = {
    onDraw: () => player()?.draw(),
    onSelect: (selected, robot) => { selected.selected = robot; player()?.draw(); },
    onDoor: () => false,
    onFloor: () => false,
    ...live,
  };
  const view = new View(container, mission, callbacks);
  if (name) container.append(make("div", name, { className: "name" }));
  return view;
}

async function startRecorded(data) {
  const missions = await decodeMissions(data.textContent);
  const compare = data.dataset.mode === "compare";
  element("title").textContent = compare ? "Comparison" : missions[0].title;
  let player = null;
  const shown = compare ? missions : missions.slice(0, 1);
  document.body.classList.toggle("side-by-side", compare);
  const views = shown.map((mission, index) =>
    addView(mission, () => player, compare ? `${"AB"[index] ?? index}: ${mission.title}` : ""));
  player = new Player(views);
  if (!compare && missions.length > 1) chooseAmong(missions, player);
  applyOptions(player, new URLSearchParams(location.hash.slice(1)));
  return player;
}

/** The address may end with #t=120&layers=voice,laser&theme=light&play=1. */
function applyOptions(player, options) {
  const { t, play, layers, theme } = Object.fromEntries(options);
  for (const name of layers?.split(",") ?? []) {
    const box = element(`layer-${name}`);
    if (box && !box.checked && !box.parentElement.hidden) box.click();
  }
  if (theme === "light") element("theme").click();
  if (Number.isFinite(Number(t ?? NaN))) player.seek(player.start + Number(t));
  if (![undefined, "0"].includes(play)) player.toggle(true);
}

function chooseAmong(missions, player) {
  const select = element("mission");
  select.hidden = false;
  element("title").hidden = true; // The selector shows it.
  missions.forEach((mission, index) => select.add(new Option(mission.title, index)));
  select.addEventListener("change", () => {
    const [view] = player.views;
    view.mission = missions[Number(select.value)];
    view.rebuild();
    player.seek(player.time);
    player.refresh();
  });
}

async function startLive() {
  const mission = await LiveMission.connect();
  let player = null, controls = null;
  element("title").textContent = mission.title;
  const view = addView(mission, () => player, "", {
    onFloor: (x, y) => controls.floor(x, y),
    onDoor: (name) => controls.door(name),
    onGoal: (robot, place) => controls.goal(robot, place),
  });
  player = new Player([view]);
  player.seek(mission.end);
  player.follow(mission.status);
  controls = new LiveControls(element("live"), mission, player);
  mission.onupdate = () => {
    if (player.following) player.time = mission.end;
    controls.refresh();
    player.follow(mission.status);
    if (mission.status.error) controls.answer.textContent = mission.status.error;
    element("failure").hidden = true;
    player.refresh();
  };
  mission.onrestart = () => {
    element("title").textContent = mission.title;
    player.following = true;
    controls.held.clear();
    controls.refreshNumbers();
    player.onlayers(player.shown);
    view.rebuild();
  };
  mission.onclose = () => fail("The simulation has ended, or its program was closed.");
  return player;
}
