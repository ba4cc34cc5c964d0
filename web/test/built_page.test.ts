// SPDX-License-Identifier: BSD-3-Clause
// The files of the page as they are built: their size, and that they name no other computer.
import assert from 'node:assert/strict';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {test} from 'node:test';
import {gzipSync} from 'node:zlib';
import {PAGE} from './flights.ts';

test('is small', async () => {
  const files = await Promise.all(['index.html', 'page.js', 'page.css'].map((name) => readFile(join(PAGE, name))));
  const size_kB = files.reduce((sum, file) => sum + gzipSync(file, {level: 9}).length, 0) / 1000;
  console.log(`web.bundle_kB ${size_kB.toFixed(1)}`);
  assert.ok(size_kB <= 300, `${size_kB} kB`);
});

test('has no address of another computer in it', async () => {
  for (const name of ['index.html', 'page.js', 'page.css', 'report_page.html']) {
    const text = await readFile(join(PAGE, name), 'utf8');
    // HTML has href="...", JSX as esbuild writes it {href:"..."}.
    assert.deepEqual(text.match(/(?:src|href)["']?\s*[=:]\s*["'`]?(?:https?:)?\/\/[^\s"'`>]+/g), null, name);
  }
  const lock = await readFile(new URL('../package-lock.json', import.meta.url), 'utf8');
  assert.ok(!lock.includes('"resolved"'));
});
