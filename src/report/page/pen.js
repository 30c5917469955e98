// Small things drawn on canvas.
import { theme } from "./theme.js";

const FONT = '"Segoe UI", system-ui, -apple-system, Roboto, "Liberation Sans", sans-serif';

/** A canvas cleared and ready to be drawn on in CSS pixels; nothing while it is not shown. */
export function prepare(canvas) {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (width === 0 || height === 0) return null;
  const ratio = window.devicePixelRatio || 1;
  const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== columns || canvas.height !== rows) [canvas.width, canvas.height] = [columns, rows];
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.lineJoin = "round";
  pen.lineCap = "round";
  return { pen, width, height };
}

/** Text with a halo of paper, so that it reads on anything. */
export function label(pen, text, x, y, { size = 12, colour = theme().text, align = "left", weight = "" } = {}) {
  pen.font = `${weight} ${size}px ${FONT}`;
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.lineWidth = 3;
  pen.strokeStyle = theme().paper;
  pen.strokeText(text, x, y);
  pen.fillStyle = colour;
  pen.fillText(text, x, y);
}

export function circle(pen, x, y, radius) {
  pen.beginPath();
  pen.arc(x, y, Math.max(radius, 0), 0, 2 * Math.PI);
}

/** An arrow from a point along a vector; shorter than its head, it is not drawn. */
export function arrow(pen, x, y, dx, dy, colour, width = 2.5) {
  const length = Math.hypot(dx, dy);
  if (!(length > 2)) return;
  const [ux, uy] = [dx / length, dy / length];
  const head = Math.min(10, 0.7 * length);
  const [tipX, tipY] = [x + dx, y + dy];
  const [neckX, neckY] = [tipX - head * ux, tipY - head * uy];
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(neckX, neckY);
  pen.stroke();
  pen.beginPath();
  pen.moveTo(tipX, tipY);
  pen.lineTo(neckX - 0.42 * head * uy, neckY + 0.42 * head * ux);
  pen.lineTo(neckX + 0.42 * head * uy, neckY - 0.42 * head * ux);
  pen.fill();
}

/** A bar of a given length with what it stands for above it. */
export function scaleBar(pen, x, y, length, text) {
  pen.strokeStyle = theme().muted;
  pen.lineWidth = 1.5;
  pen.beginPath();
  pen.moveTo(x, y - 3);
  pen.lineTo(x, y + 3);
  pen.moveTo(x, y);
  pen.lineTo(x + length, y);
  pen.moveTo(x + length, y - 3);
  pen.lineTo(x + length, y + 3);
  pen.stroke();
  label(pen, text, x + length + 6, y, { size: 11, colour: theme().muted });
}

/** A path that fades towards its begin: `points` come oldest first, as `[x, y]`. */
export function fadingPath(pen, points, colour, width) {
  const steps = 24;
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  for (let step = 0; step < steps; step++) {
    const from = Math.floor((points.length - 1) * (step / steps));
    const to = Math.ceil((points.length - 1) * ((step + 1) / steps));
    if (to <= from) continue;
    pen.globalAlpha = 0.08 + 0.92 * ((step + 1) / steps) ** 1.6;
    pen.beginPath();
    pen.moveTo(...points[from]);
    for (let k = from + 1; k <= to; k++) pen.lineTo(...points[k]);
    pen.stroke();
  }
  pen.globalAlpha = 1;
}
