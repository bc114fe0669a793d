// Files that the page offers: a picture of what it shows, and the mission as a page.

import { make } from "viewer/panel";

const KEPT_MS = 60000; // browsers copy a file some time after the click

function download(blob, name) {
  const link = make("a", "", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), KEPT_MS);
}

/** Save what the views show now, with names, keys and scales, as a picture. */
export async function savePicture(player, title) {
  const views = document.getElementById("views"), { left, top, width, height } = views.getBoundingClientRect();
  const ratio = window.devicePixelRatio, canvas = make("canvas", "", { width: width * ratio, height: height * ratio });
  const pen = canvas.getContext("2d");
  pen.scale(ratio, ratio);
  player.show(); // a canvas keeps its picture until this task ends
  pen.fillStyle = getComputedStyle(views).backgroundColor; // between two views
  pen.fillRect(0, 0, width, height);
  for (const { renderer: { domElement } } of player.views) {
    const box = domElement.getBoundingClientRect();
    pen.drawImage(domElement, Math.round(box.left - left), Math.round(box.top - top), box.width, box.height);
  }
  const image = make("img", "", { src: written(views, width, height) });
  await image.decode();
  pen.drawImage(image, 0, 0, window.innerWidth, window.innerHeight);
  const blob = await new Promise((done) => canvas.toBlob(done, "image/png"));
  download(blob, `${title}, ${(player.time - player.start).toFixed(1)} s.png`);
}

/** What is written over the views, as the address of an SVG image as large as the window, for the style depends on that. */
function written(views, width, height) {
  const copy = views.cloneNode(true), body = make("body"), { innerWidth, innerHeight } = window;
  copy.querySelectorAll("canvas").forEach((canvas) => canvas.remove());
  for (const part of [body, copy, ...copy.querySelectorAll(".view")]) part.style.background = "none";
  Object.assign(copy.style, { flex: "none", width: `${width}px`, height: `${height}px` });
  body.append(document.querySelector("style").cloneNode(true), copy);
  const text = new XMLSerializer().serializeToString(body), { theme } = document.documentElement.dataset;
  return `data:image/svg+xml,${encodeURIComponent(`<svg xmlns="http://www.w3.org/2000/svg" width="${innerWidth}"
    height="${innerHeight}" data-theme="${theme}"><foreignObject width="100%" height="100%">${text}</foreignObject></svg>`)}`;
}

/** Save the page at an address. */
export async function savePage(address, title) {
  const answer = await fetch(address);
  if (!answer.ok) throw new Error(await answer.text());
  download(await answer.blob(), `${title}.html`);
}
