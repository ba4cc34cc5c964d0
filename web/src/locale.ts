// SPDX-License-Identifier: BSD-3-Clause
// Imported first. In plain containers the browser's language is a POSIX locale, such as `en-US@posix`, with which uPlot
// throws as it is loaded.
try {
  new Intl.NumberFormat(navigator.language);
} catch {
  Object.defineProperty(navigator, 'language', {value: 'en-US', configurable: true});
}

export {};
