// What trackers and monitors have in common: an object of the library at an address.

import { clearStruct, readStruct, writeStruct } from './struct.js';

/** @typedef {import('./engine.js').Engine} Engine */
/** @typedef {import('./struct.js').Layout} Layout */

/** An object of the library, in memory of its own. */
export class Handle {
  /** @protected */
  engine;
  #at;
  #release;

  /**
   * @param {Engine} engine
   * @param {number} at
   * @param {() => void} release
   */
  constructor(engine, at, release) {
    this.engine = engine;
    this.#at = at;
    this.#release = release;
  }

  /**
   * Where it is in the memory of this engine.
   * @param {Engine} engine
   */
  address(engine) {
    if (engine !== this.engine) throw new TypeError('a tracker of another engine');
    if (!this.#at) throw new Error('a tracker after free()');
    return this.#at;
  }

  /**
   * @protected
   * @param {string} name
   * @param {...(number | bigint)} args
   */
  call(name, ...args) {
    if (!this.#at) throw new Error(`${name} after free()`);
    this.engine.check(this.engine.call(name, this.#at, ...args));
  }

  /**
   * Writes structs into the scratch memory, behind what results take, and gives their address.
   * @protected
   * @param {Layout} layout
   * @param {...object} objects
   */
  write(layout, ...objects) {
    const start = this.engine.scratch + 1024;
    objects.forEach((object, i) => {
      writeStruct(this.engine.view, start + i * layout.size, layout, object);
    });
    return start;
  }

  /**
   * The struct that a call writes.
   * @protected
   * @param {Layout} layout
   * @param {string} name
   * @param {...number} args
   * @returns {any}
   */
  read(layout, name, ...args) {
    const at = this.engine.scratch;
    clearStruct(this.engine.view, at, layout);
    this.call(name, ...args, at);
    return readStruct(this.engine.view, at, layout);
  }

  /**
   * @protected
   * @param {Layout} layout
   * @param {number} at
   * @param {number} count
   * @returns {any[]}
   */
  list(layout, at, count) {
    const view = this.engine.view;
    return Array.from({ length: count }, (_, i) => readStruct(view, at + i * layout.size, layout));
  }

  /**
   * The structs that a call writes behind two numbers: how many they are, and another one.
   * @protected
   * @param {Layout} layout
   * @param {string} name
   * @param {number} capacity
   * @param {...number} args
   * @returns {{ found: any[], other: number }}
   */
  readList(layout, name, capacity, ...args) {
    const out = this.engine.scratch;
    this.call(name, ...args, out + 16, capacity, out, out + 4);
    const { view } = this.engine;
    const found = this.list(layout, out + 16, view.getUint32(out, true));
    return { found, other: view.getUint32(out + 4, true) };
  }

  /**
   * The bytes of a record that a call writes.
   * @protected
   * @param {string} name
   * @param {number} size
   */
  readRecord(name, size) {
    const at = this.engine.scratch;
    this.call(name, at, size);
    return this.engine.bytes(at, size).slice();
  }

  /**
   * Calls with the bytes of a record, of at most `size`; what is longer is no record.
   * @protected
   * @param {string} name
   * @param {Uint8Array} record
   * @param {number} size
   * @param {...number} args
   */
  callWithRecord(name, record, size, ...args) {
    const at = this.engine.scratch + 1024;
    const given = record.subarray(0, 2 * size);
    this.engine.bytes(at, given.length).set(given);
    this.call(name, at, given.length, ...args);
  }

  /** Gives its memory back to the engine. Later calls are errors. */
  free() {
    if (this.#at) this.#release();
    this.#at = 0;
  }
}
