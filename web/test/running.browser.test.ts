// SPDX-License-Identifier: BSD-3-Clause
// The page of a flight that runs, ./rosflight fly --view: seen, checked, changed and steered.
import assert from 'node:assert/strict';
import {spawn, spawnSync, type ChildProcess} from 'node:child_process';
import {mkdtemp, readFile, rm} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, describe, test} from 'node:test';
import type {Browser, Page} from 'playwright-core';
import {bytesSource} from '../src/data/bytes.ts';
import {readLog} from '../src/data/read_log.ts';
import {clock, DESKTOP, drawnForNobody, fitsPhone, flightShown, goTo, keepPicture, LONG, newPage, onPage, PHONE, shownOnFailure, SMALL, startBrowser, vehicleIsSeen, violations, type PageOptions} from './browser.ts';
import {CHANGES} from './changes.ts';
import {showsTheLog} from './contents.ts';
import {FLY, logOf, MULTIROTOR, VIEW} from './flights.ts';
import {HANDS, KEYBOARD, reach, withoutMouse} from './hands.ts';
import {ADDRESS, until, viewer} from './simulated.ts';

const started: ChildProcess[] = [];
let browser: Browser;

before(async () => { browser = await startBrowser(); });
after(async () => {
  for (const program of started) program.kill('SIGTERM');
  await browser?.close();
});

/** The second address that --listen prints. */
const ONE_TO_LOOK = /^(http:\S+) +\(without the right to command\)$/m;

const withPage = (url: string, use: (page: Page) => Promise<void>, ...options: PageOptions) => onPage(browser, url, use, ...options);

describe('a running flight', () => {
  /** @returns the address that ./rosflight fly --view prints on standard error. */
  async function flyAndView(...options: string[]) {
    const folder = await mkdtemp(join(tmpdir(), 'rosflight_page_'));
    const program = spawn(VIEW, ['fly', '--view', '--mission', 'hop', '--out', join(folder, 'flight'), ...options],
      {stdio: ['ignore', 'pipe', 'pipe']});
    started.push(program);
    let said = '';
    let printed = '';
    program.stdout.on('data', (data) => { printed += String(data); });
    const url = await new Promise<string>((resolve) => program.stderr.on('data', (data) => {
      said += String(data);
      const found = ADDRESS.exec(said);
      if (found) resolve(found[1]!);
    }));
    return {url, program, folder, ended: () => /has ended/.test(said), printed: () => printed, said: () => said};
  }

  /** Another viewer takes control and steers. @returns its connection. */
  async function steered(url: string, ...texts: string[]) {
    const {socket, commands, steer} = await viewer(url);
    await commands.takeControl();
    for (const text of texts) {
      const {good, text: said} = await steer(text);
      assert.ok(good || said === 'the flight has ended', said); // on a busy machine
    }
    return socket;
  }

  test('is seen as it happens, can be looked back on, and stays after landing', async () => {
    const {url, program, folder, ended, printed} = await flyAndView('--speed', '0.5', '--wind', '3,240');
    await withPage(url, async (page) => {
      await page.waitForFunction(() => parseFloat(document.querySelector('.clock')!.textContent!) > 3);
      assert.equal(printed(), '', 'nothing on standard output before the landing');
      await page.waitForFunction(() => document.querySelector('.instruments')!.textContent!.includes('armed')
        && !document.querySelector('.instruments')!.textContent!.includes('disarmed'), );
      const before = await clock(page);
      await page.waitForFunction((from) => parseFloat(document.querySelector('.clock')!.textContent!) > from + 1, before);
      await vehicleIsSeen(page);
      await page.waitForSelector('.plot canvas');
      await page.getByLabel('Add a plot of any field').fill('/baro pressure'); // a topic that began after the page
      await page.waitForSelector('figure:has-text("/baro pressure") canvas');
      await page.getByRole('button', {name: 'remove the plot /baro pressure'}).click();
      await keepPicture(page, 'live');
      await goTo(page, 2);
      assert.equal(await clock(page), 2);
      assert.match(await page.locator('.instruments').innerText(), /disarmed/);
      await page.getByRole('button', {name: 'live'}).click();
      await page.waitForFunction(() => parseFloat(document.querySelector('.clock')!.textContent!) > 6);
      const other = await steered(url, 'speed 2');
      while (!ended()) await page.waitForTimeout(100);
      assert.match(printed(), /^All waypoints passed within 2 m, landed and disarmed\.\n[^]*^flight folder /m);
      await page.getByRole('tab', {name: 'Events'}).click();
      await page.waitForSelector('.events tr:has-text("land")');
      await page.waitForSelector('.instruments:has-text("disarmed")');
      await showsTheLog(page, await readLog(bytesSource('log', new Uint8Array(await readFile(logOf(join(folder, 'flight')))))));
      other.close();
    }, SMALL);
    program.kill('SIGTERM');
    await rm(folder, {recursive: true});
  });

  test('says what keeps it from arming, and what to do about it', async () => {
    const {url, program, folder} = await flyAndView('--speed', '0.1', '--hold'); // not calibrated for 50 s
    await withPage(url, async (page) => {
      await drawnForNobody(page);
      const result = (check: string) => page.locator('.preflight tr', {has: page.getByRole('rowheader', {name: check, exact: true})});
      await page.getByRole('tab', {name: 'Preflight'}).click();
      await result('calibration').getByText('✗ refuses').waitFor(); // by the flags of the status
      assert.match(await result('calibration').innerText(), /calibrate the gyro: in Preflight of the vehicle take control, then press Calibrate beside Gyro\./);
      await page.locator('.calibrations tr', {hasText: 'Gyro'}).getByText('Calibrate', {exact: true}).waitFor();
      await KEYBOARD.press(page.getByRole('button', {name: 'Check now'}));
      await page.getByText('All checks of the firmware').waitFor();
      const table = await readFile(new URL('../../firmware/core/arming_checks.hpp', import.meta.url), 'utf8');
      const names = [...table.matchAll(/\{Check::k\w+, +"([^"]+)"/g)].map(([, name]) => name!);
      assert.deepEqual(await page.locator('.preflight .checks th[scope=row]').allInnerTexts(), names);
      assert.match(await result('calibration').innerText(), /IMU not calibrated\. .*calibrate the gyro/);
      assert.match(await page.locator('.preflight .verdict').innerText(), /Arming is refused for \d+ reason/);
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, 'preflight', DESKTOP);
      const other = await steered(url, 'speed 4');
      await result('calibration').getByText('✓ pass').waitFor(); // by the flags, without asking again
      // What the list advises.
      await KEYBOARD.press(page.getByRole('button', {name: 'Take over control'}));
      for (const [name, figure] of [['gyro', /✓ standard deviation [\d.e-]+ rad\/s, limit 0.05 rad\/s/], ['airspeed', /✓ noise [\d.]+ Pa, limit 10 Pa/]] as const) {
        const row = page.locator('.calibrations tr', {has: page.getByRole('button', {name: `Calibrate ${name}`})});
        await KEYBOARD.press(row.getByRole('button'));
        await row.getByText(figure).waitFor();
      }
      const another = await steered(url, 'hold off');
      await page.getByText('The vehicle is armed.').waitFor();
      for (const socket of [other, another]) socket.close();
    }, SMALL);
    program.kill('SIGKILL');
    await rm(folder, {recursive: true});
  });

  test('has its parameters changed from the page, and each change says how it ended', async () => {
    const {url, program, folder} = await flyAndView('--speed', '2', '--hold');
    await withPage(url, async (page) => {
      await drawnForNobody(page);
      const said = page.locator('.said');
      const until = (s: number) => page.waitForFunction((t) => parseFloat(document.querySelector('.clock')!.textContent!) > t, s);
      await page.getByRole('tab', {name: 'Parameters'}).click();
      await until(5); // the vehicle's file is loaded and written
      await page.getByLabel('Search').fill('temp_comp');
      const field = page.getByLabel('Value of ACC_X_TEMP_COMP');
      assert.deepEqual([await field.count(), await page.getByRole('button', {name: 'Write to memory'}).count()], [0, 0], 'to look at without control');
      await page.getByRole('button', {name: 'Take control'}).click();
      await reach(field); // by keyboard, behind the 0 that stands there
      await page.keyboard.press('End');
      await page.keyboard.type('.0005');
      assert.equal(await field.inputValue(), '0.0005');
      await field.fill('3');
      assert.equal(await said.innerText(), 'ACC_X_TEMP_COMP: allowed: -2 .. 2');
      assert.ok(await page.getByRole('button', {name: 'Send 1 change'}).isDisabled());
      assert.deepEqual(await violations(page), []);
      await KEYBOARD.type(field, '0.001');
      await KEYBOARD.press(page.getByRole('button', {name: 'Send 1 change'}));
      await page.getByText('1 of 1 in force').waitFor();
      assert.equal(await page.locator('.result').innerText(), '✓ set to 0.001');
      assert.equal(await field.inputValue(), '0.001');
      await page.getByText('changed since the last write').waitFor();
      await page.getByLabel('Compare with a file').setInputFiles({name: 'mine.yaml', mimeType: 'application/yaml',
        buffer: Buffer.from('- {name: ACC_X_TEMP_COMP, type: 9, value: 0.002}\n- {name: ACC_Y_TEMP_COMP, type: 9, value: 0.002}\n- {name: ACC_Z_TEMP_COMP, type: 9, value: 3}\n- {name: NO_SUCH, type: 6, value: 1}\n')});
      await page.getByLabel('Send ACC_X_TEMP_COMP').uncheck();
      await page.getByRole('button', {name: 'Send 2 from the file'}).click();
      const entry = (name: string) => page.locator('.differences tr', {hasText: name});
      await entry('ACC_Y_TEMP_COMP').getByText('set to 0.002').waitFor();
      await entry('ACC_Z_TEMP_COMP').getByText('3 refused, stays at 0').waitFor(); // beyond its range
      assert.equal(await said.innerText(), '1 of 2 in force');
      assert.equal(await page.getByLabel('Value of ACC_X_TEMP_COMP').inputValue(), '0.001');
      assert.equal(await page.getByLabel('Value of ACC_Y_TEMP_COMP').inputValue(), '0.002');
      await keepPicture(page, 'parameters', DESKTOP);
      await fitsPhone(page);
      await page.getByRole('button', {name: 'Write to memory'}).click();
      await page.getByText('writing parameters: done').waitFor();
      await page.getByText('changed since the last write').waitFor({state: 'detached'});
      await field.fill('0.003'); // not sent yet
      const other = await steered(url, 'speed 0.3', 'hold off');
      await field.waitFor({state: 'detached'}); // the other one has control
      assert.equal(await page.getByRole('button', {name: 'Send 1 change'}).count(), 0);
      await page.waitForFunction(() => /(?<!dis)armed/.test(document.querySelector('.instruments')!.textContent!));
      await page.getByRole('button', {name: 'Take over control'}).click();
      assert.equal(await field.inputValue(), '0.003');
      await field.fill('0.004');
      await page.getByRole('button', {name: 'Send 1 change'}).click();
      await page.locator('.result.bad', {hasText: '✗ 0.004 refused, stays at 0.001'}).waitFor();
      await page.getByRole('tab', {name: 'Events'}).click();
      await page.waitForSelector('.events tr:has-text("viewer 1 sets ACC_X_TEMP_COMP 0.001")');
      other.close();
    }, SMALL);
    program.kill('SIGKILL');
    await rm(folder, {recursive: true});
  });

  test('has its autonomy tuned from the page; what the vehicle is made of stays', {timeout: 400_000}, async () => {
    const {url, program, folder, said} = await flyAndView('--speed', '1', '--hold', '--listen', '127.0.0.2');
    await withPage(url, async (page) => {
      await drawnForNobody(page);
      await page.getByRole('tab', {name: 'Parameters'}).click();
      const owner = page.getByLabel('Parameters of');
      await owner.selectOption('vehicle');
      const row = (key: string) => page.locator('.parameters tr', {has: page.getByRole('rowheader', {name: key, exact: true})});
      assert.match(await row('body.mass_kg').innerText(), /3\.5\s+needed/);
      assert.equal(await page.getByLabel(/^Value of/).count(), 0, 'to look at');
      await owner.selectOption('autonomy');
      await page.getByRole('button', {name: 'Take control'}).click();
      await page.getByLabel('Search').fill('tilt_deg');
      const field = page.getByLabel('Value of autonomy.limits.tilt_deg');
      assert.equal(await field.inputValue(), '35');
      await page.getByText('deg · from 1 to 60 · of every commanded attitude').waitFor();
      await field.fill('61');
      const send = page.getByRole('button', {name: 'Send 1 change'});
      await send.click();
      await page.locator('.result.bad', {hasText: 'allowed'}).waitFor();
      assert.match(await page.locator('.result.bad').innerText(), /found 61, allowed .*from 1 to 60/);
      await field.fill('22');
      await KEYBOARD.press(send);
      await page.getByText('1 of 1 in force').waitFor();
      assert.equal(await page.locator('.result').innerText(), '✓ set to 22');
      await page.waitForFunction(() => document.querySelector<HTMLInputElement>('.parameters td input')!.value === '22');
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, 'parameters-autonomy', DESKTOP);
      await fitsPhone(page);
      await page.getByLabel('Search').fill('sigma');
      assert.equal(await page.getByLabel(/^Value of/).count(), 0, 'the estimator\'s are read once');
      await page.getByRole('tab', {name: 'Events'}).click();
      await page.waitForSelector('.events tr:has-text("viewer 1 steers: tune limits.tilt_deg 22")');
    }, SMALL);

    // The other address of --listen is one to look.
    await until(() => ONE_TO_LOOK.test(said()));
    const {page} = await newPage(browser, SMALL);
    await page.goto(ONE_TO_LOOK.exec(said())![1]!);
    await flightShown(page);
    for (const [name, without] of [['Simulation', '.steering :enabled'], ['Parameters', '.parameters td input, button:text("Write to memory")'],
      ['Preflight', 'button:text("Check now"), .calibrations, .motor-test']] as const) {
      await page.getByRole('tab', {name}).click();
      if (name !== 'Preflight') await page.getByText('This address is one to look, not to command.').waitFor();
      assert.equal(await page.locator(without).count(), 0, name);
      assert.equal(await page.getByRole('button', {name: /^Take/}).count(), 0, name);
    }
    // A server that is started again has other tokens.
    program.kill('SIGKILL');
    await page.getByText('The connection to the flight is lost').waitFor();
    const again = await flyAndView('--hold', '--listen', '127.0.0.2', '--port', new URL(url).port);
    await page.getByRole('alert').getByText('wants the whole address').waitFor();
    await page.getByText('The connection to the flight is lost').waitFor({state: 'detached'});
    await page.context().close();
    again.program.kill('SIGKILL');
    for (const one of [folder, again.folder]) await rm(one, {recursive: true});
  });

  test('is steered from the page: control, time, wind, faults, transmitter; another viewer takes over', async () => {
    const {url, program, folder} = await flyAndView('--speed', '1', '--hold');
    await withPage(url, async (page) => {
      await drawnForNobody(page);
      const press = async (name: string) => {
        await page.getByRole('button', {name, exact: true}).focus();
        await page.keyboard.press('Enter');
      };
      await page.getByRole('tab', {name: 'Simulation'}).click();
      assert.ok(await page.getByRole('button', {name: 'Pause', exact: true}).last().isDisabled(), 'control first');
      await press('Take control');
      await page.getByText('You have control (viewer 1)').waitFor();
      await page.locator('.simulation').getByRole('button', {name: 'Pause', exact: true}).focus();
      await page.keyboard.press('Enter');
      await page.getByText('simulation paused').waitFor();
      let stood = NaN; // the last samples are shown some frames later
      for (let now = await clock(page); now !== stood; now = await clock(page)) {
        stood = now;
        await page.waitForTimeout(500);
      }
      await press('Step 1 s');
      await page.waitForFunction((t) => parseFloat(document.querySelector('.clock')!.textContent!) >= t + 0.9, stood);
      await page.waitForTimeout(300);
      assert.ok(await clock(page) < stood + 1.1);
      await page.getByLabel('From').fill('90');
      await press('Set wind');
      await page.getByText('Done: wind 5,90,0').waitFor();
      await page.getByLabel('Wind speed').fill('99');
      await press('One gust');
      await page.locator('.said.wrong', {hasText: 'allowed SPEED,FROM_DEG'}).waitFor();
      await page.getByLabel('Wind speed').fill('5');
      const help = spawnSync(FLY, ['fly', '--help'], {encoding: 'utf8'}).stdout;
      const listed = /WHAT is one of\n(.*?)\n\s*\n/s.exec(help)![1]!.split('\n').map((line) => line.trim().split(' ')[0]);
      assert.ok(listed.length > 30 && listed.includes('motorN_dead'), `${listed}`);
      assert.deepEqual(await page.getByLabel('Fault').first().locator('option').allInnerTexts(), listed, 'every fault of --fault');
      await page.getByLabel('Fault').first().selectOption('motorN_partial=FACTOR');
      await page.getByLabel('Number N').fill('2');
      await page.getByLabel('Size').fill('0.9');
      await press('Begin fault');
      await page.getByText('Done: fault motor2_partial=0.9').waitFor();
      assert.deepEqual(await violations(page), []);
      await keepPicture(page, 'simulation', DESKTOP);
      await press('Resume');
      await page.getByText('simulation paused').waitFor({state: 'detached'});
      await press('Let the pilot arm');
      await page.waitForFunction(() => /(?<!dis)armed/.test(document.querySelector('.instruments')!.textContent!));
      await page.locator('.simulation').getByRole('button', {name: 'Pause', exact: true}).press('Enter'); // while the other viewer comes
      await page.getByText('simulation paused').waitFor();
      const other = await newPage(browser, PHONE, {colorScheme: 'dark'});
      await other.page.goto(url);
      await flightShown(other.page);
      await other.page.getByRole('tab', {name: 'Simulation'}).click();
      await other.page.getByRole('button', {name: 'Take over control'}).click();
      await page.getByText('Viewer 2 has control').first().waitFor();
      assert.ok(await page.getByRole('button', {name: 'Set wind'}).isDisabled());
      await keepPicture(other.page, 'simulation-phone-dark');
      await other.page.getByRole('button', {name: 'Arm off'}).click();
      await other.page.getByText('Done: switch arm off').waitFor();
      await other.page.getByRole('button', {name: 'Resume'}).click();
      await other.page.getByText('Done: resume').waitFor();
      assert.deepEqual(await violations(other.page), []);
      await other.page.context().close();
      await page.getByText('Nobody has control').waitFor();
      await page.getByRole('tab', {name: 'Events'}).click();
      await page.waitForSelector('.events tr:has-text("viewer 2 takes control from viewer 1")');
    }, SMALL);
    program.kill('SIGKILL');
    await rm(folder, {recursive: true});
  });

  const LEFT_OUT = './rosflight test web-rest runs it';
  for (const hand of HANDS) {
    test(`is changed ${hand.name}`, {skip: LONG || hand === KEYBOARD ? false : LEFT_OUT}, async (t) => {
      const {url, program, folder} = await flyAndView('--speed', '1', '--hold');
      await withPage(url, async (page) => {
        const check = await withoutMouse(page);
        await drawnForNobody(page);
        for (const [point, act] of Object.entries(CHANGES)) {
          await t.test(point, {skip: LONG || point.startsWith('simulation') ? false : LEFT_OUT}, () => shownOnFailure(page, () => act(page, hand)));
        }
        await check();
      }, ...hand.options);
      program.kill('SIGKILL');
      await rm(folder, {recursive: true});
    });
  }

  test('that is gone is said, and the page connects again by itself', {timeout: 400_000}, async () => {
    const first = await flyAndView();
    const {page} = await newPage(browser, SMALL);
    await page.goto(first.url);
    await flightShown(page);
    const reaches = (s: number) => page.waitForFunction((t) => parseFloat(document.querySelector('.clock')!.textContent!) > t, s);
    await reaches(2);
    await page.getByRole('tab', {name: 'Simulation'}).click();
    await page.getByRole('button', {name: 'Take control'}).click();
    await page.getByText('You have control').waitFor();
    first.program.kill('SIGKILL');
    await page.waitForSelector('text=The connection to the flight is lost; trying again.');
    const old = await clock(page);
    const second = await flyAndView('--port', new URL(first.url).port, '--speed', '0.2'); // the page takes a second to try again
    await page.waitForSelector('text=The connection to the flight is lost', {state: 'detached', timeout: 60_000});
    await page.waitForFunction((t) => parseFloat(document.querySelector('.clock')!.textContent!) < t, old); // another flight
    await reaches(await clock(page) + 0.2);
    await vehicleIsSeen(page);
    // A log that the user opens stays: the connection ends, and with it what belongs to the server.
    const watch = await viewer(second.url);
    await page.getByRole('tab', {name: 'Simulation'}).click();
    await page.getByText('Control ended with the connection.').waitFor();
    await page.getByRole('button', {name: 'Take control'}).click();
    await watch.until(({viewer}) => viewer !== 0);
    await page.getByText('Control ended with the connection.').waitFor({state: 'detached'});
    await page.locator('input[type=file]').first().setInputFiles(logOf(MULTIROTOR));
    await watch.until(({viewer}) => viewer === 0);
    await goTo(page, 20);
    const known_s = watch.flight.end_s;
    await until(() => watch.flight.end_s > known_s + 0.1); // messages that the page must not show
    second.program.kill('SIGKILL');
    await until(() => watch.socket.readyState === WebSocket.CLOSED);
    assert.equal(await clock(page), 20);
    assert.match(await page.locator('.instruments').innerText(), /height\s*5\.\d m/);
    assert.equal(await page.getByRole('tab', {name: 'Simulation'}).count(), 0);
    assert.equal(await page.getByText('The connection to the flight is lost').count(), 0);
    await page.context().close();
    for (const {folder} of [first, second]) await rm(folder, {recursive: true});
  });
});
