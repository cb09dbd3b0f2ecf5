// Charts over the height z: steps, because a layer has one value.

import { isolated } from './names.js';
import { short, mm } from './planes.js';
import { tickStep } from './overlay.js';

const kWidth = 360;
const kLeft = 52;
const kRight = 10;
const kTop = 8;
const kBottom = 36;
const kColumns = 600;
const kLanes = ['overlap', 'gap', 'open'];
const kNames = { overlap: 'overlap', gap: 'filled gap', open: 'open gap' };

function element(name, attributes, text) {
  const node = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

/** One chart: `lines` are {name, color, values by layer}. Clicking it shows the layer there. */
export class Chart {
  constructor(root, build, { lines, label, height, choose }) {
    Object.assign(this, { root, build, lines, label, height, choose });
    this.top = Math.max(...lines.map((line) => line.values.reduce((a, b) => Math.max(a, b), 0)), 1e-12) * 1.04;
    this.svg = element('svg', { viewBox: `0 0 ${kWidth} ${height}`, role: 'img', 'aria-label': this.summary() });
    root.replaceChildren(this.svg);
    this.drawAxes();
    this.curves = lines.map((line) => this.drawLine(line));
    this.cursor = element('line', { class: 'cursor', y1: kTop, y2: this.bottom });
    this.value = element('text', { class: 'value', y: kTop + 10 });
    this.svg.append(this.cursor, this.value);
    this.svg.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) this.pick(event);
      else this.tell(event);
    });
    this.svg.addEventListener('pointerdown', (event) => this.pick(event));
    this.svg.addEventListener('pointerleave', () => {
      this.value.textContent = '';
    });
  }

  get bottom() {
    return this.height - kBottom;
  }
  x(z) {
    return kLeft + ((z - this.build.zLow) / (this.build.zHigh - this.build.zLow)) * (kWidth - kLeft - kRight);
  }
  y(value) {
    return this.bottom - (value / this.top) * (this.bottom - kTop);
  }

  summary() {
    const largest = this.lines.map(
      ({ name, values }) => `${isolated(name)}: at most ${short(values.reduce((a, b) => Math.max(a, b), 0))}`,
    );
    return `${this.label} over height z in mm. ${largest.join('; ')}`;
  }

  drawAxes() {
    const { build, svg } = this;
    const add = (x1, y1, x2, y2) => svg.append(element('line', { class: 'grid', x1, y1, x2, y2 }));
    const stepZ = tickStep(build.zHigh - build.zLow, 6);
    for (let n = Math.ceil(build.zLow / stepZ - 1e-9); n * stepZ <= build.zHigh + 1e-9 * stepZ; ++n) {
      add(this.x(n * stepZ), kTop, this.x(n * stepZ), this.bottom);
      svg.append(
        element('text', { x: this.x(n * stepZ), y: this.bottom + 14, 'text-anchor': 'middle' }, mm(n * stepZ)),
      );
    }
    const step = tickStep(this.top, 4);
    for (let n = 0; n * step <= this.top; ++n) {
      add(kLeft, this.y(n * step), kWidth - kRight, this.y(n * step));
      svg.append(element('text', { x: kLeft - 5, y: this.y(n * step) + 4, 'text-anchor': 'end' }, short(n * step)));
    }
    svg.append(
      element(
        'text',
        { x: (kLeft + kWidth - kRight) / 2, y: this.height - 6, 'text-anchor': 'middle' },
        'height z in mm',
      ),
    );
    svg.append(
      element(
        'text',
        { transform: `translate(10 ${(kTop + this.bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle' },
        this.label,
      ),
    );
  }

  /** Layers that share a column show the largest of their values. */
  drawLine({ values, color }) {
    const { build } = this;
    const share = Math.max(1, Math.ceil(build.count / kColumns));
    let path = '';
    for (let k = 0; k < build.count; k += share) {
      const end = Math.min(build.count, k + share);
      let value = 0;
      for (let i = k; i < end; ++i) value = Math.max(value, values[i]);
      path += `${k ? 'L' : 'M'}${this.x(build.layers.z_bottom[k]).toFixed(1)} ${this.y(value).toFixed(1)}H${this.x(build.zEnd[end - 1]).toFixed(1)}`;
    }
    const group = element('g', {});
    group.append(
      element('path', { class: 'halo', d: path }),
      element('path', { class: 'curve', d: path, stroke: color }),
    );
    this.svg.append(group);
    return group;
  }

  /** Where marks lie in z, below the curves. */
  addMarks(boxes, places) {
    for (const { box, kind } of boxes) {
      if (!box) continue;
      const from = this.x(Math.max(box.low[2], this.build.zLow));
      const width = Math.max(2, this.x(Math.min(box.high[2], this.build.zHigh)) - from);
      const rect = element('rect', {
        class: `mark ${kind}`,
        x: from,
        y: this.bottom - 4 - 5 * kLanes.indexOf(kind),
        width,
        height: 4,
      });
      rect.append(element('title', {}, kNames[kind]));
      this.svg.append(rect);
    }
    for (const z of places) {
      this.svg.append(
        element('path', { class: 'mark finding', d: `M${this.x(z).toFixed(1)} ${this.bottom - 8}l4 8h-8z` }),
      );
    }
  }

  setShown(shown) {
    this.curves.forEach((curve, n) => {
      curve.style.display = shown[n] ? '' : 'none';
    });
  }

  setLayer(k) {
    const x = this.x((this.build.layers.z_bottom[k] + this.build.zEnd[k]) / 2);
    this.cursor.setAttribute('x1', x);
    this.cursor.setAttribute('x2', x);
  }

  layerOf(event) {
    const box = this.svg.getBoundingClientRect();
    const part = (((event.clientX - box.left) / box.width) * kWidth - kLeft) / (kWidth - kLeft - kRight);
    const z = this.build.zLow + Math.min(1 - 1e-9, Math.max(0, part)) * (this.build.zHigh - this.build.zLow);
    return this.build.layerAt(z);
  }

  pick(event) {
    event.preventDefault();
    this.choose(this.layerOf(event));
    this.tell(event);
  }

  tell(event) {
    const k = this.layerOf(event);
    const z = this.build.layers.z_sample[k];
    this.value.textContent = `layer ${this.build.layers.index[k]}, z = ${mm(z)} mm`;
    const isLeft = this.x(z) < kWidth * 0.55;
    this.value.setAttribute('x', isLeft ? kWidth - kRight : kLeft + 4);
    this.value.setAttribute('text-anchor', isLeft ? 'end' : 'start');
  }
}
