// SPDX-License-Identifier: BSD-3-Clause
// Pixels of a PNG as browsers write them: 8 bits a colour, RGB or RGBA, not interlaced.
import {inflateSync} from 'node:zlib';

/** How many pixels differ in two pictures of the same size, and the middle of these as shares of the picture. */
export function changed(before: Buffer, after: Buffer): {pixels: number; x: number; y: number} {
  const [a, b] = [decoded(before), decoded(after)];
  const sum = {pixels: 0, x: 0, y: 0};
  for (let at = 0; at < a.width * a.height; ++at) {
    const channel = at * a.channels;
    if ([0, 1, 2].every((k) => Math.abs(a.pixels[channel + k]! - b.pixels[channel + k]!) < 16)) continue;
    ++sum.pixels;
    sum.x += at % a.width;
    sum.y += Math.floor(at / a.width);
  }
  return {pixels: sum.pixels, x: sum.x / sum.pixels / a.width, y: sum.y / sum.pixels / a.height};
}

function decoded(png: Buffer) {
  const width = png.readUInt32BE(16);
  const height = png.readUInt32BE(20);
  const channels = png[25] === 6 ? 4 : 3;
  const packed: Buffer[] = [];
  for (let at = 8; at < png.length; at += 12 + png.readUInt32BE(at)) {
    if (png.toString('latin1', at + 4, at + 8) === 'IDAT') packed.push(png.subarray(at + 8, at + 8 + png.readUInt32BE(at)));
  }
  return {width, height, channels, pixels: unfiltered(inflateSync(Buffer.concat(packed)), width * channels, height, channels)};
}

/** Each row says how it was made from what is left, above and above left of it (PNG specification, section 9). */
function unfiltered(raw: Buffer, stride: number, height: number, channels: number): Uint8Array {
  const out = new Uint8Array(stride * height);
  for (let row = 0; row < height; ++row) {
    const filter = raw[row * (stride + 1)]!;
    for (let k = 0; k < stride; ++k) {
      const left = k < channels ? 0 : out[row * stride + k - channels]!;
      const above = row === 0 ? 0 : out[(row - 1) * stride + k]!;
      const corner = k < channels || row === 0 ? 0 : out[(row - 1) * stride + k - channels]!;
      out[row * stride + k] = raw[row * (stride + 1) + 1 + k]! + [0, left, above, (left + above) >> 1, paeth(left, above, corner)][filter]!;
    }
  }
  return out;
}

function paeth(left: number, above: number, corner: number): number {
  const [a, b, c] = [left, above, corner].map((value) => Math.abs(left + above - corner - value)) as [number, number, number];
  return a <= b && a <= c ? left : b <= c ? above : corner;
}
