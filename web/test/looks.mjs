// How a page looks: its width, a screenshot, and what axe finds.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Leaves a screenshot of the page in a folder; fails where it is cut off or axe finds fault. */
export async function checkLooks(page, name, out) {
  const isWide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
  assert(!isWide, `${name}: nothing is cut off at the side`);
  await page.screenshot({ path: join(out, `${name}.png`), fullPage: true });
  await page.evaluate(axe);
  const { violations } = await page.evaluate(() => axe.run());
  assert.deepEqual(violations.map((v) => [v.id, v.nodes.map((n) => n.html)]), [], name);
}
