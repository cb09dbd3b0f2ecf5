// Colours of materials as the 32-bit numbers of canvas pixels.

const parse = (text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16));
const pack = (r, g, b) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

/** Which materials are shown, in which colour. A hidden material is as no material. */
export class Palette {
  constructor(materials) {
    this.rgb = materials.map((material) => parse(material.color));
    this.components = materials.map((material) => material.components ?? null);
    this.shown = materials.map(() => true);
    this.colors = Uint32Array.from(this.rgb, (rgb) => pack(...rgb));
  }

  /** 0 for a hidden material. */
  of(material) {
    return this.shown[material] ? this.colors[material] : 0;
  }

  /** The mixture of a graded segment at a code: the components' sRGB values weighted with their volume fractions. */
  blend(mixtures, g, material, code) {
    const { knot, part, next } = placeOf(mixtures, g, code);
    const components = this.components[material];
    const at = mixtures.fractionStart[g] + (knot - mixtures.knotStart[g]) * components.length;
    const to = mixtures.fractionStart[g] + (next - mixtures.knotStart[g]) * components.length;
    let r = 0;
    let green = 0;
    let b = 0;
    for (let c = 0; c < components.length; ++c) {
      const share = ((1 - part) * mixtures.fraction[at + c] + part * mixtures.fraction[to + c]) / 65535;
      const rgb = this.rgb[components[c]];
      r += share * rgb[0];
      green += share * rgb[1];
      b += share * rgb[2];
    }
    return pack(Math.min(255, Math.round(r)), Math.min(255, Math.round(green)), Math.min(255, Math.round(b)));
  }
}

/** Between which knots of graded segment g a code lies, and how far. */
function placeOf({ knotStart, x }, g, code) {
  let low = knotStart[g];
  let high = knotStart[g + 1];
  const first = low;
  const last = high - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] >= code) high = middle;
    else low = middle + 1;
  }
  if (low > last) return { knot: last, next: last, part: 0 };
  if (low === first) return { knot: first, next: first, part: 0 };
  return { knot: low - 1, next: low, part: (code - x[low - 1]) / (x[low] - x[low - 1]) };
}

/** The number of a segment among the graded ones, or -1. */
export function gradedNumber({ segment }, i) {
  let low = 0;
  let high = segment.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (segment[middle] < i) low = middle + 1;
    else high = middle;
  }
  return low < segment.length && segment[low] === i ? low : -1;
}

/** Volume fractions of a segment's components at a code, or null when it isn't graded. */
export function fractionsAt(build, chunk, i, code) {
  const g = gradedNumber(chunk.mixtures, i);
  if (g < 0) return null;
  const { mixtures } = chunk;
  const components = build.materials[chunk.material[i]].components;
  const { knot, next, part } = placeOf(mixtures, g, code);
  const value = (k, c) =>
    mixtures.fraction[mixtures.fractionStart[g] + (k - mixtures.knotStart[g]) * components.length + c];
  return components.map((material, c) => ({
    material,
    share: ((1 - part) * value(knot, c) + part * value(next, c)) / 65535,
  }));
}
