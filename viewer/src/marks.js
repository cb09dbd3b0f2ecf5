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
 * The pairs of the report, with boxes in mm. The build says how large an overlap or a gap is and of which solids, not
 * where: it lies somewhere in the box that both solids' bounds share. meetings() finds more on the rows.
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
        solids: pair.solids,
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

/** What a cut shows of the rows: [layer, row, low, high], the last two in units of the plane's upward axis. */
function* rowsOfCut(build, kind, place) {
  if (kind === 'xy') {
    for (let row = 0; row < build.ny; ++row) yield [place, row, row, row + 1];
    return;
  }
  for (let k = 0; k < build.count; ++k) {
    yield [k, place, build.layers.z_bottom[k] - build.zLow, build.zEnd[k] - build.zLow];
  }
}

/**
 * Where solids of a mark's pair meet in a cut: mark -> {ends: [code, low, high], sides: [v, from, to]}, along rows and
 * from row to row (from layer to layer in cuts). There an overlap ends and what is left of the other solid begins, or a gap
 * was filled. Ends must touch to a code, or be less than a pixel apart for open gaps. Null while layers aren't decoded.
 * Of each mark that is drawn.
 */
export function meetings(build, kind, place, marks) {
  const byPair = new Map();
  const keyOf = (a, b) => Math.min(a, b) * build.solids.length + Math.max(a, b);
  for (const mark of marks) {
    if (!mark.box) continue;
    const key = keyOf(...mark.solids);
    byPair.set(key, [...(byPair.get(key) ?? []), mark]);
  }
  const found = new Map();
  if (byPair.size === 0) return found;
  const placesOf = (mark) => {
    if (!found.has(mark)) found.set(mark, { ends: [], sides: [] });
    return found.get(mark);
  };
  let below = null; // the row before: its chunk and segments
  for (const [k, row, low, high] of rowsOfCut(build, kind, place)) {
    const data = build.peek(k);
    if (!data) return null;
    const { chunk, row0 } = data;
    const here = { chunk, first: chunk.rowStart[row0 + row], last: chunk.rowStart[row0 + row + 1] };
    for (let i = here.first + 1; i < here.last; ++i) {
      const width = chunk.begin[i] - chunk.end[i - 1];
      for (const mark of byPair.get(keyOf(chunk.solid[i - 1], chunk.solid[i])) ?? []) {
        if (mark.kind === 'open' ? width <= 0 || width >= build.one : width > 1) continue;
        placesOf(mark).ends.push([chunk.begin[i], low, high]);
      }
    }
    for (const [from, to, a, b] of below ? bothOf(below, here) : []) {
      for (const mark of byPair.get(keyOf(a, b)) ?? []) {
        if (mark.kind !== 'open') placesOf(mark).sides.push([low, from, to]);
      }
    }
    below = here;
  }
  return found;
}

/** Where two rows both have segments: [from, to, solid of the one, solid of the other], where these differ. */
function* bothOf(a, b) {
  for (let i = a.first, j = b.first; i < a.last && j < b.last; ) {
    const from = Math.max(a.chunk.begin[i], b.chunk.begin[j]);
    const to = Math.min(a.chunk.end[i], b.chunk.end[j]);
    if (from < to && a.chunk.solid[i] !== b.chunk.solid[j]) yield [from, to, a.chunk.solid[i], b.chunk.solid[j]];
    if (a.chunk.end[i] < b.chunk.end[j]) ++i;
    else ++j;
  }
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
