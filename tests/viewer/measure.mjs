// Times a page in Chromium: node measure.mjs PAGE [REPEATS]. Prints medians in ms; docs/viewer.md has some.

import { statSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const { chromium } = createRequire(join(here, '../../viewer/package.json'))('playwright-core');
const file = resolve(process.argv[2]);
const repeats = Number(process.argv[3] ?? 3);
const args = [
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--ignore-gpu-blocklist',
  '--disable-dev-shm-usage',
];
if (process.getuid?.() === 0) args.push('--no-sandbox');
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

/** From asking for the page to the first layer on the canvas. */
async function open(browser) {
  const page = await browser.newPage({
    viewport: { width: 1280, height: 800 },
  });
  const start = performance.now();
  await page.goto(`file://${file}`, { waitUntil: 'commit' });
  await page.waitForFunction(
    () => window.lamella?.plane.frameTimes.length > 0 && window.lamella.build.peek(window.lamella.places.xy),
    null,
    { polling: 20, timeout: 120000 },
  );
  return { page, time: performance.now() - start };
}

async function steps(page) {
  return page.evaluate(async () => {
    const { plane } = window.lamella;
    const times = { next: [], zoomed: [] };
    const frame = () => new Promise((resume) => requestAnimationFrame(resume));
    for (const [name, act] of [
      ['next', () => {}],
      ['zoomed', () => plane.zoomBy(4)],
    ]) {
      act();
      for (let n = 0; n < 40; ++n) {
        const before = plane.frameTimes.length;
        await window.lamella.go(window.lamella.place + 1);
        while (plane.frameTimes.length === before) await frame();
        times[name].push(plane.frameTimes.at(-1));
      }
    }
    return times;
  });
}

/** From the key to the picture, all layers decoded on the way the first time. */
async function cut(page, key, kind) {
  const start = performance.now();
  await page.keyboard.press(key);
  await page.waitForFunction((wanted) => window.lamella.plane.kind === wanted && !window.lamella.plane.pending, kind, {
    polling: 20,
    timeout: 120000,
  });
  return performance.now() - start;
}

async function voxels(page) {
  const start = performance.now();
  await page.keyboard.press('v');
  await page.waitForFunction(() => window.lamella.volume.frameTimes.length > 0, null, { polling: 20, timeout: 120000 });
  const opened = performance.now() - start;
  await page.evaluate(async () => {
    for (let n = 0; n < 5; ++n) {
      window.lamella.volume.turn(5, 0);
      await new Promise((resume) => {
        setTimeout(resume, 50);
      });
      window.lamella.volume.render();
    }
  });
  return {
    opened,
    frames: await page.evaluate(() => window.lamella.volume.frameTimes.slice(1)),
  };
}

const sums = {};
const add = (name, value) => {
  (sums[name] ??= []).push(value);
};
for (let n = 0; n < repeats; ++n) {
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args,
  });
  const { page, time } = await open(browser);
  add('open', time);
  const { next, zoomed } = await steps(page);
  add('layer frame', median(next));
  add('layer frame, zoomed in', median(zoomed));
  add('first cut xz', await cut(page, 'y', 'xz'));
  add('cut yz', await cut(page, 'x', 'yz'));
  const { opened, frames } = await voxels(page);
  add('voxels opened', opened);
  add('voxel frame', median(frames));
  add('heap MB', await page.evaluate(() => (performance.memory?.usedJSHeapSize ?? 0) / 1e6));
  await browser.close();
}
console.log(`${(statSync(file).size / 1e6).toFixed(1)} MB`);
for (const [name, values] of Object.entries(sums))
  console.log(`${name}: ${median(values).toFixed(1)} (${values.map((v) => v.toFixed(0)).join(', ')})`);
