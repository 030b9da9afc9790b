// monitor.mjs MODULE MODEL - the driver monitor: what it says of observations, and what a caller
// can do wrong.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { PosewiseError, load } from '../posewise.js';

const [wasm, model] = process.argv.slice(2).map((path) => readFileSync(path));
const engine = await load({ wasm, model });
const FRAME_US = 40_000;

const open = { state: 'tracking', confidence: 0.9, translationMm: [0, 0, 700], eyeOpen: [1, 1] };
const shut = { ...open, eyeOpen: [0, 0] };

/** Shows a monitor observations, each for some seconds; gives the kinds of events. */
function drive(monitor, startUs, ...stretches) {
  const kinds = [];
  let now = startUs;
  for (const [seen, seconds] of stretches) {
    for (const end = now + 1e6 * seconds; now < end; now += FRAME_US) {
      monitor.update(seen, now);
      kinds.push(...monitor.events().events.map(({ kind }) => kind));
    }
  }
  return kinds;
}

/** Whether an error is one of the library with this name. */
function coded(code) {
  return (error) => error instanceof PosewiseError && error.code === code;
}

test('closures become microsleeps and sleep', () => {
  const monitor = engine.createMonitor();
  const kinds = drive(monitor, 0, [open, 2], [shut, 4], [open, 1]);
  assert.deepEqual(kinds, ['long-closure', 'microsleep', 'sleep', 'closure-end']);
  // Nobody is there, which is not closed: what an observation lacks is unknown.
  drive(monitor, 7e6, [{}, 11]);
  const { eyes, eyesReason, degraded, openness, perclos60 } = monitor.state();
  assert.deepEqual([eyes, eyesReason, degraded, openness], ['unknown', 'no-face', true, -1]);
  assert.ok(perclos60.p80 > 0.4 && perclos60.known < 0.2);
  drive(monitor, 18e6, [{ ...open, eyeOpen: undefined }, 0.1]);
  assert.equal(monitor.state().eyes, 'unknown');
  const quick = engine.createMonitor({ microsleepUs: 600_000, longClosureUs: 400_000 });
  assert.ok(drive(quick, 0, [open, 2], [shut, 0.8]).includes('microsleep'));
});

test('zones are met', () => {
  const monitor = engine.createMonitor({ fixedPose: true }, [
    { kind: 'angles', yawDeg: [-20, 20], pitchDeg: [-15, 15], isRoad: true },
    { kind: 'angles', yawDeg: [30, 80], pitchDeg: [-20, 20] },
  ]);
  assert.equal(monitor.state().zone, 'unknown');
  const kinds = drive(monitor, 0, [open, 2], [{ ...open, yawDeg: 40 }, 4]);
  const { zone, zoneBy, zonesUs, awayUs } = monitor.state();
  assert.deepEqual([kinds, zone, zoneBy, zonesUs.length], [['long-glance'], 1, 'head', 8]);
  assert.ok(zonesUs[0] > 1e6 && zonesUs[1] > 3e6 && awayUs > 3e6 && zonesUs[2] === 0);
  const meets = (zones, time) => {
    monitor.setZones(zones);
    monitor.update(open, time);
    return monitor.state().zone;
  };
  const box = { kind: 'box', minMm: [-50, -50, -10], maxMm: [50, 50, 10], graceUs: 0xffffffff };
  const plane = { kind: 'plane', centreMm: [0, 0, 0], halfUMm: [50, 0, 0], halfVMm: [0, 50, 0] };
  assert.deepEqual([meets([box], 7e6), meets([plane], 8e6), meets([], 9e6)], [0, 0, 'outside']);
});

test('presets have values', () => {
  assert.equal(engine.defaultMonitorConfig('eu-addw-fast').longGlanceUs, 3_500_000);
  const usual = engine.defaultConfig();
  assert.deepEqual([usual.minFacePx, usual.gaze, 'flags' in usual], [40, 'off', false]);
  engine.createTracker(usual).free();
  // What is not given is the default, and 0 is 0.
  engine.createTracker({ smoothingBeta: 0 }).free();
  assert.throws(() => engine.createTracker({ minFacePx: 0 }), coded('E_MIN_FACE'));
  engine.createMonitor({ preset: 'eu-addw-slow', zoneMarginDeg: 0, fixedPose: true }).free();
  assert.throws(() => engine.createMonitor({ gapUs: 0 }), coded('E_MONITOR_CONFIG'));
  const config = engine.defaultMonitorConfig();
  assert.deepEqual([config.preset, config.fixedPose], ['general', false]);
  engine.createMonitor(config).free();
  assert.throws(() => engine.defaultMonitorConfig('generous'), TypeError);
  assert.throws(() => engine.createMonitor({ preset: 'generous' }), TypeError);
});

test('a driver is remembered', () => {
  const [first, second] = [engine.createMonitor(), engine.createMonitor()];
  drive(first, 0, [open, 100]);
  const record = first.save();
  second.restore(record);
  drive(second, 0, [open, 0.2]);
  assert.equal(second.state().zone, first.state().zone);
  assert.ok(first.state().naturalIsFinal && !second.state().naturalIsFinal);
  const wrong = record.with(63, 1);
  const damaged = [
    [record.slice(1), 'E_RECORD'], [new Uint8Array(9999), 'E_RECORD'],
    [record.slice(0, 63), 'E_RECORD_SIZE'], [new Uint8Array(0), 'E_RECORD_SIZE'],
    [wrong, 'E_RECORD_CHECKSUM'],
  ];
  for (const [bytes, code] of damaged) {
    assert.throws(() => second.restore(bytes), coded(code));
  }
});

test('another driver and another clock', () => {
  const monitor = engine.createMonitor();
  drive(monitor, 1e9, [open, 1], [shut, 0.2], [open, 1]);
  assert.equal(monitor.state().blinks, 1);
  monitor.update(open, 1e9);
  assert.equal(monitor.events().events[0].kind, 'clock-back');
  assert.throws(() => monitor.update(open, 1e9), coded('E_TIME'));
  monitor.forgetDriver();
  assert.equal(monitor.state().blinks, 0);
  monitor.update(open, Number.MIN_SAFE_INTEGER);
  for (let i = 0; i < 150; i++) monitor.update(i % 5 === 0 ? open : shut, i * FRAME_US);
  // Events that nobody reads are lost, the oldest first.
  const { events, overwritten } = monitor.events();
  assert.ok(events.length === 24 && overwritten > 0);
});

test('numbers do not wrap, and are numbers', () => {
  const monitor = engine.createMonitor();
  for (const time of [2 ** 63, NaN, Infinity, -(2 ** 60), 'soon', undefined]) {
    assert.throws(() => monitor.update(open, time), RangeError, String(time));
  }
  for (const value of [2 ** 32, -1, NaN]) {
    assert.throws(() => engine.createMonitor({ gapUs: value }), RangeError);
    const zone = { kind: 'angles', yawDeg: [-1, 1], pitchDeg: [-1, 1], graceUs: value };
    assert.throws(() => monitor.setZones([zone]), RangeError);
  }
  for (const yawDeg of ['left', [1], true, 1n]) {
    assert.throws(() => monitor.update({ ...open, yawDeg }, 0), TypeError);
  }
  assert.throws(() => engine.createMonitor({ nodDeg: NaN }), coded('E_MONITOR_CONFIG'));
  assert.throws(() => engine.createMonitor({ gapUs: 1 }), coded('E_MONITOR_CONFIG'));
  assert.equal(monitor.state().timestampUs, 0);
});

test('words, lists and zones are checked', () => {
  const monitor = engine.createMonitor();
  assert.throws(() => monitor.update({ ...open, state: 'lost' }, 0), TypeError);
  assert.throws(() => monitor.update({ ...open, eyeOpen: [1] }, 0), TypeError);
  assert.throws(() => monitor.update({ ...open, yaw: 1 }, 0), /unknown field yaw/);
  assert.throws(() => engine.createMonitor({ nods: 1 }), /unknown field nods/);
  const angles = { kind: 'angles', yawDeg: [-1, 1], pitchDeg: [-1, 1] };
  for (const zone of [
    { ...angles, kind: 'sphere' }, { ...angles, yawDeg: [1] }, { ...angles, minMm: [0, 0, 0] },
    { kind: 'angles', yawDeg: [-1, 1] }, { ...angles, yawDeg: ['a', 'b'] },
  ]) {
    assert.throws(() => monitor.setZones([zone]), TypeError, JSON.stringify(zone));
  }
  const wrong = { ...angles, yawDeg: [5, -5] };
  assert.throws(() => monitor.setZones([wrong]), coded('E_MONITOR_ZONES'));
  for (const count of [9, 200]) {
    assert.throws(() => monitor.setZones(new Array(count).fill(angles)), coded('E_MONITOR_ZONES'));
  }
});

test('nothing is used after free', () => {
  const [monitor, tracker] = [engine.createMonitor(), engine.createTracker()];
  monitor.free();
  monitor.free();
  tracker.free();
  for (const call of [
    () => monitor.state(), () => monitor.events(), () => monitor.forgetDriver(),
    () => monitor.setZones([]), () => monitor.update(open, 0), () => tracker.observation(),
  ]) {
    assert.throws(call, /after free/);
  }
  // Another monitor takes the memory, and the first one does not reach it.
  const next = engine.createMonitor();
  next.update(open, 5);
  assert.throws(() => monitor.update(open, 6), /after free/);
  assert.equal(next.state().timestampUs, 5);
});
