// Weights for an avatar: what a retargeting file makes of those that are tracked. docs/avatar.md
// has its format; the command reads the same files with `--retarget`, and says the same of wrong
// ones.

/** ARKit's shapes, in its order. */
export const AVATAR_SHAPES = [
  'eyeBlinkLeft', 'eyeLookDownLeft', 'eyeLookInLeft', 'eyeLookOutLeft', 'eyeLookUpLeft',
  'eyeSquintLeft', 'eyeWideLeft', 'eyeBlinkRight', 'eyeLookDownRight', 'eyeLookInRight',
  'eyeLookOutRight', 'eyeLookUpRight', 'eyeSquintRight', 'eyeWideRight', 'jawForward', 'jawLeft',
  'jawRight', 'jawOpen', 'mouthClose', 'mouthFunnel', 'mouthPucker', 'mouthLeft', 'mouthRight',
  'mouthSmileLeft', 'mouthSmileRight', 'mouthFrownLeft', 'mouthFrownRight', 'mouthDimpleLeft',
  'mouthDimpleRight', 'mouthStretchLeft', 'mouthStretchRight', 'mouthRollLower', 'mouthRollUpper',
  'mouthShrugLower', 'mouthShrugUpper', 'mouthPressLeft', 'mouthPressRight', 'mouthLowerDownLeft',
  'mouthLowerDownRight', 'mouthUpperUpLeft', 'mouthUpperUpRight', 'browDownLeft', 'browDownRight',
  'browInnerUp', 'browOuterUpLeft', 'browOuterUpRight', 'cheekPuff', 'cheekSquintLeft',
  'cheekSquintRight', 'noseSneerLeft', 'noseSneerRight', 'tongueOut',
];

/** Least and greatest numbers of a file. */
const MOST_GAIN = [-10, 10];
const MOST_OFFSET = [-1, 1];
const MOST_CLAMP = [-2, 2];

/**
 * How a shape is driven.
 * @typedef {object} Drive
 * @property {number} gain
 * @property {number} offset
 * @property {[number, number]} clamp
 * @property {[string, number][]} from Weights that are tracked, and their shares.
 */

/**
 * Whether a value of a file is an object with names.
 * @param {unknown} value
 * @returns {value is Record<string, unknown>}
 */
function isNamed(value) {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

/**
 * @param {unknown} value
 * @param {string} where
 */
function named(value, where) {
  if (!isNamed(value)) throw new Error(`${where}: not an object`);
  return value;
}

/**
 * A number of a file.
 * @param {unknown} value
 * @param {number[]} range
 * @param {string} where
 */
function numberWithin(value, [least, most], where) {
  if (typeof value !== 'number' || !(value >= least && value <= most)) {
    throw new Error(`${where}: not a number from ${least} to ${most}`);
  }
  return value;
}

/**
 * @param {unknown} value
 * @param {string} where
 * @returns {[number, number]}
 */
function clampOf(value, where) {
  const [least, most] = MOST_CLAMP;
  const isPair = Array.isArray(value) && value.length === 2
    && value.every((end) => typeof end === 'number' && end >= least && end <= most);
  if (!isPair || value[0] > value[1]) {
    throw new Error(`${where}: not two numbers from ${least} to ${most}, the lower first`);
  }
  return [value[0], value[1]];
}

/**
 * Refuses fields that are not known.
 * @param {Record<string, unknown>} value
 * @param {string[]} known
 * @param {string} where
 */
function checkFields(value, known, where) {
  for (const name of Object.keys(value)) {
    if (!known.includes(name)) throw new Error(`${where}${name}: no such field`);
  }
}

export class Retargeting {
  /** @type {Map<string, Drive>} */
  #drives = new Map();

  /**
   * Weights as they are tracked.
   * @param {string[]} tracked Names of the weights that are tracked.
   */
  constructor(tracked) {
    for (const name of AVATAR_SHAPES) {
      const from = /** @type {[string, number][]} */ (tracked.includes(name) ? [[name, 1]] : []);
      this.#drives.set(name, { gain: 1, offset: 0, clamp: [0, 1], from });
    }
  }

  /**
   * Reads a file.
   * @param {string} text
   * @param {string[]} tracked Names of the weights that are tracked.
   */
  static read(text, tracked) {
    let parsed;
    try {
      parsed = JSON.parse(text);
    } catch (error) {
      throw new Error(`not JSON: ${error instanceof Error ? error.message : error}`);
    }
    const file = named(parsed, 'the file');
    checkFields(file, ['shapes'], '');
    const retargeting = new Retargeting(tracked);
    for (const [name, value] of Object.entries(named(file.shapes, 'shapes'))) {
      const where = `shapes.${name}`;
      const usual = retargeting.#drives.get(name);
      if (!usual) throw new Error(`${where}: ARKit has no such shape`);
      const { gain = 1, offset = 0, clamp = [0, 1], from, ...rest } = named(value, where);
      checkFields(rest, [], `${where}.`);
      retargeting.#drives.set(name, {
        gain: numberWithin(gain, MOST_GAIN, `${where}.gain`),
        offset: numberWithin(offset, MOST_OFFSET, `${where}.offset`),
        clamp: clampOf(clamp, `${where}.clamp`),
        from: from === undefined ? usual.from
          : Object.entries(named(from, `${where}.from`)).map(([source, share]) => {
            if (!tracked.includes(source)) {
              throw new Error(`${where}.from.${source}: no such weight is tracked`);
            }
            return [source, numberWithin(share, MOST_GAIN, `${where}.from.${source}`)];
          }),
      });
    }
    return retargeting;
  }

  /**
   * The avatar's weights. What nothing drives is 0.
   * @param {Record<string, number>} tracked
   * @returns {Record<string, number>}
   */
  weights(tracked) {
    return Object.fromEntries([...this.#drives].map(([name, drive]) => {
      const { gain, offset, clamp: [least, most], from } = drive;
      const sum = from.reduce((sum, [source, share]) => sum + share * tracked[source], 0);
      const weight = Math.min(most, Math.max(least, gain * sum + offset));
      return [name, from.length > 0 ? weight : 0];
    }));
  }

  /** A file that changes nothing, to be edited: of each shape what there is. */
  get text() {
    const lines = [...this.#drives].map(([name, { gain, offset, clamp, from }]) =>
      `    ${JSON.stringify(name)}: ${JSON.stringify({
        gain, offset, clamp, from: Object.fromEntries(from),
      })}`);
    return `{\n  "shapes": {\n${lines.join(',\n')}\n  }\n}\n`;
  }
}
