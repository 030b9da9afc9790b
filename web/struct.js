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
 * @property {Record<number, string>} [others] Names of values that are no numbers of something.
 * @property {number} [flag] The bit that it is, of a number that may have others.
 * @property {boolean} [optional] Whether a caller may leave it out.
 * @property {number} [unknown] What it is then, if not 0.
 *
 * @typedef {object} Layout
 * @property {number} size Size of the struct [bytes].
 * @property {Record<string, Place>} fields
 */

// Fields that are for the library, not for the caller; flags with a meaning have a name of theirs.
const HIDDEN = ['structSize', 'reserved'];
const UNREAD = [...HIDDEN, 'flags'];

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

/** Bytes of each. */
const SIZES = { u32: 4, i64: 8, f32: 4 };

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
  if (type === 'f32') {
    if (typeof value !== 'number') throw new TypeError(`${name} must be a number, not ${value}`);
    return WRITE.f32(view, at, value);
  }
  const integer = Math.trunc(Number(value));
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
  for (const [name, place] of Object.entries(layout.fields)) {
    if (UNREAD.includes(name)) continue;
    const { at, struct, count } = place;
    if (struct) {
      object[name] = readStruct(view, start + at, struct);
    } else if (count) {
      object[name] = placesOf(place, start + at).map((each) => readValue(view, each, place));
    } else {
      object[name] = readValue(view, start + at, place);
    }
  }
  return object;
}

/**
 * Where the elements of an array are.
 * @param {Place} place
 * @param {number} start
 */
function placesOf({ type, count }, start) {
  const size = SIZES[/** @type {NumberType} */ (type)];
  return Array.from({ length: count ?? 0 }, (_, i) => start + size * i);
}

/**
 * A number, or what it means; a later library may have values that these lists lack.
 * @param {DataView} view
 * @param {number} at
 * @param {Place} place
 */
function readValue(view, at, { type, names, others, flag }) {
  const value = READ[/** @type {NumberType} */ (type)](view, at);
  if (flag) return (value & flag) !== 0;
  return names ? (names[value] ?? String(value)) : (others?.[value] ?? value);
}

/**
 * Writes an object as the struct at an address. Optional fields that it lacks become
 * unknown where they can be, else 0.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @param {Record<string, any>} object
 */
export function writeStruct(view, start, layout, object) {
  clearStruct(view, start, layout);
  changeStruct(view, start, layout, object);
}

/**
 * Writes an object over the struct at an address, of which optional fields stay that it lacks.
 * @param {DataView} view
 * @param {number} start
 * @param {Layout} layout
 * @param {Record<string, any>} object
 */
export function changeStruct(view, start, layout, object) {
  for (const name of Object.keys(object)) {
    if (!(name in layout.fields)) throw new TypeError(`unknown field ${name}`);
  }
  for (const [name, place] of Object.entries(layout.fields)) {
    if (HIDDEN.includes(name)) continue;
    const { unknown, count } = place;
    const value = object[name] ?? (count && unknown ? new Array(count).fill(unknown) : unknown);
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
function writeField(view, at, name, place, value) {
  const { struct, count, names, flag } = place;
  if (struct) return writeStruct(view, at, struct, value);
  if (flag) {
    const others = READ.u32(view, at) & ~flag;
    return WRITE.u32(view, at, others | (value ? flag : 0));
  }
  const kind = /** @type {NumberType} */ (place.type);
  if (count) {
    if (value.length !== count) throw new TypeError(`${name} must have ${count} numbers`);
    placesOf(place, at).forEach((each, i) => writeNumber(view, each, kind, name, value[i]));
    return undefined;
  }
  if (!names) return writeNumber(view, at, kind, name, value);
  if (!names.includes(value)) throw new TypeError(`${name} must be one of ${names}, not ${value}`);
  return WRITE.u32(view, at, names.indexOf(value));
}
