// SPDX-License-Identifier: BSD-3-Clause
// What 3-D view, instruments, bars, slider and plots show of a flight, against arithmetic on the columns of its log.
import assert from 'node:assert/strict';
import {spawnSync, type ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import type {Browser, Page} from 'playwright-core';
import type {Analysis} from '../src/data/analysis.ts';
import {bytesSource} from '../src/data/bytes.ts';
import type {Flight} from '../src/data/flight.ts';
import {readLog} from '../src/data/read_log.ts';
import {clock, drawn, goTo, onPage, startBrowser} from './browser.ts';
import {ATTITUDE, bars, cells, ESTIMATED, extent, inPicture, lineOf, near, objectOf, POSITION, positions} from './contents.ts';
import {FLY, logOf} from './flights.ts';
import {view} from './simulated.ts';

const DEG = 180 / Math.PI;
let browser: Browser;
const running: ChildProcess[] = [];
let url = '';
let folder = '';
let flight: Flight;

before(async () => {
  browser = await startBrowser();
  folder = join(await mkdtemp(join(tmpdir(), 'rosflight_contents_')), 'flight');
  spawnSync(FLY, ['fly', '--wind', '3,240', '--fault', 'link_cut@20:3', '--out', folder]);
  flight = await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(folder)))));
  url = await view(running, folder);
});
after(async () => {
  running.forEach((program) => program.kill('SIGTERM'));
  await browser?.close();
  await rm(join(folder, '..'), {recursive: true});
});


/** Goes there and gives back the moment that the slider has then. */
async function at(page: Page, t: number): Promise<number> {
  await goTo(page, t);
  return Number(await page.getByLabel('Time in the flight').inputValue());
}

async function space(page: Page) {
  const analysis = JSON.parse(await readFile(join(folder, 'analysis.json'), 'utf8')) as Analysis;
  for (const wanted of [12, 31]) {
    const t = await at(page, wanted);
    const vehicle = await objectOf(page, 'vehicle');
    near(vehicle.position, inPicture(cells(flight, '/sim/truth_state', POSITION, t)), 0.05, 'truth'); // 5 m/s for a row of 10 ms
    const [w, x, y, z] = cells(flight, '/sim/truth_state', ATTITUDE, t) as [number, number, number, number];
    near(vehicle.front, inPicture([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]), 0.02, 'front');
    for (const [name, topic, names] of [['flown', '/sim/truth_state', POSITION], ['estimate', '/autonomy/estimate', ESTIMATED]] as const) {
      const line = await lineOf(page, name);
      near(line.points[line.drawn]!, inPicture(cells(flight, topic, [...names], t)), 0.15, `end of the line ${name} at ${t} s`);
    }
    const cloud = await objectOf(page, 'uncertainty');
    near(cloud.position, inPicture(cells(flight, '/autonomy/estimate', ESTIMATED, t)), 0.1, 'estimate');
    const [n, e, d] = cells(flight, '/autonomy/estimate', [0, 1, 2].map((k) => `position_sigma[${k}]`), t);
    near(cloud.scale, [3 * e!, 3 * d!, 3 * n!], 0.003, 'three standard deviations');
    assert.ok(cloud.visible && vehicle.visible);
    const wind = await objectOf(page, 'wind');
    assert.ok(wind.visible);
    near(wind.up, inPicture([Math.cos(60 / DEG), Math.sin(60 / DEG), 0]), 1e-3, 'it comes from 240 degrees');
    assert.ok(Math.abs(wind.position[0]! - vehicle.position[0]!) < 1e-9 && wind.position[1]! > vehicle.position[1]!, 'above the vehicle');
  }
  for (const [name, topic, names, tolerance] of [['flown', '/sim/truth_state', POSITION, 0.03], ['estimate', '/autonomy/estimate', ESTIMATED, 0.03],
    ['setpoint', '/trajectory_command', ESTIMATED, 0.03]] as const) {
    const {points} = await lineOf(page, name);
    assert.ok(points.length > 1000, `${name}: ${points.length}`);
    near(extent(points), extent(positions(flight, topic, names)), tolerance, name);
  }
  const waypoints = analysis.waypoints.map(({position_m}) => inPicture([...position_m]));
  assert.equal(waypoints.length, 7);
  for (const [k, place] of waypoints.entries()) near((await objectOf(page, `waypoint ${k + 1}`)).position, place, 1e-6, `waypoint ${k + 1}`);
  const plan = await lineOf(page, 'plan');
  near(plan.points.flat(), waypoints.flat(), 1e-5, 'plan');
  await at(page, 3);
  assert.ok(!(await objectOf(page, 'uncertainty')).visible, 'no estimate before the companion has one');
}

/** Roll, pitch and yaw of a rotation matrix made from the quaternion [deg]. */
function angles(of: Flight, t: number): number[] {
  const [w, x, y, z] = cells(of, '/sim/truth_state', ATTITUDE, t) as [number, number, number, number];
  const R = [[1 - 2 * (y * y + z * z)], [2 * (x * y + w * z)], [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
  return [Math.atan2(R[2]![1]!, R[2]![2]!) * DEG, -Math.asin(R[2]![0]!) * DEG, Math.atan2(R[1]![0]!, R[0]![0]!) * DEG];
}

/** The row's time at which a value is largest. */
function whenLargest(table: {times: Float64Array; length: number}, value: (t: number) => number): number {
  let best = 0;
  for (let row = 1; row < table.length; row += 5) if (value(table.times[row]!) > value(table.times[best]!)) best = row;
  return table.times[best]!;
}

const numbers = (text: string) => [...text.matchAll(/-?[\d.]+/g)].map(([number]) => Number(number));

async function instruments(page: Page) {
  const truth = flight.tables.get('/sim/truth_state')!;
  const moments = [[0, 1], [0, -1], [1, 1], [1, -1]].map(([axis, sign]) => whenLargest(truth, (t) => sign! * angles(flight, t)[axis!]!));
  for (const moment of moments) {
    const t = await at(page, moment);
    const [roll, pitch, yaw] = angles(flight, t) as [number, number, number];
    const horizon = page.getByRole('img', {name: /^roll/});
    near(numbers((await horizon.getAttribute('aria-label'))!), [roll, pitch], 1, 'roll and pitch in words');
    // Rolling right turns the horizon left, pitching up moves it down, 1.6 of the picture's 120 units for a degree.
    const [turn, , down] = numbers((await horizon.locator('g g').getAttribute('transform'))!);
    near([turn!, down!], [-roll, 1.6 * pitch], 0.8, 'horizon');
    const reading = async (name: string) => numbers(await page.locator('.instruments dl > div', {hasText: name}).locator('dd').innerText())[0]!;
    near([await reading('height')], [-flight.latest('/sim/truth_state', 'pose.position.z', t)], 0.11, 'height');
    assert.ok(Math.abs((await reading('heading') - yaw + 540) % 360 - 180) < 1.5, 'heading');
    near([await reading('battery')], [flight.latest('/battery', 'voltage', t)], 0.06, 'battery');
  }
  const largest = Math.max(...moments.map((t) => Math.abs(angles(flight, t)[0]!)));
  assert.ok(largest > 5, `the flight rolls: ${largest}`);

  const link = page.locator('.state .badge', {hasText: 'link'});
  for (const [t, text] of [[19.9, 'link good'], [21.5, /^link weak, 2\d % lost$/], [22.5, /^link lost, 4\d % lost$/], [30, 'link good']] as const) {
    await at(page, t);
    const shown = await link.innerText();
    assert.ok(typeof text === 'string' ? shown === text : text.test(shown), `${t} s: ${shown}`);
  }
}

async function receiverAndOutputs(page: Page) {
  await page.getByRole('tab', {name: 'Receiver and outputs'}).click();
  const lengths = new Set<number>();
  const moved: string[] = [];
  const rc = flight.tables.get('/rc_raw')!;
  for (const wanted of [3, 25]) {
    const t = await at(page, wanted);
    const all = await bars(page);
    assert.deepEqual(all.map(({name}) => name), [...[0, 1, 2, 3, 4, 5, 6, 7].map((k) => `channel ${k}`), ...[0, 1, 2, 3].map((k) => `output ${k}`)]);
    for (const {name, share, value, use, ends} of all) {
      const field = `values[${numbers(name)[0]}]`;
      const channel = name.startsWith('channel');
      const truth = channel ? flight.latest('/rc_raw', field, t) : 100 * flight.latest('/output_raw', field, t);
      near([value], [truth], 0.5, `${name} at ${t} s`);
      near([share], [channel ? (truth - 1000) / 1000 : truth / 100], 0.01, `length of ${name} at ${t} s`);
      lengths.add(Math.round(20 * share));
      if (!channel) continue;
      const seen = Array.from(rc.column(field)!).filter((_, row) => rc.times[row]! <= t);
      const [low, high] = [Math.min(...seen), Math.max(...seen)];
      near(numbers(use).slice(-2), [low, high], 0.5, `end points of ${name} at ${t} s`);
      near(ends, [(low - 1000) / 1000, (high - 1000) / 1000], 0.01, `their marks`);
      if (high - low > 400) moved.push(name);
    }
  }
  assert.ok(moved.length >= 1, 'a channel has moved by then');
  assert.ok(lengths.size >= 4, `none, half, full and what flies: ${[...lengths]}`);
}

async function marks(page: Page) {
  const end = flight.end_s;
  const marks = await page.locator('.marks .mark').evaluateAll((all) => all.map((mark) => {
    const track = mark.parentElement!.getBoundingClientRect();
    return {share: parseFloat((mark as HTMLElement).style.left) / 100, left: (mark.getBoundingClientRect().left - track.left) / track.width,
      tone: mark.classList[1]!, title: mark.getAttribute('title')!};
  }));
  const rank = ['note', 'warning', 'bad'];
  for (const {t, tone, text} of flight.events) {
    const close = marks.filter(({share}) => Math.abs(share - t / end) < 0.002);
    assert.ok(close.some((mark) => rank.indexOf(mark.tone) >= rank.indexOf(tone)), `${t} s ${tone} ${text}`);
  }
  for (const {share, left, title} of marks) {
    const t = parseFloat(title);
    assert.ok(flight.events.some((event) => Math.abs(event.t - t) < 0.006 && title.endsWith(event.text)), title);
    near([share], [t / end], 0.001, title);
    near([left], [t / end], 0.02, `${title}: its left edge in the track`);
  }
  const lost = flight.events.find(({text}) => text === 'link lost')!;
  await page.locator('.marks .mark[title$="link lost"]').click();
  near([await clock(page)], [lost.t], 0.006, 'the moment of the mark');
}

async function plots(page: Page) {
  await page.getByRole('tab', {name: 'Plots'}).click();
  const t = await at(page, 25);
  await page.locator('.plot canvas').nth(2).waitFor();
  const over = page.locator('.plots .u-over');
  /** Where the moment shown is in each plot, as a share of its width. */
  const moments = () => over.evaluateAll((all) => all.map((one) =>
    new DOMMatrix(getComputedStyle(one.querySelector('.now')!).transform).e / one.clientWidth));
  const whole = await moments();
  assert.ok(whole.length >= 3);
  near(whole, whole.map(() => t / flight.end_s), 0.005, 'all of it');
  const box = (await over.first().boundingBox())!;
  await page.mouse.move(box.x + 0.25 * box.width, box.y + 50);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.75 * box.width, box.y + 60, {steps: 4});
  await page.mouse.up();
  const zoomed = (t / flight.end_s - 0.25) / 0.5;
  await page.waitForFunction(() => document.querySelector('.plots .tools')!.textContent!.includes('Show all'));
  await drawn(page);
  near(await moments(), whole.map(() => zoomed), 0.02, 'the middle half, in each plot');

  await page.mouse.move(box.x + 0.6 * box.width, box.y + 50);
  await drawn(page);
  const cursor_s = flight.end_s * (0.25 + 0.6 * 0.5);
  const legends = await page.locator('.plots .u-legend').evaluateAll((all) => all.slice(0, 3).map((one) => one.textContent!));
  const [north, east, height] = cells(flight, '/sim/truth_state', POSITION, cursor_s).map((value, k) => k === 2 ? -value : value);
  for (const [k, value] of [north!, east!, height!].entries()) {
    const {s, flown} = /^s(?<s>[\d.]+)setpoint.*flown(?<flown>-?[\d.]+)/.exec(legends[k]!)!.groups!;
    near([Number(s)], [cursor_s], 0.3, `cursor of plot ${k}: ${legends[k]}`);
    near([Number(flown)], [value], 0.6, `value in plot ${k}`);
  }
}

test('a flight is shown as its log has it', (t) => onPage(browser, url, async (page) => {
  await t.test('the picture has vehicle, paths, waypoints, uncertainty and wind where the log has them', () => space(page));
  await t.test('attitude indicator, numbers and state are those of the flight', () => instruments(page));
  await t.test('bars of receiver and outputs have the lengths of their values, and each channel its end points', () => receiverAndOutputs(page));
  await t.test('each event has a mark on the slider, and a mark leads to its moment', () => marks(page));
  await t.test('plots share zoom and cursor', () => plots(page));
}));
