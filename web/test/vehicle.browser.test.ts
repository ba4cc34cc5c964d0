// SPDX-License-Identifier: BSD-3-Clause
// A vehicle on a link: ./rosflight view udp:PORT against the firmware as a process (./rosflight sil). All bytes go through this test,
// which cuts the link and reads the firmware's own outputs.
import assert from 'node:assert/strict';
import {spawn, type ChildProcess} from 'node:child_process';
import {createSocket, type Socket} from 'node:dgram';
import {mkdtemp, readFile, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import type {Browser, Page} from 'playwright-core';
import {bytesSource} from '../src/data/bytes.ts';
import {checksAt} from '../src/data/checks.ts';
import {readLog} from '../src/data/read_log.ts';
import {DESKTOP, drawnForNobody, fitsPhone, keepPicture, onPage, PHONE, SMALL, startBrowser, violations, type PageOptions} from './browser.ts';
import {MULTIROTOR, PARAMETERS, SIL, VIEW} from './flights.ts';
import {finger, KEYBOARD, reach, TOUCH} from './hands.ts';
import {start} from './simulated.ts';

const started: ChildProcess[] = [];
const sockets: Socket[] = [];
let browser: Browser;
let scratch = '';
let count = 0;

before(async () => {
  browser = await startBrowser();
  scratch = await mkdtemp(join(tmpdir(), 'rosflight_vehicle_'));
});
after(async () => {
  for (const program of started) program.kill('SIGKILL');
  for (const socket of sockets) socket.close();
  await browser?.close();
  await rm(scratch, {recursive: true});
});

const bound = async () => {
  const socket = createSocket('udp4');
  sockets.push(socket);
  await new Promise<void>((resolve) => socket.bind(0, '127.0.0.1', resolve));
  return socket;
};

const TIMESYNC = 111; // link/mavlink/rosflight.xml: i64 clock of who answers [ns], i64 clock of who asks [ns]
const OUTPUT_RAW = 190; // u64 stamp [ms], 14 floats
const MOTOR_TEST = 236; // float value, u8 system, u8 motor
const HEAD = 6; // of a frame of MAVLink 1

/** Frames of MAVLink 1 in a datagram. */
function* frames(data: Buffer) {
  for (let at = 0; at + HEAD < data.length && data[at] === 0xfe; at += data[at + 1]! + HEAD + 2) {
    yield {id: data[at + 5]!, all: data.subarray(at, at + data[at + 1]! + HEAD + 2), payload: data.subarray(at + HEAD)};
  }
}

/** The firmware's outputs by its own clock, which a busy machine does not shift. */
class Outputs {
  largest = NaN;
  /** Stamp of the newest frame, and of the last above 0 [s]. */
  newest_s = -Infinity;
  turning_s = -Infinity;
  /** When the last request that turns a motor came to the firmware [s]. */
  asked_s = -Infinity;
  private sync: Buffer | undefined;
  private answered: bigint | undefined;

  /** @returns what goes on to the program. The second answer to one question is of this test. */
  fromFirmware(data: Buffer): Buffer {
    return Buffer.concat([...frames(data)].flatMap(({id, payload, all}) => {
      if (id === OUTPUT_RAW) this.read(payload);
      if (id !== TIMESYNC) return [all];
      const question = payload.readBigInt64LE(8);
      if (question !== this.answered) {
        this.answered = question;
        return [all];
      }
      this.asked_s = Number(payload.readBigInt64LE(0)) / 1e9;
      return [];
    }));
  }

  /** @returns what goes on to the firmware: behind each request that turns a motor the last question for its clock, once more. */
  toFirmware(data: Buffer): Buffer {
    return Buffer.concat([...frames(data)].flatMap(({id, payload, all}) => {
      if (id === TIMESYNC) this.sync = Buffer.from(all);
      return id === MOTOR_TEST && payload.readFloatLE(0) > 0 && this.sync ? [all, this.sync] : [all];
    }));
  }

  private read(payload: Buffer) {
    this.newest_s = Number(payload.readBigUInt64LE(0)) / 1000;
    this.largest = Math.max(...Array.from({length: 14}, (_, k) => payload.readFloatLE(8 + 4 * k)));
    if (this.largest > 0) this.turning_s = this.newest_s;
  }
}

/** Firmware, its link through this test, and the program that shows it. */
async function vehicle(memory?: string) {
  const folder = join(scratch, String(++count));
  const [inner, outer] = [await bound(), await bound()];
  const free = await bound();
  const port = free.address().port;
  await new Promise<void>((resolve) => free.close(resolve));
  sockets.splice(sockets.indexOf(free), 1);
  const sil = spawn(SIL, ['sil', '--link', `udp:127.0.0.1:${inner.address().port}`, '--listen', '0', '--nvm', memory ?? join(scratch, `${count}.nvm`)],
    {stdio: ['ignore', 'pipe', 'inherit']});
  started.push(sil);
  const outputs = new Outputs();
  const link = {cut: false};
  let board: {port: number; address: string} | undefined;
  inner.on('message', (data, from) => {
    board = from;
    const passed = outputs.fromFirmware(data);
    if (!link.cut && passed.length > 0) outer.send(passed, port, '127.0.0.1');
  });
  outer.on('message', (data) => { if (board && !link.cut) inner.send(outputs.toFirmware(data), board.port, board.address); });
  const show = async (...options: string[]) => {
    const {child, found} = await start(started, VIEW, ['view', `udp:${port}`, ...options], /http:\S+/);
    return {view: child, url: found[0]};
  };
  return {...await show('--out', folder), show, sil, folder, outputs, link};
}

const withPage = (url: string, use: (page: Page) => Promise<void>, ...options: PageOptions) => onPage(browser, url, use, ...options);
const until = async (what: () => boolean, limit_ms = 20_000) => {
  for (const began_ms = performance.now(); !what();) {
    assert.ok(performance.now() - began_ms < limit_ms, String(what));
    await new Promise((resolve) => setTimeout(resolve, 5));
  }
};

/** Gives the firmware the parameters of a flight, calibrated, from the page. */
async function setUp(page: Page) {
  await page.getByRole('tab', {name: 'Parameters'}).click();
  await page.getByText(new RegExp(`^${PARAMETERS} of ${PARAMETERS}$`)).waitFor(); // the whole list
  await page.getByRole('button', {name: 'Take control'}).click();
  await page.getByText('You have control').first().waitFor();
  await page.getByLabel('Compare with a file').setInputFiles(join(MULTIROTOR, 'parameters.yaml'));
  await page.getByRole('button', {name: /Send \d+ from the file/}).click();
  await page.getByText(/^\d+ of \d+ in force/).waitFor();
}

async function hold(page: Page, outputs: Outputs) {
  await page.getByRole('tab', {name: 'Preflight'}).click();
  await page.getByLabel('No propeller is mounted').check();
  const button = page.getByRole('button', {name: 'Hold to turn the motor'});
  await button.hover();
  await page.mouse.down();
  await until(() => outputs.largest > 0.09);
  return button;
}

/** Processes of the browser's pages. */
async function pageProcesses(): Promise<number[]> {
  const session = await browser.newBrowserCDPSession();
  const {processInfo} = await session.send('SystemInfo.getProcessInfo');
  await session.detach();
  const pages = processInfo.filter(({type}) => type === 'renderer').map(({id}) => id);
  assert.ok(pages.length > 0);
  return pages;
}

/** By the firmware's clock, from the last request that came to it until an output was above 0 for the last time [s]. Nobody sends
 * requests on, or this waits in vain. */
async function stopsAfter(outputs: Outputs) {
  const from_s = outputs.newest_s;
  await until(() => outputs.newest_s > Math.max(from_s, outputs.asked_s) + 0.8);
  assert.equal(outputs.largest, 0);
  return outputs.turning_s - outputs.asked_s;
}
const LIMIT_S = 0.35;

describe('a vehicle on a link', () => {
  test('is looked at; who takes control sets parameters, and nothing arms it', {timeout: 200_000}, async () => {
    const {url, view, folder} = await vehicle();
    await withPage(url, async (page) => {
      await drawnForNobody(page);
      await page.waitForSelector('.instruments:has-text("disarmed")');
      assert.match(await page.locator('.instruments').innerText(), /height\s*–/);
      assert.equal(await page.getByRole('tab', {name: 'Simulation'}).count(), 0);
      await page.getByRole('tab', {name: 'Preflight'}).click();
      await page.locator('.preflight tr', {hasText: 'mixer'}).first().getByText('✗ refuses').waitFor();
      assert.ok(await page.getByRole('button', {name: 'Hold to turn the motor'}).isDisabled());
      await page.getByRole('tab', {name: 'Parameters'}).click();
      assert.equal(await page.getByLabel('Value of PRIMARY_MIXER').count(), 0, 'read-only at start');
      await setUp(page);
      await keepPicture(page, 'vehicle', DESKTOP);
      await page.getByRole('tab', {name: 'Preflight'}).click();
      for (const [name, figure] of [['gyro', /✓ standard deviation [\d.e-]+ rad\/s, limit 0.05 rad\/s; offset left [\d.e-]+ rad\/s, limit 0.01/],
        ['barometer', /✓ noise [\d.]+ Pa, limit 5 Pa/], ['accelerometer', /✓ standard deviation .*; tilt [\d.e-]+ deg, limit 0.5 deg; residual against g/]] as const) {
        const row = page.locator('.calibrations tr', {has: page.getByRole('button', {name: `Calibrate ${name}`})});
        await KEYBOARD.press(row.getByRole('button'));
        await row.getByText(figure).waitFor();
      }
      await keepPicture(page, 'calibrations', DESKTOP);
      await fitsPhone(page);
      // What the page cannot do by hand is refused too.
      const refused = await page.evaluate(async () => {
        const socket = new WebSocket(location.href.replace(/^http/, 'ws'), ['foxglove.websocket.v1']);
        await new Promise((resolve) => { socket.onopen = resolve; });
        const answer = new Promise<string>((resolve) => {
          socket.onmessage = ({data}) => { if (typeof data === 'string' && data.includes('"id":"arm"')) resolve(data); };
        });
        socket.send(JSON.stringify({op: 'takeControl'}));
        socket.send(JSON.stringify({op: 'steer', text: 'switch arm on', id: 'arm'}));
        const text = await answer;
        socket.close();
        return text;
      });
      assert.match(refused, /a real vehicle cannot be steered from here/);
      await page.getByText('Nobody has control').waitFor();
    }, SMALL);
    view.kill('SIGINT');
    assert.equal(await new Promise((resolve) => view.on('exit', resolve)), 0);
    const flight = await readLog(bytesSource('log', new Uint8Array(await readFile(join(folder, 'flight.mcap')))));
    const stored = JSON.parse(await readFile(join(folder, 'preflight.json'), 'utf8')) as {ready: boolean; checks: {row: string; verdict: string; reason: string; time_s: number}[]};
    assert.equal(stored.ready, false); // of the start, when it had no mixer yet
    assert.deepEqual(stored.checks.map(({row}) => row), checksAt(flight, Infinity)!.lines.map(({name}) => name));
    assert.deepEqual({...stored.checks[0], time_s: 0}, {time_s: 0, row: 'mixer', verdict: 'refuses', reason: 'invalid mixer'});
    assert.ok(stored.checks.every(({time_s}) => time_s >= 0 && time_s < flight.end_s));
    const said = flight.events.filter(({source}) => source === 'viewer').map(({text}) => text);
    assert.equal(said[0], 'viewer 1 takes control');
    assert.match(said[1]!, /^viewer 1 sets .*PRIMARY_MIXER/);
    assert.deepEqual(said.slice(2), ['viewer 1 calibrates gyro', 'viewer 1 calibrates baro', 'viewer 1 calibrates accel',
      'viewer 2 takes control from viewer 1',
      'viewer 2 is refused: steers: switch arm on: a real vehicle cannot be steered from here', 'viewer 2 is gone']);
    assert.ok(flight.tables.get('/link/param_set')!.text('name')!.includes('PRIMARY_MIXER'));
  });

  test('a motor turns while the button is held; 0 within 0.35 s of its release (mouse, key, finger), a cut link, a hidden page, a frozen page, a killed server', {timeout: 200_000}, async () => {
    const {url, view, show, outputs, link} = await vehicle();
    const {page, context} = await (async () => {
      const context = await browser.newContext({viewport: SMALL, locale: 'en-US'});
      return {context, page: await context.newPage()};
    })();
    await page.goto(url);
    await page.waitForSelector('.instruments:has-text("disarmed")');
    await drawnForNobody(page);
    await setUp(page);
    // The pilot's throttle is low and the vehicle rests: the state before arming.
    await page.getByRole('tab', {name: 'Preflight'}).click();
    await page.getByRole('button', {name: 'Check now'}).click();
    await page.getByText('All checks of the firmware').waitFor();
    const button = await hold(page, outputs);
    const began_s = outputs.newest_s;
    assert.match(await button.getAttribute('class') ?? '', /held/);
    // One request turns it for 0.3 s. A busy machine may leave a gap between two of the page's requests, and then it rests in between.
    await until(() => outputs.turning_s > began_s + 1.5 && Math.abs(outputs.largest - 0.1) < 1e-6);
    await page.getByText('output 0: 0.10').waitFor();
    assert.deepEqual(await violations(page), []);
    await keepPicture(page, 'motor-test', DESKTOP, async () => {
      await page.mouse.up();
      await hold(page, outputs);
      await page.getByText('output 0: 0.10').waitFor();
    });
    await page.mouse.up();
    await until(() => outputs.largest === 0);

    const took: Record<string, number> = {};
    const measure = async (name: string, stop: () => Promise<number>) => { took[name] = await stop(); };
    await measure('release', async () => {
      await hold(page, outputs);
      await page.mouse.up();
      return stopsAfter(outputs);
    });
    await measure('key', async () => {
      await KEYBOARD.press(page.getByLabel('No propeller is mounted')); // twice: unmarked and marked again
      await KEYBOARD.press(page.getByLabel('No propeller is mounted'));
      await reach(button);
      await page.keyboard.down(' ');
      await until(() => outputs.largest > 0.09);
      await page.keyboard.up(' ');
      return stopsAfter(outputs);
    });
    await page.setViewportSize(PHONE);
    await button.scrollIntoViewIfNeeded();
    const place = (await button.boundingBox())!;
    const lifted = await finger(page, place.x + 20, place.y + 10);
    await until(() => outputs.largest > 0.09);
    assert.deepEqual(await violations(page), [], 'held on a phone');
    await lifted();
    await until(() => outputs.largest === 0);
    await measure('finger', async () => {
      await button.scrollIntoViewIfNeeded();
      const {x, y} = (await button.boundingBox())!;
      const lift = await finger(page, x + 20, y + 10);
      await until(() => outputs.largest > 0.09);
      await lift();
      return stopsAfter(outputs);
    });
    await page.setViewportSize(SMALL);
    await measure('cut', async () => {
      await hold(page, outputs);
      link.cut = true;
      const s = await stopsAfter(outputs);
      link.cut = false;
      await page.mouse.up();
      await page.waitForTimeout(500);
      return s;
    });
    await measure('hidden', async () => {
      await hold(page, outputs);
      await page.evaluate(() => {
        Object.defineProperty(document, 'hidden', {value: true, configurable: true});
        document.dispatchEvent(new Event('visibilitychange'));
      });
      const s = await stopsAfter(outputs);
      await page.evaluate(() => Object.defineProperty(document, 'hidden', {value: false, configurable: true}));
      await page.mouse.up();
      return s;
    });
    await page.setViewportSize(PHONE);
    await measure('frozen', async () => { // as by a phone that is locked: the page gets no event, its process no time
      await button.scrollIntoViewIfNeeded();
      const {x, y} = (await button.boundingBox())!;
      const lift = await finger(page, x + 20, y + 10);
      await until(() => outputs.largest > 0.09);
      const pages = await pageProcesses();
      for (const id of pages) process.kill(id, 'SIGSTOP');
      const s = await stopsAfter(outputs).finally(() => pages.forEach((id) => process.kill(id, 'SIGCONT')));
      await lift();
      return s;
    });
    await page.setViewportSize(SMALL);
    await hold(page, outputs);
    view.kill('SIGKILL');
    took['killed'] = await stopsAfter(outputs);
    console.log(`web.motor_stop_s ${Object.entries(took).map(([name, s]) => `${name} ${s.toFixed(3)}`).join(', ')}`);
    for (const [name, s] of Object.entries(took)) assert.ok(s < LIMIT_S, `${name}: ${s} s`);
    // The page says that the program is gone; when it is back, nobody has control.
    await page.getByText('The connection to the flight is lost').waitFor();
    assert.equal(await page.getByRole('button', {name: /Take control|Hold to turn/}).count(), 0);
    await show('--out', join(scratch, String(++count)), '--port', new URL(url).port);
    await page.getByText('Nobody has control').waitFor();
    await page.getByText('The connection to the flight is lost').waitFor({state: 'detached'});
    assert.ok(await button.isDisabled());
    await context.close();
  });

  test('with damaged memory refuses to arm until the parameters are written', {timeout: 120_000}, async () => {
    const memory = join(scratch, 'damaged.nvm');
    await writeFile(memory, Buffer.alloc(64, 0x5a));
    const {url} = await vehicle(memory);
    await withPage(url, async (page) => {
      await drawnForNobody(page);
      const row = page.locator('.preflight tr', {has: page.getByRole('rowheader', {name: 'storage', exact: true})});
      await page.getByRole('tab', {name: 'Preflight'}).click();
      await row.getByText('✗ refuses').waitFor();
      assert.match(await row.innerText(), /stored parameters damaged\. Check the parameters, then write them to memory\./);
      await page.getByRole('tab', {name: 'Parameters'}).click();
      await page.getByText(new RegExp(`^${PARAMETERS} of ${PARAMETERS}$`)).waitFor();
      await page.getByRole('button', {name: 'Take control'}).click();
      await page.getByRole('button', {name: 'Write to memory'}).click();
      await page.getByText('writing parameters: done').waitFor();
      await page.getByRole('tab', {name: 'Preflight'}).click();
      await page.getByRole('button', {name: 'Check now'}).click();
      await row.getByText('✓ pass').waitFor();
    }, SMALL);
  });

  test('is seen and calibrated by a phone in the dark', {timeout: 240_000}, async () => {
    const {url} = await vehicle();
    await withPage(url, async (page) => {
      await page.waitForSelector('.instruments:has-text("disarmed")');
      await page.getByRole('tab', {name: 'Preflight'}).click();
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, 'vehicle-phone-dark');
      await TOUCH.press(page.getByRole('tab', {name: 'Parameters'}));
      await page.getByText(new RegExp(`^${PARAMETERS} of ${PARAMETERS}$`)).waitFor();
      await TOUCH.press(page.getByRole('tab', {name: 'Preflight'}));
      await TOUCH.press(page.getByRole('button', {name: 'Take control'}));
      await TOUCH.press(page.getByRole('button', {name: 'Calibrate gyro'}));
      await page.getByText(/✓ standard deviation [\d.e-]+ rad/).waitFor();
    }, PHONE, {colorScheme: 'dark', hasTouch: true});
  });
});
