// The build inside the page: its header, and its layers, decoded chunk by chunk when they are asked for.

/** Numbers that were folded (0, -1, 1, -2 ... as 0, 1, 2, 3 ...) with their sign again. */
const unfold = (value) => (value >>> 1) ^ -(value & 1);

function bytesOf(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; ++i) bytes[i] = raw.charCodeAt(i);
  return bytes;
}

async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads columns of unsigned 32-bit numbers that lie as four planes of bytes. */
class Columns {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }
  take(count) {
    const { bytes, at } = this;
    const column = new Uint32Array(count);
    for (let i = 0; i < count; ++i) {
      column[i] =
        bytes[at + i] |
        (bytes[at + count + i] << 8) |
        (bytes[at + 2 * count + i] << 16) |
        (bytes[at + 3 * count + i] << 24);
    }
    this.at += 4 * count;
    return column;
  }
}

/** First segment of each row, and behind the last. */
function rowStarts(counts) {
  const start = new Uint32Array(counts.length + 1);
  let count = 0;
  for (let r = 0; r < counts.length; ++r) {
    count += unfold(counts[r]);
    start[r + 1] = start[r] + count;
  }
  return start;
}

/** Begins and ends from gaps and lengths, each told as the difference to its place in the row before. */
function restoreEnds(rowStart, gaps, lengths) {
  const begin = new Int32Array(gaps.length);
  const end = new Int32Array(gaps.length);
  let before = 0;
  let beforeCount = 0;
  const gap = new Int32Array(gaps.length);
  const length = new Int32Array(gaps.length);
  for (let r = 0; r + 1 < rowStart.length; ++r) {
    const first = rowStart[r];
    const count = rowStart[r + 1] - first;
    let x = 0;
    for (let s = 0; s < count; ++s) {
      const i = first + s;
      const known = s < beforeCount;
      gap[i] = unfold(gaps[i]) + (known ? gap[before + s] : 0);
      length[i] = unfold(lengths[i]) + (known ? length[before + s] : 0);
      begin[i] = x + gap[i];
      x = end[i] = begin[i] + length[i];
    }
    before = first;
    beforeCount = count;
  }
  return { begin, end };
}

const narrowed = (column, most) => (most < 256 ? Uint8Array : most < 65536 ? Uint16Array : Uint32Array).from(column);

/** What graded segments consist of; see slicing/layer.h, Mixtures. */
function restoreMixtures(columns, sizes, chunk, materials) {
  const segment = columns.take(sizes.graded);
  const counts = columns.take(sizes.graded);
  const x = new Int32Array(columns.take(sizes.knots).buffer);
  const folded = columns.take(sizes.fractions);
  const fraction = new Uint16Array(sizes.fractions);
  const knotStart = new Uint32Array(sizes.graded + 1);
  const fractionStart = new Uint32Array(sizes.graded + 1);
  for (let g = 0; g < sizes.graded; ++g) {
    if (g > 0) segment[g] += segment[g - 1];
    const components = materials[chunk.material[segment[g]]].components.length;
    knotStart[g + 1] = knotStart[g] + counts[g];
    fractionStart[g + 1] = fractionStart[g] + counts[g] * components;
    let last = chunk.begin[segment[g]];
    for (let k = knotStart[g]; k < knotStart[g + 1]; ++k) last = x[k] = last + unfold(x[k] >>> 0);
    for (let f = fractionStart[g]; f < fractionStart[g + 1]; ++f) {
      fraction[f] = unfold(folded[f]) + (f < fractionStart[g] + components ? 0 : fraction[f - components]);
    }
  }
  return { segment, knotStart, x, fractionStart, fraction };
}

/** Rows of the hatch: as those of the raster, along lines at the layer's angle. */
function restoreHatch(columns, sizes, materials) {
  const rowStart = rowStarts(columns.take(sizes.hatch_rows));
  const ends = restoreEnds(rowStart, columns.take(sizes.hatch_segments), columns.take(sizes.hatch_segments));
  return { rowStart, ...ends, material: narrowed(columns.take(sizes.hatch_segments), materials) };
}

/** Layers, rows and segments of one build. Places along x are codes: 2^bits a pixel, 0 at the centre of pixel 0. */
export class Build {
  constructor(header, chunkTexts) {
    Object.assign(this, header);
    this.count = this.layers.index.length;
    this.one = 2 ** this.grid.bits;
    [this.nx, this.ny] = this.grid.size;
    this.zLow = this.count ? this.layers.z_bottom[0] : 0;
    // With layers left out, each stands for those up to the next.
    this.zEnd = this.layers.z_bottom.slice(1).concat(this.layers.z_top.slice(-1));
    this.zHigh = this.count ? this.zEnd[this.count - 1] : 1;
    this.isThinned = this.layers.index.some((index, k) => index !== this.layers.index[0] + k);
    this.texts = chunkTexts;
    this.decoded = [];
    this.chunkOf = new Uint32Array(this.count);
    this.firstLayer = [];
    let layer = 0;
    this.chunks.forEach((sizes, c) => {
      this.firstLayer.push(layer);
      this.chunkOf.fill(c, layer, (layer += sizes.layers));
    });
  }

  /** Where the data of layer k lie, or null while they aren't decoded. */
  peek(k) {
    const chunk = this.decoded[this.chunkOf[k]];
    return chunk?.rowStart ? { chunk, row0: (k - chunk.firstLayer) * this.ny } : null;
  }

  /** The hatch rows of layer k in mm: how they lie, and where each segment is; null where there are none decoded. */
  peekHatch(k) {
    const data = this.hatch ? this.peek(k) : null;
    if (!data) return null;
    const { spacing, angle, rotation, unit, centre } = this.hatch;
    const t = angle + this.layers.index[k] * rotation;
    const along = [Math.cos(t), Math.sin(t)];
    let row0 = 0;
    for (let before = data.chunk.firstLayer; before < k; ++before) row0 += this.layers.hatch_rows[before];
    return {
      rows: data.chunk.hatch,
      row0,
      count: this.layers.hatch_rows[k],
      along,
      offset: (row) => (this.layers.hatch_first[k] + row + 0.5) * spacing,
      place: (code) => code * unit + centre[0] * along[0] + centre[1] * along[1],
      spacing,
    };
  }

  async load(k) {
    const c = this.chunkOf[k];
    this.decoded[c] ??= this.decode(c).then((chunk) => {
      this.decoded[c] = chunk;
    });
    await this.decoded[c];
    return this.peek(k);
  }

  async decode(c) {
    const sizes = this.chunks[c];
    const columns = new Columns(await inflate(bytesOf(this.texts.take(c))));
    const rowStart = rowStarts(columns.take(sizes.rows));
    const ends = restoreEnds(rowStart, columns.take(sizes.segments), columns.take(sizes.segments));
    const material = narrowed(columns.take(sizes.segments), this.materials.length);
    const solid = narrowed(columns.take(sizes.segments), this.solids.length);
    const chunk = { firstLayer: this.firstLayer[c], rowStart, ...ends, material, solid };
    chunk.mixtures = restoreMixtures(columns, sizes, chunk, this.materials);
    if (this.hatch) chunk.hatch = restoreHatch(columns, sizes, this.materials.length);
    return chunk;
  }

  /** Decodes the chunks of all given layers; says how far it is and lets the page live between chunks. */
  async loadAll(layers, report) {
    const wanted = [...new Set(Array.from(layers, (k) => this.chunkOf[k]))];
    for (let n = 0; n < wanted.length; ++n) {
      if (!this.decoded[wanted[n]]?.rowStart) {
        await this.load(this.firstLayer[wanted[n]]);
        report?.((n + 1) / wanted.length);
        await new Promise((resume) => setTimeout(resume));
      }
    }
  }

  /** The segment of a row that holds the code, or -1: begins are included, ends are not. */
  find({ chunk, row0 }, row, code) {
    let low = chunk.rowStart[row0 + row];
    let high = chunk.rowStart[row0 + row + 1];
    const last = high;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (chunk.end[middle] > code) high = middle;
      else low = middle + 1;
    }
    return low < last && chunk.begin[low] <= code ? low : -1;
  }

  /** The layer that stands at height z (mm), or -1. */
  layerAt(z) {
    if (!(z >= this.zLow && z < this.zHigh)) return -1;
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.zEnd[middle] > z) high = middle;
      else low = middle + 1;
    }
    return low;
  }

  /** mm */
  x(code) {
    return this.grid.origin[0] + (code / this.one + 0.5) * this.grid.pitch[0];
  }
  y(row) {
    return this.grid.origin[1] + (row + 0.5) * this.grid.pitch[1];
  }
}

/** Reads header and chunks out of the page. Texts of chunks are dropped once they are taken. */
export function readBuild(document) {
  const scripts = [...document.querySelectorAll('script.chunk')];
  const take = (c) => {
    const text = scripts[c].textContent;
    scripts[c].remove();
    return text;
  };
  return new Build(JSON.parse(document.getElementById('build').textContent), { take });
}
