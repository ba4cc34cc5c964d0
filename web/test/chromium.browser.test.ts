// SPDX-License-Identifier: BSD-3-Clause
// Which browser the tests take.
import assert from 'node:assert/strict';
import {execFileSync, type ChildProcess} from 'node:child_process';
import {existsSync} from 'node:fs';
import {test} from 'node:test';
import {goTo, onPage, startBrowser, SYSTEM_CHROMIUM, vehicleIsSeen} from './browser.ts';
import {MULTIROTOR} from './flights.ts';
import {view} from './simulated.ts';

delete process.env['ROSFLIGHT_CHROMIUM']; // the one that is named comes before both

test('where the browser of the package does not start, Debian\'s shows the vehicle', {skip: existsSync(SYSTEM_CHROMIUM) ? false : 'it is not installed',
  timeout: 120_000}, async () => {
  const browser = await startBrowser([], async () => '/nonexistent/chromium');
  const running: ChildProcess[] = [];
  try {
    assert.ok(execFileSync(SYSTEM_CHROMIUM, ['--version'], {encoding: 'utf8'}).includes(browser.version()));
    await onPage(browser, await view(running, MULTIROTOR), async (page) => {
      await goTo(page, 20);
      await vehicleIsSeen(page);
    });
  } finally {
    running.forEach((program) => program.kill('SIGTERM'));
    await browser.close();
  }
});
