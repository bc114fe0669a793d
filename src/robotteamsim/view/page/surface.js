// The canvas of a view, and how finely it is drawn.

import { WebGLRenderer } from "three";

const SMOOTH_AFTER_MS = 400;
const SHIFTS_PX = [[-0.25, -0.25], [0.25, 0.25], [-0.25, 0.25], [0.25, -0.25]];

/** How a browser draws in three dimensions: "hardware", "software", or null if it cannot. */
export function webgl() {
  const probe = document.createElement("canvas").getContext("webgl2");
  if (!probe) return null;
  const names = probe.getExtension("WEBGL_debug_renderer_info");
  const renderer = probe.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : probe.RENDERER);
  probe.getExtension("WEBGL_lose_context")?.loseContext(); // browsers limit the number of contexts
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(renderer) ? "software" : "hardware";
}

/**
 * With a graphics processor every picture is smooth. Without one smoothing takes half of the time. Such a browser draws
 * without it while pictures change. When nothing has changed for a moment, it draws the same picture four times, shifted
 * by parts of a pixel, and shows their mean. A change waits for one of these drawings at most.
 */
export class Surface {
  constructor(isSlow) {
    this.isSlow = isSlow;
    const canvas = document.createElement("canvas");
    // An opaque canvas costs the browser less than one that it has to blend with the page.
    const context = canvas.getContext("webgl2", { alpha: false, antialias: !isSlow });
    this.renderer = new WebGLRenderer({ canvas, context });
    this.renderer.setPixelRatio(isSlow ? 1 : Math.min(window.devicePixelRatio, 2));
    this.elements = [canvas];
    if (isSlow) this.elements.push(this._mean());
  }

  _mean() {
    const canvas = document.createElement("canvas");
    canvas.className = "mean";
    canvas.hidden = true;
    this.mean = canvas.getContext("2d", { alpha: false });
    return canvas;
  }

  render(scene, camera) {
    this.renderer.render(scene, camera);
    if (!this.isSlow) return;
    this.mean.canvas.hidden = true;
    clearTimeout(this.timer);
    cancelAnimationFrame(this.next);
    this.timer = setTimeout(() => this._smooth(scene, camera, 0), SMOOTH_AFTER_MS);
  }

  _smooth(scene, camera, index) {
    const { width, height } = this.renderer.domElement, { canvas } = this.mean;
    if (!index) Object.assign(canvas, { width, height });
    camera.setViewOffset(width, height, ...SHIFTS_PX[index], width, height);
    this.renderer.render(scene, camera);
    camera.clearViewOffset();
    this.mean.globalAlpha = 1 / (index + 1);
    this.mean.drawImage(this.renderer.domElement, 0, 0);
    if (index + 1 < SHIFTS_PX.length) this.next = requestAnimationFrame(() => this._smooth(scene, camera, index + 1));
    else canvas.hidden = false;
  }

  /** Wait until the graphics processor, or the software in its place, has done all that it was asked to. */
  async finished() {
    const context = this.renderer.getContext(), fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence) return; // the context is lost
    context.flush();
    while (context.clientWaitSync(fence, 0, 0) === context.TIMEOUT_EXPIRED) await new Promise((done) => setTimeout(done, 4));
    context.deleteSync(fence);
  }
}
