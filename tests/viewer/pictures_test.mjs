// What the page of `lamella view` draws, pixel by pixel against pictures and segments that others read.

import assert from 'node:assert/strict';
import { describe, test } from 'node:test';
import {
  goTo,
  grip,
  kPitch,
  onPage,
  place,
  prepare,
  read,
  readCanvas,
  readPictures,
  screenPlace,
  settled,
  slice,
  view,
} from './fixture.mjs';

prepare();

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

const channels = (rgba) => [24, 16, 8, 0].map((shift) => (rgba >>> shift) & 255);
const isNear = (a, b, tolerance) =>
  a === b || (tolerance > 0 && channels(a).every((value, c) => Math.abs(value - channels(b)[c]) <= tolerance));

describe('layers', () => {
  test('every pixel has the label of the exported picture', () =>
    onPage('grip.html', async (page) => {
      await page.keyboard.press('1');
      for (const layer of [3, 17, 35, 36, 60]) {
        await goTo(page, layer);
        const { wrong, full } = compare(await readCanvas(page), grip.pictures, layer);
        assert.ok(full > 500, `layer ${layer} shows ${full} pixels`);
        assert.equal(wrong, 0, `layer ${layer}`);
      }
    }));

  test('a picture of another layer is told apart', () =>
    onPage('grip.html', async (page) => {
      await page.keyboard.press('1');
      await goTo(page, 35);
      assert.ok(compare(await readCanvas(page), grip.pictures, 30).wrong > 100);
    }));

  test('graded materials have the blended colours', () =>
    onPage('lens.html', async (page) => {
      await page.keyboard.press('1');
      const layer = await page.evaluate(() => window.lamella.places.xy);
      for (const n of [layer, layer + 5]) {
        await goTo(page, n);
        const { wrong, full } = compare(await readCanvas(page), readPictures('mixed', place('lens'), String(n)), 0, 1);
        assert.ok(full > 300);
        assert.equal(wrong, 0);
      }
    }));

  test('a hidden material leaves its pixels empty and no others', () =>
    onPage('grip.html', async (page) => {
      await page.keyboard.press('1');
      await goTo(page, 35);
      const full = await readCanvas(page);
      await page.getByRole('checkbox', { name: 'TPE Thermolast K' }).uncheck();
      const less = await readCanvas(page);
      const hidden = 0xf59e29ff;
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
    const written = view('grip', 'thin.html', '--layers', '10:40', '--every', '7');
    assert.equal(written.format, 'html');
    assert.equal(written.files.length, 1);
    return onPage('thin.html', async (page) => {
      assert.match(await page.locator('#facts').textContent(), /5 of 71 layers/);
      await page.keyboard.press('1');
      await goTo(page, 31);
      assert.equal(await page.locator('#number').inputValue(), '31');
      assert.equal(compare(await readCanvas(page), grip.pictures, 31).wrong, 0);
    });
  });
});

describe('the head of the page', () => {
  test('says how the assembly was turned', () => {
    const report = slice('connector', 'turned', ['--orient', 'height', '--layer-height', '0.5', '--pitch', '0.2']);
    view('turned', 'turned.html');
    return onPage('turned.html', async (page) => {
      const text = (await page.locator('#facts').textContent()).replaceAll('\u2212', '-');
      const [, degrees, ...axis] = text.match(/turned by ([\d.]+)\u00B0 about \(([-\d.]+), ([-\d.]+), ([-\d.]+)\)/);
      // Rodrigues' formula gives the rotation of the report again.
      const angle = (degrees * Math.PI) / 180;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      const [x, y, z] = axis.map(Number);
      const matrix = [
        [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
        [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
        [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
      ];
      for (let row = 0; row < 3; ++row) {
        for (let column = 0; column < 3; ++column) {
          assert.ok(Math.abs(matrix[row][column] - report.rotation[row][column]) < 2e-3, text);
        }
      }
    });
  });
  test('says nothing of it where nothing was turned', () =>
    onPage('grip.html', async (page) => {
      assert.doesNotMatch(await page.locator('#facts').textContent(), /turned/);
    }));
});

describe('segments', () => {
  test('are those of the build, ends to 1/65536 of a pixel', () =>
    onPage('grip.html', async (page) => {
      for (const layer of [2, 20, 35, 50, 69]) {
        const told = await page.evaluate(async (k) => {
          const { build } = window.lamella;
          const { chunk, row0 } = await build.load(k);
          return Array.from({ length: build.ny }, (_, row) => {
            const [first, last] = [chunk.rowStart[row0 + row], chunk.rowStart[row0 + row + 1]];
            return Array.from({ length: last - first }, (__, n) => {
              const i = first + n;
              return [build.x(chunk.begin[i]), build.x(chunk.end[i]), chunk.material[i], chunk.solid[i]];
            });
          });
        }, layer);
        const rows = read('segments', place('grip'), String(layer));
        assert.equal(told.length, rows.length);
        rows.forEach((row, j) => {
          assert.equal(told[j].length, row.length, `layer ${layer}, row ${j}`);
          row.forEach(([begin, end, material, solid], n) => {
            const [toldBegin, toldEnd, ...ids] = told[j][n];
            assert.ok(Math.abs(toldBegin - begin) < kPitch / 65536 && Math.abs(toldEnd - end) < kPitch / 65536);
            assert.deepEqual(ids, [material, solid]);
          });
        });
      }
    }));
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

  test('xz has the labels of the exported pictures', () =>
    onPage('grip.html', async (page) => {
      await page.getByRole('tab', { name: 'Cut xz' }).click();
      await goTo(page, 25);
      const row = grip.pictures.height - 1 - 25;
      await compareCut(page, grip.pictures, (k, i) =>
        i >= 0 && i < grip.pictures.width ? grip.pictures.at(k, row, i) : 0,
      );
    }));

  test('yz has the labels of the exported pictures', () =>
    onPage('grip.html', async (page) => {
      await page.getByRole('tab', { name: 'Cut yz' }).click();
      await goTo(page, 75);
      await compareCut(page, grip.pictures, (k, j) =>
        j >= 0 && j < grip.pictures.height ? grip.pictures.at(k, grip.pictures.height - 1 - j, 75) : 0,
      );
    }));

  test('go through the pointer', () =>
    onPage('grip.html', async (page) => {
      await goTo(page, 35);
      await page.mouse.move(...(await screenPlace(page, 120.5, 20.5)));
      await page.keyboard.press('x');
      await settled(page);
      assert.equal(await page.locator('#number').inputValue(), '120');
      await page.keyboard.press('z');
      await page.mouse.move(...(await screenPlace(page, 120.5, 20.5)));
      await page.keyboard.press('y');
      assert.equal(await page.locator('#number').inputValue(), '20');
    }));
});

describe('voxels', () => {
  test('the cutting plane shows the labels, in their colours', () =>
    onPage('grip.html', async (page) => {
      await page.keyboard.press('v');
      await page.waitForFunction(() => window.lamella.volume.frameTimes.length > 0, null);
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
            const p = volume.camera.position
              .clone()
              .set((i + 0.5) * volume.unit[0], (j + 0.5) * volume.unit[1], 35.5 * volume.unit[2])
              .project(volume.camera);
            const pixel = new Uint8Array(4);
            gl.readPixels(
              Math.floor(((p.x + 1) / 2) * width),
              Math.floor(((p.y + 1) / 2) * height),
              1,
              1,
              gl.RGBA,
              gl.UNSIGNED_BYTE,
              pixel,
            );
            found.push([i, j, [...pixel]]);
          }
        }
        return { step: volume.data.step, found };
      });
      assert.deepEqual(places.step, [1, 1, 1]);
      let full = 0;
      for (const [i, j, pixel] of places.found) {
        const wanted = grip.pictures.at(35, grip.pictures.height - 1 - j, i);
        if (wanted === 0) continue; // deeper voxels, or nothing, show there
        ++full;
        assert.deepEqual(pixel, channels(wanted), `voxel ${i}, ${j}`);
      }
      assert.ok(full > 80, `${full} voxels`);
    }));

  test('keys turn it and move the plane', () =>
    onPage('grip.html', async (page) => {
      await page.keyboard.press('v');
      await page.waitForFunction(() => window.lamella.volume.frameTimes.length > 0, null);
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
