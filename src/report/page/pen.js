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

/** Width of a label (px). */
export function widthOf(pen, text, { size = 12, weight = "" } = {}) {
  pen.font = `${weight} ${size}px ${FONT}`;
  return pen.measureText(text).width;
}

/** Whether two boxes have a place in common. */
export function meet(one, other) {
  return one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom;
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

/**
 * An arrow that ends at the border of a box (`left`, `top`, `right`, `bottom`), where two strokes
 * across it say that it goes on. If it does, the place and the direction (inwards) of its end.
 */
export function arrowWithin(pen, box, [x, y], [dx, dy], colour, width) {
  if (!(Math.hypot(dx, dy) > 2)) return null;
  const part = partWithin(box, [x, y], [dx, dy]);
  if (!part) return null;
  const [from, to] = part;
  const at = (share) => [x + share * dx, y + share * dy];
  const [begin, tip] = [at(from), at(to)];
  if (to < 1 && from > 0) {
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(...begin);
    pen.lineTo(...tip);
    pen.stroke();
  } else {
    arrow(pen, ...begin, tip[0] - begin[0], tip[1] - begin[1], colour, width);
  }
  if (from === 0 && to === 1) return null;
  const length = Math.hypot(dx, dy);
  const along = [dx / length, dy / length];
  const [end, inwards] = to < 1 ? [tip, -1] : [begin, 1];
  breakMark(pen, [end[0] + 18 * inwards * along[0], end[1] + 18 * inwards * along[1]], along, colour);
  return { end, direction: along.map((part) => inwards * part) };
}

/**
 * A label beside the cut end of an arrow: the first place on either side of it, inwards from the
 * end, where it lies in the box and on none of the rectangles taken. Its own is taken from then on.
 */
export function labelBeside(pen, box, { end, direction }, text, look, taken) {
  const [wide, high] = [widthOf(pen, text, look) / 2 + 4, 9];
  const [x, y] = direction;
  const places = [];
  for (let along = 6; along <= 150; along += 12) {
    for (const side of [1, -1]) {
      // as far aside as the text needs for the slope of the arrow
      const aside = side * (5 + wide * Math.abs(y) + high * Math.abs(x));
      places.push([end[0] + along * x - aside * y, end[1] + along * y + aside * x]);
    }
  }
  const about = ([a, b]) => ({ left: a - wide, right: a + wide, top: b - high, bottom: b + high });
  const inside = ({ left, right, top, bottom }) => left >= box.left && right <= box.right && top >= box.top && bottom <= box.bottom;
  const free = (place) => inside(about(place)) && !taken.some((other) => meet(about(place), other));
  const clamp = (value, low, most) => Math.min(Math.max(value, low), Math.max(low, most));
  const [a, b] = places.find(free) ?? [
    clamp(places[0][0], box.left + wide, box.right - wide),
    clamp(places[0][1], box.top + high, box.bottom - high),
  ];
  taken.push(about([a, b]));
  label(pen, text, a, b, { ...look, align: "center" });
}

/** Two strokes across a line, for what is left out of it. */
function breakMark(pen, [x, y], [alongX, alongY], colour) {
  const stroke = (shift, look, width) => {
    pen.strokeStyle = look;
    pen.lineWidth = width;
    const [middleX, middleY] = [x + shift * alongX, y + shift * alongY];
    const [acrossX, acrossY] = [6 * (0.4 * alongX - alongY), 6 * (0.4 * alongY + alongX)];
    pen.beginPath();
    pen.moveTo(middleX - acrossX, middleY - acrossY);
    pen.lineTo(middleX + acrossX, middleY + acrossY);
    pen.stroke();
  };
  stroke(0, theme().paper, 5);
  stroke(-2.5, colour, 1.6);
  stroke(2.5, colour, 1.6);
}

/** Which part of a line lies in a box, as shares of it; nothing if none does. */
function partWithin({ left, top, right, bottom }, [x, y], [dx, dy]) {
  let [from, to] = [0, 1];
  for (const [step, room] of [[-dx, x - left], [dx, right - x], [-dy, y - top], [dy, bottom - y]]) {
    if (step === 0 && room < 0) return null;
    if (step > 0) to = Math.min(to, room / step);
    if (step < 0) from = Math.max(from, room / step);
  }
  return from < to ? [from, to] : null;
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
