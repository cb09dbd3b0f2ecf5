// Puts the page together: one state (view, place, pointer), and what shows it.

import { readBuild } from './build.js';
import { Chart } from './charts.js';
import { Palette } from './colors.js';
import { fillHelp, listenForKeys } from './keys.js';
import { findingMarks, pairMarks } from './marks.js';
import { byId, describe, fillReport, MaterialList, showPoint } from './panel.js';
import { isolated, nameNode } from './names.js';
import { PlaneView } from './plane_view.js';
import { mm, planesOf, short } from './planes.js';
import { turnText } from './turn.js';
import { VolumeView } from './volume_view.js';

const kTabs = { xy: 'tab-xy', xz: 'tab-xz', yz: 'tab-yz', '3d': 'tab-3d' };
const kClipSteps = 400;

class Page {
  constructor(build) {
    this.build = build;
    this.planes = planesOf(build);
    this.palette = new Palette(build.materials);
    this.view = 'xy';
    this.places = { xy: build.count >> 1, xz: build.ny >> 1, yz: build.nx >> 1, '3d': kClipSteps >> 1 };
    this.marks = pairMarks(build);
    this.findings = findingMarks(build);
    this.plane = new PlaneView(byId('plane'), build, this.palette, this.planes, {
      probe: (probe) => this.tellPoint(probe),
      turn: (steps) => this.go(this.place + steps),
      drawn: () => {
        byId('zoom').textContent = this.zoomText();
      },
    });
    this.plane.marks = this.marks;
    this.volume = new VolumeView(byId('volume'), build, this.palette, {});
    this.fillTexts();
    this.fillAside();
    this.listen();
  }

  get place() {
    return this.places[this.view];
  }
  get last() {
    return (this.view === '3d' ? kClipSteps : this.planes[this.view].places) - 1;
  }

  fillTexts() {
    const { build } = this;
    const { pitch, size } = build.grid;
    const name = build.sources.map((source) => source.split('/').pop()).join(', ') || 'build';
    document.title = `${isolated(name)} \u2013 Lamella`;
    byId('title').replaceChildren(nameNode(name));
    const shown =
      build.count === build.layers.planned
        ? `${build.count} layers`
        : `${build.count} of ${build.layers.planned} layers`;
    const thin = build.isThinned ? ' (each stands for those up to the next)' : '';
    byId('facts').textContent =
      `${shown}${thin} \u00B7 ${size[0]} \u00D7 ${size[1]} pixels of ${short(pitch[0])} \u00D7 ${short(pitch[1])} mm \u00B7 z ${mm(build.zLow)} to ${mm(build.zHigh)} mm${turnText(build.rotation)}`;
    fillHelp(byId('keys'), build);
    showPoint(byId('point'), null);
  }

  fillAside() {
    const { build } = this;
    this.materials = new MaterialList(byId('materials'), build, this.palette, () => this.refreshColors());
    const choose = (k) => {
      if (this.view !== 'xy') this.open('xy');
      this.go(k);
    };
    const lines = build.materials.map((material, m) => ({
      name: material.name,
      color: material.color,
      values: build.layers.area[m],
    }));
    this.areaChart = new Chart(byId('area-chart'), build, { lines, label: 'area in mm\u00B2', height: 190, choose });
    const thickness = build.layers.z_top.map((top, k) => top - build.layers.z_bottom[k]);
    this.thicknessChart = new Chart(byId('thickness-chart'), build, {
      lines: [{ name: 'layers', color: 'var(--accent)', values: thickness }],
      label: 'thickness in mm',
      height: 120,
      choose,
    });
    const places = this.findings
      .filter(({ layer }) => layer !== null)
      .map(({ layer }) => build.layers.z_sample[this.planes.xy.placeOf(layer)]);
    for (const chart of [this.areaChart, this.thicknessChart]) chart.addMarks(this.marks, places);
    fillReport(byId('report'), build, this.marks, this.findings, (mark) => this.lead(mark));
  }

  /** Shows the middle of a mark's box, or the layer of a finding. */
  lead(mark) {
    this.open('xy');
    for (const other of this.marks) other.isChosen = other === mark;
    if (mark.box) {
      const z = (mark.box.low[2] + mark.box.high[2]) / 2;
      this.go(Math.max(0, this.build.layerAt(z)));
    } else {
      this.go(this.planes.xy.placeOf(mark.layer));
    }
    byId('plane').focus();
  }

  refreshColors() {
    this.areaChart.setShown(this.palette.shown);
    this.volume.refreshShown();
    this.plane.draw();
  }

  /** "xy", "xz", "yz" or "3d". */
  open(view) {
    this.view = view;
    for (const [name, id] of Object.entries(kTabs)) {
      byId(id).setAttribute('aria-selected', String(name === view));
      byId(id).tabIndex = name === view ? 0 : -1;
    }
    byId('stage').setAttribute('aria-labelledby', kTabs[view]);
    const isVolume = view === '3d';
    byId('plane').hidden = isVolume;
    byId('volume').hidden = !isVolume;
    document.querySelectorAll('.for-plane').forEach((part) => {
      part.hidden = isVolume;
    });
    document.querySelectorAll('.for-volume').forEach((part) => {
      part.hidden = !isVolume;
    });
    document.querySelector('.for-cut').hidden = view === 'xy';
    document.querySelector('.for-layer').hidden = view !== 'xy';
    if (isVolume) this.openVolume();
    this.go(this.place);
  }

  async openVolume() {
    try {
      await this.volume.open((share) => this.busy(`Making voxels: ${Math.round(100 * share)} %`));
    } catch (error) {
      this.busy(`No 3D picture: ${error.message}. It needs WebGL 2.`);
      return;
    }
    this.busy('');
    const { data, unit } = this.volume;
    const of = data.step.every((step) => step === 1) ? '' : `, each of ${data.step.join(' \u00D7 ')} of the build's`;
    byId('voxel-size').textContent =
      `${data.size.join(' \u00D7 ')} voxels of ${unit.map(short).join(' \u00D7 ')} mm${of}`;
    this.showVolumeMarks();
    this.volume.resize();
    this.showPlace();
  }

  busy(text) {
    byId('busy').textContent = text;
    byId('busy').hidden = text === '';
  }

  /** To a layer, row, column, or place of the cutting plane; waits for its data and shows it. */
  async go(place) {
    const { view } = this;
    const next = Math.min(this.last, Math.max(0, Math.round(place)));
    if (Number.isNaN(next)) return;
    this.places[view] = next;
    this.showPlace();
    if (view === '3d') {
      this.volume.setClip({ share: (next + 0.5) / kClipSteps });
      this.showPlace();
      return;
    }
    await this.loadFor(view, next);
    if (this.view !== view || this.places[view] !== next) return;
    this.plane.show(view, next);
    this.tellPoint(this.plane.probe);
  }

  async loadFor(view, place) {
    if (view === 'xy') {
      if (!this.build.peek(place)) await this.build.load(place);
      return;
    }
    await this.build.loadAll(this.planes[view].layersNeeded(place), (share) =>
      this.busy(`Decoding layers: ${Math.round(100 * share)} %`),
    );
    if (this.view === view) this.busy('');
  }

  showPlace() {
    const { view, place } = this;
    const slider = byId('position');
    slider.max = this.last;
    slider.value = place;
    const plane = this.planes[view];
    byId('number').value = plane ? plane.numberOf(place) : place;
    byId('where-name').textContent = plane?.word ?? 'Cut';
    byId('where').textContent = plane ? plane.label(place) : this.volume.clipLabel();
    slider.setAttribute('aria-label', plane?.word ?? 'Place of the cutting plane');
    slider.setAttribute(
      'aria-valuetext',
      `${plane ? `${plane.word} ${plane.numberOf(place)}, ` : ''}${byId('where').textContent}`,
    );
    byId('plane').setAttribute(
      'aria-label',
      plane ? `${plane.word} ${plane.numberOf(place)}, ${plane.label(place)}` : '',
    );
    const layer = this.places.xy;
    this.materials.setLayer(layer);
    this.areaChart.setLayer(layer);
    this.thicknessChart.setLayer(layer);
  }

  zoomText() {
    const zoom = this.view === '3d' ? 1 : (this.plane.windows[this.view]?.across ?? 1);
    return `${short(Number(zoom.toPrecision(3)))} px/pixel`;
  }

  tellPoint(probe) {
    if (this.view === '3d') return;
    const told = describe(this.build, this.planes[this.view], this.place, probe, this.plane.pixels);
    showPoint(byId('point'), told);
    this.said = told?.say ?? '';
  }

  setTheme(theme) {
    document.documentElement.dataset.theme = theme;
    this.refreshTheme();
  }

  /** What is drawn rather than styled takes its colours anew. */
  refreshTheme() {
    this.plane.draw();
    this.volume.refreshTheme();
    this.showVolumeMarks();
  }

  showVolumeMarks() {
    const style = getComputedStyle(document.body);
    const inkOf = (kind) => style.getPropertyValue(`--${kind}`).trim();
    this.volume.setMarks(this.plane.marksShown ? this.marks : [], {
      overlap: inkOf('overlap'),
      gap: inkOf('gap'),
      open: inkOf('open'),
    });
  }

  toggleTheme() {
    const isDark = getComputedStyle(document.documentElement).getPropertyValue('--is-dark').trim() === '1';
    this.setTheme(isDark ? 'light' : 'dark');
  }

  toggle(id) {
    byId(id).click();
  }

  /** The cut through the pointer. */
  cutThrough(view) {
    const { probe } = this.plane;
    if (probe && this.view !== '3d') {
      const voxel = this.planes[this.view].voxel(this.place, probe.h, probe.v);
      const wanted = { xy: voxel.layer, xz: voxel.row, yz: Math.floor(voxel.across) }[view];
      if (wanted >= 0) this.places[view] = wanted;
    }
    this.open(view);
  }

  listen() {
    const on = (id, type, act) => byId(id).addEventListener(type, act);
    for (const [view, id] of Object.entries(kTabs)) on(id, 'click', () => this.open(view));
    document.querySelector('[role=tablist]').addEventListener('keydown', (event) => this.moveTab(event));
    on('position', 'input', () => this.go(Number(byId('position').value)));
    on('number', 'change', () => this.go(this.placeOfNumber(Number(byId('number').value))));
    document.querySelector('.slider').addEventListener(
      'wheel',
      (event) => {
        event.preventDefault();
        this.go(this.place + ((event.deltaY || event.deltaX) < 0 ? 1 : -1));
      },
      { passive: false },
    );
    on('back', 'click', () => this.go(this.place - 1));
    on('forth', 'click', () => this.go(this.place + 1));
    on('zoom-in', 'click', () => this.plane.zoomBy(1.5));
    on('zoom-out', 'click', () => this.plane.zoomBy(1 / 1.5));
    on('fit', 'click', () => this.plane.fit());
    on('one', 'click', () => this.plane.oneToOne());
    on('pixels', 'change', () => {
      this.plane.pixels = byId('pixels').checked;
      this.plane.draw();
      this.tellPoint(this.plane.probe);
    });
    on('marks', 'change', () => {
      this.plane.marksShown = byId('marks').checked;
      this.plane.draw();
      this.showVolumeMarks();
    });
    if (!this.build.hatch) document.querySelector('#rows option[value=hatch]').remove();
    on('rows', 'change', () => {
      this.plane.rows = byId('rows').value;
      this.plane.drawSoon();
      byId('zoom').textContent = this.zoomText();
    });
    on('stretch', 'change', () => this.plane.setStretch(Number(byId('stretch').value)));
    on('home', 'click', () => this.volume.home());
    on('clip-axis', 'change', () => {
      this.volume.setClip({ axis: byId('clip-axis').value });
      this.showPlace();
    });
    on('clip-flip', 'change', () => this.volume.setClip({ flip: byId('clip-flip').checked }));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.refreshTheme());
    on('theme', 'click', () => this.toggleTheme());
    on('help', 'click', () => byId('keys').showModal());
    listenForKeys(this.keyActions());
  }

  placeOfNumber(number) {
    return this.planes[this.view]?.placeOf(number) ?? number;
  }

  moveTab(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const views = Object.keys(kTabs);
    const view = views[(views.indexOf(this.view) + step + views.length) % views.length];
    this.open(view);
    byId(kTabs[view]).focus();
  }

  keyActions() {
    const { plane, volume } = this;
    const arrow = (x, y) => () => (this.view === '3d' ? volume.turn(-8 * x, -8 * y) : plane.panBy(-60 * x, 60 * y));
    const probe = (x, y) => () => {
      if (this.view === '3d') return;
      plane.moveProbe(x, y);
      byId('live').textContent = this.said;
    };
    const zoom = (factor) => () => (this.view === '3d' ? volume.turn(0, 0, 1 / factor) : plane.zoomBy(factor));
    const step = (steps) => () => this.go(this.place + steps);
    return {
      PageUp: step(1),
      PageDown: step(-1),
      'Shift+PageUp': step(10),
      'Shift+PageDown': step(-10),
      Home: () => this.go(0),
      End: () => this.go(this.last),
      ArrowLeft: arrow(-1, 0),
      ArrowRight: arrow(1, 0),
      ArrowUp: arrow(0, 1),
      ArrowDown: arrow(0, -1),
      'Shift+ArrowLeft': probe(-1, 0),
      'Shift+ArrowRight': probe(1, 0),
      'Shift+ArrowUp': probe(0, 1),
      'Shift+ArrowDown': probe(0, -1),
      '+': zoom(1.25),
      '=': zoom(1.25),
      '-': zoom(0.8),
      0: () => (this.view === '3d' ? volume.home() : plane.fit()),
      1: () => {
        if (this.view !== '3d') plane.oneToOne();
      },
      z: () => this.cutThrough('xy'),
      y: () => this.cutThrough('xz'),
      x: () => this.cutThrough('yz'),
      v: () => this.open('3d'),
      p: () => this.toggle('pixels'),
      m: () => this.toggle('marks'),
      f: () => this.toggle('clip-flip'),
      c: () => this.next('clip-axis'),
      r: () => {
        if (this.view === 'xy') this.next('rows');
      },
      t: () => this.toggleTheme(),
      '?': () => byId('keys').showModal(),
    };
  }

  /** The next choice of a list. */
  next(id) {
    const select = byId(id);
    select.selectedIndex = (select.selectedIndex + 1) % select.options.length;
    select.dispatchEvent(new Event('change'));
  }
}

window.addEventListener('unhandledrejection', ({ reason }) => {
  byId('busy').hidden = false;
  byId('busy').textContent =
    `This page can't be read: ${reason?.message ?? reason}. Make it again, or try a newer browser.`;
});
const start = performance.now();
const page = new Page(readBuild(document));
page.open('xy');
// For those who look into the page by its console, and for the tests.
window.lamella = Object.assign(page, { readTime: performance.now() - start });
