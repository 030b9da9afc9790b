// retargeting.mjs CASES.json NAMES - retargeting files give the weights, or the errors, that they
// should; the command's tests read the same cases. NAMES: the weights that are tracked.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { AVATAR_SHAPES, Retargeting } from '../demo/avatar/retargeting.js';

const [path, names] = process.argv.slice(2);
/** Names of the weights that are tracked, as the library has them. */
const tracked = names.split(',');
const cases = JSON.parse(readFileSync(path, 'utf8'));
for (const { file, tracked: given, weights, says } of cases) {
  const text = typeof file === 'string' ? file : JSON.stringify(file);
  if (says) {
    assert.throws(() => Retargeting.read(text, tracked), ({ message }) => message.startsWith(says),
      says);
    continue;
  }
  const all = Object.fromEntries(tracked.map((name) => [name, given[name] ?? 0]));
  const retargeting = Retargeting.read(text, tracked);
  const found = retargeting.weights(all);
  assert.deepEqual(Object.keys(found), AVATAR_SHAPES);
  for (const name of AVATAR_SHAPES) {
    assert(Math.abs(found[name] - (weights[name] ?? 0)) < 1e-6, `${text} ${name} ${found[name]}`);
  }
  // The file that the page saves says the same.
  assert.deepEqual(Retargeting.read(retargeting.text, tracked).weights(all), found);
}
console.log(`${cases.length} cases`);
