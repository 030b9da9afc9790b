// gltf.mjs FILE.glb - what Khronos' validator says of a file; fails on an error or a warning.

import { readFile } from 'node:fs/promises';
import { argv, exit } from 'node:process';
import { validateBytes } from 'gltf-validator';

const bytes = await readFile(argv[2]);
const { issues, info } = await validateBytes(new Uint8Array(bytes));
for (const { severity, code, message, pointer } of issues.messages) {
  if (severity < 2) console.log(code, pointer, message);
}
const { numErrors: errors, numWarnings: warnings } = issues;
console.log(`${errors} errors, ${warnings} warnings, ${info.totalVertexCount} vertices`);
if (errors + warnings > 0) exit(1);
