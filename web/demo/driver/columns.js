// The columns that `track --monitor` adds to its table, and the events of each frame.

/** @typedef {import('../../worker.js').Watched} Watched */
/** @typedef {import('../../layout.js').MonitorState} MonitorState */

/**
 * @param {60 | 180} seconds
 * @param {(state: MonitorState) => import('../../layout.js').Perclos} of
 * @returns {[string[], number, (w: Watched) => (number | string)[]][]}
 */
function windowOf(seconds, of) {
  const shares = ['p70', 'p80', 'em', 'known'].map((name) => `perclos_${name}_${seconds}`);
  return [
    [shares, 4, ({ state }) => {
      const { p70, p80, em, known } = of(state);
      return [p70, p80, em, known];
    }],
    [[`closures_${seconds}`, `mean_closure_us_${seconds}`], 0,
      ({ state }) => [of(state).closures, of(state).meanClosureUs]],
  ];
}

/** @param {MonitorState['zone']} zone */
function zoneNumber(zone) {
  return typeof zone === 'number' ? zone : { unknown: -1, outside: -2 }[zone];
}

/**
 * Names, decimals, values.
 * @type {[string[], number, (w: Watched) => (number | string)[]][]}
 */
export const MONITOR_COLUMNS = [
  [['eyes', 'eyes_reason'], 0, ({ state: s }) => [s.eyes, s.eyesReason]],
  [['openness'], 3, ({ state: s }) => [s.openness]],
  [['closure_us'], 0, ({ state: s }) => [s.closureUs]],
  ...windowOf(60, (state) => state.perclos60),
  ...windowOf(180, (state) => state.perclos180),
  [['blinks', 'yawns', 'nods', 'mouth_open_us', 'look_down_us'], 0,
    ({ state: s }) => [s.blinks, s.yawns, s.nods, s.mouthOpenUs, s.lookDownUs]],
  [['zone', 'zone_us', 'away_us', 'away_30_us'], 0,
    ({ state: s }) => [zoneNumber(s.zone), s.zoneUs, s.awayUs, s.away30Us]],
  [['road_yaw_deg', 'road_pitch_deg'], 2, ({ state: s }) => s.fromRoadDeg],
  [['drowsiness'], 0, ({ state: s }) => [s.drowsiness]],
  [['degraded'], 0, ({ state: s }) => [Number(s.degraded)]],
  [['zone_by'], 0, ({ state: s }) => [s.zoneBy]],
  [['road_gaze_yaw_deg', 'road_gaze_pitch_deg'], 2, ({ state: s }) => s.gazeFromRoadDeg],
  [['events'], 0, ({ events }) => [events.map(({ kind }) => kind).join(' ')]],
];
