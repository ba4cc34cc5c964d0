// SPDX-License-Identifier: BSD-3-Clause
// What a person changes on the page of a running flight, each with one hand of hands.ts.
import assert from 'node:assert/strict';
import type {Page} from 'playwright-core';
import type {Hand} from './hands.ts';

const button = (page: Page, name: string | RegExp) => page.getByRole('button', {name, exact: typeof name === 'string'});
const done = (page: Page, text: string) => page.locator('.said', {hasText: `Done: ${text}`}).waitFor();

/** What a person can change in a flight, without a mouse; in this order on one page. */
export const CHANGES: Record<string, (page: Page, hand: Hand) => Promise<void>> = {
  'simulation: control, time, wind, faults, pilot': async (page, hand) => {
    await hand.press(page.getByRole('tab', {name: 'Simulation'}));
    await hand.press(button(page, /^Take/));
    await page.getByText('You have control').waitFor();
    const steering = page.locator('.steering');
    await hand.press(steering.getByRole('button', {name: 'Pause'}));
    await done(page, 'pause');
    await hand.press(button(page, 'Step 10 ms'));
    await done(page, 'step 4');
    await hand.type(page.getByLabel('Wind speed'), '3');
    await hand.press(button(page, 'Set wind'));
    await done(page, 'wind 3,270,0');
    await hand.choose(page.getByLabel('Fault').first(), 'baro_step=VALUE');
    await hand.type(page.getByLabel('Size'), '2');
    await hand.press(button(page, 'Begin fault'));
    await done(page, 'fault baro_step=2');
    await hand.press(button(page, 'End all faults'));
    await done(page, 'heal');
    const speed = page.getByLabel('Speed of the simulation');
    const other = await speed.inputValue() === '2' ? '1' : '2';
    await hand.choose(speed, other);
    await done(page, `speed ${other}`);
    await hand.press(button(page, 'Resume'));
    await done(page, 'resume');
  },
  'parameters: of the firmware, written, and of autonomy': async (page, hand) => {
    await hand.press(page.getByRole('tab', {name: 'Parameters'}));
    for (const [owner, key] of [['autonomy', 'autonomy.limits.tilt_deg'], ['firmware', 'ACC_X_TEMP_COMP']] as const) {
      await hand.choose(page.getByLabel('Parameters of'), owner);
      await hand.type(page.getByLabel('Search'), key.toLowerCase());
      const field = page.getByLabel(`Value of ${key}`);
      const value = owner === 'autonomy' ? Number(await field.inputValue()) - 1 : 0.001 + Number(await field.inputValue());
      await hand.type(field, String(value));
      await hand.press(button(page, 'Send 1 change'));
      await page.locator('.result', {hasText: `✓ set to ${value}`}).waitFor();
    }
    await hand.press(button(page, 'Write to memory'));
    await page.getByText('writing parameters: done').waitFor();
  },
  'preflight: checks': async (page, hand) => {
    await hand.press(page.getByRole('tab', {name: 'Preflight'}));
    await hand.press(button(page, 'Check now'));
    await page.getByText('All checks of the firmware').waitFor();
  },
  'tune: a gain tried, undone, taken': async (page, hand) => {
    await hand.press(page.getByRole('tab', {name: 'Tune'}));
    const gain = page.getByLabel('PID_ROLL_ANG_P');
    const before = await gain.inputValue();
    for (const [end, after] of [['Undo', before], ['Take', '1.5']] as const) {
      await hand.type(gain, '1.5'); // by its first letter the value that it has
      await hand.press(button(page, 'Try'));
      await page.getByText(`Before: PID_ROLL_ANG_P ${before}`).waitFor();
      await hand.press(button(page, end));
      await page.getByText('Before:').waitFor({state: 'detached'});
      assert.equal(await gain.inputValue(), after);
    }
    await hand.type(gain, before);
    await hand.press(button(page, 'Try'));
    await page.getByText('Before: PID_ROLL_ANG_P 1.5').waitFor();
    await hand.press(button(page, 'Take'));
  },
  'simulation: gust, sticks, switches, hold, return, landing, another mission': async (page, hand) => {
    await hand.press(page.getByRole('tab', {name: 'Simulation'}));
    const steering = page.locator('.steering');
    const all = async (...changes: [name: string, text: string][]) => {
      for (const [name, text] of changes) {
        await hand.press(steering.getByRole('button', {name, exact: true}));
        await done(page, text);
      }
    };
    await all(['One gust', 'gust'], ['Hold before arming', 'hold on'], ['Pause', 'pause']);
    for (const stick of ['roll', 'pitch', 'yaw', 'throttle']) {
      await hand.slide(page.getByLabel(`Stick ${stick}`));
      await done(page, `stick ${stick}`);
    }
    await hand.slide(page.getByLabel('Stick throttle'), 'to its beginning'); // or nothing arms
    await done(page, 'stick throttle 0');
    await all(['Attitude override off', 'switch attitude_override off'], ['Attitude override on', 'switch attitude_override on'],
      ['Throttle override off', 'switch throttle_override off'], ['Throttle override on', 'switch throttle_override on'],
      ['Angle mode off', 'switch attitude_mode off'], ['Angle mode on', 'switch attitude_mode on'], ['Arm on', 'switch arm on'], ['Arm off', 'switch arm off']);
    await hand.choose(page.getByLabel('Speed of the simulation'), '0.25'); // a busy machine has to land it before it lands
    await done(page, 'speed 0.25');
    await all(['Resume', 'resume'], ['Let the pilot arm', 'hold off']);
    await page.waitForFunction(() => /(?<!dis)armed/.test(document.querySelector('.instruments')!.textContent!));
    await all(['Return and land', 'return'], ['Land', 'land']);
    await hand.type(page.getByLabel('Next mission'), 'hop');
    await hand.press(button(page, 'Reset'));
    await done(page, 'reset hop');
  },
};
