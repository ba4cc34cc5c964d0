// SPDX-License-Identifier: BSD-3-Clause
// The token of a server that other computers may reach stands in the page's address after '#', which browsers send to nobody.

const token = () => location.hash.slice(1);

/** For fetch(). */
export function admission(): Record<string, string> {
  return token() ? {Authorization: `Bearer ${token()}`} : {};
}

/** The first message of a WebSocket, if one is wanted. */
export function firstMessage(): string | undefined {
  return token() ? JSON.stringify({op: 'token', token: token()}) : undefined;
}

/** What the user has to do without the right one. */
export const WHOLE_ADDRESS = 'The server wants the whole address that it printed, with what stands after #. It is new with each start.';
