// SPDX-License-Identifier: BSD-3-Clause
// The page in a browser, as a user has it: served by ./rosflight view, opened with a file, without WebGL.
import assert from 'node:assert/strict';
import {type ChildProcess} from 'node:child_process';
import {readFile} from 'node:fs/promises';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import type {Browser, Page} from 'playwright-core';
import {bytesSource} from '../src/data/bytes.ts';
import {readLog} from '../src/data/read_log.ts';
import {clock, DESKTOP, drawn, flightShown, goTo, keepPicture, LONG, newPage, onPage, PHONE, startBrowser, vehicleIsSeen, vehicleSeen, violations, type PageOptions} from './browser.ts';
import {FIXED_WING, logOf, MULTIROTOR} from './flights.ts';
import {HANDS, KEYBOARD, withoutMouse, type Hand} from './hands.ts';
import {changed} from './picture.ts';
import {view} from './simulated.ts';

const started: ChildProcess[] = [];
let browser: Browser;
let multirotor = '';
let fixedWing = '';

before(async () => {
  browser = await startBrowser();
  [multirotor, fixedWing] = await Promise.all([view(started, MULTIROTOR), view(started, FIXED_WING)]);
});
after(async () => {
  for (const program of started) program.kill('SIGTERM');
  await browser?.close();
});

const flightOf = async (folder: string) => readLog(bytesSource('log', new Uint8Array(await readFile(logOf(folder)))));

const withPage = (url: string, use: (page: Page) => Promise<void>, ...options: PageOptions) => onPage(browser, url, use, ...options);

describe('replay of a flight', () => {
  test('shows the vehicle where it is, also after a seek and in each view', () => withPage(multirotor, async (page) => {
    for (const t of [7, 44, 20]) { // the last one away from the discs of the waypoints, which hide it from afar
      await goTo(page, t);
      await vehicleIsSeen(page, `${t} s`);
    }
    for (const name of ['Whole flight', 'From above', 'From south', 'From east', 'Follow']) {
      await page.getByRole('button', {name}).click();
      await drawn(page);
      await vehicleIsSeen(page, name);
    }
    // Turned by the mouse, it is away from the middle.
    await page.getByRole('button', {name: 'Whole flight'}).click();
    const {x, y, width, height} = (await page.locator('canvas').first().boundingBox())!;
    await page.mouse.move(x + width / 2, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + 0.7 * width, y + 0.6 * height, {steps: 3});
    await page.mouse.up();
    await drawn(page);
    const turned = await vehicleAt(page);
    assert.ok(Math.hypot(turned.x - 0.5, turned.y - 0.5) > 0.05, JSON.stringify(turned));
    await vehicleIsSeen(page, 'turned');
    // A body that is drawn beside the vehicle's place is found.
    await page.evaluate(() => { window.rosflightScene!.object('vehicle')!.children[0]!.position.y += 1; });
    for (const name of ['Follow', 'From east']) {
      await page.getByRole('button', {name}).click();
      await drawn(page);
      const {off_m} = (await vehicleSeen(page))!;
      assert.ok(Math.abs(off_m - 1) < 0.3, `${name}: ${off_m} m`);
    }
  }));

  test('numbers are those of the moment', () => withPage(multirotor, async (page) => {
    await goTo(page, 20);
    const shown = await page.locator('.instruments').innerText();
    assert.match(shown, /height\s*5\.\d m/); // the mission's second leg is at 5 m
    assert.match(shown, /armed/);
    await goTo(page, 1);
    assert.match(await page.locator('.instruments').innerText(), /disarmed/);
  }));

  test('goes by keyboard alone', () => withPage(multirotor, async (page) => {
    await page.keyboard.press('.');
    const one = await clock(page);
    await page.keyboard.press('.');
    assert.ok(await clock(page) > one);
    await page.keyboard.press(',');
    assert.equal(await clock(page), one);
    await page.keyboard.press(' ');
    await page.waitForFunction((from) => parseFloat(document.querySelector('.clock')!.textContent!) > from + 0.2, one);
    await page.keyboard.press(' ');
    const paused = await clock(page);
    await drawn(page);
    assert.equal(await clock(page), paused);
    await slider(page).press('End');
    assert.ok(Math.abs(await clock(page) - Number(await slider(page).getAttribute('max'))) < 0.011);
    await slider(page).press('Home');
    assert.equal(await clock(page), 0);
    await page.getByRole('tab', {name: 'Plots'}).focus();
    await page.keyboard.press('ArrowRight');
    assert.equal(await page.getByRole('tab', {name: 'Events'}).getAttribute('aria-selected'), 'true');
  }));

  test('plays at the speed chosen and stops at the end', () => withPage(multirotor, async (page) => {
    await page.getByLabel('Speed').selectOption('20');
    await page.getByRole('button', {name: 'Play'}).click();
    await page.waitForFunction(() => document.querySelector('.play')!.getAttribute('aria-label') === 'Play', undefined, {timeout: 60_000});
    assert.ok(await clock(page) > 50);
  }));

  test('plots have curves, and any field can be added', () => withPage(multirotor, async (page) => {
    await page.waitForSelector('.plot canvas');
    assert.match(await page.locator('figure', {hasText: 'North'}).first().innerText(), /setpoint/);
    await page.getByLabel('Add a plot of any field').fill('/baro pressure');
    await page.waitForSelector('figure:has-text("/baro pressure") canvas');
    const {x, y, width} = (await page.locator('figure:has-text("/baro pressure") .u-over').boundingBox())!;
    await page.mouse.move(x + 0.2 * width, y + 20);
    await page.mouse.down();
    await page.mouse.move(x + 0.4 * width, y + 20, {steps: 3});
    await page.mouse.up();
    await button(page, 'Show all of it').waitFor();
    await page.mouse.dblclick(x + 0.3 * width, y + 20);
    await button(page, 'Show all of it').waitFor({state: 'detached'});
    await page.getByRole('button', {name: 'remove the plot /baro pressure'}).click();
    assert.equal(await page.locator('figure:has-text("/baro pressure")').count(), 0);
  }));

  test('the mixer is drawn as it stands in the parameters, and each channel has its use', () => withPage(multirotor, async (page) => {
    await page.getByRole('tab', {name: 'Receiver and outputs'}).click();
    await goTo(page, 20);
    const discs = await page.locator('.mixer .motor').evaluateAll((all) => all.map((one) => {
      const [disc, turning] = [...one.querySelectorAll('circle')];
      return [Number(one.getAttribute('data-output')), Math.sign(Number(disc!.getAttribute('cx'))), Math.sign(Number(disc!.getAttribute('cy'))), Number(turning!.getAttribute('r'))];
    }));
    assert.deepEqual(discs.map((one) => one.slice(0, 3)), [[0, 1, -1], [1, 1, 1], [2, -1, 1], [3, -1, -1]], 'front right, rear right, rear left, front left');
    for (const [output, , , radius] of discs) assert.ok(radius! > 5, `motor ${output} turns`);
    const file = await readFile(join(MULTIROTOR, 'parameters.yaml'), 'utf8');
    const share = (row: number, k: number) => Number(new RegExp(`PRI_MIXER_${row}_${k}, type: 9, value: ([-\\d.e]+)`).exec(file)![1]);
    const shares = (await page.locator('.mixer tbody tr').allInnerTexts()).map((text) => text.split('\t').slice(0, 5));
    assert.deepEqual(shares, [0, 1, 2, 3].map((k) => // thrust is upwards, z of the body is downwards
      [`${k} motor`, ...[-share(2, k), share(3, k), share(4, k), share(5, k)].map((value) => value.toFixed(2))]));
    assert.match(await page.locator('.bar', {hasText: 'channel 0'}).innerText(), /roll/);
    assert.match(await page.locator('.bar', {hasText: 'channel 5'}).innerText(), /attitude override, throttle override/);
    await keepPicture(page, 'mixer');
  }));

  test('the mixer of a fixed wing has its servos and no airframe of motors', () => withPage(fixedWing, async (page) => {
    await page.getByRole('tab', {name: 'Receiver and outputs'}).click();
    await goTo(page, 20);
    const [head, ...rows] = (await page.locator('.mixer tr').allInnerTexts()).map((text) => text.split('\t').slice(0, 5));
    assert.deepEqual(head, ['output', 'thrust ahead', 'roll', 'pitch', 'yaw']);
    assert.deepEqual(rows, [['0 servo', '0.00', '1.00', '0.00', '0.00'], ['1 servo', '0.00', '0.00', '-0.50', '0.50'],
      ['2 servo', '0.00', '0.00', '0.50', '0.50'], ['4 motor', '1.00', '0.00', '0.00', '0.00']], 'aileron, both of the inverted V, propeller');
    assert.equal(await page.locator('.mixer svg').count(), 0);
  }));

  test('facts have the verdict and every waypoint', () => withPage(multirotor, async (page) => {
    await page.getByRole('tab', {name: 'Facts'}).click();
    assert.match(await page.locator('.verdict').innerText(), /Success/);
    assert.equal(await page.locator('.facts table').nth(1).locator('tbody tr').count(), 7);
  }));

  test('parameters can be searched', () => withPage(multirotor, async (page) => {
    await page.getByRole('tab', {name: 'Parameters'}).click();
    await goTo(page, 40);
    await page.getByLabel('Search').fill('batt_volt_max');
    assert.equal(await page.locator('.parameters tbody tr').first().innerText(), 'BATT_VOLT_MAX\t25.2\t25', 'name, value, default');
    assert.match(await page.locator('.parameters .about').innerText(), /^V · 0 .. 100 · Voltage of the full battery/);
    await page.getByLabel('Search').fill('');
    await page.getByLabel('Group').selectOption('PID');
    for (const name of await page.locator('.parameters tbody th').allInnerTexts()) assert.match(name, /^PID_/);
    assert.equal(await page.getByLabel('Value of PID_ROLL_RATE_P').count(), 0, 'a log cannot be commanded');
  }));

  test('parameters of a file are compared with those of a flight', () => withPage(multirotor, async (page) => {
    await page.getByRole('tab', {name: 'Parameters'}).click();
    const open = (text: string) => page.getByLabel('Compare with a file')
      .setInputFiles({name: 'mine.yaml', mimeType: 'application/yaml', buffer: Buffer.from(text)});
    await goTo(page, 40);
    await open(await readFile(join(MULTIROTOR, 'parameters.yaml'), 'utf8'));
    await page.getByText('mine.yaml has the same values').waitFor();
    await open('- {name: BATT_VOLT_MAX, type: 9, value: 24.0}\n');
    assert.equal(await page.locator('.differences tbody').innerText(), 'BATT_VOLT_MAX\t25.2\t24');
    const made = (name: string, text: string) => ({name, mimeType: 'application/yaml', buffer: Buffer.from(text)});
    await page.getByLabel('Compare with a file').setInputFiles([made('one.yaml', '- {name: A, type: 6, value: 1}\n- {name: B, type: 6, value: 2}\n- {name: C, type: 6, value: 3}\n'),
      made('two.yaml', '- {name: A, type: 6, value: 1}\n- {name: B, type: 6, value: 5}\n- {name: D, type: 6, value: 4}\n')]);
    await page.getByText('3 differences between one.yaml and two.yaml').waitFor();
    assert.equal(await page.locator('.differences tbody').innerText(), 'B\t2\t5\nD\tno such parameter\t4\nC\t3\tno such parameter');
    await open('{"no": "such file"}');
    await page.getByText('mine.yaml, line 1: found').waitFor();
    const saved = page.waitForEvent('download');
    await page.getByRole('button', {name: 'Save to a file'}).click();
    assert.equal(await readFile(await (await saved).path(), 'utf8'), (await readFile(join(MULTIROTOR, 'parameters.yaml'), 'utf8')).replace(/^#.*\n/, ''));
  }));

  test('of another computer is seen with the whole address alone', async () => {
    const url = await view(started, MULTIROTOR, '--listen', '127.0.0.2');
    const [base, token] = url.split('#') as [string, string];
    assert.match(token, /^[0-9a-f]{32}$/);
    await withPage(url, async (page) => {
      await goTo(page, 20);
      await vehicleIsSeen(page);
    });
    const {page} = await newPage(browser);
    await page.goto(`${base}#${token.replace(/./, (first) => first === '0' ? '1' : '0')}`);
    await page.getByRole('alert').getByText('wants the whole address').waitFor();
    await page.context().close();
  });

  test('a fixed wing flies too, and is seen on the ground', () => withPage(fixedWing, async (page) => {
    await goTo(page, 15);
    await vehicleIsSeen(page);
    await goTo(page, 40);
    await vehicleIsSeen(page);
    assert.ok(parseFloat(/speed\s*([\d.]+) m\/s/.exec(await page.locator('.instruments').innerText())![1]!) > 8);
  }));

  test('surfaces of a fixed wing are deflected as its outputs say, and are seen where they are', () => withPage(fixedWing, async (page) => {
    const wing = await flightOf(FIXED_WING);
    const angles = () => page.evaluate(() => ['right aileron', 'left aileron', 'left tail', 'right tail']
      .map((name) => window.rosflightScene!.object(name)!.rotation.x));
    const command = wing.tables.get('/command')!;
    const roll = command.column('u[3]')!;
    const rightmost = roll.reduce((best, value, row) => value > roll[best]! ? row : best, 0);
    for (const t of [1, 20, command.times[rightmost]!]) {
      await goTo(page, t);
      const moment = Number(await slider(page).inputValue());
      const outputs = [0, 1, 2].map((k) => 2 * wing.latest('/sim/truth_vehicle', `outputs[${k}]`, moment) - 1);
      const travel_rad = 40 * Math.PI / 180; // vehicles/anaconda.yaml
      const wanted = [-outputs[0]!, outputs[0]!, -outputs[1]!, outputs[2]!].map((value) => value * travel_rad);
      (await angles()).forEach((angle, k) => assert.ok(Math.abs(angle - wanted[k]!) < 1e-6, `${moment} s, ${k}: ${angle} for ${wanted[k]}`));
    }
    assert.ok((await angles())[0]! < -0.05, 'rolling right, the right aileron is up');
    const canvas = page.locator('canvas').first();
    const pitch = command.column('u[4]')!;
    await goTo(page, command.times[pitch.reduce((best, value, row) => value > pitch[best]! ? row : best, 0)]!);
    await keepPicture(page, 'fixed-wing', undefined, async () => {
      await page.getByRole('button', {name: 'Follow'}).click();
      await canvas.hover();
      await page.mouse.wheel(0, -600); // closer
    });
    const clip = (await canvas.boundingBox())!;
    for (const name of ['right aileron', 'left tail']) {
      await page.getByRole('button', {name: 'Follow'}).click();
      await drawn(page);
      const before = await page.screenshot({clip});
      const at = await page.evaluate((part) => {
        const hinge = window.rosflightScene!.object(part)!;
        hinge.rotation.x -= 0.6;
        window.rosflightScene!.setView('follow'); // draws again
        return window.rosflightScene!.inPicture(hinge.getWorldPosition(hinge.position.clone()))!;
      }, name);
      await drawn(page);
      const seen = changed(before, await page.screenshot({clip}));
      assert.ok(seen.pixels > 20 && Math.hypot(seen.x - at.x, seen.y - at.y) < 0.05, `${name} at ${at.x}, ${at.y}: ${JSON.stringify(seen)}`);
    }
  }));

  test('rotors turn with their outputs and stand without', () => withPage(multirotor, async (page) => {
    const flight = await flightOf(MULTIROTOR);
    const angles = () => page.evaluate(() => [0, 1, 2, 3].map((k) => window.rosflightScene!.object(`rotor ${k}`)!.rotation.y));
    const turned = async (from: number, to: number) => {
      await goTo(page, from);
      const before = await angles();
      await goTo(page, to);
      return (await angles()).map((angle, k) => angle - before[k]!);
    };
    assert.deepEqual(flight.latest('/sim/truth_vehicle', 'outputs[0]', 4), 0);
    assert.deepEqual(await turned(2, 4), [0, 0, 0, 0]);
    const truth = flight.tables.get('/sim/truth_vehicle')!;
    const moved = await turned(20, 20.5);
    for (const [k, angle] of moved.entries()) {
      const speeds = truth.column(`rotor_speed[${k}]`)!.subarray(truth.rowAt(20), truth.rowAt(20.5));
      const mean = speeds.reduce((sum, speed) => sum + speed, 0) / speeds.length;
      assert.ok(mean > 100 && Math.abs(Math.abs(angle) / (0.05 * 0.5 * mean) - 1) < 0.01, `rotor ${k}: ${angle} rad at ${mean} rad/s, a twentieth of it shown`);
    }
    assert.deepEqual(moved.map(Math.sign), [1, -1, 1, -1]);
  }));
});

const button = (page: Page, name: string | RegExp) => page.getByRole('button', {name, exact: typeof name === 'string'});
const tab = (page: Page, name: string) => page.getByRole('tab', {name});
const slider = (page: Page) => page.getByLabel('Time in the flight');
const vehicleAt = (page: Page) => page.evaluate(() => window.rosflightScene!.vehicleInPicture()!);

/** What a person can do with a flight that was, without a mouse; in this order on one page. */
const POINTS: Record<string, (page: Page, hand: Hand) => Promise<void>> = {
  'moments: slider, steps, play, speed': async (page, hand) => {
    await hand.slide(slider(page));
    const slid = await clock(page);
    assert.ok(slid > 1, `${slid}`);
    await hand.press(button(page, 'One step on'));
    assert.ok(await clock(page) > slid);
    await hand.press(button(page, 'One step back'));
    assert.equal(await clock(page), slid);
    await hand.choose(page.getByLabel('Speed'), '5');
    await hand.press(button(page, 'Play'));
    await page.waitForFunction((from) => parseFloat(document.querySelector('.clock')!.textContent!) > from + 1, slid);
    await hand.press(button(page, 'Pause'));
  },
  'camera: other views, turned': async (page, hand) => {
    await hand.press(button(page, 'Whole flight'));
    await drawn(page);
    const before = await vehicleAt(page);
    await hand.turn(page.locator('canvas').first());
    const after = await vehicleAt(page);
    assert.ok(Math.hypot(after.x - before.x, after.y - before.y) > 0.005, `${after.x}, ${after.y}`);
    await hand.press(button(page, 'Follow'));
    await drawn(page);
    assert.ok(await vehicleAt(page));
  },
  'plots: a field added, zoom': async (page, hand) => {
    await hand.type(page.getByLabel('Add a plot of any field'), '/baro pressure');
    await page.waitForSelector('figure:has-text("/baro pressure") canvas');
    /** The moment shown is there, as a share of the width of the plot. */
    const markedAt = (share: number) => page.waitForFunction((wanted) => {
      const marker = document.querySelector('.plots figure .now')!;
      return Math.abs(new DOMMatrix(getComputedStyle(marker).transform).e / marker.parentElement!.clientWidth - wanted) < 0.02;
    }, share);
    const whole = await clock(page) / Number(await slider(page).getAttribute('max'));
    assert.ok(Math.abs(whole - 0.5) > 0.04, `${whole}`);
    await markedAt(whole);
    for (let k = 0; k < 5; ++k) await hand.press(button(page, 'Zoom in'));
    await markedAt(0.5);
    await hand.press(button(page, 'Show all of it'));
    await markedAt(whole);
    await hand.press(button(page, 'remove the plot /baro pressure'));
  },
  'events: one leads to its moment': async (page, hand) => {
    await hand.press(tab(page, 'Events'));
    const row = page.locator('.events tr', {hasText: /land/i}).first();
    await hand.press(row.getByRole('button'));
    assert.equal(await clock(page), parseFloat(await row.locator('td').first().innerText()));
    assert.equal(await row.getAttribute('aria-current'), 'time');
  },
  'preflight: the checks before arming': async (page, hand) => {
    await hand.slide(slider(page));
    await hand.press(tab(page, 'Preflight'));
    assert.match(await page.locator('.preflight .verdict').innerText(), /armed/);
    assert.ok(await page.locator('.preflight .checks tbody tr').count() > 5);
  },
  'receiver and outputs: channels and mixer': async (page, hand) => {
    await hand.press(tab(page, 'Receiver and outputs'));
    await page.locator('.mixer svg').scrollIntoViewIfNeeded();
    assert.equal(await page.locator('.mixer .motor').count(), 4);
  },
  'parameters: search, group, file, save': async (page, hand) => {
    await hand.press(tab(page, 'Parameters'));
    await hand.choose(page.getByLabel('Group'), 'BATT');
    await hand.press(page.getByLabel('only those that differ from the default'));
    await hand.type(page.getByLabel('Search'), 'volt_max');
    assert.deepEqual(await page.locator('.parameters tbody th').allInnerTexts(), ['BATT_VOLT_MAX']);
    await hand.give(page.locator('label', {hasText: 'Compare with a file'}), {name: 'mine.yaml', mimeType: 'application/yaml',
      buffer: Buffer.from('- {name: BATT_VOLT_MAX, type: 9, value: 24.0}\n')});
    await page.getByText('1 difference from mine.yaml').waitFor();
    const saved = page.waitForEvent('download');
    await hand.press(button(page, 'Save to a file'));
    assert.equal((await saved).suggestedFilename(), 'parameters.yaml');
  },
  'tune: an axis and its band': async (page, hand) => {
    await hand.press(tab(page, 'Tune'));
    await hand.choose(page.getByLabel('Axis'), 'Pitch');
    await hand.choose(page.getByLabel('Band'), '2 %');
    await hand.choose(page.getByLabel('Axis'), 'Altitude');
    await page.getByText('No step of altitude in this flight yet.').waitFor();
  },
};

for (const hand of HANDS) {
  test(`a flight is looked at ${hand.name}`, {skip: hand === KEYBOARD || LONG ? false : './rosflight test web-rest runs it'}, (t) => withPage(multirotor, async (page) => {
    const check = await withoutMouse(page);
    for (const [point, act] of Object.entries(POINTS)) await t.test(point, () => act(page, hand));
    await check();
  }, ...hand.options));
}

describe('what may go wrong', () => {
  async function openFile(page: Page, name: string, buffer: Buffer) {
    await page.locator('input[type=file]').setInputFiles({name, mimeType: 'application/octet-stream', buffer});
  }

  test('a file of the user replaces the flight; one that is no log is refused with a line', () => withPage(multirotor, async (page) => {
    const log = await readFile(logOf(FIXED_WING));
    await openFile(page, 'mine.mcap', log.subarray(0, log.length / 2));
    await page.waitForSelector('text=/The log has no end: it was read as far as it goes/');
    assert.match(await page.locator('h1').innerText(), /flies/);
    await openFile(page, 'notes.txt', Buffer.from('no log'));
    assert.equal(await page.getByRole('alert').innerText(), 'notes.txt: is no MCAP file');
    // The same by a drop.
    await page.evaluate(async (address) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([await (await fetch(address)).arrayBuffer()], 'dropped.mcap'));
      document.querySelector('header')!.dispatchEvent(new DragEvent('drop', {dataTransfer, bubbles: true, cancelable: true}));
    }, 'flight/flight.mcap'); // which the server has of the other flight
    await flightShown(page);
    assert.equal(await page.getByRole('alert').count(), 0);
  }));

  test('without WebGL all but the 3-D view works', async () => {
    const plain = await startBrowser(['--disable-3d-apis']);
    try {
      const {page, complaints} = await newPage(plain);
      await page.goto(multirotor);
      await page.waitForSelector('text=This browser has no WebGL');
      await goTo(page, 20);
      assert.match(await page.locator('.instruments').innerText(), /height\s*5\.\d m/);
      await page.waitForSelector('.plot canvas');
      const contents: Record<string, string> = {'Plots': '.plot canvas', 'Events': '.events tr', 'Preflight': '.preflight .checks tr', 'Receiver and outputs': '.mixer .motor',
        'Firmware': '#panel table tr', 'Facts': '.facts tr', 'Parameters': '.parameters tbody tr', 'Tune': '.tune select'};
      const tabs = await page.getByRole('tab').all();
      assert.deepEqual(await Promise.all(tabs.map((one) => one.innerText())), Object.keys(contents));
      for (const one of tabs) {
        await one.click();
        await page.locator(contents[await one.innerText()]!).first().waitFor();
      }
      const others = complaints.filter((one) => !/WebGL/.test(one)); // what three.js says of it
      assert.deepEqual(others, []);
    } finally {
      await plain.close();
    }
  });
});

describe('for everybody', () => {
  test('the button turns light into dark and back, the picture too', () => withPage(multirotor, async (page) => {
    /** Sum of red, green and blue: of the page, and of the sky in the picture. */
    const brightness = () => page.evaluate(() => {
      const sum = (numbers: Iterable<number>) => [...numbers].slice(0, 3).reduce((all, one) => all + one, 0);
      const gl = document.querySelector('canvas')!.getContext('webgl2')!;
      const corner = new Uint8Array(4);
      gl.readPixels(0, gl.drawingBufferHeight - 1, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, corner);
      return [sum(getComputedStyle(document.body).backgroundColor.match(/\d+/g)!.map(Number)), sum(corner)];
    });
    await button(page, 'From south').click(); // above the horizon there is the sky
    for (const dark of [true, false]) {
      await button(page, 'Light or dark').click();
      await drawn(page);
      for (const one of await brightness()) assert.ok(dark ? one < 200 : one > 600, `${one}, dark: ${dark}`);
    }
  }));

  for (const [name, viewport, scheme] of [['desktop', DESKTOP, 'light'], ['dark', DESKTOP, 'dark'], ['phone', PHONE, 'light']] as const) {
    test(`axe finds nothing, ${name}`, () => withPage(multirotor, async (page) => {
      await goTo(page, 20);
      for (const tab of await page.getByRole('tab').all()) {
        await tab.click();
        await drawn(page);
        assert.deepEqual(await violations(page), [], await tab.innerText());
        if (name === 'desktop') await keepPicture(page, `view-${(await tab.innerText()).toLowerCase().replaceAll(' ', '-')}`);
      }
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `${wide} pixels wider than the window`);
    }, viewport, {...(scheme === 'dark' ? {colorScheme: scheme} : {})}));
  }
});
