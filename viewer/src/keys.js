// The keys, what they do, and the page that lists them.

import { node } from './panel.js';

export const kKeys = [
  ['Page Up, Page Down', 'next or previous layer (row, column, or place of the cutting plane); with Shift ten at once'],
  ['Home, End', 'the first, the last'],
  ['Arrow keys', 'move the picture; in 3D turn it'],
  ['Shift and arrow keys', 'move the pointer by one pixel and one row or layer'],
  ['+, \u2212', 'larger, smaller'],
  ['0, 1', 'all of it; one screen pixel for each pixel of the lattice'],
  ['Z, Y, X, V', 'layer xy, cut xz, cut yz through the pointer, voxels in 3D'],
  ['P, M', 'whole pixels instead of exact ends; marks'],
  ['R', 'on layers: segments as lines, those of the raster rows or of the hatch rows'],
  ['C, F', 'in 3D: the axis that is cut across; keep the other side'],
  ['T', 'dark or light'],
  ['?', 'this list'],
];

const kMouse = [
  ['Wheel', 'zoom at the pointer; in 3D nearer or further'],
  ['Shift and wheel, or wheel over the slider', 'next or previous layer'],
  ['Drag', 'move the picture; in 3D turn it, with the right button move it'],
  ['Two fingers', 'zoom and move the picture'],
  ['Click or drag in a chart', 'show the layer there'],
];

export function fillHelp(dialog, build) {
  const list = (pairs) =>
    node('dl', {}, ...pairs.flatMap(([key, what]) => [node('dt', {}, key), node('dd', {}, what)]));
  const close = node('button', {}, 'Close');
  close.addEventListener('click', () => dialog.close());
  const fineness = `Ends of segments are within ${(build.grid.pitch[0] / build.one).toExponential(1)} mm of those of the build; no pixel's label differs.`;
  dialog.replaceChildren(
    node('h2', { id: 'h-keys' }, 'Keys'),
    list(kKeys),
    node('h2', {}, 'Mouse and touch'),
    list(kMouse),
    node('p', {}, fineness),
    close,
  );
}

/** Calls the action of a key. Keys typed into fields stay theirs. */
export function listenForKeys(actions) {
  window.addEventListener('keydown', (event) => {
    const { target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    const isField = target.matches('input:not([type=checkbox]), select, textarea');
    const isTab = target.matches('[role=tab]') && event.key.startsWith('Arrow');
    if (
      isTab ||
      (isField && (event.key.length === 1 || /^(Arrow|Home|End)/.test(event.key) || target.matches('select')))
    )
      return;
    const name =
      (event.shiftKey && event.key.length > 1 ? 'Shift+' : '') +
      (event.key.length === 1 ? event.key.toLowerCase() : event.key);
    if (!actions[name]) return;
    event.preventDefault();
    actions[name]();
  });
}
