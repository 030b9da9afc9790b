// unit.mjs MODULE - runs the unit tests that a WebAssembly module consists of. A test that fails
// traps; which one is not known, because such a module has no output.

import { readFileSync } from 'node:fs';

const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]));
process.exit(instance.exports.main(0, 0));
