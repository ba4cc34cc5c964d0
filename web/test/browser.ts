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
import {pixelAt} from './picture.ts';

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

/** Keeps a picture for people to look at, and its dark twin, in the folder that ROSFLIGHT_WEB_PICTURES names; in another size than the test's
 * if given. `ready` is done before each: what a new size or scheme of colours ends is begun again. */
export async function keepPicture(page: Page, name: string, size?: typeof DESKTOP, ready = async () => {}) {
  const folder = process.env['ROSFLIGHT_WEB_PICTURES'];
  if (!folder) return;
  const before = page.viewportSize()!;
  if (size) await page.setViewportSize(size);
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

/** Whether the picture shows the vehicle where the camera says it is: its rotors are blue, what is around them is not. */
export async function vehicleIsSeen(page: Page) {
  const share = await page.evaluate(() => window.rosflightScene!.vehicleInPicture());
  assert.ok(share, 'the vehicle is not in the picture');
  const box = (await page.locator('canvas').first().boundingBox())!;
  const picture = await page.screenshot({clip: box});
  const there = pixelAt(picture, share.x, share.y, 0.02);
  const elsewhere = pixelAt(picture, 0.5, 0.97, 0.005);
  const distance = Math.hypot(...there.map((value, k) => value - elsewhere[k]!));
  assert.ok(distance > 40, `at the vehicle ${there}, on the ground ${elsewhere}`);
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

/** Opens the page, does something with it and then wants no complaint. */
export async function onPage(browser: Browser, url: string, use: (page: Page) => Promise<void>, ...options: PageOptions) {
  const {page, complaints} = await newPage(browser, ...options);
  try {
    await page.goto(url);
    await flightShown(page);
    await use(page);
    assert.deepEqual(complaints, []);
  } catch (error) {
    const text = await page.locator('body').innerText({timeout: 10_000}).catch(String);
    (error as Error).message += `\nThe page when it failed: ${text.replaceAll(/\s+/g, ' ')}`; // the message alone stands in a stage's output
    throw error;
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
