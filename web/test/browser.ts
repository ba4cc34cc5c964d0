// SPDX-License-Identifier: BSD-3-Clause
// A headless browser with WebGL: the Chromium that the package @sparticuz/chromium has inside, Debian's where that does not start, or the
// one that the variable ROSFLIGHT_CHROMIUM names.
import chromium from '@sparticuz/chromium';
import assert from 'node:assert/strict';
import {createReadStream, existsSync} from 'node:fs';
import {readFile, stat} from 'node:fs/promises';
import {createServer, type Server} from 'node:http';
import type {AddressInfo} from 'node:net';
import {createRequire} from 'node:module';
import {extname, join} from 'node:path';
import {chromium as playwright, type Browser, type Page} from 'playwright-core';

const AXE = await readFile(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const FLAGS = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'];

/** What takes a minute of real time, or does not hold beside other stages on two cores: ./rosflight test web-rest. */
export const LONG = process.env['ROSFLIGHT_WEB_LONG'] !== undefined;

/** Debian's, for machines where that of the package does not start: its processor is x86-64. */
export const SYSTEM_CHROMIUM = '/usr/bin/chromium';

export async function startBrowser(flags: string[] = [], packaged = () => chromium.executablePath()): Promise<Browser> {
  const launch = (executablePath: string) => playwright.launch({executablePath, args: [...FLAGS, ...flags]});
  const chosen = process.env['ROSFLIGHT_CHROMIUM'];
  if (chosen) return launch(chosen);
  try {
    return await launch(await packaged());
  } catch (error) {
    if (!existsSync(SYSTEM_CHROMIUM)) throw error;
    return launch(SYSTEM_CHROMIUM);
  }
}

export const DESKTOP = {width: 1280, height: 800};
/** For pictures that must keep up: WebGL in software takes 80 ms of a processor for each of this size. */
export const SMALL = {width: 900, height: 420};
export const PHONE = {width: 390, height: 844};

/** A page that fails the test on errors of its scripts and on requests to anybody but this computer. */
export async function newPage(browser: Browser, viewport = DESKTOP, more: {colorScheme?: 'dark' | 'light'; hasTouch?: boolean} = {}) {
  const context = await browser.newContext({viewport, locale: 'en-US', colorScheme: 'light', ...more});
  const page = await context.newPage();
  page.setDefaultTimeout(120_000); // the machine may be busy
  const complaints: string[] = [];
  page.on('pageerror', (error) => complaints.push(`error in the page: ${error.stack}`));
  page.on('console', (message) => {
    const icon = message.location().url.endsWith('/favicon.ico'); // Debian's Chromium asks for one, and the page has none
    if (message.type() === 'error' && !icon) complaints.push(`console: ${message.text()}`);
  });
  page.on('request', (request) => {
    const {protocol, hostname} = new URL(request.url());
    const here = ['file:', 'data:', 'blob:'].includes(protocol) || hostname.startsWith('127.0.0.');
    if (!here) complaints.push(`request to another computer: ${request.url()}`);
  });
  return {page, complaints};
}

/** Waits until the page has read its flight and drawn it; as long as reading goes on, however slow the machine. */
export async function flightShown(page: Page) {
  const share = () => page.evaluate(() => document.querySelector('progress')?.value ?? -1);
  for (let before = NaN;;) {
    if (await page.waitForSelector('main.flight', {timeout: 30_000}).catch(() => undefined)) break;
    const now = await share();
    if (now === before) throw new Error(`reading the flight stands still at a share of ${now}`);
    before = now;
  }
  await page.waitForFunction(() => Number(document.querySelector('canvas')?.dataset['frames'] ?? 0) > 0);
}

/** The picture is as high as a line of text from now on: for what looks at tables alone, as WebGL in software takes half a processor. */
export const drawnForNobody = (page: Page) => page.locator('.space').evaluate((space) => Object.assign(space.style, {height: '16px', minHeight: '0'}));

/** Keeps a picture for people to look at, and its dark twin, in the folder that ROSFLIGHT_WEB_PICTURES names; in another size than the test's
 * if given. `ready` is done before each: what a new size or scheme of colours ends is begun again. */
export async function keepPicture(page: Page, name: string, size?: typeof DESKTOP, ready = async () => {}) {
  const folder = process.env['ROSFLIGHT_WEB_PICTURES'];
  if (!folder) return;
  const before = page.viewportSize()!;
  if (size) await page.setViewportSize(size);
  await page.locator('.space').evaluateAll((spaces) => spaces.forEach((space) => space.removeAttribute('style')));
  const keep = async (file: string) => {
    await ready();
    await drawn(page);
    await page.screenshot({path: join(folder, file)});
  };
  await keep(`${name}.png`);
  if (await page.evaluate(() => matchMedia('(prefers-color-scheme: light)').matches)) {
    await page.emulateMedia({colorScheme: 'dark'});
    await keep(`${name}-dark.png`);
    await page.emulateMedia({colorScheme: 'light'});
  }
  if (size) await page.setViewportSize(before);
}

/** Until the picture has been drawn again `frames` times, or rests: frames count, not time. */
export async function drawn(page: Page) {
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

export async function goTo(page: Page, t: number) {
  await page.getByLabel('Time in the flight').fill(String(t));
  await drawn(page);
}

export const clock = async (page: Page) => parseFloat(await page.locator('.clock').innerText());

export interface Seen {
  /** How many pixels the vehicle changes, as a share of a disc of its radius. */
  share: number;
  /** From where it must be to the middle of these pixels, in metres at its distance. */
  off_m: number;
}

/** What changes in the picture when the vehicle is taken out of it: shadow, path and uncertainty are in both pictures. The page draws nothing in
 * between, so a flight may go on. */
export const vehicleSeen = (page: Page): Promise<Seen | undefined> => page.evaluate(() => {
  const scene = window.rosflightScene!;
  const vehicle = scene.object('vehicle')!;
  const place = scene.vehicleInPicture();
  if (!place) return undefined;
  const canvas = document.querySelector('canvas')!;
  const gl = canvas.getContext('webgl2')!;
  const {width, height} = canvas;
  const pixels = (visible: boolean) => {
    vehicle.visible = visible;
    scene['draw']();
    const all = new Uint8Array(4 * width * height); // rows from the bottom
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, all);
    return all;
  };
  const [without, there] = [pixels(false), pixels(true)];
  const [words, others] = [without, there].map(({buffer}) => new Uint32Array(buffer)) as [Uint32Array, Uint32Array];
  const sum = {pixels: 0, x: 0, y: 0};
  for (let at = 0; at < width * height; ++at) {
    if (words[at] === others[at] || [0, 1, 2].every((k) => Math.abs(there[4 * at + k]! - without[4 * at + k]!) < 16)) continue;
    ++sum.pixels;
    sum.x += at % width + 0.5;
    sum.y += height - Math.floor(at / width) - 0.5;
  }
  const camera = scene['camera'];
  const metre = Math.hypot(...[...vehicle.position.clone().set(0, 1, 0).applyQuaternion(camera.quaternion).add(vehicle.position).project(camera)
    .sub(vehicle.position.clone().project(camera))].slice(0, 2).map((shift, k) => shift / 2 * [width, height][k]!));
  return {share: sum.pixels / (Math.PI * (metre * scene['model']!.radius) ** 2),
    off_m: Math.hypot(sum.x / sum.pixels - place.x * width, sum.y / sum.pixels - place.y * height) / metre};
});

/** A vehicle that is drawn where the camera says it is changes more and is off by less: 0.13 m at most was seen, 0.05 from the side. */
const SHARE = 0.03;
const OFF_M = 0.3;

export async function vehicleIsSeen(page: Page, name = '') {
  const seen = await vehicleSeen(page);
  assert.ok(seen, `${name}: the vehicle is not in the picture`);
  assert.ok(seen.share > SHARE && seen.off_m < OFF_M, `${name}: ${JSON.stringify(seen)}`);
}

export interface Files { [address: string]: string }

/** Serves files by address, with ranges, for pages without the project's own server. */
export async function serve(files: Files): Promise<{url: string; server: Server}> {
  const types: Record<string, string> = {'.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.json': 'application/json'};
  const server = createServer(async (request, response) => {
    const address = (request.url ?? '/').slice(1).split('?')[0] || 'index.html';
    const file = files[address];
    if (!file) return response.writeHead(404).end();
    const {size} = await stat(file);
    const range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? '');
    const [start, end] = range ? [Number(range[1]), Math.min(Number(range[2]), size - 1)] : [0, size - 1];
    response.writeHead(range ? 206 : 200, {'Content-Type': types[extname(address || '')] ?? 'application/octet-stream',
      'Content-Length': end - start + 1, ...(range ? {'Content-Range': `bytes ${start}-${end}/${size}`} : {})});
    return createReadStream(file, {start, end}).pipe(response);
  });
  await new Promise<void>((resolve) => server.listen(0, '127.0.0.1', resolve));
  return {url: `http://127.0.0.1:${(server.address() as AddressInfo).port}/`, server};
}

export function pageFiles(folder: string): Files {
  return Object.fromEntries(['index.html', 'page.js', 'page.css'].map((name) => [name, join(folder, name)]));
}

export type PageOptions = [typeof DESKTOP?, {colorScheme?: 'dark'; hasTouch?: boolean}?];

/** Runs it; an error says what the page showed, because the message alone stands in a stage's output. */
export async function shownOnFailure(page: Page, use: () => Promise<void>) {
  try {
    await use();
  } catch (error) {
    const text = await page.locator('body').innerText({timeout: 10_000}).catch(String);
    (error as Error).message += `\nThe page when it failed: ${text.replaceAll(/\s+/g, ' ')}`;
    throw error;
  }
}

/** Opens the page, does something with it and then wants no complaint. */
export async function onPage(browser: Browser, url: string, use: (page: Page) => Promise<void>, ...options: PageOptions) {
  const {page, complaints} = await newPage(browser, ...options);
  try {
    await shownOnFailure(page, async () => {
      await page.goto(url);
      await flightShown(page);
      await use(page);
      assert.deepEqual(complaints, []);
    });
  } finally {
    await page.context().close();
  }
}

interface Axe { run(): Promise<{violations: {id: string; nodes: {html: string}[]}[]}> }

/** What axe finds in the page as it is. */
export async function violations(page: Page): Promise<string[]> {
  await page.evaluate(AXE);
  return page.evaluate(async () => (await (window as unknown as {axe: Axe}).axe.run()).violations
    .map(({id, nodes}) => `${id}: ${nodes.map(({html}) => html).slice(0, 3).join(' | ')}`));
}

/** On a phone: axe finds nothing, and all of the page is inside the window. */
export async function fitsPhone(page: Page) {
  const before = page.viewportSize()!;
  await page.setViewportSize(PHONE);
  await drawn(page);
  assert.deepEqual(await violations(page), []);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  assert.ok(wide <= 0, `${wide} pixels wider than a phone`);
  await page.setViewportSize(before);
}
