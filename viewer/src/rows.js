// Segments as lines: the rows that a layer is made of, those of the raster or those of the hatch.

/** Canvas pixels between rows from which they are told apart. */
export const kRowsFrom = 4;

/** Lines of the raster rows in units of the axes: [h0, v0, h1, v1, material]. Only rows between `low` and `high`. */
function* rasterLines(view, low, high) {
  const { build, place } = view;
  const data = build.peek(place);
  if (!data) return;
  const { chunk, row0 } = data;
  const last = Math.min(build.ny - 1, Math.ceil(high));
  for (let row = Math.max(0, Math.floor(low)); row <= last; ++row) {
    for (let i = chunk.rowStart[row0 + row]; i < chunk.rowStart[row0 + row + 1]; ++i) {
      const v = row + 0.5;
      yield [chunk.begin[i] / build.one + 0.5, v, chunk.end[i] / build.one + 0.5, v, chunk.material[i]];
    }
  }
}

/** The same of the hatch rows. */
function* hatchLines(view) {
  const { build, place, plane } = view;
  const hatch = build.peekHatch(place);
  if (!hatch) return;
  const { rows, row0, count, along } = hatch;
  const units = (s, offset) => [
    (s * along[0] - offset * along[1] - plane.across.origin) / plane.across.unit,
    (s * along[1] + offset * along[0] - plane.up.origin) / plane.up.unit,
  ];
  for (let row = 0; row < count; ++row) {
    const offset = hatch.offset(row);
    for (let i = rows.rowStart[row0 + row]; i < rows.rowStart[row0 + row + 1]; ++i) {
      yield [
        ...units(hatch.place(rows.begin[i]), offset),
        ...units(hatch.place(rows.end[i]), offset),
        rows.material[i],
      ];
    }
  }
}

/** Canvas pixels from row to row. */
export function rowDistance(view) {
  if (view.rows !== 'hatch') return view.up;
  const { build } = view;
  return build.hatch ? (build.hatch.spacing / build.grid.pitch[0]) * view.window.across : 0;
}

/** Lines over the picture, which is dimmed so that they stand out; nothing while rows are too near to each other. */
export function drawRows(view, context, ink, toX, toY) {
  if (view.kind !== 'xy' || view.rows === 'none') return 0;
  const distance = rowDistance(view);
  if (distance < kRowsFrom) return 0;
  const { overlay, density, palette } = view;
  context.save();
  context.globalAlpha = 0.72;
  context.fillStyle = ink.card;
  context.fillRect(0, 0, overlay.width, overlay.height);
  context.globalAlpha = 1;
  const width = Math.min(Math.max(distance * 0.45, 1.5), 5 * density);
  const low = view.window.top - overlay.height / view.up;
  const lines = view.rows === 'hatch' ? hatchLines(view) : rasterLines(view, low, view.window.top);
  const byMaterial = new Map();
  let drawn = 0;
  for (const [h0, v0, h1, v1, material] of lines) {
    if (!palette.shown[material]) continue;
    const [x0, y0, x1, y1] = [toX(view, h0), toY(view, v0), toX(view, h1), toY(view, v1)];
    if (Math.max(x0, x1) < 0 || Math.min(x0, x1) > overlay.width) continue;
    if (Math.max(y0, y1) < 0 || Math.min(y0, y1) > overlay.height) continue;
    if (!byMaterial.has(material)) byMaterial.set(material, [new Path2D(), new Path2D()]);
    const [path, ends] = byMaterial.get(material);
    path.moveTo(x0, y0);
    path.lineTo(x1, y1);
    addEnds(ends, x0, y0, x1, y1, Math.min(distance * 0.35, 6 * density));
    ++drawn;
  }
  for (const [material, [path, ends]] of byMaterial) {
    // A rim, for colours that are near the page's own.
    context.strokeStyle = ink.soft;
    context.globalAlpha = 0.6;
    context.lineWidth = width + Math.min(distance * 0.15, 2 * density);
    context.stroke(path);
    context.globalAlpha = 1;
    const [r, g, b] = palette.rgb[material];
    context.strokeStyle = `rgb(${r} ${g} ${b})`;
    context.lineWidth = width;
    context.stroke(path);
    context.strokeStyle = ink.ink;
    context.lineWidth = density;
    context.stroke(ends);
  }
  context.restore();
  return drawn;
}

/** A short stroke across each end. */
function addEnds(path, x0, y0, x1, y1, reach) {
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (!(length > 0)) return;
  const [nx, ny] = [(-(y1 - y0) / length) * reach, ((x1 - x0) / length) * reach];
  for (const [x, y] of [
    [x0, y0],
    [x1, y1],
  ]) {
    path.moveTo(x - nx, y - ny);
    path.lineTo(x + nx, y + ny);
  }
}
