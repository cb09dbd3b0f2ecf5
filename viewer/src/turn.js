// How the parts' files were turned before they were sliced.

/** Degrees and unit axis of a rotation matrix, given by its rows; the axis is the one whose angle is in [0, 180]. */
export function axisAndAngle([[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]]) {
  const sine = [zy - yz, xz - zx, yx - xy];
  const twice = Math.hypot(...sine);
  const angle = Math.atan2(twice, xx + yy + zz - 1);
  if (twice > 1e-6) return { degrees: (angle * 180) / Math.PI, axis: sine.map((s) => s / twice) };
  if (angle < 1) return { degrees: 0, axis: [0, 0, 1] };
  // Half a turn: R + 1 is twice the product of the axis with itself, its longest row the best known.
  const rows = [
    [xx + 1, xy, xz],
    [yx, yy + 1, yz],
    [zx, zy, zz + 1],
  ];
  const row = rows.reduce((a, b) => (Math.hypot(...a) >= Math.hypot(...b) ? a : b));
  return { degrees: 180, axis: row.map((value) => value / Math.hypot(...row)) };
}

/** What the page says of it; nothing where nothing was turned. */
export function turnText(rotation) {
  if (!rotation) return '';
  const { degrees, axis } = axisAndAngle(rotation);
  const numbers = axis.map((value) => String(Number(value.toFixed(3)) || 0).replace('-', '\u2212'));
  return ` \u00B7 turned by ${Number(degrees.toFixed(2))}\u00B0 about (${numbers.join(', ')})`;
}
