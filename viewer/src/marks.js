// Places that deserve a look: overlaps and gaps by pairs of solids, findings with a layer, narrow gaps along rows.

/** The box that both solids' bounds share, opened by `slack` mm; null when they don't meet. */
function commonBox(a, b, slack) {
  if (!a?.lower || !b?.lower) return null;
  const low = a.lower.map((value, axis) => Math.max(value, b.lower[axis]) - slack);
  const high = a.upper.map((value, axis) => Math.min(value, b.upper[axis]) + slack);
  return low.every((value, axis) => value <= high[axis]) ? { low, high } : null;
}

// Of a pixel, or where the width isn't known of a voxel. What is thinner is listed and not drawn: rounding makes such slivers wherever curved faces touch.
const kThin = 1e-3;

const kKinds = [
  {
    list: 'overlaps',
    kind: 'overlap',
    word: 'overlap',
    slackOf: () => 0,
    sizeOf: (pair) => ({ volume: pair.volume, width: pair.largest_depth }),
  },
  {
    list: 'gaps',
    kind: 'gap',
    word: 'filled gap',
    slackOf: (pair) => pair.largest_depth,
    sizeOf: (pair) => ({ volume: pair.volume, width: pair.largest_depth }),
  },
  {
    list: 'open_gaps',
    kind: 'open',
    word: 'open gap',
    slackOf: (pair) => pair.largest_gap,
    sizeOf: (pair) => ({ volume: pair.volume, width: pair.largest_gap }),
  },
];

/**
 * The pairs of the report as boxes in mm. The build says how large an overlap or a gap is and of which solids, not
 * where: it lies somewhere in the box that both solids' bounds share.
 */
export function pairMarks(build) {
  const marks = [];
  const voxel = build.grid.pitch.reduce((a, b) => a * b);
  for (const { list, kind, word, slackOf, sizeOf } of kKinds) {
    for (const pair of build.report[list]) {
      const [a, b] = pair.solids.map((solid) => build.solids[solid]);
      const { volume, width } = sizeOf(pair);
      const isThin = width > 0 ? width < kThin * build.grid.pitch[0] : volume < kThin * voxel;
      marks.push({
        kind,
        word,
        names: [a?.name ?? '?', b?.name ?? '?'],
        volume,
        width,
        layers: pair.layers,
        box: isThin ? null : commonBox(a, b, slackOf(pair)),
        isThin,
      });
    }
  }
  return marks;
}

/** Findings of the report; those that name a layer know it. Layers are numbers of the whole build. */
export function findingMarks(build) {
  return build.report.findings.map((finding) => {
    const match = /\blayer (\d+)\b/.exec(finding.what);
    return { ...finding, layer: match ? Number(match[1]) : null };
  });
}

/**
 * Gaps along the rows of layer k that are narrower than a pixel: [row, code of the left end, code of the right end].
 * What touches has no gap at all.
 */
export function narrowGaps(build, k) {
  const data = build.peek(k);
  const gaps = [];
  if (!data) return gaps;
  const { chunk, row0 } = data;
  for (let row = 0; row < build.ny; ++row) {
    const last = chunk.rowStart[row0 + row + 1];
    for (let i = chunk.rowStart[row0 + row] + 1; i < last; ++i) {
      const width = chunk.begin[i] - chunk.end[i - 1];
      if (width > 0 && width < build.one) gaps.push([row, chunk.end[i - 1], chunk.begin[i]]);
    }
  }
  return gaps;
}
