// SPDX-License-Identifier: BSD-3-Clause
// The view Tune of a flight that runs: steps are made and measured, gains tried, undone and taken.
import assert from 'node:assert/strict';
import {type ChildProcess} from 'node:child_process';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import type {Browser, Page} from 'playwright-core';
import {DESKTOP, drawnForNobody, fitsPhone, keepPicture, LONG, onPage, SMALL, startBrowser, violations} from './browser.ts';
import {KEYBOARD} from './hands.ts';
import {flyWatched, viewer} from './simulated.ts';

const started: ChildProcess[] = [];
let browser: Browser;

before(async () => { browser = await startBrowser(); });
after(async () => {
  for (const program of started) program.kill('SIGKILL');
  await browser?.close();
});

/** A flight of a multirotor that will hold at 8 m, with Tune open. */
async function tune(test: (page: Page, url: string) => Promise<void>) {
  const folder = await mkdtemp(join(tmpdir(), 'rosflight_tune_'));
  const mission = join(folder, 'high.yaml');
  await writeFile(mission, 'mission:\n  - {type: hold, w: [0, 0, -8], speed: 4, heading_deg: 0, hold_seconds: 300}\n');
  const {url} = await flyWatched(started, join(folder, 'flight'), '--mission', mission, '--hold');
  await onPage(browser, url, async (page) => {
    await drawnForNobody(page);
    await page.getByRole('tab', {name: 'Tune'}).click();
    await test(page, url);
  }, SMALL);
  await rm(folder, {recursive: true});
}

async function takeOff(page: Page) {
  await page.getByRole('tab', {name: 'Simulation'}).click();
  await page.getByRole('button', {name: 'Let the pilot arm'}).click();
  await page.getByRole('tab', {name: 'Tune'}).click();
}
const high = (page: Page) => page.waitForFunction(() => parseFloat(/height([\d.]+)/.exec(document.querySelector('.instruments')!.textContent!)?.[1] ?? '0') > 7);

const STICK = {button: 'Step for 2 s', begun: 'The pilot takes the sticks', ended: 'The pilot gave the sticks back'};
const ALTITUDE = {button: 'Step for 5 s', begun: 'The mission is flown at another altitude', ended: 'The mission is flown as it is'};

/** A step there and back, by keyboard. */
async function step(page: Page, {button, begun, ended}: typeof STICK) {
  const known = await rowsOf(page).count();
  await KEYBOARD.press(page.getByRole('button', {name: button}));
  await page.getByText(begun).waitFor();
  await page.getByText(ended).waitFor();
  await page.waitForFunction((count) => document.querySelectorAll('.steps tbody tr').length >= count + 2, known, {timeout: 20_000});
}
const rowsOf = (page: Page) => page.locator('.steps tbody tr');
/** Numbers of a step; the newest, 0, is the way back. */
const cells = async (page: Page, row: number) => (await rowsOf(page).nth(row).locator('td').allInnerTexts()).map((text) => parseFloat(text));
/** A busy computer may miss the samples of a step, which the page then says; a person steps again. */
const missing = async (page: Page) => (await rowsOf(page).nth(1).innerText()).includes('samples are missing');

test('a step of the roll stick has its figures beside the gains, which are tried, undone and taken', {timeout: 240_000}, () => tune(async (page, url) => {
  await page.getByText('No step of roll in this flight yet.').waitFor();
  await page.getByRole('button', {name: 'Take control'}).click();
  assert.ok(await page.getByRole('button', {name: STICK.button}).isDisabled(), 'on the ground');
  await page.getByText('From 3 m above the take-off on.').waitFor();
  const watch = await viewer(url);
  await takeOff(page);
  const flown = async () => {
    await high(page);
    const begin = watch.flight.end_s;
    await step(page, STICK);
    const truth = watch.flight.tables.get('/sim/truth_state')!;
    const from = truth.rowAt(begin);
    const heights = [...truth.column('pose.position.z')!.subarray(from, truth.length)].map((z) => -z);
    const span = Math.max(...heights) - Math.min(...heights);
    assert.ok(heights.length > 100 && span < 1, `the altitude stays: ${span} m`);
  };
  const measured = async () => { do await flown(); while (await missing(page)); };
  await measured();
  const first = await cells(page, 1);
  assert.ok(Math.abs(first[0]! - 10) < 0.3, `a step of 10 degrees: ${first}`);
  assert.ok(first[1]! > 0.03 && first[1]! < 0.6, `rise: ${first}`);
  assert.ok(first[2]! >= 0 && first[2]! < 60, `overshoot: ${first}`);
  assert.equal(first[5], 1, 'gain in force');
  const gain = page.getByLabel('PID_ROLL_ANG_P');
  await gain.fill('-1');
  await page.getByText(/PID_ROLL_ANG_P: allowed/).waitFor();
  assert.ok(await page.getByRole('button', {name: 'Try'}).isDisabled());
  await gain.fill('0.5');
  await page.getByRole('button', {name: 'Try'}).click();
  await page.getByText('Before: PID_ROLL_ANG_P 1').waitFor();
  await measured();
  assert.deepEqual(await violations(page), []);
  await keepPicture(page, 'tune', DESKTOP);
  await fitsPhone(page);
  const softer = await cells(page, 1);
  assert.equal(softer[5], 0.5);
  assert.ok(softer[1]! > 1.2 * first[1]!, `half the gain answers more slowly: ${softer}, ${first}`);
  await page.getByRole('button', {name: 'Undo'}).click();
  await page.getByText('set to 1').waitFor();
  assert.equal(await gain.inputValue(), '1');
  assert.ok(await page.getByRole('button', {name: 'Undo'}).isDisabled());
  await gain.fill('0.9');
  await page.getByRole('button', {name: 'Try'}).click();
  await page.getByText('Before: PID_ROLL_ANG_P 1').waitFor();
  await page.getByRole('button', {name: 'Take', exact: true}).click();
  await page.getByText(/^Taken\./).waitFor();
  assert.equal(await gain.inputValue(), '0.9');
  watch.socket.close();
}));

test('so has a step of the altitude, whose gains are those of autonomy', {timeout: 240_000, skip: LONG ? false : './rosflight test web-rest runs it'}, () => tune(async (page) => {
  await page.getByRole('button', {name: 'Take control'}).click();
  await takeOff(page);
  await high(page);
  await page.getByLabel('Axis').selectOption('Altitude');
  const damping = page.getByLabel('follower.vertical.kd_1_s');
  await damping.fill('1001');
  await page.getByRole('button', {name: 'Try'}).click();
  await page.getByText(/found 1001, allowed/).waitFor();
  await damping.fill('2');
  await page.getByRole('button', {name: 'Try'}).click();
  await page.getByText('Before: follower.vertical.kd_1_s 3.5').waitFor();
  do await step(page, ALTITUDE); while (await missing(page));
  const climbed = await cells(page, 1);
  assert.equal(climbed[0], 1, 'metres');
  assert.ok(climbed[1]! > 0.3 && climbed[1]! < 2, `rise: ${climbed}`);
  assert.deepEqual(climbed.slice(5), [4, 1, 2], 'gains in force');
  assert.deepEqual(await violations(page), []);
  await keepPicture(page, 'tune-altitude', DESKTOP);
  await page.getByRole('button', {name: 'Undo'}).click();
  await page.getByText('set to 3.5').waitFor();
}));
