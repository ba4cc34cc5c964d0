// SPDX-License-Identifier: BSD-3-Clause
// Measures the page in a headless browser. Usage: node bench/figures.ts VIEW SHORT LONG, which are the program rosflight_view, the
// folder of a short flight and that of one whose log has about 100 MB. Prints one JSON object. tools/bench_web.py makes the flights.
import {spawn, type ChildProcess} from 'node:child_process';
import {stat} from 'node:fs/promises';
import {join} from 'node:path';
import type {Browser, Page} from 'playwright-core';
import {newPage, SMALL, startBrowser} from '../test/browser.ts';

const REPEATS = 10;
const [program = '', short = '', long = ''] = process.argv.slice(2);
const started: ChildProcess[] = [];

async function view(folder: string): Promise<string> {
  const child = spawn(program, ['view', folder], {stdio: ['ignore', 'pipe', 'inherit']});
  started.push(child);
  for await (const line of child.stdout) return String(line).split(' ')[0]!;
  throw new Error('./rosflight view printed nothing');
}

const median = (values: number[]) => values.sort((a, b) => a - b)[values.length >> 1]!;

/** From navigation to the first frame with the vehicle in it [s]: the second one, as the scene draws an empty one when it is made. */
async function firstPicture(browser: Browser, url: string): Promise<number> {
  const {page} = await newPage(browser, SMALL);
  await page.goto(url);
  const ms = await page.evaluate(() => new Promise<number>((resolve) => {
    const look = () => {
      const drawn = Number(document.querySelector('canvas')?.dataset['frames'] ?? 0) > 1;
      if (drawn && window.rosflightScene?.vehicleInPicture()) resolve(performance.now());
      else requestAnimationFrame(look);
    };
    look();
  }));
  await page.context().close();
  return ms / 1000;
}

/** From a move of the time slider until the page has drawn it [ms]: script and draw calls, without the frame period. */
async function seek(page: Page): Promise<number> {
  return page.evaluate(async () => {
    const slider = document.querySelector<HTMLInputElement>('.track input')!;
    const frames = () => Number(document.querySelector('canvas')!.dataset['frames']);
    const took: number[] = [];
    for (let k = 0; k < 40; ++k) {
      await new Promise((resolve) => requestAnimationFrame(resolve));
      const before = frames();
      const start = performance.now();
      slider.value = String(Number(slider.max) * ((k * 0.37 + 0.05) % 1));
      slider.dispatchEvent(new Event('input', {bubbles: true}));
      while (frames() === before) await new Promise((resolve) => requestAnimationFrame(resolve));
      took.push(performance.now() - start);
    }
    return took.sort((a, b) => a - b)[took.length >> 1]!;
  });
}

const browser = await startBrowser();
try {
  const shortUrl = await view(short);
  const pictures: number[] = [];
  for (let k = 0; k < REPEATS; ++k) pictures.push(await firstPicture(browser, shortUrl));
  const {page} = await newPage(browser, SMALL);
  await page.goto(await view(long));
  const opened_s = await page.waitForFunction(() => document.querySelector('main.flight') ? performance.now() / 1000 : false, undefined,
    {timeout: 0, polling: 'raf'}).then((handle) => handle.jsonValue() as Promise<number>);
  const {size} = await stat(join(long, 'flight.mcap'));
  console.log(JSON.stringify({first_picture_s: median(pictures), open_100MB_s: opened_s * 1e8 / size, seek_ms: await seek(page)}));
} finally {
  await browser.close();
  for (const child of started) child.kill('SIGTERM');
}
