// SPDX-License-Identifier: BSD-3-Clause
// Foxglove and Lichtblick at the port of ./rosflight fly --view: with the Origin that a browser sends for each, and with the class that
// both connect with. They may look, not command.
import {FoxgloveClient} from '@foxglove/ws-protocol';
import assert from 'node:assert/strict';
import {spawn, type ChildProcess} from 'node:child_process';
import {mkdtemp, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, before, test} from 'node:test';
import type {Browser} from 'playwright-core';
import {startBrowser} from './browser.ts';
import {VIEW} from './flights.ts';

const CHOSEN = 'https://chosen.example.org';
/** Origins of web pages. Lichtblick as a program (Electron) loads its window from a file: "file://". */
const HOSTED = ['https://app.foxglove.dev', 'https://lichtblick-suite.github.io', CHOSEN];

const scratch = await mkdtemp(join(tmpdir(), 'rosflight_applications_'));
let browser: Browser;
let flying: ChildProcess;
let socket = '';

before(async () => {
  browser = await startBrowser();
  flying = spawn(VIEW, ['fly', '--view', '--mission', 'hop', '--out', join(scratch, 'flight'), '--allow-origin', CHOSEN],
    {stdio: ['ignore', 'ignore', 'pipe']});
  let said = '';
  socket = await new Promise((resolve) => flying.stderr!.on('data', (data) => {
    said += String(data);
    const found = /http(:\S+)/.exec(said);
    if (found) resolve(`ws${found[1]}`);
  }));
});
after(async () => {
  flying.kill('SIGKILL');
  await browser?.close();
  await rm(scratch, {recursive: true});
});

/** A page of this address, whose contents are ours, connects and asks for control: all that the server says until it has answered. */
async function lookFrom(address: string, from = browser): Promise<string> {
  // A person is asked by the browser whether a page of the network may reach this computer.
  const page = await (await from.newContext({permissions: ['local-network-access']})).newPage();
  await page.route('https://**', (route) => route.fulfill({contentType: 'text/html', body: '<title>application</title>'}));
  await page.goto(address);
  const said = await page.evaluate((url) => new Promise<string>((resolve) => {
    const connection = new WebSocket(url, ['foxglove.websocket.v1']);
    let texts = '';
    connection.onopen = () => connection.send('{"op":"takeControl","id":"a"}');
    connection.onmessage = ({data}) => {
      if (typeof data !== 'string') return;
      texts += `${data}\n`;
      if (data.includes('"status"')) connection.close();
    };
    connection.onclose = () => resolve(texts);
  }), socket);
  await page.context().close();
  return said;
}

test('pages of Foxglove, Lichtblick and a chosen origin look in a browser, and a page of anybody else does not', {timeout: 120_000}, async () => {
  const file = join(scratch, 'index.html');
  await writeFile(file, '<title>application</title>');
  const inElectron = await startBrowser(['--allow-file-access-from-files']); // whose windows have this right, and so an Origin
  try {
    for (const [address, from] of [...HOSTED.map((address) => [address, browser] as const), [`file://${file}`, inElectron] as const]) {
      const said = await lookFrom(address, from);
      assert.match(said, /"commands":"no"/, address);
      assert.match(said, /may look, not command/, address);
    }
  } finally {
    await inElectron.close();
  }
  for (const address of ['https://example.org', `file://${file}`]) assert.equal(await lookFrom(address), '', address); // that of a file is null
});

test('FoxgloveClient of an application receives the vehicle\'s motion and reads parameters; what it commands is refused', {timeout: 120_000}, async () => {
  for (const origin of [...HOSTED, 'file://']) {
    const ws = new WebSocket(socket, {protocols: [FoxgloveClient.SUPPORTED_SUBPROTOCOL], headers: {Origin: origin}} as never);
    const client = new FoxgloveClient({ws: ws as never});
    const moved = new Promise<void>((resolve) => {
      client.on('advertise', (channels) => {
        for (const {id, topic} of channels) if (topic === '/sim/truth_state') client.subscribe(id);
      });
      client.on('message', () => resolve());
    });
    const refused = new Promise<string>((resolve) => client.on('status', ({message}) => { if (!/none are known/.test(message)) resolve(message); }));
    await new Promise<void>((resolve) => client.on('open', () => resolve()));
    await moved;
    client.setParameters([{name: 'ACC_X_TEMP_COMP', value: 0.001}], 'set');
    assert.match(await refused, /may look, not command/, origin);
    let value: unknown;
    client.on('parameterValues', ({parameters, id}) => { if (id === 'get') value = parameters[0]?.value; });
    while (value === undefined) { // until the list has come over the link
      client.getParameters(['ACC_X_TEMP_COMP'], 'get');
      await new Promise((resolve) => setTimeout(resolve, 100));
    }
    assert.equal(value, 0, origin);
    client.close();
  }
});
