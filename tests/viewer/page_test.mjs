// The page of `lamella view` in a browser, as its users have it.

import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { describe, test } from 'node:test';
import {
  goTo,
  grip,
  kPitch,
  number,
  onPage,
  openPage,
  place,
  prepare,
  read,
  readPoint,
  screenPlace,
  settled,
} from './fixture.mjs';

prepare();

describe('under the pointer', () => {
  test('is the segment of the build, in mm', () =>
    onPage('grip.html', async (page) => {
      const rows = read('segments', place('grip'), '35');
      await goTo(page, 35);
      let checked = 0;
      for (const row of [8, 20, 32, 47]) {
        for (const [begin, end, , solid] of rows[row]) {
          const origin = grip.report.grid.origin[0];
          await page.mouse.move(...(await screenPlace(page, ((begin + end) / 2 - origin) / kPitch, row + 0.5)));
          const point = await readPoint(page);
          const [, from, to] = /x (\S+) to (\S+) mm/.exec(point.segment);
          assert.ok(
            Math.abs(number(from) - begin) <= kPitch / 65536 && Math.abs(number(to) - end) <= kPitch / 65536,
            `${begin} ${end}: ${point.segment}`,
          );
          assert.equal(point.material, grip.report.solids[solid].material);
          assert.equal(point.solid, grip.report.solids[solid].name);
          assert.match(point['x, y, z'], /mm$/);
          ++checked;
        }
      }
      assert.ok(checked >= 10, `${checked} segments`);
    }));

  test('is told of mixtures in per cent', () =>
    onPage('lens.html', async (page) => {
      await page.keyboard.press('Shift+ArrowRight');
      const shares = [...(await readPoint(page)).mixture.matchAll(/([\d.]+) %/g)].map((match) => Number(match[1]));
      assert.ok(shares.length >= 2);
      assert.ok(Math.abs(shares.reduce((a, b) => a + b) - 100) < 0.3, shares.join());
    }));
});

describe('keys and pointer', () => {
  const layer = (page) => page.evaluate(() => window.lamella.places.xy);

  test('all of it works without a pointer', () =>
    onPage('grip.html', async (page) => {
      await page.keyboard.press('Home');
      assert.equal(await layer(page), 0);
      for (const [key, wanted] of [
        ['PageUp', 1],
        ['Shift+PageUp', 11],
        ['PageDown', 10],
        ['End', 70],
        ['Shift+PageDown', 60],
      ]) {
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
      assert.ok(!(await page.getByRole('dialog').isVisible()));
      await page.getByRole('tab', { name: 'Layer xy' }).focus();
      await page.keyboard.press('ArrowRight');
      assert.equal(await page.getByRole('tab', { name: 'Cut xz' }).getAttribute('aria-selected'), 'true');
    }));

  test('every control can be reached by Tab', () =>
    onPage('grip.html', async (page) => {
      const wanted = await page.evaluate(
        () =>
          [...document.querySelectorAll('button, input, select, [tabindex="0"]')].filter(
            (part) => part.checkVisibility() && part.tabIndex >= 0,
          ).length,
      );
      const reached = new Set();
      for (let n = 0; n < wanted + 3; ++n) {
        await page.keyboard.press('Tab');
        reached.add(await page.evaluate(() => [...document.querySelectorAll('*')].indexOf(document.activeElement)));
      }
      assert.ok(reached.size >= wanted, `${reached.size} of ${wanted}`);
    }));

  test('the wheel zooms at the pointer, with Shift and over the slider it turns layers', () =>
    onPage('grip.html', async (page) => {
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

  test('two fingers zoom and move what lies under them', () =>
    onPage(
      'grip.html',
      async (page) => {
        const [a, b] = [await screenPlace(page, 90, 30), await screenPlace(page, 130, 34)];
        const touch = await page.context().newCDPSession(page);
        const send = (type, ...points) =>
          touch.send('Input.dispatchTouchEvent', { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
        const before = await page.evaluate(() => window.lamella.plane.window.across);
        await send('touchStart', a);
        await send('touchStart', a, b);
        const moved = (k) => [
          [a[0] - 12 * k, a[1] - 3 * k],
          [b[0] + 18 * k, b[1] + 5 * k],
        ];
        for (let k = 1; k <= 5; ++k) await send('touchMove', ...moved(k));
        const [wantedA, wantedB] = moved(5);
        const spread = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);
        // On a busy machine the last move comes to the page later than the answer that it was sent.
        await page.waitForFunction(
          (wanted) => Math.abs(window.lamella.plane.window.across / wanted - 1) < 1e-3,
          (before * spread(wantedA, wantedB)) / spread(a, b),
        );
        await settled(page);
        const scale = await page.evaluate(() => window.lamella.plane.window.across);
        // Scale and place have three numbers for two fingers' four: they turned by less than a degree.
        const middle = (p, q) => [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
        assert.ok(spread(await screenPlace(page, 110, 32), middle(wantedA, wantedB)) < 3);
        await send('touchEnd', wantedA);
        await send('touchMove', [wantedA[0] + 20, wantedA[1]]);
        await settled(page);
        assert.equal(await page.evaluate(() => window.lamella.plane.window.across), scale);
        await send('touchEnd');
        await page.waitForFunction(() => window.lamella.plane.pointers.size === 0);
      },
      { hasTouch: true },
    ));

  test('dragging moves the picture', () =>
    onPage('grip.html', async (page) => {
      const [x, y] = await screenPlace(page, 100, 30);
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x + 40, y - 25);
      await page.mouse.up();
      const now = await screenPlace(page, 100, 30);
      assert.ok(Math.hypot(now[0] - x - 40, now[1] - y + 25) < 1);
    }));
});

describe('rows as lines', () => {
  const zoomTo = (page, scale) =>
    page.evaluate((wanted) => {
      const { plane } = window.lamella;
      plane.fit();
      plane.zoomBy(wanted / plane.window.across);
    }, scale);
  const drawn = async (page) => {
    await settled(page);
    return page.evaluate(() => window.lamella.plane.rowsDrawn);
  };

  test('raster rows are drawn once they can be told apart', () =>
    onPage('grip.html', async (page) => {
      await goTo(page, 35);
      assert.equal(await page.locator('#rows option').count(), 2); // the page holds no hatch
      await page.locator('#rows').selectOption('raster');
      await zoomTo(page, 3);
      assert.equal(await drawn(page), 0);
      await zoomTo(page, 4.01);
      const all = await drawn(page);
      const { width, left } = await page.evaluate(() => {
        const { plane } = window.lamella;
        return { width: plane.overlay.width / plane.window.across, left: plane.window.left };
      });
      const origin = grip.report.grid.origin[0];
      const seen = read('segments', place('grip'), '35')
        .flat()
        .filter(([begin, end]) => (end - origin) / kPitch > left && (begin - origin) / kPitch < left + width);
      assert.ok(Math.abs(all - seen.length) <= 2 && all > 100, `${all} of ${seen.length}`);
      await page.locator('#plane').focus();
      await page.keyboard.press('r');
      assert.equal(await page.locator('#rows').inputValue(), 'none');
      assert.equal(await drawn(page), 0);
    }));

  test('hatch rows lie where those of the build do', () =>
    onPage('hatched.html', async (page) => {
      let compared = 0;
      for (const layer of [3, 17, 30]) {
        await goTo(page, layer);
        const wanted = read('hatch', place('hatched'), `${layer}`);
        const told = await page.evaluate((k) => {
          const { build } = window.lamella;
          const { rows, row0, count, along, offset, place } = build.peekHatch(k);
          const at = (s, row) => [s * along[0] - offset(row) * along[1], s * along[1] + offset(row) * along[0]];
          const lines = [];
          for (let row = 0; row < count; ++row)
            for (let i = rows.rowStart[row0 + row]; i < rows.rowStart[row0 + row + 1]; ++i)
              lines.push([...at(place(rows.begin[i]), row), ...at(place(rows.end[i]), row), rows.material[i]]);
          return lines;
        }, layer);
        assert.equal(told.length, wanted.length);
        told.forEach((line, n) =>
          line.forEach((value, i) => assert.ok(Math.abs(value - wanted[n][i]) < 1e-5, `${layer} ${n} ${i}`)),
        );
        compared += told.length;
      }
      assert.ok(compared > 100, `${compared}`);
      await goTo(page, 17);
      await page.locator('#rows').selectOption('hatch');
      await zoomTo(page, 4);
      assert.equal(await drawn(page), read('hatch', place('hatched'), '17').length); // all of it is in sight
    }));
});

describe('charts and report', () => {
  test('areas are those of the segments', () =>
    onPage('grip.html', async (page) => {
      const areas = read('areas', place('grip'));
      const told = await page.evaluate(() => window.lamella.build.layers.area);
      areas.forEach((values, m) =>
        values.forEach((value, k) => assert.ok(Math.abs(told[m][k] - value) <= 1e-6 * value, `${m} ${k}`)),
      );
      await goTo(page, 35);
      const cell = await page.locator('#materials tbody tr').first().locator('td').nth(1).textContent();
      assert.ok(Math.abs(Number(cell) - areas[0][35]) < 1e-4 * areas[0][35]);
    }));

  test('a click in a chart shows the layer there', () =>
    onPage('grip.html', async (page) => {
      const chart = page.getByRole('img', {
        name: /^area in mm\u00B2 over height z in mm/,
      });
      const box = await chart.boundingBox();
      await page.mouse.click(box.x + (box.width * (52 + 0.25 * (360 - 62))) / 360, box.y + 40);
      await page.waitForFunction(() => window.lamella.places.xy === 17);
    }));

  test('overlaps and gaps of the build are listed and marked', () =>
    onPage(
      'grip.html',
      async (page) => {
        const items = await page.locator('#report li').allTextContents();
        const count = (word) => items.filter((text) => text.startsWith(word)).length;
        assert.equal(count('overlap'), grip.report.overlaps.length);
        assert.equal(count('filled gap'), grip.report.gaps.length);
        assert.match(items.join('\n'), /1798 mm\u00B3/);
        assert.match(await page.locator('#report').textContent(), /0 rows repaired/);
        const item = page.locator('#report li', { hasText: '1798 mm\u00B3' });
        const pixels = () =>
          page.evaluate(() => {
            const { overlay } = window.lamella.plane;
            const { data } = overlay.getContext('2d').getImageData(0, 0, overlay.width, overlay.height);
            let marked = 0;
            for (let i = 0; i < data.length; i += 4)
              if (data[i] > 170 && data[i + 1] < 60 && data[i + 2] > 60 && data[i + 2] < 130 && data[i + 3] > 150)
                ++marked;
            return marked;
          });
        await item.getByRole('button').click();
        await settled(page);
        const marked = await pixels();
        assert.ok(marked > 100, `${marked} pixels`);
        await page.keyboard.press('m');
        await settled(page);
        assert.ok((await pixels()) < marked / 10);
      },
      { colorScheme: 'light' },
    ));
});

describe('marks', () => {
  test('lie where the solids of an overlap meet', () =>
    onPage('grip.html', async (page) => {
      await goTo(page, 35);
      const found = await page.evaluate(() => {
        const { plane } = window.lamella;
        return [...plane.meetings].map(([mark, { ends, sides }]) => ({
          solids: mark.solids,
          box: mark.box,
          ends,
          sides,
        }));
      });
      const rows = read('segments', place('grip'), '35');
      const [x0, y0] = grip.report.grid.origin;
      const codes = 2 ** (await page.evaluate(() => window.lamella.build.grid.bits));
      let checked = 0;
      for (const { solids, box, ends, sides } of found) {
        const isPair = (a, b) => solids.includes(a) && solids.includes(b) && a !== b;
        const wanted = rows.flatMap((row, j) =>
          row.slice(1).flatMap((segment, i) => (isPair(row[i][3], segment[3]) ? [[segment[0], j]] : [])),
        );
        assert.equal(ends.length, wanted.length);
        ends.forEach(([code, low], n) => {
          const x = x0 + (code / codes + 0.5) * kPitch;
          assert.ok(Math.abs(x - wanted[n][0]) < 1e-4 && low === wanted[n][1], `${x} ${wanted[n]}`);
          // The box of the bounds holds what the mark says more precisely.
          assert.ok(x >= box.low[0] - 1e-4 && x <= box.high[0] + 1e-4);
          const y = y0 + (low + 0.5) * kPitch;
          assert.ok(y >= box.low[1] - kPitch && y <= box.high[1] + kPitch);
        });
        for (const [row, from, to] of sides) {
          const middle = x0 + ((from + to) / 2 / codes + 0.5) * kPitch;
          const at = (j) => rows[j].find(([begin, end]) => begin <= middle && middle < end);
          assert.ok(isPair(at(row - 1)[3], at(row)[3]), `${row} ${middle}`);
        }
        checked += ends.length + sides.length;
      }
      assert.ok(checked > 50, `${checked}`);
    }));
});

describe('doubts', () => {
  test('are listed, and those that name a layer lead there', async () => {
    const page = readFileSync(place('grip.html'), 'utf8');
    const finding = {
      severity: 'warning',
      solid: '/Overmoulded grip/Griffkern',
      face: '',
      entity: '#123',
      what: "rows enter the solid and don't leave it: layer 12 (z = -11.287 mm) and 3 more, rows: 5",
      hint: 'compare these layers',
    };
    const changed = page
      .replace(/"within_budget":true,("rays":\d+,"segments":\d+,"repaired_rays":)0/, '"within_budget":false,$17')
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
    const { page: shown } = await openPage('damaged.html');
    await shown.waitForFunction(() => /can't be read/.test(document.getElementById('busy').textContent));
    await shown.close();
  });
});

describe('hostile names', () => {
  /** The grip's page with every name in quotes that is a key of `names` replaced. */
  const renamed = (file, names) => {
    let page = readFileSync(place('grip.html'), 'utf8');
    for (const [name, other] of Object.entries(names)) {
      assert.ok(page.includes(JSON.stringify(name)), name);
      page = page.replaceAll(JSON.stringify(name), () => JSON.stringify(other));
    }
    writeFileSync(place(file), page);
    return file;
  };

  test('a long material leaves the columns in the panel', () =>
    onPage(renamed('long.html', { 'TPE Thermolast K': 'M'.repeat(600) }), async (page) => {
      const { right, cells } = await page.evaluate(() => {
        const edge = (node) => node.getBoundingClientRect().right;
        return {
          right: edge(document.querySelector('aside')),
          cells: [...document.querySelectorAll('#materials td')].map(edge),
        };
      });
      assert.ok(cells.length >= 18, `${cells.length} cells`);
      for (const cell of cells) assert.ok(cell <= right, `${cell} beyond ${right}`);
    }));

  test("a name's direction ends with the name", () => {
    const { name } = grip.report.solids[grip.report.overlaps[0].solids[0]];
    return onPage(renamed('turned_names.html', { [name]: `a\u2069\u202E${name}` }), async (page) => {
      // The word behind the name, as it is seen: where its first and its last letter are.
      const words = await page.evaluate(() =>
        [...document.querySelectorAll('#report li')].flatMap((item) => {
          const walker = document.createTreeWalker(item, NodeFilter.SHOW_TEXT);
          for (let text = walker.nextNode(); text; text = walker.nextNode()) {
            const at = text.data.lastIndexOf(' layers') + 1;
            if (at === 0) continue;
            const left = (i) => {
              const range = new Range();
              range.setStart(text, at + i);
              range.setEnd(text, at + i + 1);
              return range.getBoundingClientRect().left;
            };
            return [[left(0), left(5)]];
          }
          return [];
        }),
      );
      assert.ok(words.length >= 1);
      for (const [first, last] of words) assert.ok(first < last, `${first} ${last}`);
      const labels = await page.locator('#report button').evaluateAll((all) => all.map((one) => one.ariaLabel));
      const turned = labels.filter((label) => label.includes(name));
      assert.ok(turned.length >= 1 && turned.every((label) => !label.includes('\u202E')), labels.join());
    });
  });
});

describe('for everyone', () => {
  test('every control has a name, and the picture says where it is', () =>
    onPage('grip.html', async (page) => {
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
    await onPage(
      'grip.html',
      async (page) => {
        assert.equal(await ground(page), 'rgb(20, 24, 29)');
        await page.getByRole('button', { name: 'Dark or light page' }).click();
        assert.equal(await ground(page), 'rgb(255, 255, 255)');
      },
      { colorScheme: 'dark' },
    );
    await onPage(
      'grip.html',
      async (page) => {
        assert.equal(await ground(page), 'rgb(255, 255, 255)');
        await page.keyboard.press('t');
        assert.equal(await ground(page), 'rgb(20, 24, 29)');
      },
      { colorScheme: 'light' },
    );
  });

  test('it works without a network', () =>
    onPage('grip.html', async (page) => {
      await page.context().setOffline(true);
      await page.reload();
      await page.waitForFunction(() => window.lamella?.plane.frameTimes.length > 0);
    }));
});
