// Builds, pages and a browser for the tests; what pages are compared with comes from read_build.py.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, before } from 'node:test';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
export const source = join(here, '../..');
const { chromium } = createRequire(join(source, 'viewer/package.json'))('playwright-core');
const lamella = process.env.LAMELLA;
const folder = mkdtempSync(join(tmpdir(), 'lamella-viewer-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

/** Runs lamella; exit code 3 repeats doubts of the slicing and is as good as 0 here. */
export function run(...args) {
  try {
    return execFileSync(lamella, [...args, '--quiet'], {
      encoding: 'utf8',
      stdio: ['ignore', 'pipe', 'pipe'],
    });
  } catch (error) {
    if (error.status === 3) return error.stdout;
    throw new Error(`lamella ${args.join(' ')}: ${error.status}\n${error.stderr}`);
  }
}

export const place = (name) => join(folder, name);

/** Slices a data set; the JSON report. */
export function slice(name, build, options, materials = 'materials.xml') {
  const set = join(source, 'datasets', name);
  return JSON.parse(
    run(
      'slice',
      join(set, `${name}.step`),
      '-o',
      place(build),
      '--materials',
      join(set, materials),
      '--json',
      ...options,
    ),
  );
}

export function view(build, page, ...options) {
  return JSON.parse(run('view', place(build), '-o', place(page), '--json', ...options));
}

export function read(...args) {
  const text = execFileSync('/usr/bin/python3', [join(here, 'read_build.py'), ...args], {
    encoding: 'utf8',
    maxBuffer: 1 << 28,
  });
  return JSON.parse(text);
}

/** Pictures as {count, height, width, at(n, row, column)}: RGBA as one number, 0 where nothing is, row 0 at the top. */
export function readPictures(kind, ...args) {
  const [count, height, width] = read(kind, ...args, place('pixels.bin'));
  const bytes = readFileSync(place('pixels.bin'));
  const at = (n, row, column) => {
    const i = 4 * ((n * height + row) * width + column);
    return bytes[i + 3] === 0 ? 0 : bytes.readUInt32BE(i);
  };
  return { count, height, width, at };
}

const kPatience = 180000; // ms

/** SwiftShader draws in software, the same on every machine. */
async function startBrowser() {
  const args = [
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
    '--ignore-gpu-blocklist',
    '--disable-dev-shm-usage',
  ];
  if (process.getuid?.() === 0) args.push('--no-sandbox');
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args,
  });
}

/** Opens a page; errors of its scripts and requests for anything but itself fail the test that asks `faults`. */
export async function openPage(file, options = {}) {
  const page = await browser.newPage({
    viewport: { width: 1280, height: 900 },
    ...options,
  });
  // Pictures are drawn in software, maybe on a machine that has much else to do.
  page.setDefaultTimeout(kPatience);
  const faults = [];
  page.on('pageerror', (error) => faults.push(error.message));
  page.on('console', (message) => {
    if (message.type() === 'error') faults.push(message.text());
  });
  page.on('request', (request) => {
    if (!/^(file|blob|data):/.test(request.url())) faults.push(`asks for ${request.url()}`);
  });
  await page.goto(`file://${place(file)}`);
  await page.waitForFunction(() => window.lamella?.plane.frameTimes.length > 0);
  return { page, faults };
}

/** Runs `act` on a fresh page and fails on its errors. */
export async function onPage(file, act, options) {
  const { page, faults } = await openPage(file, options);
  try {
    await act(page);
    assert.deepEqual(faults, []);
  } finally {
    await page.close();
  }
}

export const kPitch = 0.5; // mm, of the grip along every axis
/** The slicing's report and the exported pictures of the grip, once the tests run. */
export const grip = {};
let browser;

/** Pages of the grip and of the graded lens, and a browser to open them in, before any test. */
export function prepare() {
  const timeout = 300000;
  before(
    async () => {
      grip.report = slice('overmoulded_grip', 'grip', ['--pitch', `${kPitch}`, '--layer-height', `${kPitch}`]);
      view('grip', 'grip.html');
      run('export', place('grip'), '--to', 'png-indexed', '-o', place('grip-png'));
      grip.pictures = readPictures('pictures', place('grip-png'));
      slice('interpenetrating_bodies', 'hatched', [
        '--pitch',
        '0.5',
        '--layer-height',
        '0.5',
        '--hatch-spacing',
        '1.1',
        '--hatch-angle',
        '20',
        '--rotate-per-layer',
        '67',
      ]);
      view('hatched', 'hatched.html', '--hatches');
      slice('gradient_lens', 'lens', ['--pitch', '0.5', '--layer-height', '1'], 'graded.xml');
      view('lens', 'lens.html');
      browser = await startBrowser();
    },
    { timeout },
  );
  after(() => browser?.close());
}

/** Waits until what was asked for is on the canvas. */
export async function settled(page) {
  await page.waitForFunction(() => {
    const { plane, view, place } = window.lamella;
    return view === '3d' || (plane.kind === view && plane.place === place && !plane.stale && !plane.pending);
  });
}

/** The canvas of a cut as RGBA numbers like readPictures(), with the place of its corner on the plane. */
export async function readCanvas(page) {
  await settled(page);
  const {
    width,
    height,
    base64,
    window: where,
    up,
  } = await page.evaluate(() => {
    const canvas = document.getElementById('picture');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let text = '';
    for (let i = 0; i < data.length; i += 32768) text += String.fromCharCode(...data.subarray(i, i + 32768));
    const { plane } = window.lamella;
    return {
      width: canvas.width,
      height: canvas.height,
      base64: btoa(text),
      window: plane.window,
      up: plane.up,
    };
  });
  const bytes = Buffer.from(base64, 'base64');
  const at = (x, y) => {
    const i = 4 * (y * width + x);
    return bytes[i + 3] === 0 ? 0 : bytes.readUInt32BE(i);
  };
  return {
    width,
    height,
    at,
    left: where.left,
    top: where.top,
    across: where.across,
    up,
  };
}

/** Types a layer's number as a person does. */
export async function goTo(page, number) {
  await page.getByRole('spinbutton').fill(String(number));
  await page.keyboard.press('Enter');
  await page.locator('#plane').focus();
  await settled(page);
}

/** What the panel says under the pointer, as {term: text}. */
export const readPoint = (page) =>
  page.evaluate(() =>
    Object.fromEntries(
      [...document.querySelectorAll('#point dt')].map((term) => [
        term.textContent,
        term.nextElementSibling.textContent,
      ]),
    ),
  );

/** Screen places of a place on the plane in units of its axes. */
export async function screenPlace(page, h, v) {
  return page.evaluate(
    ([across, up]) => {
      const { plane } = window.lamella;
      const box = plane.root.getBoundingClientRect();
      return [
        box.left + ((across - plane.window.left) * plane.window.across) / plane.density,
        box.top + ((plane.window.top - up) * plane.up) / plane.density,
      ];
    },
    [h, v],
  );
}

/** A number as the page writes it. */
export const number = (text) => Number(text.replace('\u2212', '-'));
