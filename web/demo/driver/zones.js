// The zones of the page's driver monitor: those of the preset `general`, with names.

/** @typedef {import('../../monitor.js').Zone} Zone */
/** @typedef {{ name: string, yawDeg: number[], pitchDeg: number[], isRoad?: boolean }} NamedZone */

/** Time of a glance at mirrors and instruments that is a part of driving [us]. */
const GLANCE_US = 1e6;
/** Beyond any angle [deg]. */
const ALL = 180;

/** @type {(NamedZone & { graceUs?: number })[]} */
export const ZONES = [
  { name: 'road', yawDeg: [-15, 15], pitchDeg: [-12, 12], isRoad: true },
  { name: 'lap', yawDeg: [-50, 50], pitchDeg: [-ALL, -25] },
  { name: 'instruments', yawDeg: [-15, 15], pitchDeg: [-25, -12], graceUs: GLANCE_US },
  { name: 'right', yawDeg: [15, 50], pitchDeg: [-25, ALL], graceUs: GLANCE_US },
  { name: 'left', yawDeg: [-50, -15], pitchDeg: [-25, ALL], graceUs: GLANCE_US },
  { name: 'roof', yawDeg: [-15, 15], pitchDeg: [12, ALL], graceUs: GLANCE_US },
  { name: 'far right', yawDeg: [50, ALL], pitchDeg: [-ALL, ALL], graceUs: GLANCE_US },
  { name: 'far left', yawDeg: [-ALL, -50], pitchDeg: [-ALL, ALL], graceUs: GLANCE_US },
];

/**
 * Zones of a monitor elsewhere, with names where they are these.
 * @param {Omit<NamedZone, 'name'>[]} zones
 * @returns {NamedZone[]}
 */
export function withNames(zones) {
  return zones.map((zone, index) => {
    const angles = (/** @type {Omit<NamedZone, 'name'>} */ { yawDeg, pitchDeg }) =>
      `${[yawDeg, pitchDeg]}`;
    const known = ZONES.find((other) => angles(other) === angles(zone));
    return { ...zone, name: known?.name ?? (zone.isRoad ? 'road' : `zone ${index}`) };
  });
}

/**
 * As the library takes them.
 * @returns {Zone[]}
 */
export function zonesOfLibrary() {
  return ZONES.map(({ name, ...zone }) => /** @type {Zone} */ ({ kind: 'angles', ...zone }));
}
