// The canvas of a view, and how finely it is drawn.

import { WebGLRenderer } from "three";

const SMOOTH_AFTER_MS = 400, SMOOTH_RATIO = 2;

/**
 * With a graphics processor every picture is smooth. Without one smoothing takes half of the time, so that pictures are
 * drawn without it while they change, and once more at twice the resolution when nothing has changed for a moment.
 */
export class Surface {
  constructor() {
    this.isSlow = drawsInSoftware();
    const canvas = document.createElement("canvas");
    // An opaque canvas costs the browser less than one that it has to blend with the page.
    const context = canvas.getContext("webgl2", { alpha: false, antialias: !this.isSlow });
    this.ratio = Math.min(window.devicePixelRatio, this.isSlow ? 1 : 2);
    this.renderer = new WebGLRenderer({ canvas, context: context ?? undefined });
    this.renderer.setPixelRatio(this.ratio);
  }

  render(scene, camera) {
    this._draw(scene, camera, this.ratio);
    if (!this.isSlow) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this._draw(scene, camera, SMOOTH_RATIO), SMOOTH_AFTER_MS);
  }

  _draw(scene, camera, ratio) {
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    this.renderer.render(scene, camera);
  }
}

function drawsInSoftware() {
  const probe = document.createElement("canvas").getContext("webgl2");
  if (!probe) return false; // three.js reports it
  const names = probe.getExtension("WEBGL_debug_renderer_info");
  const renderer = probe.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : probe.RENDERER);
  probe.getExtension("WEBGL_lose_context")?.loseContext(); // browsers limit the number of contexts
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer);
}
