// The picture of a cut: pans, zooms, follows the pointer.

import { paint } from './pictures.js';
import { drawOverlay } from './overlay.js';

const kLeastZoom = 1 / 64;
const kMostZoom = 400;
const kMargin = { left: 58, right: 16, top: 16, bottom: 34 }; // of a fitted picture, CSS pixels; the rulers lie there

export class PlaneView {
  /** `events`: probe(place or null), turn(steps) */
  constructor(root, build, palette, planes, events) {
    Object.assign(this, { root, build, palette, planes, events });
    this.picture = root.querySelector('#picture');
    this.overlay = root.querySelector('#overlay');
    this.windows = {};
    this.pixels = false;
    this.rows = 'none'; // segments as lines: none, raster, hatch
    this.pointers = new Map(); // that are down, by id, in canvas pixels
    this.stretch = 1; // of z in cuts
    this.marksShown = true;
    this.marks = [];
    this.probe = null;
    this.kind = 'xy';
    this.place = 0;
    this.frameTimes = [];
    new ResizeObserver(() => this.resize()).observe(root);
    this.listen();
  }

  get plane() {
    return this.planes[this.kind];
  }
  get density() {
    return window.devicePixelRatio || 1;
  }
  /** left and top in units of the axes, across: canvas pixels a unit across */
  get window() {
    return (this.windows[this.kind] ??= this.fitted());
  }
  /** Canvas pixels a unit upwards for one a unit across: the scale in mm is the same, but z may be stretched. */
  get ratio() {
    const { up, across } = this.plane;
    return (up.unit / across.unit) * (up.name === 'z' ? this.stretch : 1);
  }
  get up() {
    return this.window.across * this.ratio;
  }

  show(kind, place) {
    if (kind !== this.kind) this.setProbe(null);
    this.kind = kind;
    this.place = place;
    this.draw();
  }

  resize() {
    const { width, height } = this.root.getBoundingClientRect();
    for (const canvas of [this.picture, this.overlay]) {
      canvas.width = Math.max(1, Math.round(width * this.density));
      canvas.height = Math.max(1, Math.round(height * this.density));
    }
    for (const kind of Object.keys(this.windows)) if (this.windows[kind].isFitted) delete this.windows[kind];
    this.draw();
  }

  fitted() {
    const { across, up } = this.plane;
    const { width, height } = this.picture;
    const [left, right, top, bottom] = ['left', 'right', 'top', 'bottom'].map((side) => kMargin[side] * this.density);
    const { ratio } = this;
    const zoom = Math.max(
      1e-6,
      Math.min((width - left - right) / across.count, (height - top - bottom) / (up.count * ratio)),
    );
    const scale = { across: zoom, up: zoom * ratio };
    return {
      across: zoom,
      left: across.count / 2 - (left + (width - left - right) / 2) / scale.across,
      top: up.count / 2 + (top + (height - top - bottom) / 2) / scale.up,
      isFitted: true,
    };
  }

  /** Draws z larger than x and y in the cuts: thin stacks are seen better. */
  setStretch(stretch) {
    this.stretch = stretch;
    delete this.windows.xz;
    delete this.windows.yz;
    this.draw();
  }

  fit() {
    this.windows[this.kind] = this.fitted();
    this.draw();
  }

  /** One canvas pixel for a pixel of the lattice, on the same grid, so that every pixel has the label of one voxel. */
  oneToOne() {
    const { across, up } = this.plane;
    this.windows[this.kind] = { across: 1, left: 0, top: 0 };
    this.window.left = Math.round((across.count - this.picture.width) / 2);
    const shown = this.picture.height / this.up;
    this.window.top = this.kind === 'xy' ? Math.round((up.count + shown) / 2) : (up.count + shown) / 2;
    this.draw();
  }

  /** About a place of the canvas, in its pixels; the middle without one. */
  zoomBy(factor, at) {
    const { x, y } = at ?? { x: this.picture.width / 2, y: this.picture.height / 2 };
    const old = { ...this.window, up: this.up };
    const window = (this.windows[this.kind] = {
      across: Math.min(kMostZoom, Math.max(kLeastZoom, old.across * factor)),
    });
    window.left = old.left + x / old.across - x / window.across;
    window.top = old.top - y / old.up + y / this.up;
    this.draw();
  }

  /** By canvas pixels, as a hand moves paper. */
  panBy(x, y) {
    const { window } = this;
    window.left -= x / window.across;
    window.top += y / this.up;
    window.isFitted = false;
    this.draw();
  }

  /** One pointer moves the picture; two keep what is under them where it is, by moving and zooming it. */
  movePointer(id, at) {
    const old = this.pointers.get(id);
    this.pointers.set(id, at);
    const other = [...this.pointers].find(([key]) => key !== id)?.[1];
    if (!other) {
      this.panBy(at.x - old.x, at.y - old.y);
      return;
    }
    const spread = (from) => Math.hypot(from.x - other.x, from.y - other.y);
    this.panBy((at.x - old.x) / 2, (at.y - old.y) / 2);
    const least = 8 * this.density; // nearer to each other fingers say nothing of a scale
    if (spread(old) < least || spread(at) < least) return;
    this.zoomBy(spread(at) / spread(old), { x: (at.x + other.x) / 2, y: (at.y + other.y) / 2 });
  }

  /** What lies under a place of the canvas, in units of the axes. */
  unitsAt({ x, y }) {
    return { h: this.window.left + x / this.window.across, v: this.window.top - y / this.up };
  }

  setProbe(probe) {
    this.probe = probe;
    this.events.probe(probe);
    this.drawSoon();
  }

  /** By whole pixels and rows or layers, from the middle of the picture when there is no probe yet. */
  moveProbe(stepsAcross, stepsUp) {
    const { across, up } = this.plane;
    const from = this.probe ?? { h: across.count / 2, v: up.count / 2 };
    const h = Math.min(across.count, Math.max(1, Math.floor(from.h) + 1 + stepsAcross)) - 0.5;
    this.setProbe({ h, v: this.kind === 'xy' ? this.rowMiddle(from.v, stepsUp) : this.layerMiddle(from.v, stepsUp) });
    this.keepInSight();
  }

  rowMiddle(v, steps) {
    return Math.min(this.build.ny, Math.max(1, Math.floor(v) + 1 + steps)) - 0.5;
  }

  layerMiddle(v, steps) {
    const at = this.build.layerAt(this.build.zLow + v);
    const k = Math.min(this.build.count - 1, Math.max(0, at + steps));
    return (this.build.layers.z_bottom[k] + this.build.zEnd[k]) / 2 - this.build.zLow;
  }

  keepInSight() {
    const x = (this.probe.h - this.window.left) * this.window.across;
    const y = (this.window.top - this.probe.v) * this.up;
    const beyond = (value, size) => (value < 0 ? -value : value > size ? size - value : 0);
    const dx = beyond(x, this.picture.width);
    const dy = beyond(y, this.picture.height);
    if (dx || dy) this.panBy(dx, dy);
  }

  drawSoon() {
    this.pending ??= requestAnimationFrame(() => {
      this.pending = null;
      this.drawOver();
    });
  }

  /** On the next frame, however often it is asked for. */
  draw() {
    this.stale = true;
    this.drawSoon();
  }

  drawOver() {
    if (this.stale) this.drawPicture();
    this.stale = false;
    drawOverlay(this);
  }

  drawPicture() {
    const start = performance.now();
    const { width, height } = this.picture;
    const context = this.picture.getContext('2d');
    const image = context.createImageData(width, height);
    const window = { width, height, ...this.window, up: this.up, pixels: this.pixels };
    paint(this.kind, this.build, this.palette, this.place, window, new Uint32Array(image.data.buffer));
    context.putImageData(image, 0, 0);
    this.frameTimes.push(performance.now() - start);
    if (this.frameTimes.length > 500) this.frameTimes.shift();
    this.events.drawn?.();
  }

  listen() {
    const { root } = this;
    const canvasPlace = (event) => {
      const box = root.getBoundingClientRect();
      return { x: (event.clientX - box.left) * this.density, y: (event.clientY - box.top) * this.density };
    };
    root.addEventListener('pointerdown', (event) => {
      if (event.button > 1) return;
      root.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, canvasPlace(event));
      root.classList.add('dragged');
    });
    root.addEventListener('pointermove', (event) => {
      const at = canvasPlace(event);
      if (this.pointers.has(event.pointerId)) this.movePointer(event.pointerId, at);
      if (this.pointers.size < 2) this.setProbe(this.unitsAt(at));
    });
    const release = (event) => {
      this.pointers.delete(event.pointerId);
      if (this.pointers.size === 0) root.classList.remove('dragged');
    };
    root.addEventListener('pointerup', release);
    root.addEventListener('pointercancel', release);
    root.addEventListener('pointerleave', () => {
      if (this.pointers.size === 0) this.setProbe(null);
    });
    root.addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        const delta = event.deltaY || event.deltaX;
        if (event.shiftKey) this.events.turn(delta < 0 ? 1 : -1);
        else this.zoomBy(Math.exp(-Math.max(-200, Math.min(200, delta)) / 400), canvasPlace(event));
      },
      { passive: false },
    );
  }
}
