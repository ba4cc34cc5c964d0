// SPDX-License-Identifier: BSD-3-Clause
// Two ways to use the page without a mouse: by keyboard alone, each control reached by Tab, and by touch on a phone.
import assert from 'node:assert/strict';
import type {CDPSession, Locator, Page} from 'playwright-core';
import {drawn, PHONE, SMALL, type PageOptions} from './browser.ts';

type Files = {name: string; mimeType: string; buffer: Buffer};

export interface Hand {
  name: string;
  options: PageOptions;
  /** A button, a box or a tab. */
  press(target: Locator): Promise<void>;
  type(target: Locator, text: string): Promise<void>;
  choose(target: Locator, value: string): Promise<void>;
  /** Of a slider: towards its end, or to its beginning. */
  slide(target: Locator, to?: 'to its beginning'): Promise<void>;
  /** The picture. */
  turn(picture: Locator): Promise<void>;
  /** The label of a button that wants a file. */
  give(label: Locator, file: Files): Promise<void>;
}

async function enabled(target: Locator) {
  await target.page().waitForFunction((element) => !element!.matches(':disabled'), await target.elementHandle());
}

/** Presses Tab until the target has the focus. */
export async function reach(target: Locator) {
  const page = target.page();
  await enabled(target);
  const steps = await target.evaluate((element) => {
    const all = [...document.querySelectorAll<HTMLElement>('a[href], button, input, select, textarea, summary, [tabindex]')]
      .filter((one) => one.tabIndex >= 0 && !one.matches(':disabled') && one.getClientRects().length > 0);
    const [from, to] = [document.activeElement as HTMLElement, element as HTMLElement].map((one) => all.indexOf(one)) as [number, number];
    return from < 0 || to < 0 ? 0 : to - from;
  });
  for (let k = 0; k < Math.abs(steps); ++k) await page.keyboard.press(steps < 0 ? 'Shift+Tab' : 'Tab');
  for (let presses = 0; presses < 200; ++presses) { // the page may have changed meanwhile
    const side = await target.evaluate((element) => element === document.activeElement ? 0
      : document.activeElement!.compareDocumentPosition(element) & Node.DOCUMENT_POSITION_PRECEDING ? -1 : 1);
    if (side === 0) return;
    await page.keyboard.press(side < 0 ? 'Shift+Tab' : 'Tab');
  }
  const [focus, disabled] = await target.evaluate((element) => [document.activeElement!.outerHTML.slice(0, 200), element.matches(':disabled')] as const);
  assert.fail(`${target} is not reached by Tab; it is ${disabled ? 'disabled' : 'enabled'}, the focus is on ${focus}`);
}

async function given(page: Page, ask: () => Promise<void>, file: Files) {
  const chooser = page.waitForEvent('filechooser');
  await ask();
  await (await chooser).setFiles(file);
}

export const KEYBOARD: Hand = {
  name: 'by keyboard alone',
  options: [SMALL],
  async press(target) {
    const {keyboard} = target.page();
    if (await target.getAttribute('role') !== 'tab') {
      await reach(target);
      return keyboard.press(await target.getAttribute('type') === 'checkbox' ? ' ' : 'Enter');
    }
    await reach(target.page().locator('[role=tab][aria-selected=true]'));
    while (await target.getAttribute('aria-selected') !== 'true') await keyboard.press('ArrowRight');
  },
  async type(target, text) {
    await reach(target);
    await target.page().keyboard.press('Control+A');
    await target.page().keyboard.type(text);
  },
  async choose(target, value) {
    await reach(target);
    const steps = await target.evaluate((select: HTMLSelectElement, to) =>
      [...select.options].findIndex((option) => option.value === to) - select.selectedIndex, value);
    for (let left = Math.abs(steps); left > 0; --left) await target.page().keyboard.press(steps > 0 ? 'ArrowDown' : 'ArrowUp');
    assert.equal(await target.inputValue(), value);
  },
  async slide(target, to) {
    await reach(target);
    await target.page().keyboard.press(to ? 'Home' : 'PageUp');
  },
  async turn(picture) {
    await reach(picture);
    for (let k = 0; k < 3; ++k) await picture.page().keyboard.press('ArrowRight');
  },
  give: (label, file) => given(label.page(), () => KEYBOARD.press(label.locator('input')), file),
};

/** Unanswered by the browser for so long [ms], a touch is lost. */
const TOUCH_LIMIT_MS = 15_000;

/** One for each page, open as long as it: the browser makes the click after it has answered the touch. A session that ends then could take it along. */
const sessions = new WeakMap<Page, Promise<CDPSession>>();
function sessionOf(page: Page): Promise<CDPSession> {
  const session = sessions.get(page) ?? page.context().newCDPSession(page);
  sessions.set(page, session);
  return session;
}

async function touch(page: Page, type: 'touchStart' | 'touchMove' | 'touchEnd', ...touchPoints: {x: number; y: number}[]) {
  const session = await sessionOf(page);
  let timer: NodeJS.Timeout | undefined;
  const lost = new Promise<never>((_, reject) => { timer = setTimeout(reject, TOUCH_LIMIT_MS, new Error(`no answer to ${type}`)); });
  await Promise.race([session.send('Input.dispatchTouchEvent', {type, touchPoints}), lost]).finally(() => clearTimeout(timer));
}

/** A finger on the place; lifted by the function that it returns. */
export async function finger(page: Page, x: number, y: number, to = {x, y}) {
  await touch(page, 'touchStart', {x, y});
  for (const share of to.x === x && to.y === y ? [] : [0.25, 0.5, 0.75, 1]) await touch(page, 'touchMove', {x: x + share * (to.x - x), y: y + share * (to.y - y)});
  return () => touch(page, 'touchEnd');
}

/** Playwright's tap() looks for what lies under the finger, which hung for its whole time on a busy machine. Lines that come in the moment
 * between the look and the touch move the target away from under the finger, and a touch may be lost; then the tap is repeated. */
async function tap(target: Locator) {
  const page = target.page();
  await enabled(target);
  let why: unknown;
  for (let tries = 0; tries < 5; ++tries) {
    await target.evaluate((wanted) => {
      wanted.scrollIntoView({block: 'center', behavior: 'instant'});
      delete document.body.dataset['met'];
      window.addEventListener('click', ({target: met}) => { document.body.dataset['met'] = String(wanted.contains(met as Node)); }, {capture: true, once: true});
    });
    const {x, y, width, height} = (await target.boundingBox())!;
    try {
      // The end is sent with the beginning: nothing can move in between.
      await Promise.all([touch(page, 'touchStart', {x: x + width / 2, y: y + height / 2}), touch(page, 'touchEnd')]);
      await page.waitForFunction(() => document.body.dataset['met'], undefined, {timeout: TOUCH_LIMIT_MS});
      if (await page.evaluate(() => document.body.dataset['met'] === 'true')) return;
      why = 'it moves away from under the finger';
    } catch (error) {
      why = error;
      const session = await sessionOf(page);
      session.send('Input.dispatchTouchEvent', {type: 'touchCancel', touchPoints: []}).catch(() => undefined); // the finger may still be down
    }
  }
  assert.fail(`${target} is not tapped: ${why}`);
}

export const TOUCH: Hand = {
  name: 'by touch on a phone',
  options: [PHONE, {hasTouch: true}],
  press: (target) => tap(target),
  async type(target, text) {
    await tap(target);
    await target.fill(text);
  },
  async choose(target, value) { // the list of a phone is not part of the page
    await target.scrollIntoViewIfNeeded();
    await target.selectOption(value);
  },
  async slide(target, to) { // the browser makes no click of a touch on a slider
    await enabled(target);
    await target.scrollIntoViewIfNeeded();
    const {x, y, width, height} = (await target.boundingBox())!;
    await (await finger(target.page(), x + 0.5 * width, y + height / 2, {x: x + (to ? 0.02 : 0.75) * width, y: y + height / 2}))();
  },
  async turn(picture) {
    await picture.scrollIntoViewIfNeeded();
    const {x, y, width, height} = (await picture.boundingBox())!;
    await (await finger(picture.page(), x + width / 2, y + height / 2, {x: x + 0.7 * width, y: y + height / 2}))();
    await drawn(picture.page());
  },
  give: (label, file) => given(label.page(), () => tap(label), file),
};

export const HANDS = [KEYBOARD, TOUCH];

/** Begins to note what pointers are used; the function returned wants no mouse, and all of the page inside the window. */
export async function withoutMouse(page: Page) {
  await page.evaluate(() => window.addEventListener('pointerdown', ({pointerType}) => { document.body.dataset[pointerType] = 'used'; }, true));
  return async () => {
    assert.equal(await page.evaluate(() => document.body.dataset['mouse']), undefined);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= document.documentElement.clientWidth), 'wider than the window');
  };
}
