// The mechanism at one moment: bodies, joints, bearings with enlarged clearance, forces.
import { theme, seriesColour } from "./theme.js";
import { arrow, arrowWithin, circle, fadingPath, label, labelBeside, meet, widthOf } from "./pen.js";
import { inUnit, prefixed } from "./format.js";

/** Smallest radii that journal and bearing are drawn with (px). */
const SMALLEST_JOURNAL = 4;

/** Smallest and largest x and y (m) that a run's bodies reach; nothing where none is drawn. */
export function extent(run) {
  if (!run.drawing || run.times.length === 0) return null;
  const box = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  const take = ([x, y]) => {
    if (!Number.isFinite(x) || !Number.isFinite(y)) return;
    [box.left, box.right] = [Math.min(box.left, x), Math.max(box.right, x)];
    [box.bottom, box.top] = [Math.min(box.bottom, y), Math.max(box.top, y)];
  };
  const moments = 720;
  for (let k = 0; k <= moments; k++) {
    run.seek(run.begin + ((run.end - run.begin) * k) / moments);
    const { bodies, centres, place } = placesOf(run, 1);
    bodies.flat().concat(centres).forEach(take);
    for (const joint of run.drawing.joints.filter((joint) => joint.pinion)) {
      const [x, y] = place(seat(joint));
      for (const side of [-joint.pinion, joint.pinion]) take([x + side, y + side]);
    }
    for (const { at, radius } of run.drawing.joints.flatMap((joint) => joint.wheels ?? [])) {
      const [x, y] = place(at);
      for (const side of [-radius, radius]) take([x + side, y + side]);
    }
    for (const joint of run.drawing.joints.filter((joint) => joint.walls)) {
      const [x, y] = place(seat(joint));
      const { gap, block, pin } = joint.walls;
      const half = gap + (block ? Math.max(...block) / 2 : pin);
      for (const side of [-half, half]) take([x + side, y + side]);
    }
  }
  run.drawing.ground.forEach((point) => take(point.at));
  return Number.isFinite(box.left) ? box : null;
}

/**
 * Where each point is drawn at the time sought (m). A journal stands off its bearing by `factor`
 * times the true offset, and its body's mass centre goes along by the mean; all else stays where
 * it is, so that factor 1 is true.
 */
function placesOf(run, factor) {
  const { drawing } = run;
  const ground = drawing.ground.map((point) => [...point.at]);
  const centres = run.bodies.map((name) => [run.at(run.column("position_x", name)), run.at(run.column("position_y", name))]);
  const bodies = drawing.bodies.map((points, body) => {
    const [x, y] = centres[body];
    const angle = run.at(run.column("angle", run.bodies[body]));
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    return points.map(({ at: [px, py] }) => [x + cos * px - sin * py, y + sin * px + cos * py]);
  });
  const place = ({ body, point }) => (body === null ? ground : bodies[body])[point];
  drawing.joints.forEach(({ between, clearance }, joint) => {
    if (!clearance) return;
    const [x, y] = run.offsetAt(run.joints[joint]);
    const journal = place(between[1]);
    const { body } = between[1];
    if (body === null || !Number.isFinite(x)) return;
    [x, y].forEach((offset, k) => {
      journal[k] += (factor - 1) * offset;
      centres[body][k] += ((factor - 1) * offset) / bodies[body].length;
    });
  });
  return { ground, bodies, centres, place };
}

/** Where a joint's sign and force are drawn: on its bearing, or where its second body has hold of the first. */
function seat({ kind, between }) {
  return kind === "revolute" ? between[0] : between[1];
}

/** Where a joint is drawn (m): at its seat, or where the pitch circles of two wheels touch. */
function spot(joint, place) {
  if (!joint.wheels) return place(seat(joint));
  const [large, small] = joint.wheels.toSorted((a, b) => b.radius - a.radius);
  const [[x, y], [u, v]] = [place(large.at), place(small.at)];
  const part = large.radius / Math.hypot(u - x, v - y);
  return [x + part * (u - x), y + part * (v - y)];
}

/** Centre of a joint (m) as drawn at the time sought. */
export function jointPlace(run, joint, factor) {
  return spot(run.drawing.joints[joint], placesOf(run, factor).place);
}

/** Radii of bearing and journal on the screen (px); what is between them is the clearance. */
export function circles(clearance, factor, scale) {
  const gap = factor * clearance.radial * scale;
  const journal = Math.max(clearance.bearing_radius * scale - gap, SMALLEST_JOURNAL);
  return { journal, bearing: journal + gap, gap };
}

/**
 * Draws a run at the time sought. `view` maps metres to pixels; `look` says how large offsets and
 * forces are drawn, in which colours, and what else.
 */
export function drawMechanism(pen, run, view, look) {
  const places = placesOf(run, look.factor);
  const at = (place) => [view.x(place[0]), view.y(place[1])];
  drawGround(pen, run, places, at, look.symbol);
  for (let body = 0; body < run.bodies.length; body++) drawBody(pen, outline(places, body).map(at), look);
  run.drawing.joints.forEach((joint, index) => {
    const colour = seriesColour(look.colourOf(run.joints[index]));
    for (const wheel of joint.wheels ?? []) drawWheel(pen, run, wheel, at(places.place(wheel.at)), view.scale, colour);
  });
  for (const centre of places.centres) drawCentre(pen, at(centre));
  for (const ends of run.drawing.springs) drawSpring(pen, ...ends.map((end) => at(places.place(end))), look.symbol);
  run.drawing.joints.forEach((joint, index) => {
    const centre = at(spot(joint, places.place));
    const colour = seriesColour(look.colourOf(run.joints[index]));
    if (joint.kind === "distance") drawLink(pen, ...joint.between.map((end) => at(places.place(end))), colour);
    if (joint.pinion) drawPinion(pen, run, joint, centre, joint.pinion * view.scale, colour, look.symbol);
    else if (joint.walls) drawWalls(pen, run, joint, at(places.place(joint.between[0])), centre, colour, view.scale);
    else if (joint.axis) drawSlide(pen, run, joint, at(places.place(joint.between[0])), centre, colour, look.symbol);
    if (joint.clearance) drawBearing(pen, run, joint, index, centre, at(places.place(joint.between[1])), view, look);
    else if (!joint.walls?.pin && !joint.wheels) drawPin(pen, centre, colour);
    if (joint.driven) drawDrive(pen, centre, view, joint, look);
  });
  for (const load of run.drawing.loads) drawLoad(pen, run, load, places, at, look.symbol);
  const cuts = [];
  run.drawing.joints.forEach((joint, index) => {
    if (look.forces) drawForce(pen, run, joint, index, at(spot(joint, places.place)), view, look, cuts);
  });
  const taken = [...look.taken, ...drawNames(pen, run, places, at, view, look)];
  for (const { cut, colour, alpha, force } of cuts) {
    pen.globalAlpha = alpha;
    labelBeside(pen, look.box, cut, inUnit(force, prefixed("N", force), 3), { colour, weight: "600" }, taken);
    pen.globalAlpha = 1;
  }
}

/** A link without mass, between two points. */
function drawLink(pen, from, to, colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(...to);
  pen.stroke();
}

/** How far a body is turned at the time sought (rad). */
function turned(run, body) {
  return body === null ? 0 : run.at(run.column("angle", run.bodies[body]));
}

/** The direction of a joint's axis on the screen (rad). */
function axisAngle(run, { axis: [x, y], between }) {
  return -(Math.atan2(y, x) + turned(run, between[0].body));
}

/** The pitch circle of a wheel, its rim beside it, and a spoke from the one that has its teeth outside. */
function drawWheel(pen, run, { at, radius, ring }, centre, scale, colour) {
  const pixels = radius * scale;
  const rim = Math.max(3, 0.08 * pixels);
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  circle(pen, ...centre, pixels);
  pen.stroke();
  pen.lineWidth = 1;
  circle(pen, ...centre, ring ? pixels + rim : Math.max(pixels - rim, 0));
  pen.stroke();
  const spoke = -turned(run, at.body);
  const [from, to] = ring ? [pixels, pixels + rim] : [0, pixels];
  pen.lineWidth = 1.6;
  pen.beginPath();
  pen.moveTo(centre[0] + from * Math.cos(spoke), centre[1] + from * Math.sin(spoke));
  pen.lineTo(centre[0] + to * Math.cos(spoke), centre[1] + to * Math.sin(spoke));
  pen.stroke();
}

/** A pinion with a spoke, and the rack that it rolls on; its radius (px) is positive where that is to the left of the axis. */
function drawPinion(pen, run, joint, centre, radius, colour, s) {
  const spoke = -turned(run, joint.between[1].body);
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  circle(pen, ...centre, Math.abs(radius));
  pen.stroke();
  pen.beginPath();
  pen.moveTo(...centre);
  pen.lineTo(centre[0] + Math.abs(radius) * Math.cos(spoke), centre[1] + Math.abs(radius) * Math.sin(spoke));
  pen.stroke();
  pen.save();
  pen.translate(...centre);
  pen.rotate(axisAngle(run, joint));
  pen.strokeStyle = theme().muted;
  pen.lineWidth = 1.2;
  const reach = Math.max(34 * s, 1.5 * Math.abs(radius));
  const side = Math.sign(radius);
  pen.beginPath();
  pen.moveTo(-reach, -radius);
  pen.lineTo(reach, -radius);
  for (let x = -reach; x <= reach - 5; x += 7) {
    pen.moveTo(x, -radius);
    pen.lineTo(x + 5, -radius - 6 * side);
  }
  pen.stroke();
  pen.restore();
}

/** The line that a point slides on, and the block or pin on it. */
function drawSlide(pen, run, joint, from, centre, colour, s) {
  const angle = axisAngle(run, joint);
  const along = [Math.cos(angle), Math.sin(angle)];
  const travel = (centre[0] - from[0]) * along[0] + (centre[1] - from[1]) * along[1];
  const reach = 34 * s;
  pen.strokeStyle = theme().muted;
  pen.lineWidth = 1.2;
  pen.setLineDash([6, 4]);
  pen.beginPath();
  for (const end of [Math.min(0, travel) - reach, Math.max(0, travel) + reach]) pen.lineTo(from[0] + end * along[0], from[1] + end * along[1]);
  pen.stroke();
  pen.setLineDash([]);
  if (joint.kind !== "prismatic") return;
  pen.save();
  pen.translate(...centre);
  pen.rotate(angle);
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  pen.strokeRect(-17 * s, -10 * s, 34 * s, 20 * s);
  pen.restore();
}

/** Both walls of a guide or a slot with play, true to scale, and the block or the pin between them. */
function drawWalls(pen, run, joint, from, centre, colour, scale) {
  const { gap, block, angle, pin } = joint.walls;
  const half = scale * (block ? block[1] / 2 : pin);
  const wall = half + scale * gap;
  const along = axisAngle(run, joint);
  const travel = (centre[0] - from[0]) * Math.cos(along) + (centre[1] - from[1]) * Math.sin(along);
  const reach = Math.max(34, (block ? 0.8 * block[0] : 2 * pin) * scale);
  const [begin, end] = [Math.min(0, travel) - reach, Math.max(0, travel) + reach];
  pen.save();
  pen.translate(...from);
  pen.rotate(along);
  pen.strokeStyle = theme().muted;
  pen.lineWidth = 1.2;
  pen.beginPath();
  for (const side of [-1, 1]) {
    pen.moveTo(begin, side * wall);
    pen.lineTo(end, side * wall);
    for (let x = begin; x <= end - 5; x += 7) {
      pen.moveTo(x, side * wall);
      pen.lineTo(x + 5, side * (wall + 6));
    }
  }
  pen.stroke();
  pen.restore();
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  if (block) {
    pen.save();
    pen.translate(...centre);
    const [x, y] = joint.axis;
    pen.rotate(-(Math.atan2(y, x) + turned(run, joint.between[1].body) - angle));
    pen.strokeRect((-scale * block[0]) / 2, -half, scale * block[0], 2 * half);
    pen.restore();
  } else {
    circle(pen, ...centre, half);
    pen.stroke();
  }
}

/** A spring: a zigzag between two points. */
function drawSpring(pen, from, to, s) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (!(length > 0)) return;
  const teeth = 12;
  const wide = Math.min(7 * s, length / 4);
  pen.strokeStyle = theme().muted;
  pen.lineWidth = 1.4;
  pen.beginPath();
  pen.moveTo(...from);
  for (let k = 0; k < teeth; k++) {
    const part = 0.15 + (0.7 * (k + 0.5)) / teeth;
    const off = (k % 2 ? wide : -wide) / length;
    pen.lineTo(from[0] + part * dx - off * dy, from[1] + part * dy + off * dx);
  }
  pen.lineTo(...to);
  pen.stroke();
}

/**
 * A load, of one size whatever its own: an arrow that pushes at its point, a turning one about the centre
 * of its body, a coil. It points where the load counts positive.
 */
function drawLoad(pen, run, load, places, at, s) {
  const colour = theme().muted;
  if (load.kind === "force") {
    const [x, y] = at(places.place(load.at));
    const angle = -(Math.atan2(load.direction[1], load.direction[0]) + turned(run, load.frame));
    const [dx, dy] = [30 * s * Math.cos(angle), 30 * s * Math.sin(angle)];
    arrow(pen, x - 1.25 * dx, y - 1.25 * dy, dx, dy, colour, 1.8);
    return;
  }
  const [x, y] = at(places.centres[load.body ?? load.on]);
  if (load.kind === "torque") {
    turnAbout(pen, x, y, 14 * s, false, colour);
    return;
  }
  pen.strokeStyle = colour;
  pen.lineWidth = 1.4;
  pen.beginPath();
  for (let turn = 0; turn <= 2.5; turn += 0.05) {
    const radius = (3 + 4 * turn) * s;
    pen.lineTo(x + radius * Math.cos(2 * Math.PI * turn), y - radius * Math.sin(2 * Math.PI * turn));
  }
  pen.stroke();
}

/** The mechanism of another run as thin dashed lines. */
export function drawGhost(pen, run, view) {
  const places = placesOf(run, 1);
  pen.strokeStyle = theme().ghost;
  pen.lineWidth = 1.2;
  pen.setLineDash([5, 4]);
  for (let body = 0; body < run.bodies.length; body++) {
    const points = outline(places, body);
    pen.beginPath();
    points.forEach(([x, y], k) => (k ? pen.lineTo(view.x(x), view.y(y)) : pen.moveTo(view.x(x), view.y(y))));
    if (points.length > 2) pen.closePath();
    pen.stroke();
  }
  pen.setLineDash([]);
}

function drawGround(pen, run, places, at, s) {
  const used = new Set();
  for (const { between } of run.drawing.joints) {
    for (const { body, point } of between) if (body === null) used.add(point);
  }
  for (const point of used) {
    const [x, y] = at(places.ground[point]);
    pen.strokeStyle = pen.fillStyle = theme().muted;
    pen.lineWidth = 1.3;
    pen.beginPath();
    pen.moveTo(x - 13 * s, y + 24 * s);
    pen.lineTo(x, y);
    pen.lineTo(x + 13 * s, y + 24 * s);
    pen.closePath();
    pen.stroke();
    pen.beginPath();
    pen.moveTo(x - 20 * s, y + 24 * s);
    pen.lineTo(x + 20 * s, y + 24 * s);
    for (let k = -16; k <= 20; k += 7) {
      pen.moveTo(x + k * s, y + 24 * s);
      pen.lineTo(x + (k - 6) * s, y + 31 * s);
    }
    pen.stroke();
  }
}

/** A body's points; with a single one, its mass centre besides. */
function outline(places, body) {
  const points = places.bodies[body];
  return points.length > 1 ? points : [...points, places.centres[body]];
}

/** A mass centre, as a quartered disc. */
function drawCentre(pen, [x, y]) {
  const radius = 4;
  circle(pen, x, y, radius);
  pen.fillStyle = theme().paper;
  pen.fill();
  pen.fillStyle = pen.strokeStyle = theme()["steel-edge"];
  pen.lineWidth = 1;
  for (const begin of [0, Math.PI]) {
    pen.beginPath();
    pen.moveTo(x, y);
    pen.arc(x, y, radius, begin, begin + Math.PI / 2);
    pen.fill();
  }
  circle(pen, x, y, radius);
  pen.stroke();
}

function drawBody(pen, points, look) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  if (points.length > 2) pen.closePath();
  pen.strokeStyle = theme()["steel-edge"];
  pen.lineWidth = look.barWidth + 2;
  pen.stroke();
  pen.strokeStyle = pen.fillStyle = theme().steel;
  pen.lineWidth = look.barWidth;
  if (points.length > 2) pen.fill();
  pen.stroke();
}

function drawPin(pen, [x, y], colour) {
  circle(pen, x, y, 5);
  pen.fillStyle = theme().paper;
  pen.fill();
  pen.strokeStyle = colour;
  pen.lineWidth = 2.5;
  pen.stroke();
}

/** The bearing as a ring, the journal in it, and the way it came. */
function drawBearing(pen, run, joint, index, centre, journal, view, look) {
  const colour = seriesColour(look.colourOf(run.joints[index]));
  const { bearing, journal: radius, gap } = circles(joint.clearance, look.factor, view.scale);
  circle(pen, ...centre, bearing + look.wall);
  pen.fillStyle = theme()["steel-edge"];
  pen.fill();
  circle(pen, ...centre, bearing + look.wall - 1);
  pen.fillStyle = theme().steel;
  pen.fill();
  circle(pen, ...centre, bearing);
  pen.fillStyle = theme().panel;
  pen.fill();
  pen.strokeStyle = colour;
  pen.lineWidth = 1.5;
  pen.stroke();
  circle(pen, ...journal, radius);
  pen.globalAlpha = 0.3;
  pen.fillStyle = colour;
  pen.fill();
  pen.globalAlpha = 1;
  pen.stroke();
  if (gap > 5) {
    const scale = view.scale * look.factor;
    const tail = tailOf(run, run.joints[index], look.time, look.tail);
    fadingPath(pen, tail.map(([x, y]) => [centre[0] + scale * x, centre[1] - scale * y]), colour, 1.3);
  }
  circle(pen, ...journal, 2);
  pen.fillStyle = colour;
  pen.fill();
}

/** Where the journal centre was lately, as offsets (m), oldest first, the present last. */
export function tailOf(run, name, time, duration) {
  const [x, y] = [run.column("clearance_x", name), run.column("clearance_y", name)];
  if (!x || !y || run.times.length === 0) return [];
  run.seek(time - duration);
  const points = [run.offsetAt(name)];
  const first = run.row + 1;
  run.seek(time);
  for (let row = first; row <= run.row; row++) points.push([x[row], y[row]]);
  points.push(run.offsetAt(name));
  return points.filter(([a, b]) => Number.isFinite(a) && Number.isFinite(b));
}

function drawDrive(pen, [x, y], view, joint, look) {
  const hole = joint.clearance ? circles(joint.clearance, look.factor, view.scale).bearing + look.wall : 5;
  // a drive turns its second body
  turnAbout(pen, x, y, hole + 9, look.backwards, theme().muted);
}

/** An arrow round a centre; backwards, it stands at the other end. */
function turnAbout(pen, x, y, radius, backwards, colour) {
  pen.strokeStyle = colour;
  pen.lineWidth = 1.6;
  pen.beginPath();
  pen.arc(x, y, radius, -0.3, -1.9, true);
  pen.stroke();
  const angle = backwards ? -0.3 : -1.9;
  const turn = backwards ? 1 : -1;
  const [tipX, tipY] = [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  const [alongX, alongY] = [-turn * Math.sin(angle), turn * Math.cos(angle)];
  pen.fillStyle = colour;
  pen.beginPath();
  pen.moveTo(tipX + 6 * alongX, tipY + 6 * alongY);
  pen.lineTo(tipX + 4 * Math.cos(angle), tipY + 4 * Math.sin(angle));
  pen.lineTo(tipX - 4 * Math.cos(angle), tipY - 4 * Math.sin(angle));
  pen.fill();
}

/**
 * The force on a joint's second body: an ideal joint's starts at the pin, a contact's pushes the
 * journal from outside, its head where they touch. Arrows that the border cuts go into `cuts`.
 */
function drawForce(pen, run, joint, index, centre, view, look, cuts) {
  const name = run.joints[index];
  const colour = seriesColour(look.colourOf(name));
  const push = ([fx, fy], [ox, oy], alpha) => {
    const [dx, dy] = [fx * look.forceScale, -fy * look.forceScale];
    const length = Math.hypot(ox, oy);
    let cut;
    pen.globalAlpha = alpha;
    if (joint.clearance && length > 0) {
      const { bearing } = circles(joint.clearance, look.factor, view.scale);
      const [x, y] = [centre[0] + (bearing * ox) / length, centre[1] - (bearing * oy) / length];
      cut = arrowWithin(pen, look.box, [x - dx, y - dy], [dx, dy], colour, 3);
    } else {
      cut = arrowWithin(pen, look.box, centre, [dx, dy], colour, 3);
    }
    pen.globalAlpha = 1;
    if (cut) cuts.push({ cut, colour, alpha, force: Math.hypot(fx, fy) });
  };
  for (const held of look.held) {
    if (held.run === run && held.joint === index) push(held.force, held.offset, held.alpha);
  }
  push(run.forceAt(index), joint.clearance ? run.offsetAt(name) : [0, 0], 1);
}

/** The rectangles that names of joints and bodies, and the joints themselves, take. */
function drawNames(pen, run, places, at, view, look) {
  const taken = [];
  const names = [];
  const around = (x, y, wide, high) => ({ left: x - wide, right: x + wide, top: y - high, bottom: y + high });
  const take = (...box) => taken.push(around(...box));
  // joints at one place have their names below one another
  const name = (text, x, y, how) => {
    const width = widthOf(pen, text, how);
    const middle = { left: x + width / 2, right: x - width / 2, center: x }[how.align ?? "left"];
    let box = around(middle, y, width / 2 + 2, 7);
    for (let tries = 0; tries < 6 && names.some((other) => meet(box, other)); tries++) {
      y += 15;
      box = around(middle, y, width / 2 + 2, 7);
    }
    label(pen, text, x, y, how);
    names.push(box);
    take(middle, y, width / 2 + 2, 9);
  };
  run.drawing.joints.forEach((joint, index) => {
    const [x, y] = at(spot(joint, places.place));
    const hole = joint.clearance ? circles(joint.clearance, look.factor, view.scale).bearing + look.wall : 6;
    take(x, y, hole, hole);
    if (!look.names) return;
    const grounded = !joint.wheels && seat(joint).body === null;
    const how = { size: 14, colour: seriesColour(look.colourOf(run.joints[index])), weight: "600" };
    if (grounded) name(run.joints[index], x - Math.max(20 * look.symbol, hole) - 6, y + 17 * look.symbol, { ...how, align: "right" });
    else name(run.joints[index], x + 0.75 * hole + 5, y - 0.75 * hole - 9, how);
  });
  if (!look.names) return taken;
  places.bodies.forEach((points, body) => {
    const drawn = points.map(at);
    const span = Math.max(...drawn.map(([x, y]) => Math.hypot(x - drawn[0][0], y - drawn[0][1])));
    if (span < 90) return;
    const [x, y] = at(places.centres[body]);
    name(run.bodies[body], x, y + 15, { size: 11, colour: theme().muted, align: "center" });
  });
  return taken;
}
