// Names are whatever a file says: beside other text they must not reorder it.

/** Embeddings, overrides and isolates: no script needs them for a name, and one left open would reach beyond it. */
const kControls = /[\u202A-\u202E\u2066-\u2069]/g;

const plain = (name) => String(name).replace(kControls, '\uFFFD');

/** A name as a node that text around it may stand beside. */
export function nameNode(name) {
  const made = document.createElement('bdi');
  made.append(plain(name));
  return made;
}

/** The same within a string, such as a label that is read out. */
export const isolated = (name) => `\u2068${plain(name)}\u2069`;

/** Nodes and texts with `between` in between them. */
export const joined = (parts, between) => parts.flatMap((part, i) => (i > 0 ? [between, part] : [part]));
