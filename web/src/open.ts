// SPDX-License-Identifier: BSD-3-Clause
// Where the page gets its flight from: inside itself (report.html), the server that gave the page, or a file of the user.
import {connect, disconnect} from './connect.ts';
import type {Analysis} from './data/analysis.ts';
import {blobSource, bytesSource, urlSource, type ByteSource} from './data/bytes.ts';
import {readLog} from './data/read_log.ts';
import * as state from './state.ts';
import {admission, WHOLE_ADDRESS} from './token.ts';

/** What the server has: addresses relative to the page. */
interface Offer { name?: string; log?: string; summary?: string; analysis?: string; live?: boolean; other?: {name: string; parameters: string} }

const PAUSE_EACH_MS = 40;

export async function openFirst() {
  const inside = document.getElementById('flight-log')?.textContent?.trim();
  if (inside) {
    state.summary.value = parsed(document.getElementById('flight-summary')?.textContent);
    state.extract.value = true;
    await open(async () => bytesSource('report.html', await unpacked(fromBase64(inside))), parsed(document.getElementById('flight-analysis')?.textContent));
  } else if (location.protocol.startsWith('http')) {
    const get = (address: string) => fetch(address, {headers: admission()});
    const answer = await get('offer.json').catch(() => undefined);
    if (answer?.status === 401) {
      state.failure.value = WHOLE_ADDRESS;
      return;
    }
    if (!answer?.ok) return;
    const offer = await answer.json() as Offer;
    const json = async (address: string | undefined) => address ? parsed(await (await get(address)).text()) : undefined;
    state.summary.value = await json(offer.summary);
    const analysis = await json(offer.analysis);
    state.other.value = offer.other;
    if (offer.live) connect(offer.name ?? 'flight');
    else if (offer.log) await open(() => urlSource(offer.log!, offer.name, admission()), analysis);
  }
}

/** On the page of something that runs it ends the connection: the next message would take the log away. */
export async function openFile(file: File) {
  disconnect();
  state.summary.value = undefined; // is of another flight
  state.extract.value = false;
  await open(async () => blobSource(file.name, file));
}

async function open(source: () => Promise<ByteSource>, analysis?: Record<string, unknown>) {
  state.play(false);
  state.failure.value = '';
  state.flight.value = undefined;
  state.time.value = 0;
  state.loading.value = {share: 0};
  let shown = performance.now();
  try {
    const flight = await readLog(await source(), async (share) => {
      if (performance.now() - shown < PAUSE_EACH_MS) return;
      state.loading.value = {share};
      await new Promise((resolve) => setTimeout(resolve)); // lets the page draw
      shown = performance.now();
    });
    flight.analysis = analysis as Analysis | undefined;
    state.flight.value = flight;
  } catch (error) {
    state.failure.value = (error as Error).message;
  } finally {
    state.loading.value = undefined;
  }
}

function parsed(text: string | null | undefined): Record<string, unknown> | undefined {
  try {
    return text ? JSON.parse(text) as Record<string, unknown> : undefined;
  } catch {
    return undefined; // a flight is shown without it
  }
}

async function unpacked(gzip: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  return new Uint8Array(await new Response(new Blob([gzip]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer());
}

function fromBase64(text: string): Uint8Array<ArrayBuffer> {
  const characters = atob(text);
  return Uint8Array.from(characters, (character) => character.charCodeAt(0));
}
