// Bundles src/ into dist/viewer.html, one file that loads nothing: node build.mjs [OUTPUT].
import { readFile, mkdir, writeFile } from 'node:fs/promises';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const output = process.argv[2] ?? join(here, 'dist', 'viewer.html');

async function bundle(entry) {
  const result = await build({
    absWorkingDir: here,
    entryPoints: [entry],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: ['es2022', 'chrome110', 'firefox113', 'safari16.4'],
    charset: 'ascii',
    legalComments: 'eof',
  });
  return result.outputFiles[0].text.trim();
}

const [page, style, script] = await Promise.all([
  readFile(join(here, 'src/page.html'), 'utf8'),
  bundle('src/style.css'),
  bundle('src/main.js'),
]);
const whole = page
  .replace('/*style*/', () => style)
  .replace('/*script*/', () => script.replaceAll('</script', '<\\/script'));
await mkdir(dirname(output), { recursive: true });
await writeFile(output, whole);
