// SPDX-License-Identifier: BSD-3-Clause
// Usage: node web/build.mjs OUT. Makes the page: OUT/index.html with page.js and page.css beside it for the server, and
// OUT/report_page.html with all of it inside, in which a flight's data take the place of the line <!-- flight -->.
import {build} from 'esbuild';
import {mkdir, readFile, writeFile} from 'node:fs/promises';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {gzipSync} from 'node:zlib';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2];
if (!out) {
  console.error('usage: node web/build.mjs OUT');
  process.exit(2);
}

const {outputFiles} = await build({
  entryPoints: {page: join(here, 'src/main.tsx')}, bundle: true, minify: true, write: false, outdir: out,
  loader: {'.csv': 'text', '.md': 'text', '.txt': 'text'}, format: 'iife', target: 'es2022', jsx: 'automatic', jsxImportSource: 'preact', charset: 'utf8', legalComments: 'eof',
  logLevel: 'warning',
});
// In a report the script is packed: it would be half of a short flight's file.
const START = `(async () => {
  const bytes = Uint8Array.from(atob(document.getElementById('page-script').textContent), (one) => one.charCodeAt(0));
  const script = document.createElement('script');
  script.textContent = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).text();
  document.head.append(script);
})();`;
const text = (end) => outputFiles.find(({path}) => path.endsWith(end)).text;
const page = await readFile(join(here, 'src/page.html'), 'utf8');
const put = (style, script) => page.replace('<!-- style -->', () => style).replace('<!-- script -->', () => script);
await mkdir(out, {recursive: true});
await Promise.all([
  writeFile(join(out, 'page.js'), text('.js')),
  writeFile(join(out, 'page.css'), text('.css')),
  writeFile(join(out, 'index.html'), put('<link rel="stylesheet" href="page.css">', '<script src="page.js"></script>')
    .replace('<!-- flight -->\n', '')),
  writeFile(join(out, 'report_page.html'), put(`<style>${text('.css')}</style>`,
    `<script type="application/gzip" id="page-script">${gzipSync(text('.js'), {level: 9}).toString('base64')}</script>\n<script>${START}</script>`)),
]);
