// SPDX-License-Identifier: BSD-3-Clause
// report.html as a user has it: opened from the disk, without a server.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {mkdtemp, readFile, rm, stat} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import {pathToFileURL} from 'node:url';
import {gunzipSync} from 'node:zlib';
import type {Browser, Page} from 'playwright-core';
import {bytesSource} from '../src/data/bytes.ts';
import {linkQualityAt} from '../src/data/link_quality.ts';
import {readLog} from '../src/data/read_log.ts';
import {DESKTOP, drawn, flightShown, goTo, keepPicture, newPage, PHONE, startBrowser, vehicleIsSeen} from './browser.ts';
import {FIXED_WING, FLY, logOf, MULTIROTOR} from './flights.ts';

let browser: Browser;
before(async () => { browser = await startBrowser(); });
after(() => browser?.close());

/** Made for ROS tools of what other topics hold. */
const REPEATED = ['/sim/pose', '/sim/odometry', '/autonomy/odometry', '/gnss/fix'];
const reportOf = (folder: string) => join(folder, 'report.html');

/** Opens it from the disk and then wants no complaint, so also no request to a server. */
async function withReport(folder: string, use: (page: Page) => Promise<void>, ...options: [typeof DESKTOP?, {colorScheme?: 'dark'}?]) {
  const {page, complaints} = await newPage(browser, ...options);
  page.on('request', (request) => { if (/^(http|ws)/.test(request.url())) complaints.push(`request: ${request.url()}`); });
  try {
    await page.goto(pathToFileURL(reportOf(folder)).href);
    await flightShown(page);
    await use(page);
    assert.deepEqual(complaints, []);
  } finally {
    await page.context().close();
  }
}

async function extractOf(folder: string) {
  const html = await readFile(reportOf(folder), 'utf8');
  const text = /<script type="application\/gzip" id="flight-log">([^<]*)</.exec(html)![1]!;
  return readLog(bytesSource('report', new Uint8Array(gunzipSync(Buffer.from(text, 'base64')))));
}

/** How many of the sorted times are the first of their 20 ms. */
function bins(times: Float64Array, length: number): number {
  const count = new Set<number>();
  for (let k = 0; k < length; ++k) count.add(Math.floor((times[k]! + 1e-7) * 50));
  return count.size;
}

describe('report.html', () => {
  for (const [name, folder] of [['the default flight', MULTIROTOR], ['a fixed wing', FIXED_WING]] as const) {
    test(`has every event of ${name} and each state at 50 Hz`, async () => {
      const extract = await extractOf(folder);
      const log = await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(folder)))));
      assert.deepEqual(extract.events, log.events);
      assert.deepEqual(extract.plans, log.plans);
      for (const topic of REPEATED) log.tables.delete(topic);
      assert.deepEqual([...extract.tables.keys()].sort(), [...log.tables.keys()].sort());
      for (const [topic, table] of log.tables) {
        const kept = extract.tables.get(topic)!;
        const all = kept.length === table.length;
        assert.ok(all || kept.length === bins(table.times, table.length), `${topic}: ${kept.length} of ${table.length}`);
      }
      assert.deepEqual(linkQualityAt(extract, 30), linkQualityAt(log, 30));
    });
  }

  test('of the default flight has at most 3 MB', async () => {
    const {size} = await stat(reportOf(MULTIROTOR));
    console.log(`web.report_MB ${(size / 1e6).toFixed(2)}`);
    assert.ok(size <= 3e6, `${size} bytes`);
  });

  test('opens from the disk with the same views, and says what it holds', () => withReport(MULTIROTOR, async (page) => {
    await goTo(page, 20);
    await vehicleIsSeen(page);
    const shown = await page.locator('.instruments').innerText();
    assert.match(shown, /height\s*5\.\d m/);
    assert.match(shown, /armed/);
    assert.match(await page.locator('.notice').innerText(), /every event and 50 Hz of every field, but for the topics that repeat others for ROS tools\./);
    await page.waitForSelector('.plot canvas');
    await keepPicture(page, 'report');
    await page.getByRole('tab', {name: 'Facts'}).click();
    assert.match(await page.locator('.facts').innerText(), /to fly it again\s*\.\/rosflight fly/);
  }));

  for (const [name, viewport, scheme] of [['dark', DESKTOP, 'dark'], ['phone', PHONE, 'light']] as const) {
    test(`looks as it should, ${name}`, () => withReport(FIXED_WING, async (page) => {
      await goTo(page, 60);
      await vehicleIsSeen(page);
      await keepPicture(page, `report_${name}`);
      await page.locator('summary', {hasText: 'Fixed wing'}).click();
      const figures = page.locator('details', {hasText: 'Fixed wing'}).locator('figure');
      assert.equal(await figures.count(), 5);
      await figures.nth(1).scrollIntoViewIfNeeded();
      await figures.locator('canvas').first().waitFor();
      await drawn(page);
      await keepPicture(page, `report_${name}_plots`);
    }, viewport, scheme === 'dark' ? {colorScheme: scheme} : {}));
  }

  test('shows what the firmware counted and its filters', () => withReport(MULTIROTOR, async (page) => {
    await goTo(page, 40);
    await page.getByRole('tab', {name: 'Firmware'}).click();
    await page.waitForSelector('.firmware canvas');
    const text = await page.locator('.firmware').innerText();
    const delay_ms = Number(/The filters delay slow motion by ([\d.]+) ms/.exec(text)![1]);
    assert.ok(Math.abs(delay_ms - 0.3 / 0.7 * 2.5) < 0.1, `${delay_ms} ms`); // GYRO_XY_LPF, GYRO_Z_LPF of 0.3 at 400 Hz
    assert.match(text, /Longest pass, µs\s*\d+/);
    assert.match(text, /Passes over the budget\s*\d+/);
    assert.ok(Number(/Passes of the main loop\s*(\d+)/.exec(text)![1]) > 1000);
    await keepPicture(page, 'firmware');
  }));

  test('shows the checks before arming that the folder has', () => withReport(MULTIROTOR, async (page) => {
    const stored = JSON.parse(await readFile(join(MULTIROTOR, 'preflight.json'), 'utf8')) as {ready: boolean; checks: {row: string; verdict: string; reason: string}[]};
    assert.ok(stored.ready);
    assert.equal(stored.checks.length, 17);
    await page.getByRole('tab', {name: 'Preflight'}).click();
    await page.getByRole('button', {name: /^All checks at [\d.]+ s$/}).press('Enter');
    await page.getByText('All checks of the firmware').waitFor();
    const rows = (await page.locator('.preflight .checks tbody tr').allInnerTexts()).map((text) => text.split('\t'));
    assert.deepEqual(rows.map(([name, verdict]) => [name!.trim(), verdict!.trim().slice(2)]), stored.checks.map(({row, verdict}) => [row, verdict]));
  }));

  test('marks the parameters that differ from the default', () => withReport(MULTIROTOR, async (page) => {
    await page.getByRole('tab', {name: 'Parameters'}).click();
    await page.getByLabel('only those that differ from the default').check();
    const rows = await page.locator('.parameters tbody tr:not(.about)').count();
    assert.ok(rows > 5 && rows < 200, `${rows}`);
    for (const cells of await page.locator('.parameters tbody tr:not(.about)').allInnerTexts()) {
      const [, value, standard] = cells.split('\t');
      assert.notEqual(value, standard);
    }
  }));

  test('shows when a fault was in force, and what the estimate rejected', async () => {
    const folder = await mkdtemp(join(tmpdir(), 'rosflight_report_'));
    spawnSync(FLY, ['fly', '--fault', 'baro_step=8@20:6', '--out', join(folder, 'flight')]);
    await withReport(join(folder, 'flight'), async (page) => {
      const lane = (name: string) => page.locator('.lane', {has: page.locator('.name', {hasText: name})}).locator('.span');
      assert.equal(await lane('faults').getAttribute('title'), 'baro_step=8, 20.00 to 26.00 s');
      assert.match((await lane('rejected').first().getAttribute('title'))!, /barometer/);
      await page.waitForSelector('.plot canvas');
      await goTo(page, 22);
      await keepPicture(page, 'report_fault');
    });
    await rm(folder, {recursive: true});
  });
});
