// Paints cuts through the build into canvas pixels: each takes the colour of the segment at its centre.

import { gradedNumber } from './colors.js';

/**
 * A window on a plane. Across, unit is one pixel (x) or row (y) of the lattice; upwards it is one row (y) or one mm (z).
 * @typedef {{width: number, height: number, left: number, top: number, across: number, up: number, pixels: boolean}} Window
 * left and top are places in those units, across and up canvas pixels a unit; pixels: whole pixels of the lattice.
 */

/** The first canvas pixel whose centre isn't before a border. */
const firstFrom = (border, window) => Math.ceil((border - window.left) * window.across - 0.5);

/** Paints one row of segments along x. */
function paintSegments(build, palette, { chunk, row0 }, row, window, out) {
  const { one } = build;
  const last = chunk.rowStart[row0 + row + 1];
  const border = (code) => (window.pixels ? Math.ceil(code / one) : code / one + 0.5);
  for (let i = chunk.rowStart[row0 + row]; i < last; ++i) {
    const from = Math.max(0, firstFrom(border(chunk.begin[i]), window));
    if (from >= window.width) break;
    const to = Math.min(window.width, firstFrom(border(chunk.end[i]), window));
    const material = chunk.material[i];
    if (from >= to || !palette.shown[material]) continue;
    if (palette.components[material]) paintGraded(build, palette, chunk, i, from, to, window, out);
    else out.fill(palette.colors[material], from, to);
  }
}

function paintGraded(build, palette, chunk, i, from, to, window, out) {
  const g = gradedNumber(chunk.mixtures, i);
  for (let a = from; a < to; ++a) {
    const place = window.left + (a + 0.5) / window.across;
    const code = (window.pixels ? Math.floor(place) : place - 0.5) * build.one;
    out[a] = palette.blend(chunk.mixtures, g, chunk.material[i], code);
  }
}

function colorAt(build, palette, data, row, code) {
  const i = build.find(data, row, code);
  if (i < 0) return 0;
  const material = data.chunk.material[i];
  if (!palette.shown[material]) return 0;
  if (!palette.components[material]) return palette.colors[material];
  return palette.blend(data.chunk.mixtures, gradedNumber(data.chunk.mixtures, i), material, code);
}

/** Paints one line along y at the centre of a column. */
function paintColumn(build, palette, data, column, window, out) {
  let known = -1;
  let color = 0;
  for (let a = 0; a < window.width; ++a) {
    const row = Math.floor(window.left + (a + 0.5) / window.across);
    if (row < 0 || row >= build.ny) continue;
    if (row !== known) color = colorAt(build, palette, data, (known = row), column * build.one);
    out[a] = color;
  }
}

/** Paints lines from the top; `sourceOf` gives what a line shows (an equal number: an equal line), -1 for nothing. */
function paintLines(window, out, sourceOf, paintLine) {
  let last = -1;
  for (let b = 0; b < window.height; ++b) {
    const source = sourceOf(window.top - (b + 0.5) / window.up);
    const at = b * window.width;
    if (source < 0) continue;
    if (source === last) out.copyWithin(at, at - window.width, at);
    else paintLine(source, out.subarray(at, at + window.width));
    last = source;
  }
}

const paints = {
  xy(build, palette, k, window, out) {
    const data = build.peek(k);
    const rowOf = (v) => (v >= 0 && v < build.ny ? Math.floor(v) : -1);
    if (data) paintLines(window, out, rowOf, (row, line) => paintSegments(build, palette, data, row, window, line));
  },
  xz(build, palette, row, window, out) {
    paintLines(
      window,
      out,
      (v) => build.layerAt(build.zLow + v),
      (k, line) => {
        const data = build.peek(k);
        if (data) paintSegments(build, palette, data, row, window, line);
      },
    );
  },
  yz(build, palette, column, window, out) {
    paintLines(
      window,
      out,
      (v) => build.layerAt(build.zLow + v),
      (k, line) => {
        const data = build.peek(k);
        if (data) paintColumn(build, palette, data, column, window, line);
      },
    );
  },
};

/** Whether a square of 2 or 3 pixels each way has one colour; written out, because most squares of a picture do. */
function isPlain(fine, at, stride, f) {
  const color = fine[at];
  if (fine[at + 1] !== color || fine[at + stride] !== color || fine[at + stride + 1] !== color) return false;
  if (f === 2) return true;
  const last = at + 2 * stride;
  return (
    fine[at + 2] === color &&
    fine[at + stride + 2] === color &&
    fine[last] === color &&
    fine[last + 1] === color &&
    fine[last + 2] === color
  );
}

/** The mean of f x f pixels each, f = 2 or 3; what is empty counts as see-through. */
function reduce(fine, f, { width, height }, out) {
  const bytes = new Uint8Array(fine.buffer);
  const stride = width * f;
  for (let b = 0, at = 0; b < height; ++b) {
    for (let a = 0, corner = b * f * stride; a < width; ++a, ++at, corner += f) {
      out[at] = isPlain(fine, corner, stride, f) ? fine[corner] : mean(bytes, fine, corner, f, stride);
    }
  }
}

function mean(bytes, fine, corner, f, stride) {
  let r = 0;
  let g = 0;
  let b = 0;
  let n = 0;
  for (let v = 0; v < f; ++v) {
    for (let u = 0; u < f; ++u) {
      const i = corner + v * stride + u;
      if (fine[i] === 0) continue;
      r += bytes[4 * i];
      g += bytes[4 * i + 1];
      b += bytes[4 * i + 2];
      ++n;
    }
  }
  return (
    ((Math.round((255 * n) / (f * f)) << 24) |
      (Math.round(b / n) << 16) |
      (Math.round(g / n) << 8) |
      Math.round(r / n)) >>>
    0
  );
}

const kMostFiner = 3;
let memory = new Uint32Array(0);

/** Zeros, in memory that is used again from picture to picture. */
function scratch(count) {
  if (memory.length === count) return memory.fill(0);
  return (memory = new Uint32Array(count));
}

/**
 * Paints a cut: "xy" at a layer, "xz" at a row, "yz" at a column. Where the canvas is coarser than the lattice a pixel
 * is the mean of up to 3 x 3 samples.
 */
export function paint(kind, build, palette, place, window, out) {
  const f = Math.min(kMostFiner, Math.ceil(1 / Math.min(1, window.across, window.up) - 1e-9));
  if (f <= 1) {
    paints[kind](build, palette, place, window, out);
    return;
  }
  const finer = {
    ...window,
    width: window.width * f,
    height: window.height * f,
    across: window.across * f,
    up: window.up * f,
  };
  const fine = scratch(finer.width * finer.height);
  paints[kind](build, palette, place, finer, fine);
  reduce(fine, f, window, out);
}
