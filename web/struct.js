// Reads and writes C structs in WebAssembly's memory, by the tables of layout.js.

/**
 * @typedef {object} Place Where a field is: a number or a struct, once or several times.
 * @property {number} at Offset from the start of the struct [bytes].
 * @property {string} [type] `u32`, `i64` or `f32`; a number.
 * @property {Layout} [struct] A struct.
 * @property {number} [count] Elements of an array.
 * @property {readonly string[]} [names] Names of the field's values.
 *
 * @typedef {object} Layout
 * @property {number} size Size of the struct [bytes].
 * @property {Record<string, Place>} fields
 */

// Fields that are for the library, not for the caller.
const HIDDEN = ['structSize', 'reserved'];

/** @type {Record<string, (view: DataView, at: number) => number>} */
const READ = {
  u32: (view, at) => view.getUint32(at, true),
  i64: (view, at) => Number(view.getBigInt64(at, true)),
  f32: (view, at) => view.getFloat32(at, true),
};

/** @type {Record<string, (view: DataView, at: number, value: number) => void>} */
const WRITE = {
  u32: (view, at, value) => view.setUint32(at, value, true),
  i64: (view, at, value) => view.setBigInt64(at, BigInt(Math.trunc(value)), true),
  f32: (view, at, value) => view.setFloat32(at, value, true),
};

/**
 * The struct at an address, as an object.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @returns {any}
 */
export function readStruct(view, start, layout) {
  /** @type {Record<string, unknown>} */
  const object = {};
  for (const [name, { at, type, struct, count, names }] of Object.entries(layout.fields)) {
    if (HIDDEN.includes(name)) continue;
    if (struct) {
      object[name] = readStruct(view, start + at, struct);
    } else if (count) {
      const read = READ[type ?? ''];
      object[name] = Array.from({ length: count }, (_, i) => read(view, start + at + 4 * i));
    } else {
      const value = READ[type ?? ''](view, start + at);
      object[name] = names ? (names[value] ?? String(value)) : value;
    }
  }
  return object;
}

/**
 * Writes an object as the struct at an address. Fields that it lacks become 0.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @param {Record<string, any>} object
 */
export function writeStruct(view, start, layout, object) {
  for (const name of Object.keys(object)) {
    if (!(name in layout.fields)) throw new TypeError(`unknown field ${name}`);
  }
  for (const [name, { at, type, struct, count, names }] of Object.entries(layout.fields)) {
    const value = name === 'structSize' ? layout.size : object[name];
    if (struct) {
      writeStruct(view, start + at, struct, value ?? {});
    } else if (count) {
      for (let i = 0; i < count; i++) WRITE[type ?? ''](view, start + at + 4 * i, value?.[i] ?? 0);
    } else {
      const number = names ? Math.max(names.indexOf(value), 0) : Number(value ?? 0);
      WRITE[type ?? ''](view, start + at, number);
    }
  }
}
