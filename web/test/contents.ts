// SPDX-License-Identifier: BSD-3-Clause
// What stands in the page's picture and bars, and the same out of a flight, for tests that compare them.
import assert from 'node:assert/strict';
import type {Line2} from 'three/addons/lines/Line2.js';
import type {Page} from 'playwright-core';
import type {Flight} from '../src/data/flight.ts';
import {clock} from './browser.ts';

/** Columns of a topic at the latest message. */
export const cells = (of: Flight, topic: string, names: string[], t: number) => names.map((name) => of.latest(topic, name, t));
/** From north-east-down to the picture: x east, y up, z south. */
export const inPicture = ([n, e, d]: number[]) => [e!, -d!, -n!];
export const POSITION = ['pose.position.x', 'pose.position.y', 'pose.position.z'];
export const ATTITUDE = ['pose.orientation.w', 'pose.orientation.x', 'pose.orientation.y', 'pose.orientation.z'];
export const ESTIMATED = ['position[0]', 'position[1]', 'position[2]'];

export function near(is: number[], wanted: number[], tolerance: number, what: string) {
  assert.equal(is.length, wanted.length, what);
  is.forEach((value, k) => assert.ok(Math.abs(value - wanted[k]!) <= tolerance, `${what}: ${is} for ${wanted}`));
}

interface Placed {
  visible: boolean; position: number[]; scale: number[];
  /** Where its -z, the front of a vehicle, and its y, the tip of an arrow, point to. */
  front: number[]; up: number[];
}

export const objectOf = (page: Page, name: string) => page.evaluate((wanted): Placed => {
  const object = window.rosflightScene!.object(wanted)!;
  const along = (x: number, y: number, z: number) => object.position.clone().set(x, y, z).applyQuaternion(object.quaternion).toArray();
  return {visible: object.visible, position: object.position.toArray(), scale: object.scale.toArray(), front: along(0, 0, -1), up: along(0, 1, 0)};
}, name);

/** Points of a line, and how many of its segments are drawn. */
export const lineOf = (page: Page, name: string) => page.evaluate((wanted) => {
  const {geometry} = window.rosflightScene!.object(wanted) as Line2;
  const {instanceStart, instanceEnd} = geometry.attributes;
  const point = (of: typeof instanceStart, k: number) => [of!.getX(k), of!.getY(k), of!.getZ(k)];
  const last = instanceStart!.count - 1;
  return {points: [...Array.from({length: last + 1}, (_, k) => point(instanceStart, k)), point(instanceEnd, last)], drawn: geometry.instanceCount};
}, name);

/** Smallest and largest of each coordinate. */
export const extent = (points: number[][]) => [0, 1, 2].flatMap((k) => [Math.min(...points.map((point) => point[k]!)), Math.max(...points.map((point) => point[k]!))]);

/** Positions of a whole topic in the picture, without those that are not finite. */
export function positions(flight: Flight, topic: string, names: readonly string[]): number[][] {
  const table = flight.tables.get(topic)!;
  return Array.from({length: table.length}, (_, row) => names.map((name) => table.column(name)![row]!)).filter((point) => point.every(Number.isFinite)).map(inPicture);
}

/** Each bar: share that is filled, its number, its use and end points in words, and their marks. */
export const bars = (page: Page) => page.locator('.bar').evaluateAll((all) => all.map((bar) => {
  const [gauge, fill] = [bar.querySelector('.gauge')!, bar.querySelector('.fill')!];
  return {name: bar.getAttribute('aria-label')!, share: fill.getBoundingClientRect().width / gauge.clientWidth,
    value: parseFloat(bar.querySelector('.value')!.textContent!), use: bar.querySelector('.use')?.textContent ?? '',
    ends: [...bar.querySelectorAll('.end')].map((end) => parseFloat((end as HTMLElement).style.left) / 100)};
}));

/** The page of a flight that has landed, to which each message came as it happened, at its last moment. It has no more than 60 of a second. */
export async function showsTheLog(page: Page, flight: Flight) {
  const t = flight.end_s;
  const SEEN_M = 0.4; // of a path, between two messages
  near([await clock(page)], [t], 0.05, 'the last moment');
  for (const [name, topic, names] of [['flown', '/sim/truth_state', POSITION], ['estimate', '/autonomy/estimate', ESTIMATED], ['setpoint', '/trajectory_command', ESTIMATED]] as const) {
    const {points} = await lineOf(page, name);
    assert.ok(points.length > 100, `${name}: ${points.length}`);
    near(extent(points), extent(positions(flight, topic, names)), SEEN_M, name);
  }
  near((await objectOf(page, 'vehicle')).position, inPicture(cells(flight, '/sim/truth_state', POSITION, t)), 0.02, 'vehicle');
  const cloud = await objectOf(page, 'uncertainty');
  near(cloud.position, inPicture(cells(flight, '/autonomy/estimate', ESTIMATED, t)), 0.05, 'estimate');
  const [n, e, d] = cells(flight, '/autonomy/estimate', [0, 1, 2].map((k) => `position_sigma[${k}]`), t);
  near(cloud.scale, [3 * e!, 3 * d!, 3 * n!], 0.02, 'three standard deviations');
  const corners = flight.plans[0]!.points.map((point) => inPicture([...point]));
  near((await lineOf(page, 'plan')).points.flat(), corners.flat(), 1e-4, 'plan');
  for (const [k, place] of corners.entries()) near((await objectOf(page, `waypoint ${k + 1}`)).position, place, 1e-6, `waypoint ${k + 1}`);
  const wind = await objectOf(page, 'wind');
  assert.ok(wind.visible);
  near(wind.up, inPicture([0.5, Math.sqrt(0.75), 0]), 1e-3, 'it comes from 240 degrees');
  assert.equal(await page.locator('.state .badge', {hasText: 'link'}).innerText(), 'link good');
  await page.getByRole('tab', {name: 'Receiver and outputs'}).click();
  for (const {name, value, share} of await bars(page)) {
    const [kind, k] = name.split(' ');
    const truth = kind === 'channel' ? flight.latest('/rc_raw', `values[${k}]`, t) : 100 * flight.latest('/output_raw', `values[${k}]`, t);
    near([value], [truth], 0.5, name);
    near([share], [kind === 'channel' ? (truth - 1000) / 1000 : truth / 100], 0.01, `length of ${name}`);
  }
}
