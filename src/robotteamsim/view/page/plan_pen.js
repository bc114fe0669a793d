// Draws outlines on a canvas in metres, with y upwards.

export class PlanPen {
  /** Args: alpha: false, as an opaque canvas costs the browser less than one that it has to blend with the page. */
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d", { alpha: false });
  }

  /** Begin a picture. Args: metre: its length [px].  left, bottom: where the place [0, 0] is [px]. */
  begin(metre, [left, bottom], ground) {
    const { canvas: { width, height, clientWidth }, pen } = this, ratio = width / clientWidth; // as `fit` chose it
    this.metre = metre;
    pen.resetTransform();
    pen.fillStyle = ground;
    pen.fillRect(0, 0, width, height);
    pen.setTransform(ratio * metre, 0, 0, -ratio * metre, ratio * left, ratio * bottom);
  }

  /** Begin a path through points. */
  path(points, isClosed = false) {
    this.pen.beginPath();
    for (const [x, y] of points) this.pen.lineTo(x, y);
    if (isClosed) this.pen.closePath();
    return this;
  }

  /** Begin the path around a body at a pose: its outline, or a disc if that is empty. */
  body([x, y, yaw = 0], outline, radius) {
    const cos = Math.cos(yaw), sin = Math.sin(yaw);
    this.path(outline.map(([px, py]) => [x + cos * px - sin * py, y + sin * px + cos * py]), outline.length > 0);
    if (!outline.length) this.pen.arc(x, y, radius, 0, 2 * Math.PI);
    return this;
  }

  /** Draw a map: each cell is one pixel of an image, which is enlarged. Args: look: colour and opacity of a cell by its value. */
  cells({ rows, columns, cell_m, origin_m: [x, y], values }, look) {
    const image = document.createElement("canvas");
    Object.assign(image, { width: columns, height: rows });
    const brush = image.getContext("2d");
    values.forEach((value, cell) => {
      if (!value) return;
      [brush.fillStyle, brush.globalAlpha] = look(value);
      brush.fillRect(cell % columns, Math.floor(cell / columns), 1, 1);
    });
    this.pen.imageSmoothingEnabled = false;
    this.pen.drawImage(image, x, y, columns * cell_m, rows * cell_m);
  }

  fill(colour, opacity = 1) {
    Object.assign(this.pen, { fillStyle: colour, globalAlpha: opacity });
    this.pen.fill();
    this.pen.globalAlpha = 1;
    return this;
  }

  stroke(colour, width_px = 1.2) {
    Object.assign(this.pen, { strokeStyle: colour, lineWidth: width_px / this.metre });
    this.pen.stroke();
    return this;
  }
}
