// The three planes of cuts: their axes, and what lies at a place on them.

/** @typedef {{name: string, origin: number, unit: number, count: number}} Axis origin and unit in mm */

/** What a plane needs of the build; `place` is the number of its layer, row or column. */
export function planesOf(build) {
  const { origin, pitch, size } = build.grid;
  const x = { name: 'x', origin: origin[0], unit: pitch[0], count: size[0] };
  const y = { name: 'y', origin: origin[1], unit: pitch[1], count: size[1] };
  const z = { name: 'z', origin: build.zLow, unit: 1, count: build.zHigh - build.zLow };
  const { layers } = build;
  return {
    xy: {
      across: x,
      up: y,
      along: 'z',
      places: build.count,
      word: 'Layer',
      layersNeeded: (k) => [k],
      numberOf: (k) => layers.index[k],
      placeOf: (index) => nearest(layers.index, index),
      label: (k) => `z = ${mm(layers.z_sample[k])} mm, ${mm(layers.z_bottom[k])} to ${mm(layers.z_top[k])} mm`,
      voxel: (place, h, v) => ({ layer: place, row: Math.floor(v), across: h }),
    },
    xz: {
      across: x,
      up: z,
      along: 'y',
      places: size[1],
      word: 'Row',
      layersNeeded: () => layers.index.keys(),
      numberOf: (row) => row,
      placeOf: (row) => row,
      label: (row) => `y = ${mm(build.y(row))} mm`,
      voxel: (place, h, v) => ({ layer: build.layerAt(build.zLow + v), row: place, across: h }),
    },
    yz: {
      across: y,
      up: z,
      along: 'x',
      places: size[0],
      word: 'Column',
      layersNeeded: () => layers.index.keys(),
      numberOf: (column) => column,
      placeOf: (column) => column,
      label: (column) => `x = ${mm(build.x(column * build.one))} mm`,
      voxel: (place, h, v) => ({ layer: build.layerAt(build.zLow + v), row: Math.floor(h), across: place + 0.5 }),
    },
  };
}

function nearest(ascending, value) {
  let best = 0;
  ascending.forEach((one, k) => {
    if (Math.abs(one - value) < Math.abs(ascending[best] - value)) best = k;
  });
  return best;
}

/** mm with as many digits as a micrometre's tenth has, without zeros behind. */
export function mm(value) {
  const text = value.toFixed(4);
  return (text.includes('.') ? text.replace(/\.?0+$/, '') : text).replace(/^-0$/, '0').replace('-', '\u2212');
}

/** A number with five significant digits, as people write it. */
export function short(value) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) return value.toExponential(3).replace('-', '\u2212');
  return Number(value.toPrecision(5)).toString().replace('-', '\u2212');
}

/**
 * The segment at a place of a plane in mm, or what else is there.
 * `across` is in pixels along x, so that pixel i spans i to i + 1.
 */
export function segmentAt(build, { layer, row, across }, usePixels) {
  if (layer < 0 || row < 0 || row >= build.ny) return null;
  const data = build.peek(layer);
  if (!data) return null;
  const code = (usePixels ? Math.floor(across) : across - 0.5) * build.one;
  const i = build.find(data, row, code);
  return { data, i, code };
}
