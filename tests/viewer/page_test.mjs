// The page of `lamella view` in a browser, as its users have it.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import {
  goTo, number, openPage, place, read, readCanvas, readPictures, readPoint, run, screenPlace, settled, slice, startBrowser, view,
} from './fixture.mjs';

const kPitch = 0.5;
let browser;
let report;
let pictures;

before(async () => {
  report = slice('overmoulded_grip', 'grip', ['--pitch', String(kPitch), '--layer-height', String(kPitch)]);
  view('grip', 'grip.html');
  run('export', place('grip'), '--to', 'png-indexed', '-o', place('grip-png'));
  pictures = readPictures('pictures', place('grip-png'));
  slice('gradient_lens', 'lens', ['--pitch', '0.5', '--layer-height', '1'], 'graded.xml');
  view('lens', 'lens.html');
  browser = await startBrowser();
}, { timeout: 300000 });

after(() => browser?.close());

/** Runs `act` on a fresh page and fails on its errors. */
async function onPage(file, act, options) {
  const { page, faults } = await openPage(browser, file, options);
  try {
    await act(page);
    assert.deepEqual(faults, []);
  } finally {
    await page.close();
  }
}

/** How many pixels of a canvas at 1:1 differ from a picture, and how many of both show anything. */
function compare(canvas, expected, n, tolerance = 0) {
  let wrong = 0;
  let full = 0;
  for (let y = 0; y < canvas.height; ++y) {
    const row = expected.height - (canvas.top - y);
    for (let x = 0; x < canvas.width; ++x) {
      const column = canvas.left + x;
      const isInside = row >= 0 && row < expected.height && column >= 0 && column < expected.width;
      const wanted = isInside ? expected.at(n, row, column) : 0;
      if (wanted) ++full;
      if (!isNear(canvas.at(x, y), wanted, tolerance)) ++wrong;
    }
  }
  return { wrong, full };
}

const channels = (rgba) => [24, 16, 8, 0].map((shift) => rgba >>> shift & 255);
const isNear = (a, b, tolerance) => a === b || tolerance > 0 && channels(a).every((value, c) => Math.abs(value - channels(b)[c]) <= tolerance);

describe('layers', () => {
  test('every pixel has the label of the exported picture', () => onPage('grip.html', async (page) => {
    await page.keyboard.press('1');
    for (const layer of [3, 17, 35, 36, 60]) {
      await goTo(page, layer);
      const { wrong, full } = compare(await readCanvas(page), pictures, layer);
      assert.ok(full > 500, `layer ${layer} shows ${full} pixels`);
      assert.equal(wrong, 0, `layer ${layer}`);
    }
  }));

  test('a picture of another layer is told apart', () => onPage('grip.html', async (page) => {
    await page.keyboard.press('1');
    await goTo(page, 35);
    assert.ok(compare(await readCanvas(page), pictures, 30).wrong > 100);
  }));

  test('graded materials have the blended colours', () => onPage('lens.html', async (page) => {
    await page.keyboard.press('1');
    const layer = await page.evaluate(() => window.lamella.places.xy);
    for (const n of [layer, layer + 5]) {
      await goTo(page, n);
      const { wrong, full } = compare(await readCanvas(page), readPictures('mixed', place('lens'), String(n)), 0, 1);
      assert.ok(full > 300);
      assert.equal(wrong, 0);
    }
  }));

  test('a hidden material leaves its pixels empty and no others', () => onPage('grip.html', async (page) => {
    await page.keyboard.press('1');
    await goTo(page, 35);
    const full = await readCanvas(page);
    await page.getByRole('checkbox', { name: 'TPE Thermolast K' }).uncheck();
    const less = await readCanvas(page);
    const hidden = 0xF59E29FF;
    let gone = 0;
    for (let y = 0; y < full.height; ++y) {
      for (let x = 0; x < full.width; ++x) {
        if (full.at(x, y) === hidden) ++gone;
        assert.equal(less.at(x, y), full.at(x, y) === hidden ? 0 : full.at(x, y));
      }
    }
    assert.ok(gone > 1000);
  }));

  test('thinned pages keep the numbers of the build', () => {
    const report = view('grip', 'thin.html', '--layers', '10:40', '--every', '7');
    assert.equal(report.format, 'html');
    assert.equal(report.files.length, 1);
    return onPage('thin.html', async (page) => {
      assert.match(await page.locator('#facts').textContent(), /5 of 71 layers/);
      await page.keyboard.press('1');
      await goTo(page, 31);
      assert.equal(await page.locator('#number').inputValue(), '31');
      assert.equal(compare(await readCanvas(page), pictures, 31).wrong, 0);
    });
  });
});

describe('cuts', () => {
  /** Compares the middle line of each layer of a cut at 1:1, z stretched so that layers have several lines. */
  async function compareCut(page, expected, pixelOf) {
    await page.getByLabel('z \u00D7').selectOption('5');
    await page.keyboard.press('1');
    const canvas = await readCanvas(page);
    let full = 0;
    for (let k = 0; k < expected.count; ++k) {
      const y = Math.floor((canvas.top - (k + 0.5) * kPitch) * canvas.up);
      if (y < 0 || y >= canvas.height) continue;
      for (let x = 0; x < canvas.width; ++x) {
        const wanted = pixelOf(k, canvas.left + x);
        if (wanted) ++full;
        assert.equal(canvas.at(x, y), wanted, `layer ${k}, ${canvas.left + x}`);
      }
    }
    assert.ok(full > 1000);
  }

  test('xz has the labels of the exported pictures', () => onPage('grip.html', async (page) => {
    await page.getByRole('tab', { name: 'Cut xz' }).click();
    await goTo(page, 25);
    const row = pictures.height - 1 - 25;
    await compareCut(page, pictures, (k, i) => (i >= 0 && i < pictures.width ? pictures.at(k, row, i) : 0));
  }));

  test('yz has the labels of the exported pictures', () => onPage('grip.html', async (page) => {
    await page.getByRole('tab', { name: 'Cut yz' }).click();
    await goTo(page, 75);
    await compareCut(page, pictures, (k, j) => (j >= 0 && j < pictures.height ? pictures.at(k, pictures.height - 1 - j, 75) : 0));
  }));

  test('go through the pointer', () => onPage('grip.html', async (page) => {
    await goTo(page, 35);
    await page.mouse.move(...await screenPlace(page, 120.5, 20.5));
    await page.keyboard.press('x');
    await settled(page);
    assert.equal(await page.locator('#number').inputValue(), '120');
    await page.keyboard.press('z');
    await page.mouse.move(...await screenPlace(page, 120.5, 20.5));
    await page.keyboard.press('y');
    assert.equal(await page.locator('#number').inputValue(), '20');
  }));
});

describe('under the pointer', () => {
  test('is the segment of the build, in mm', () => onPage('grip.html', async (page) => {
    const rows = read('segments', place('grip'), '35');
    await goTo(page, 35);
    let checked = 0;
    for (const row of [8, 20, 32, 47]) {
      for (const [begin, end, , solid] of rows[row]) {
        const origin = report.grid.origin[0];
        await page.mouse.move(...await screenPlace(page, ((begin + end) / 2 - origin) / kPitch, row + 0.5));
        const point = await readPoint(page);
        const [, from, to] = /x (\S+) to (\S+) mm/.exec(point.segment);
        assert.ok(Math.abs(number(from) - begin) <= kPitch / 65536 && Math.abs(number(to) - end) <= kPitch / 65536, `${begin} ${end}: ${point.segment}`);
        assert.equal(point.material, report.solids[solid].material);
        assert.equal(point.solid, report.solids[solid].name);
        assert.match(point['x, y, z'], /mm$/);
        ++checked;
      }
    }
    assert.ok(checked >= 10, `${checked} segments`);
  }));

  test('is told of mixtures in per cent', () => onPage('lens.html', async (page) => {
    await page.keyboard.press('Shift+ArrowRight');
    const shares = [...(await readPoint(page)).mixture.matchAll(/([\d.]+) %/g)].map((match) => Number(match[1]));
    assert.ok(shares.length >= 2);
    assert.ok(Math.abs(shares.reduce((a, b) => a + b) - 100) < 0.3, shares.join());
  }));
});

describe('keys and pointer', () => {
  const layer = (page) => page.evaluate(() => window.lamella.places.xy);

  test('all of it works without a pointer', () => onPage('grip.html', async (page) => {
    await page.keyboard.press('Home');
    assert.equal(await layer(page), 0);
    for (const [key, wanted] of [['PageUp', 1], ['Shift+PageUp', 11], ['PageDown', 10], ['End', 70], ['Shift+PageDown', 60]]) {
      await page.keyboard.press(key);
      assert.equal(await layer(page), wanted, key);
    }
    await page.locator('#position').focus();
    await page.keyboard.press('ArrowLeft');
    assert.equal(await layer(page), 59);
    await page.keyboard.press('Home');
    for (let n = 0; n < 35; ++n) await page.keyboard.press('PageUp');
    await page.locator('#plane').focus();
    await page.keyboard.press('Shift+ArrowRight');
    const before = (await readPoint(page)).voxel;
    await page.keyboard.press('Shift+ArrowRight');
    await page.keyboard.press('Shift+ArrowUp');
    const [[i, j], [i2, j2]] = [before, (await readPoint(page)).voxel].map((text) => text.match(/\d+/g).map(Number));
    assert.deepEqual([i2, j2], [i + 1, j + 1]);
    assert.notEqual(await page.locator('#live').textContent(), '');
    await page.keyboard.press('p');
    assert.ok(await page.getByRole('checkbox', { name: 'Pixels' }).isChecked());
    await page.keyboard.press('?');
    assert.ok(await page.getByRole('dialog').isVisible());
    await page.keyboard.press('Escape');
    assert.ok(!await page.getByRole('dialog').isVisible());
    await page.getByRole('tab', { name: 'Layer xy' }).focus();
    await page.keyboard.press('ArrowRight');
    assert.equal(await page.getByRole('tab', { name: 'Cut xz' }).getAttribute('aria-selected'), 'true');
  }));

  test('every control can be reached by Tab', () => onPage('grip.html', async (page) => {
    const wanted = await page.evaluate(() => [...document.querySelectorAll('button, input, select, [tabindex="0"]')]
      .filter((part) => part.checkVisibility() && part.tabIndex >= 0).length);
    const reached = new Set();
    for (let n = 0; n < wanted + 3; ++n) {
      await page.keyboard.press('Tab');
      reached.add(await page.evaluate(() => [...document.querySelectorAll('*')].indexOf(document.activeElement)));
    }
    assert.ok(reached.size >= wanted, `${reached.size} of ${wanted}`);
  }));

  test('the wheel zooms at the pointer, with Shift and over the slider it turns layers', () => onPage('grip.html', async (page) => {
    const at = await screenPlace(page, 100.25, 30.25);
    await page.mouse.move(...at);
    const window = () => page.evaluate(() => ({ ...window.lamella.plane.window }));
    const old = await window();
    await page.mouse.wheel(0, -200);
    await page.waitForFunction((across) => window.lamella.plane.window.across > across, old.across);
    const now = await screenPlace(page, 100.25, 30.25);
    assert.ok(Math.hypot(now[0] - at[0], now[1] - at[1]) < 1.5);
    const start = await layer(page);
    await page.keyboard.down('Shift');
    await page.mouse.wheel(0, -100);
    await page.keyboard.up('Shift');
    await page.waitForFunction((k) => window.lamella.places.xy === k + 1, start);
    await page.locator('#position').hover();
    await page.mouse.wheel(0, 100);
    await page.waitForFunction((k) => window.lamella.places.xy === k, start);
  }));

  test('dragging moves the picture', () => onPage('grip.html', async (page) => {
    const [x, y] = await screenPlace(page, 100, 30);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y - 25);
    await page.mouse.up();
    const now = await screenPlace(page, 100, 30);
    assert.ok(Math.hypot(now[0] - x - 40, now[1] - y + 25) < 1);
  }));
});

describe('charts and report', () => {
  test('areas are those of the segments', () => onPage('grip.html', async (page) => {
    const areas = read('areas', place('grip'));
    const told = await page.evaluate(() => window.lamella.build.layers.area);
    areas.forEach((values, m) => values.forEach((value, k) => assert.ok(Math.abs(told[m][k] - value) <= 1e-6 * value, `${m} ${k}`)));
    await goTo(page, 35);
    const cell = await page.locator('#materials tbody tr').first().locator('td').nth(1).textContent();
    assert.ok(Math.abs(Number(cell) - areas[0][35]) < 1e-4 * areas[0][35]);
  }));

  test('a click in a chart shows the layer there', () => onPage('grip.html', async (page) => {
    const chart = page.getByRole('img', { name: /^area in mm\u00B2 over height z in mm/ });
    const box = await chart.boundingBox();
    await page.mouse.click(box.x + box.width * (52 + 0.25 * (360 - 62)) / 360, box.y + 40);
    await page.waitForFunction(() => window.lamella.places.xy === 17);
  }));

  test('overlaps and gaps of the build are listed and marked', () => onPage('grip.html', async (page) => {
    const items = await page.locator('#report li').allTextContents();
    const count = (word) => items.filter((text) => text.startsWith(word)).length;
    assert.equal(count('overlap'), report.overlaps.length);
    assert.equal(count('filled gap'), report.gaps.length);
    assert.match(items.join('\n'), /1798 mm\u00B3/);
    assert.match(await page.locator('#report').textContent(), /0 rows repaired/);
    const item = page.locator('#report li', { hasText: '1798 mm\u00B3' });
    const pixels = () => page.evaluate(() => {
      const { overlay } = window.lamella.plane;
      const { data } = overlay.getContext('2d').getImageData(0, 0, overlay.width, overlay.height);
      let marked = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i] > 170 && data[i + 1] < 60 && data[i + 2] > 60 && data[i + 2] < 130 && data[i + 3] > 150) ++marked;
      return marked;
    });
    await item.getByRole('button').click();
    await settled(page);
    const marked = await pixels();
    assert.ok(marked > 100, `${marked} pixels`);
    await page.keyboard.press('m');
    await settled(page);
    assert.ok(await pixels() < marked / 10);
  }, { colorScheme: 'light' }));
});

describe('doubts', () => {
  test('are listed, and those that name a layer lead there', async () => {
    const page = readFileSync(place('grip.html'), 'utf8');
    const finding = { severity: 'warning', solid: '/Overmoulded grip/Griffkern', face: '', entity: '#123',
      what: 'rows enter the solid and don\'t leave it: layer 12 (z = -11.287 mm) and 3 more, rows: 5', hint: 'compare these layers' };
    const changed = page.replace(/"within_budget":true,("rays":\d+,"segments":\d+,"repaired_rays":)0/, '"within_budget":false,$17')
      .replace(/"findings":\[.*?\]\}\}<\/script>/, () => `"findings":[${JSON.stringify(finding)}]}}</script>`);
    assert.notEqual(changed, page);
    writeFileSync(place('doubts.html'), changed);
    await onPage('doubts.html', async (shown) => {
      const text = await shown.locator('#report').textContent();
      assert.match(text, /EXCEEDED its error budget/);
      assert.match(text, /7 rows repaired/);
      assert.match(text, /Griffkern, #123: rows enter the solid/);
      assert.equal(await shown.locator('svg .mark.finding').count(), 2);
      await shown.getByRole('button', { name: 'Show layer 12' }).click();
      await settled(shown);
      assert.equal(await shown.locator('#number').inputValue(), '12');
    });
  });

  test('a damaged page says so', async () => {
    const page = readFileSync(place('grip.html'), 'utf8');
    writeFileSync(place('damaged.html'), page.replace(/class="chunk">.{40}/, 'class="chunk">'));
    const { page: shown } = await openPage(browser, 'damaged.html');
    await shown.waitForFunction(() => /can't be read/.test(document.getElementById('busy').textContent));
    await shown.close();
  });
});

describe('voxels', () => {
  test('the cutting plane shows the labels, in their colours', () => onPage('grip.html', async (page) => {
    await page.keyboard.press('v');
    await page.waitForFunction(() => window.lamella.volume.frameTimes.length > 0, null, { timeout: 60000 });
    await page.getByLabel('Cut across').selectOption('z');
    // Where the middles of voxels of the cut lie on the screen; only those that no edge of the box crosses.
    const places = await page.evaluate(() => {
      const { volume } = window.lamella;
      volume.setMarks([], {});
      volume.lines.visible = false;
      for (const label of volume.labels) label.visible = false;
      volume.camera.position.copy(volume.controls.target).add({ x: 0, y: -60, z: 300 });
      volume.controls.update();
      volume.setClip({ axis: 'z', share: 35.5 / volume.data.size[2] });
      volume.render();
      const { width, height } = volume.renderer.domElement;
      const gl = volume.renderer.getContext();
      const found = [];
      for (let j = 3; j < 64; j += 6) {
        for (let i = 5; i < volume.data.size[0]; i += 9) {
          const p = volume.camera.position.clone().set((i + 0.5) * volume.unit[0], (j + 0.5) * volume.unit[1], 35.5 * volume.unit[2]).project(volume.camera);
          const pixel = new Uint8Array(4);
          gl.readPixels(Math.floor((p.x + 1) / 2 * width), Math.floor((p.y + 1) / 2 * height), 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
          found.push([i, j, [...pixel]]);
        }
      }
      return { step: volume.data.step, found };
    });
    assert.deepEqual(places.step, [1, 1, 1]);
    let full = 0;
    for (const [i, j, pixel] of places.found) {
      const wanted = pictures.at(35, pictures.height - 1 - j, i);
      if (wanted === 0) continue;  // deeper voxels, or nothing, show there
      ++full;
      assert.deepEqual(pixel, channels(wanted), `voxel ${i}, ${j}`);
    }
    assert.ok(full > 80, `${full} voxels`);
  }));

  test('keys turn it and move the plane', () => onPage('grip.html', async (page) => {
    await page.keyboard.press('v');
    await page.waitForFunction(() => window.lamella.volume.frameTimes.length > 0, null, { timeout: 60000 });
    const camera = () => page.evaluate(() => window.lamella.volume.camera.position.toArray());
    const old = await camera();
    await page.locator('#volume').focus();
    await page.keyboard.press('ArrowLeft');
    assert.notDeepEqual(await camera(), old);
    await page.keyboard.press('Home');
    assert.match(await page.locator('#where').textContent(), /^y = \S+ mm$/);
    await page.keyboard.press('c');
    assert.match(await page.locator('#where').textContent(), /^z = \S+ mm$/);
  }));
});

describe('for everyone', () => {
  test('every control has a name, and the picture says where it is', () => onPage('grip.html', async (page) => {
    for (const role of ['button', 'checkbox', 'tab', 'slider', 'spinbutton', 'img', 'application']) {
      const parts = await page.getByRole(role).count();
      const named = await page.getByRole(role, { name: /\S/ }).count();
      assert.ok(parts > 0 && named === parts, `${role}: ${named} of ${parts} have names`);
    }
    await goTo(page, 35);
    assert.match(await page.locator('#plane').getAttribute('aria-label'), /^Layer 35, z = \S+ mm/);
    assert.match(await page.locator('#position').getAttribute('aria-valuetext'), /^Layer 35, z = \S+ mm/);
  }));

  test('dark and light follow the system and the button', async () => {
    const ground = (page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await onPage('grip.html', async (page) => {
      assert.equal(await ground(page), 'rgb(20, 24, 29)');
      await page.getByRole('button', { name: 'Dark or light page' }).click();
      assert.equal(await ground(page), 'rgb(255, 255, 255)');
    }, { colorScheme: 'dark' });
    await onPage('grip.html', async (page) => {
      assert.equal(await ground(page), 'rgb(255, 255, 255)');
      await page.keyboard.press('t');
      assert.equal(await ground(page), 'rgb(20, 24, 29)');
    }, { colorScheme: 'light' });
  });

  test('it works without a network', () => onPage('grip.html', async (page) => {
    await page.context().setOffline(true);
    await page.reload();
    await page.waitForFunction(() => window.lamella?.plane.frameTimes.length > 0);
  }));
});
