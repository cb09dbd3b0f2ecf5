// The column beside the picture: materials, what is under the pointer, the report.

import { fractionsAt } from './colors.js';
import { isolated, joined, nameNode } from './names.js';
import { mm, segmentAt, short } from './planes.js';

export const byId = (id) => document.getElementById(id);

/** A node of HTML; children are nodes or texts. */
export function node(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

export function swatch(color) {
  const made = node('i', { class: 'dot', 'aria-hidden': 'true' });
  made.style.background = color;
  return made;
}

/** Rows of boxes, one a material; `changed` is called when one was switched. */
export class MaterialList {
  constructor(root, build, palette, changed) {
    Object.assign(this, { root, build, palette, changed });
    this.boxes = [];
    this.areas = [];
    const table = node(
      'table',
      {},
      node(
        'thead',
        {},
        node(
          'tr',
          {},
          node('th', { scope: 'col' }, 'shown'),
          node('th', { scope: 'col', class: 'number' }, 'layer mm\u00B2'),
          node('th', { scope: 'col', class: 'number' }, 'build mm\u00B3'),
        ),
      ),
    );
    const body = node('tbody');
    build.materials.forEach((material, m) => body.append(this.row(material, m)));
    table.append(body);
    root.replaceChildren(table, this.buttons());
  }

  row(material, m) {
    const box = node('input', { type: 'checkbox', id: `material-${m}` });
    box.checked = true;
    box.addEventListener('change', () => this.set(m, box.checked));
    this.boxes.push(box);
    const area = node('td', { class: 'number' });
    this.areas.push(area);
    const parts = material.components?.map((component) => nameNode(this.build.materials[component].name));
    const label = node('label', { for: box.id }, swatch(material.color), nameNode(material.name));
    if (parts) label.append(node('small', {}, 'mixed of ', ...joined(parts, ' + ')));
    // Volumes are those of plain materials; a graded one has none of its own.
    const volume = material.components ? '\u2013' : short(material.volume ?? 0);
    return node('tr', {}, node('td', {}, box, label), area, node('td', { class: 'number' }, volume));
  }

  buttons() {
    const all = node('button', {}, 'All');
    const none = node('button', {}, 'None');
    all.addEventListener('click', () => this.setAll(() => true));
    none.addEventListener('click', () => this.setAll(() => false));
    return node('p', { class: 'row' }, all, none);
  }

  set(m, shown) {
    this.palette.shown[m] = shown;
    this.boxes[m].checked = shown;
    this.changed();
  }

  setAll(of) {
    this.boxes.forEach((box, m) => {
      box.checked = this.palette.shown[m] = of(m);
    });
    this.changed();
  }

  setLayer(k) {
    this.areas.forEach((cell, m) => {
      cell.textContent = short(this.build.layers.area[m][k] ?? 0);
    });
  }
}

/** What is under the pointer, as pairs of term and text or nodes; null without a pointer. */
export function describe(build, plane, place, probe, usePixels) {
  if (!probe) return null;
  const voxel = plane.voxel(place, probe.h, probe.v);
  const point = pointOf(build, plane, voxel, probe, place);
  const rows = [['x, y, z', `${point.map(mm).join(', ')} mm`]];
  const found = segmentAt(build, voxel, usePixels);
  const isInside =
    voxel.layer >= 0 && voxel.row >= 0 && voxel.row < build.ny && voxel.across >= 0 && voxel.across < build.nx;
  if (!isInside) return { rows: [...rows, ['', 'outside the lattice']], say: 'outside the lattice' };
  const index = build.layers.index[voxel.layer];
  rows.push(['voxel', `${Math.floor(voxel.across)}, ${voxel.row}, layer ${index}`]);
  if (!found) return { rows: [...rows, ['', 'not decoded yet']], say: '' };
  if (found.i < 0) return { rows: [...rows, ['material', 'none']], say: `no material, ${rows[0][1]}` };
  return withSegment(build, found, rows);
}

function pointOf(build, plane, voxel, probe, place) {
  const at = {
    [plane.across.name]: plane.across.origin + plane.across.unit * probe.h,
    [plane.up.name]: plane.up.origin + plane.up.unit * probe.v,
  };
  at[plane.along] = {
    x: () => build.x(place * build.one),
    y: () => build.y(place),
    z: () => build.layers.z_sample[place],
  }[plane.along]();
  return [at.x, at.y, at.z];
}

function withSegment(build, { data, i, code }, rows) {
  const { chunk } = data;
  const material = build.materials[chunk.material[i]];
  const solid = build.solids[chunk.solid[i]];
  const [from, to] = [build.x(chunk.begin[i]), build.x(chunk.end[i])];
  rows.push(['material', nameNode(material.name), material.color], ['solid', nameNode(solid.name || solid.path)]);
  rows.push(['segment', `x ${fine(from)} to ${fine(to)} mm, ${fine(to - from)} mm long`]);
  const mix = fractionsAt(build, chunk, i, code);
  if (mix)
    rows.push([
      'mixture',
      joined(
        mix.map(({ material: m, share }) => [`${(100 * share).toFixed(1)} % `, nameNode(build.materials[m].name)]),
        ', ',
      ).flat(),
    ]);
  return {
    rows,
    say: `${isolated(material.name)}, solid ${isolated(solid.name)}, x from ${fine(from)} to ${fine(to)} mm`,
  };
}

/** mm to a nanometre: codes are finer than a thousandth of a pixel. */
const fine = (value) =>
  value
    .toFixed(6)
    .replace(/\.?0+$/, '')
    .replace(/^-/, '\u2212');

export function showPoint(root, told) {
  const rows = told?.rows ?? [['', 'Move the pointer over the picture, or hold Shift and press an arrow key.']];
  root.replaceChildren(
    ...rows.flatMap(([term, text, color]) => {
      const value = node('dd', term ? {} : { class: 'hint' });
      if (color) value.append(swatch(color));
      value.append(...[text].flat());
      return [...(term ? [node('dt', {}, term)] : []), value];
    }),
  );
}

/** Marks and findings with buttons that lead there. `lead` takes a mark or a finding. */
export function fillReport(root, build, marks, findings, lead) {
  const { report } = build;
  const items = [
    ...marks.map((mark) => markItem(mark, lead)),
    ...findings.map((finding) => findingItem(finding, lead)),
  ];
  const rays = [
    ['repaired_rays', 'rows repaired'],
    ['unclosed_rays', 'rows not closed'],
    ['uncertain_hits', 'uncertain hits'],
  ]
    .map(([key, words]) => `${report[key]} ${words}`)
    .join(', ');
  const verdict = report.within_budget
    ? 'The slicing kept its error budget.'
    : 'The slicing EXCEEDED its error budget.';
  root.replaceChildren(
    node('p', { class: report.within_budget ? 'good' : 'bad' }, verdict),
    node('p', {}, `Of ${report.rays} rows: ${rays}.`),
  );
  if (report.interfaces.length)
    root.append(node('p', {}, `${report.interfaces.length} pairs of solids share a surface.`));
  root.append(
    items.length ? node('ul', { class: 'items' }, ...items) : node('p', {}, 'No overlaps, gaps or findings.'),
  );
}

function markItem(mark, lead) {
  const width = mark.width > 0 ? `, up to ${short(mark.width)} mm` : '';
  const figures = `${short(mark.volume)} mm\u00B3${width}, in ${mark.layers} layers`;
  const [a, b] = mark.names;
  const item = node('li', { class: mark.kind }, `${mark.word} of `, nameNode(a), ' and ', nameNode(b), `: ${figures}`);
  const text = `${mark.word} of ${isolated(a)} and ${isolated(b)}: ${figures}`;
  if (mark.isThin) item.append(node('small', {}, ' (too thin to draw)'));
  if (mark.box)
    item.append(
      ' ',
      leadButton('Show', `Show the ${text}`, () => lead(mark)),
    );
  return item;
}

function findingItem(finding, lead) {
  const where = joined([finding.solid, finding.face, finding.entity].filter(Boolean).map(nameNode), ', ');
  const item = node(
    'li',
    { class: `finding ${finding.severity}` },
    `${finding.severity}: `,
    ...(where.length ? [...where, ': '] : []),
    nameNode(finding.what),
  );
  if (finding.hint) item.append(node('small', {}, ' ', nameNode(finding.hint)));
  if (finding.layer !== null)
    item.append(
      ' ',
      leadButton(`Layer ${finding.layer}`, `Show layer ${finding.layer}`, () => lead(finding)),
    );
  return item;
}

function leadButton(text, label, act) {
  const button = node('button', { 'aria-label': label }, text);
  button.addEventListener('click', act);
  return button;
}
