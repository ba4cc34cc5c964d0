// SPDX-License-Identifier: BSD-3-Clause
// Pictures of reports in the view of the whole flight, for documents: node test/report_pictures.ts OUT.png FLIGHT_FOLDER TIME_S [...three more]
import {join} from 'node:path';
import {pathToFileURL} from 'node:url';
import {drawn, flightShown, goTo, newPage, startBrowser} from './browser.ts';

const SIZE = {width: 1120, height: 700};
const words = process.argv.slice(2);
const browser = await startBrowser();
for (let k = 0; k + 2 < words.length; k += 3) {
  const {page} = await newPage(browser, SIZE);
  await page.goto(pathToFileURL(join(words[k + 1]!, 'report.html')).href);
  await flightShown(page);
  await page.getByRole('button', {name: 'Whole flight'}).click();
  await goTo(page, Number(words[k + 2]));
  await drawn(page);
  await page.screenshot({path: words[k]!});
  await page.context().close();
}
await browser.close();
