// SPDX-License-Identifier: BSD-3-Clause
// Vehicles on a pseudo terminal and on TCP: ./rosflight view pty:PATH and tcp:HOST:PORT against ./rosflight sil, and the calibrations
// that a person does.
import assert from 'node:assert/strict';
import {spawnSync, type ChildProcess} from 'node:child_process';
import {existsSync} from 'node:fs';
import {mkdtemp, readFile, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import type {Browser, Page} from 'playwright-core';
import {bytesSource} from '../src/data/bytes.ts';
import {readLog} from '../src/data/read_log.ts';
import {DESKTOP, drawnForNobody, keepPicture, LONG, onPage, PHONE, SMALL, startBrowser, violations} from './browser.ts';
import {MULTIROTOR, PARAMETERS, PYTHON, SIL, VIEW} from './flights.ts';
import {HANDS, KEYBOARD, TOUCH, withoutMouse, type Hand} from './hands.ts';
import {start} from './simulated.ts';

const PEER = new URL('../../ground/test/peer.py', import.meta.url).pathname;
const started: ChildProcess[] = [];
let browser: Browser;
let scratch = '';
let count = 0;

before(async () => {
  browser = await startBrowser();
  scratch = await mkdtemp(join(tmpdir(), 'rosflight_links_'));
});
after(async () => {
  for (const program of started) program.kill('SIGKILL');
  await browser?.close();
  await rm(scratch, {recursive: true});
});

/** @returns the firmware as a process and the link that it prints. */
async function firmware(link: string, ...options: string[]) {
  const {child, found} = await start(started, SIL, ['sil', '--link', link, ...options], /link=(\S+)/);
  return {sil: child, link: found[1]!};
}

async function show(link: string, ...options: string[]) {
  const folder = join(scratch, `flight${++count}`);
  const {child, found} = await start(started, VIEW, ['view', link, '--out', folder, ...options], /http:\S+/);
  return {view: child, url: found[0], folder};
}

async function takeControl(page: Page) {
  await page.getByRole('tab', {name: 'Parameters'}).click();
  await page.getByRole('button', {name: 'Take control'}).click();
  await page.getByText('You have control').first().waitFor();
}

/** The whole list is known. */
const listed = (page: Page) => page.getByText(new RegExp(`^${PARAMETERS} of ${PARAMETERS}$`)).waitFor();

const rowOf = (page: Page, name: string) => page.locator('.calibrations tr', {has: page.getByRole('button', {name: `Calibrate ${name}`})});
const begin = (page: Page, name: string, hand: Hand) => hand.press(rowOf(page, name).getByRole('button', {name: `Calibrate ${name}`}));

/** Sticks to all ends again and again, then released; later both ends of the throttle, armed. */
const TRANSMITTER = {sweepFrom_s: 2, sweeps: 8, release_s: 10, arm_s: 20};
function transmitterScript(): string {
  const {sweepFrom_s, sweeps, release_s, arm_s} = TRANSMITTER;
  const sticks = ['roll', 'pitch', 'yaw', 'throttle'];
  const events = Array.from({length: 2 * sweeps}, (_, k) => sticks.map((stick) => `at_s: ${sweepFrom_s + k / 2}, set: ${stick}, to: ${k % 2}.0`)).flat();
  for (const stick of ['roll', 'pitch', 'yaw']) events.push(`at_s: ${release_s}, set: ${stick}, to: ${stick === 'roll' ? 0.53 : 0.5}`);
  events.push(`at_s: ${release_s}, set: throttle, to: 0.0`, `at_s: ${arm_s}, switch: arm, on: true`, `at_s: ${arm_s + 2}, set: throttle, to: 1.0`,
    `at_s: ${arm_s + 4}, set: throttle, to: 0.0`, `at_s: ${arm_s + 6}, switch: arm, on: false`);
  return `start: {attitude_mode: 1, throttle_override: 1}\nevents:\n${events.map((event) => `  - {${event}}\n`).join('')}`;
}

describe('a vehicle on a serial port or TCP', () => {
  for (const kind of ['pty', 'tcp:0']) {
    test(`is shown over ${kind}, changed, and the page shows its end`, {timeout: 120_000}, async () => {
      const {sil, link} = await firmware(kind, '--nvm', join(scratch, `${kind.slice(0, 3)}.nvm`));
      assert.match(link, kind === 'pty' ? /^pty:\// : /^tcp:127\.0\.0\.1:\d+$/);
      // A real port is typed as serial:PATH; the comparison of two vehicles types pty:PATH.
      const {url, view, folder} = await show(link.replace('pty:', 'serial:'));
      await onPage(browser, url, async (page) => {
        await drawnForNobody(page);
        await page.waitForSelector('.instruments:has-text("disarmed")');
        await takeControl(page);
        await page.getByLabel('Search').fill('FAILSAFE_THR');
        await page.getByLabel('Value of FAILSAFE_THR').fill('0.25');
        await page.getByRole('button', {name: 'Send 1 change'}).click();
        await page.getByText('1 of 1 in force').waitFor();
        sil.kill('SIGTERM');
        await page.getByRole('tab', {name: 'Events'}).click();
        await page.waitForSelector('.events tr:has-text("link lost")');
      }, kind === 'pty' ? SMALL : PHONE);
      view.kill('SIGINT');
      await new Promise((resolve) => view.on('exit', resolve));
      const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(join(folder, 'flight.mcap')))));
      assert.ok(flight.tables.get('/link/param_set')!.text('name')!.includes('FAILSAFE_THR'));
      assert.ok(flight.events.some(({text}) => text === 'link lost'));
    });
  }
});

test('a link that nobody can compare with ends the program before it serves or writes anything', () => {
  for (const [other, why] of [['nonsense', 'allowed a link to another vehicle'], ['tcp:127.0.0.1:9', 'allowed a link to another vehicle'], ['tcp:127.0.0.1', 'allowed a port from 1 to 65535'], ['tcp:[::1:5', 'no host and port']]) {
    const folder = join(scratch, 'not-made');
    const {status, stdout, stderr} = spawnSync(VIEW, ['view', 'tcp:127.0.0.1:9', '--out', folder, '--compare', other!], {encoding: 'utf8', timeout: 10_000});
    assert.deepEqual([status, stdout, existsSync(folder)], [2, '', false]);
    assert.match(stderr, new RegExp(`^rosflight: .*${why}[^\n]*\n$`));
  }
});

for (const hand of HANDS) test(`two vehicles are compared by their parameters, and one takes values of the other, ${hand.name}`, {timeout: 120_000}, async () => {
  const one = await firmware('tcp:0', '--nvm', join(scratch, `one${++count}.nvm`));
  const two = await firmware('pty', '--nvm', join(scratch, `two${count}.nvm`));
  const {url: twos, view} = await show(two.link);
  await onPage(browser, twos, async (page) => { // the other vehicle is another one
    await drawnForNobody(page);
    await takeControl(page);
    await page.getByLabel('Search').fill('FAILSAFE_THR');
    await page.getByLabel('Value of FAILSAFE_THR').fill('0.3');
    await page.getByRole('button', {name: 'Send 1 change'}).click();
    await page.getByText('1 of 1 in force').waitFor();
    await page.getByRole('button', {name: 'Write to memory'}).click();
    await page.getByText('writing parameters: done').waitFor();
  }, SMALL);
  view.kill('SIGINT');
  await new Promise((resolve) => view.on('exit', resolve)); // a serial port serves one program
  const {url} = await show(one.link, '--compare', two.link);
  await onPage(browser, url, async (page) => {
    await drawnForNobody(page);
    const check = await withoutMouse(page);
    await hand.press(page.getByRole('tab', {name: 'Parameters'}));
    await hand.press(page.getByRole('button', {name: 'Take control'}));
    await listed(page);
    const compare = page.getByRole('button', {name: `Compare with ${two.link}`});
    const row = page.locator('.differences tbody tr', {hasText: 'FAILSAFE_THR'});
    while (await row.count() === 0) {
      await hand.press(compare);
      await page.waitForTimeout(200);
    }
    assert.deepEqual((await row.locator('td').allInnerTexts()).slice(1, 4), ['FAILSAFE_THR', '-1', '0.3']);
    const measured = await page.locator('.differences tbody tr').count() - 1; // of the barometer and the pitot tube, at each start
    assert.ok(measured <= 3, await page.locator('.differences').innerText());
    for (const box of await page.locator('.differences tbody input').all()) {
      if (await box.getAttribute('aria-label') !== 'Send FAILSAFE_THR') await hand.press(box);
    }
    await hand.press(page.getByRole('button', {name: 'Send 1 from the file'}));
    await page.getByText('1 of 1 in force').waitFor();
    await hand.type(page.getByLabel('Search'), 'FAILSAFE_THR');
    assert.equal(await page.getByLabel('Value of FAILSAFE_THR').inputValue(), '0.3');
    await hand.press(compare);
    await page.locator('.differences h2').waitFor();
    assert.equal(await row.count(), 0);
    await check();
  }, ...hand.options);
});

const REST = {concurrency: true, skip: LONG ? false : './rosflight test web-rest runs it: over a minute of real time'};
describe('calibrations that a person does', REST, () => {
  for (const hand of HANDS) test(`receiver and speed controllers show each instruction and end with their figures, ${hand.name}`, {timeout: 300_000}, async () => {
    const memory = join(scratch, `transmitter${++count}.nvm`);
    const script = join(scratch, `pilot${count}.yaml`);
    await writeFile(script, transmitterScript());
    const first = await firmware('tcp:0', '--nvm', memory);
    const {url} = await show(first.link);
    await onPage(browser, url, async (page) => {
      await drawnForNobody(page);
      await takeControl(page);
      await listed(page);
      await page.getByLabel('Compare with a file').setInputFiles(join(MULTIROTOR, 'parameters.yaml'));
      await page.getByRole('button', {name: /Send \d+ from the file/}).click();
      await page.getByText(/^\d+ of \d+ in force/).waitFor();
      await page.getByRole('button', {name: 'Write to memory'}).click();
      await page.getByText('writing parameters: done').waitFor();
      const check = await withoutMouse(page);
      await hand.press(page.getByRole('tab', {name: 'Preflight'}));
      assert.ok(await rowOf(page, 'speed controllers').getByRole('button').isDisabled(), 'with propellers');
      first.sil.kill('SIGTERM');
      await new Promise((resolve) => first.sil.on('exit', resolve));
      // Again with somebody at the transmitter; view connects by itself.
      const {sil} = await firmware(first.link, '--nvm', memory, '--rc', script);
      await hand.press(page.getByRole('tab', {name: 'Events'}));
      await page.locator('.events tr', {hasText: 'link up'}).nth(1).waitFor();
      await hand.press(page.getByRole('tab', {name: 'Preflight'}));
      await begin(page, 'receiver', hand);
      await page.getByText(/move both sticks of the transmitter to all their ends/).first().waitFor();
      await page.locator('.calibration-lines', {hasText: /roll stick \(channel \d+\): 1000 \.\. 2000 us/}).waitFor();
      await rowOf(page, 'receiver').getByText(/✓ trim Z_EQ_TORQUE: /).waitFor();
      assert.match(await page.locator('.calibration-lines').innerText(), /trim X_EQ_TORQUE: 0\.0 -> 0\.0\d*[1-9]/);
      await hand.press(page.getByLabel('Propellers are off'));
      await begin(page, 'speed controllers', hand);
      await page.getByText(/arm, then raise the throttle stick to its end/).first().waitFor();
      await rowOf(page, 'speed controllers').getByText(/✓ former mixer put back and stored/).waitFor();
      assert.match(await page.locator('.calibration-lines').innerText(), /endpoints sent: 0\.000 and 1\.000 on 10 outputs/);
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, hand === TOUCH ? 'calibrations-by-hand-phone' : 'calibrations-by-hand', hand === TOUCH ? PHONE : DESKTOP);
      await begin(page, 'speed controllers', hand);
      await page.locator('.calibration-lines li').nth(1).waitFor({state: 'detached'}); // those of the former one
      await page.getByText(/arm, then raise the throttle stick to its end/).first().waitFor();
      await hand.press(rowOf(page, 'speed controllers').getByRole('button', {name: 'Stop'}));
      await rowOf(page, 'speed controllers').getByText(/✗ stopped; former mixer put back and stored/).waitFor();
      await hand.press(page.getByRole('tab', {name: 'Parameters'}));
      await hand.type(page.getByLabel('Search'), 'PRIMARY_MIXER');
      assert.notEqual(await page.getByLabel('Value of PRIMARY_MIXER').inputValue(), '0');
      await check();
      sil.kill('SIGTERM');
    }, ...hand.options);
  });

  test('the magnetometer is turned by hand and ends with the residual of its fit', {timeout: 300_000}, async () => {
    const {found} = await start(started, PYTHON, [PEER], /tcp:\S+/);
    const {url} = await show(found[0]);
    await onPage(browser, url, async (page) => {
      await drawnForNobody(page);
      await takeControl(page);
      await page.getByRole('tab', {name: 'Preflight'}).click();
      await begin(page, 'magnetometer', KEYBOARD);
      await page.getByText(/turn a full circle about the vertical/).first().waitFor();
      await rowOf(page, 'magnetometer').getByText(/✓ /).waitFor({timeout: 240_000});
      const lines = await page.locator('.calibration-lines').innerText();
      const share = Number(/mag: fit residual ([\d.]+) % of the field, limit/.exec(lines)![1]);
      assert.ok(share < 1, lines);
      await page.getByRole('tab', {name: 'Parameters'}).click();
      await page.getByLabel('Search').fill('MAG_X_BIAS');
      assert.ok(Math.abs(Number(await page.getByLabel('Value of MAG_X_BIAS').inputValue()) - 15e-6) < 2e-6);
    }, SMALL);
  });
});
