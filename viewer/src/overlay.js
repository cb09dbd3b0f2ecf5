// What lies over the picture of a cut: rulers in mm, the lattice's border, marks, the pointer and its segment.

import { segmentAt, mm } from './planes.js';
import { meetings, narrowGaps } from './marks.js';
import { drawRows } from './rows.js';

const kRuler = { left: 46, bottom: 22 }; // CSS pixels
const kGridFrom = 10; // canvas pixels a pixel of the lattice, from which its lines are drawn

/** A step of 1, 2 or 5 times a power of ten with room for a label each. */
export function tickStep(range, most) {
  const raw = range / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].find((factor) => raw <= factor * power) * power;
}

function colors(root) {
  const style = getComputedStyle(root);
  const of = (name) => style.getPropertyValue(name).trim();
  return {
    ink: of('--ink'),
    soft: of('--soft'),
    line: of('--line'),
    card: of('--card'),
    accent: of('--accent'),
    overlap: of('--overlap'),
    gap: of('--gap'),
    open: of('--open'),
  };
}

/** Places of the canvas from units of the axes. */
const toX = (view, h) => (h - view.window.left) * view.window.across;
const toY = (view, v) => (view.window.top - v) * view.up;

/** Units of an axis from mm. */
const fromMm = (axis, value) => (value - axis.origin) / axis.unit;

export function drawOverlay(view) {
  const { overlay, density } = view;
  const context = overlay.getContext('2d');
  context.clearRect(0, 0, overlay.width, overlay.height);
  context.lineWidth = density;
  context.font = `${11 * density}px system-ui, sans-serif`;
  const ink = colors(view.root);
  view.rowsDrawn = drawRows(view, context, ink, toX, toY);
  drawGrid(view, context, ink);
  drawBorder(view, context, ink);
  if (view.marksShown) drawMarks(view, context, ink);
  drawProbe(view, context, ink);
  drawRulers(view, context, ink);
}

function drawBorder(view, context, ink) {
  const { across, up } = view.plane;
  context.strokeStyle = ink.soft;
  context.setLineDash([]);
  context.strokeRect(toX(view, 0), toY(view, up.count), across.count * view.window.across, up.count * view.up);
}

/** Lines between the pixels of the lattice, once they are large enough to tell apart. */
function drawGrid(view, context, ink) {
  const { across, up } = view.plane;
  context.strokeStyle = ink.ink;
  context.globalAlpha = 0.16;
  context.beginPath();
  if (view.window.across >= kGridFrom) {
    const last = Math.min(across.count, Math.ceil(view.window.left + view.overlay.width / view.window.across));
    for (let i = Math.max(0, Math.floor(view.window.left)); i <= last; ++i) {
      context.moveTo(toX(view, i), toY(view, up.count));
      context.lineTo(toX(view, i), toY(view, 0));
    }
  }
  for (const v of horizontalLines(view)) {
    context.moveTo(toX(view, 0), toY(view, v));
    context.lineTo(toX(view, across.count), toY(view, v));
  }
  context.stroke();
  context.globalAlpha = 1;
}

function horizontalLines(view) {
  const { build } = view;
  const low = view.window.top - view.overlay.height / view.up;
  if (view.kind !== 'xy') {
    const seen = build.layers.z_bottom.map((z) => z - build.zLow).filter((v) => v >= low && v <= view.window.top);
    return seen.length * kGridFrom < view.overlay.height ? seen : [];
  }
  if (view.up < kGridFrom) return [];
  const lines = [];
  for (let j = Math.max(0, Math.floor(low)); j <= Math.min(build.ny, Math.ceil(view.window.top)); ++j) lines.push(j);
  return lines;
}

function drawMarks(view, context, ink) {
  const { across, up, along } = view.plane;
  const axisNumber = (name) => 'xyz'.indexOf(name);
  const depth = depthOf(view);
  const met = view.kind === 'yz' ? null : drawMeetings(view, context, ink);
  for (const mark of view.marks) {
    // Where the pair is seen to meet, the box of its bounds says nothing more; but one may have asked for it.
    if (!mark.box || (met?.has(mark) && !mark.isChosen)) continue;
    const third = axisNumber(along);
    if (depth < mark.box.low[third] || depth > mark.box.high[third]) continue;
    const [a, u] = [axisNumber(across.name), axisNumber(up.name)];
    const x = toX(view, fromMm(across, mark.box.low[a]));
    const y = toY(view, fromMm(up, mark.box.high[u]));
    const width = toX(view, fromMm(across, mark.box.high[a])) - x;
    const height = toY(view, fromMm(up, mark.box.low[u])) - y;
    drawBox(context, { x, y, width, height }, mark, ink[mark.kind], view.density);
  }
  if (view.kind === 'xy') drawNarrowGaps(view, context, ink);
}

/** mm along the axis that the plane is cut across. */
function depthOf(view) {
  const { build, place, kind } = view;
  if (kind === 'xy') return build.layers.z_sample[place];
  return kind === 'xz' ? build.y(place) : build.x(place * build.one);
}

function drawBox(context, { x, y, width, height }, mark, color, density) {
  context.strokeStyle = color;
  context.lineWidth = 1.5 * density;
  context.setLineDash([5 * density, 4 * density]);
  context.strokeRect(x - density, y - density, width + 2 * density, height + 2 * density);
  context.setLineDash([]);
  context.lineWidth = density;
  if (mark.isChosen) {
    context.globalAlpha = 0.14;
    context.fillStyle = color;
    context.fillRect(x, y, width, height);
    context.globalAlpha = 1;
  }
}

/** Lines where solids of a pair meet along rows and from row to row. Returns the marks that have any. */
function drawMeetings(view, context, ink) {
  const { build, place, kind } = view;
  const key = `${kind} ${place}`;
  if (view.meetingsOf !== key || !view.meetings) {
    view.meetings = meetings(build, kind, place, view.marks);
    view.meetingsOf = view.meetings ? key : null;
  }
  for (const [mark, { ends, sides }] of view.meetings ?? []) {
    context.strokeStyle = ink[mark.kind];
    context.lineWidth = (mark.isChosen ? 4 : 2.5) * view.density;
    context.beginPath();
    for (const [code, low, high] of ends) {
      const x = toX(view, code / build.one + 0.5);
      const middle = toY(view, (low + high) / 2);
      const reach = Math.max(1.5 * view.density, (toY(view, low) - toY(view, high)) / 2);
      context.moveTo(x, middle - reach);
      context.lineTo(x, middle + reach);
    }
    for (const [v, from, to] of sides) {
      context.moveTo(toX(view, from / build.one + 0.5), toY(view, v));
      context.lineTo(toX(view, to / build.one + 0.5), toY(view, v));
    }
    context.stroke();
  }
  context.lineWidth = view.density;
  return view.meetings;
}

function drawNarrowGaps(view, context, ink) {
  const { build, place } = view;
  const key = `${place}`;
  if (view.gapsOf !== key || !view.gaps)
    [view.gapsOf, view.gaps] = [build.peek(place) ? key : null, narrowGaps(build, place)];
  context.strokeStyle = ink.open;
  context.lineWidth = 2 * view.density;
  context.beginPath();
  for (const [row, from, to] of view.gaps) {
    const x = toX(view, (from + to) / 2 / build.one + 0.5);
    const reach = Math.max(2 * view.density, view.up / 2);
    context.moveTo(x, toY(view, row + 0.5) - reach);
    context.lineTo(x, toY(view, row + 0.5) + reach);
  }
  context.stroke();
  context.lineWidth = view.density;
}

function drawProbe(view, context, ink) {
  if (!view.probe) return;
  drawSegment(view, context, ink);
  const x = toX(view, view.probe.h);
  const y = toY(view, view.probe.v);
  context.strokeStyle = ink.ink;
  context.globalAlpha = 0.55;
  context.setLineDash([3 * view.density, 3 * view.density]);
  context.beginPath();
  context.moveTo(x, 0);
  context.lineTo(x, view.overlay.height);
  context.moveTo(0, y);
  context.lineTo(view.overlay.width, y);
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

/** A frame about the segment under the pointer; across the plane yz it is one point and has none. */
function drawSegment(view, context, ink) {
  if (view.kind === 'yz') return;
  const { build } = view;
  const voxel = view.plane.voxel(view.place, view.probe.h, view.probe.v);
  const found = segmentAt(build, voxel, view.pixels);
  if (!found || found.i < 0) return;
  const { chunk } = found.data;
  const from = toX(view, chunk.begin[found.i] / build.one + 0.5);
  const to = toX(view, chunk.end[found.i] / build.one + 0.5);
  const [low, high] =
    view.kind === 'xy'
      ? [voxel.row, voxel.row + 1]
      : [build.layers.z_bottom[voxel.layer] - build.zLow, build.zEnd[voxel.layer] - build.zLow];
  const top = toY(view, high);
  const height = Math.max(2 * view.density, toY(view, low) - top);
  for (const [color, width] of [
    [ink.card, 4],
    [ink.ink, 1.5],
  ]) {
    context.strokeStyle = color;
    context.lineWidth = width * view.density;
    context.strokeRect(from, top, to - from, height);
  }
  context.lineWidth = view.density;
}

function drawRulers(view, context, ink) {
  const { width, height } = view.overlay;
  const left = kRuler.left * view.density;
  const bottom = height - kRuler.bottom * view.density;
  context.fillStyle = ink.card;
  context.fillRect(0, 0, left, height);
  context.fillRect(left, bottom, width - left, height - bottom);
  context.strokeStyle = ink.line;
  context.strokeRect(left, -view.density, width, bottom + view.density);
  context.fillStyle = ink.soft;
  drawTicks(view, context, view.plane.across, { from: left, to: width, isAcross: true, edge: bottom });
  drawTicks(view, context, view.plane.up, { from: 0, to: bottom, isAcross: false, edge: left });
  context.textAlign = 'left';
  context.fillText('mm', 6 * view.density, height - 7 * view.density);
}

function drawTicks(view, context, axis, { from, to, isAcross, edge }) {
  const { density } = view;
  const value = (at) =>
    axis.origin + axis.unit * (isAcross ? view.window.left + at / view.window.across : view.window.top - at / view.up);
  const [low, high] = [value(from), value(to)].sort((a, b) => a - b);
  const step = tickStep(high - low, Math.max(2, (to - from) / (isAcross ? 90 : 60) / density));
  context.textAlign = isAcross ? 'center' : 'right';
  context.beginPath();
  for (let n = Math.ceil(low / step); n <= high / step; ++n) {
    const units = fromMm(axis, n * step);
    const at = isAcross ? toX(view, units) : toY(view, units);
    if (at < from + 12 * density || at > to - (isAcross ? 34 : 12) * density) continue;
    const text = mm(n * step);
    if (isAcross) {
      context.moveTo(at, edge);
      context.lineTo(at, edge + 4 * density);
      context.fillText(text, at, edge + 15 * density);
    } else {
      context.moveTo(edge - 4 * density, at);
      context.lineTo(edge, at);
      context.fillText(text, edge - 7 * density, at + 4 * density);
    }
  }
  context.stroke();
  context.textAlign = isAcross ? 'right' : 'left';
  context.fillText(axis.name, isAcross ? to - 6 * density : 6 * density, isAcross ? edge + 15 * density : 14 * density);
}
