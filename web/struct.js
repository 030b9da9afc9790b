// Reads and writes C structs in WebAssembly's memory, by the tables of layout.js.

/**
 * @typedef {'u32' | 'i64' | 'f32'} NumberType
 *
 * @typedef {object} Place Where a field is: a number or a struct, once or several times.
 * @property {number} at Offset from the start of the struct [bytes].
 * @property {NumberType} [type] A number.
 * @property {Layout} [struct] A struct.
 * @property {number} [count] Elements of an array.
 * @property {readonly string[]} [names] Names of the field's values.
 * @property {boolean} [optional] Whether a caller may leave it out: then it is 0.
 *
 * @typedef {object} Layout
 * @property {number} size Size of the struct [bytes].
 * @property {Record<string, Place>} fields
 */

// Fields that are for the library, not for the caller.
const HIDDEN = ['structSize', 'reserved'];

/** @type {Record<NumberType, (view: DataView, at: number) => number>} */
const READ = {
  u32: (view, at) => view.getUint32(at, true),
  i64: (view, at) => Number(view.getBigInt64(at, true)),
  f32: (view, at) => view.getFloat32(at, true),
};

/** @type {Record<NumberType, (view: DataView, at: number, value: number) => void>} */
const WRITE = {
  u32: (view, at, value) => view.setUint32(at, value, true),
  i64: (view, at, value) => view.setBigInt64(at, BigInt(value), true),
  f32: (view, at, value) => view.setFloat32(at, value, true),
};

/** Least and largest integers: those of C, and of JavaScript where it has fewer. */
const RANGES = {
  u32: [0, 0xffffffff],
  i64: [Number.MIN_SAFE_INTEGER, Number.MAX_SAFE_INTEGER],
};

/**
 * Writes a number. Integers lose their fraction, as times of browsers have one, and never wrap.
 * @param {DataView} view
 * @param {number} at
 * @param {NumberType} type
 * @param {string} name
 * @param {unknown} value
 */
function writeNumber(view, at, type, name, value) {
  const number = Number(value);
  if (type === 'f32') return WRITE.f32(view, at, number);
  const integer = Math.trunc(number);
  const [least, most] = RANGES[type];
  if (!(integer >= least && integer <= most)) {
    throw new RangeError(`${name} must be ${least}..${most}, not ${value}`);
  }
  return WRITE[type](view, at, integer);
}

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
      const places = Array.from({ length: count }, (_, i) => start + at + 4 * i);
      object[name] = places.map((place) => readNumber(view, place, type, names));
    } else {
      object[name] = readNumber(view, start + at, type, names);
    }
  }
  return object;
}

/**
 * A number, or its name; a later library may have values that these lists lack.
 * @param {DataView} view
 * @param {number} at
 * @param {NumberType | undefined} type
 * @param {readonly string[] | undefined} names
 */
function readNumber(view, at, type, names) {
  const value = READ[/** @type {NumberType} */ (type)](view, at);
  return names ? (names[value] ?? String(value)) : value;
}

/**
 * Writes an object as the struct at an address. Optional fields that it lacks become 0.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @param {Record<string, any>} object
 */
export function writeStruct(view, start, layout, object) {
  for (const name of Object.keys(object)) {
    if (!(name in layout.fields)) throw new TypeError(`unknown field ${name}`);
  }
  clearStruct(view, start, layout);
  for (const [name, place] of Object.entries(layout.fields)) {
    if (HIDDEN.includes(name)) continue;
    const value = object[name] ?? undefined;
    if (value !== undefined) writeField(view, start + place.at, name, place, value);
    else if (!place.optional) throw new TypeError(`${name} is missing`);
  }
}

/**
 * Makes a struct empty: all 0 but its size.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 */
export function clearStruct(view, start, { size, fields }) {
  new Uint8Array(view.buffer, start, size).fill(0);
  if ('structSize' in fields) WRITE.u32(view, start + fields.structSize.at, size);
}

/**
 * @param {DataView} view
 * @param {number} at
 * @param {string} name
 * @param {Place} place
 * @param {any} value
 */
function writeField(view, at, name, { type, struct, count, names }, value) {
  if (struct) return writeStruct(view, at, struct, value);
  const kind = /** @type {NumberType} */ (type);
  if (count) {
    if (value.length !== count) throw new TypeError(`${name} must have ${count} numbers`);
    for (let i = 0; i < count; i++) writeNumber(view, at + 4 * i, kind, name, value[i]);
    return undefined;
  }
  if (!names) return writeNumber(view, at, kind, name, value);
  if (!names.includes(value)) throw new TypeError(`${name} must be one of ${names}, not ${value}`);
  return WRITE.u32(view, at, names.indexOf(value));
}
