// The build as a block of voxels for the 3D picture: the lattice itself, or every few voxels of it when it is large.

import { gradedNumber } from './colors.js';

const kMostAlong = 1024;
const kMostVoxels = 2 ** 24; // 64 MiB of texture
const kBlock = 8; // voxels along a block of the coarse texture that lets rays skip what is empty

/**
 * How many voxels along each axis, and how many of the lattice's each stands for. While there are too many, they grow
 * along the axis where they are smallest in mm, of equals along the one with the most.
 */
export function shapeOf(build) {
  const lattice = [build.nx, build.ny, build.count];
  const pitch = [build.grid.pitch[0], build.grid.pitch[1], (build.zHigh - build.zLow) / build.count];
  const step = [1, 1, 1];
  for (;;) {
    const size = lattice.map((count, axis) => Math.ceil(count / step[axis]));
    const isLong = size.some((count) => count > kMostAlong);
    if (!isLong && size[0] * size[1] * size[2] <= kMostVoxels) return { size, step };
    const axes = [0, 1, 2].filter((axis) => (isLong ? size[axis] > kMostAlong : size[axis] > 1));
    axes.sort((m, n) => step[m] * pitch[m] - step[n] * pitch[n] || size[n] - size[m]);
    ++step[axes[0]];
  }
}

/** Layers that voxels are taken of, from the bottom: planes of voxels are equally spaced in z, layers need not be. */
export function layersOf(build, count) {
  const height = (build.zHigh - build.zLow) / count;
  return Array.from({ length: count }, (_, k) => Math.max(0, build.layerAt(build.zLow + (k + 0.5) * height)));
}

/** Writes the row's segments into voxels: colour, and material + 1 in alpha. */
function fillRow(build, palette, { chunk, row0 }, row, { size, step }, out, at) {
  const last = chunk.rowStart[row0 + row + 1];
  const middle = step[0] >> 1;
  const voxelFrom = (code) => Math.max(0, Math.ceil((Math.ceil(code / build.one) - middle) / step[0]));
  for (let i = chunk.rowStart[row0 + row]; i < last; ++i) {
    const from = voxelFrom(chunk.begin[i]);
    const to = Math.min(size[0], voxelFrom(chunk.end[i]));
    if (from >= to) continue;
    const material = chunk.material[i];
    const label = Math.min(material + 1, 255) << 24;
    if (!palette.components[material]) {
      out.fill(((palette.colors[material] & 0xffffff) | label) >>> 0, at + from, at + to);
      continue;
    }
    const g = gradedNumber(chunk.mixtures, i);
    for (let a = from; a < to; ++a) {
      const color = palette.blend(chunk.mixtures, g, material, (a * step[0] + middle) * build.one);
      out[at + a] = ((color & 0xffffff) | label) >>> 0;
    }
  }
}

/** Which blocks hold anything. */
function coarseOf(voxels, size) {
  const blocks = size.map((count) => Math.ceil(count / kBlock));
  const coarse = new Uint8Array(blocks[0] * blocks[1] * blocks[2]);
  for (let k = 0, at = 0; k < size[2]; ++k) {
    for (let j = 0; j < size[1]; ++j) {
      const row = ((k >> 3) * blocks[1] + (j >> 3)) * blocks[0];
      for (let i = 0; i < size[0]; ++i, ++at) if (voxels[at] !== 0) coarse[row + (i >> 3)] = 255;
    }
  }
  return { coarse, blocks };
}

/** The voxels; all layers that it needs are decoded on the way. */
export async function makeVoxels(build, palette, report) {
  const shape = shapeOf(build);
  const layers = layersOf(build, shape.size[2]);
  await build.loadAll(layers, report);
  const [nx, ny, nz] = shape.size;
  const voxels = new Uint32Array(nx * ny * nz);
  layers.forEach((layer, k) => {
    const data = build.peek(layer);
    for (let j = 0; j < ny; ++j) {
      const row = Math.min(build.ny - 1, j * shape.step[1] + (shape.step[1] >> 1));
      fillRow(build, palette, data, row, shape, voxels, (k * ny + j) * nx);
    }
  });
  return { ...shape, voxels, ...coarseOf(voxels, shape.size) };
}
