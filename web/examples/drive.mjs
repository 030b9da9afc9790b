// drive.mjs VIDEO.y4m [PRESET] - watches a driver: an event per line, then what was measured.

import { load } from 'posewise';
import { framesOf } from './frames.mjs';

const [video, preset = 'general'] = process.argv.slice(2);

/** The road, a mirror that may be looked at for a second, a screen, and the lap. */
const zones = [
  { kind: 'angles', yawDeg: [-25, 25], pitchDeg: [-12, 15], isRoad: true },
  { kind: 'angles', yawDeg: [35, 60], pitchDeg: [-10, 10], graceUs: 1_000_000 },
  { kind: 'box', minMm: [180, 170, 80], maxMm: [420, 330, 120] },
  { kind: 'plane', centreMm: [0, 600, 400], halfUMm: [400, 0, 0], halfVMm: [0, 0, 400] },
];

const engine = await load();
// Part of the driver's mean gaze is taken off it: most of the time drivers look ahead.
const tracker = engine.createTracker({ gaze: 'natural' });
// A look into the lap is reported after a second.
const config = { ...engine.defaultMonitorConfig(preset), lookDownUs: 1_000_000 };
const monitor = engine.createMonitor(config, zones);
for (const { frame, timestampUs } of framesOf(video)) {
  tracker.step(frame, timestampUs);
  monitor.update(tracker.observation(), timestampUs);
  const { events, overwritten } = monitor.events();
  for (const { kind, startUs, durationUs, zone, isCut } of events) {
    const time = `${(startUs / 1e6).toFixed(2)} s for ${(durationUs / 1e6).toFixed(2)} s`;
    console.log(`${kind} from ${time}, zone ${zone}${isCut ? ' cut' : ''}`);
  }
  if (overwritten) console.log(`${overwritten} events were not read in time`);
}
const { eyes, eyesReason, drowsiness, zone, blinks, yawns, nods, perclos60 } = monitor.state();
console.log(`eyes ${eyes} (${eyesReason}), ${drowsiness}, zone ${zone}`);
console.log(`${blinks} blinks, ${yawns} yawns, ${nods} nods`);
const [p80, known] = [perclos60.p80, perclos60.known].map((share) => (100 * share).toFixed(1));
console.log(`P80 over 60 s: ${p80} % of the ${known} % that is known`);
// Somebody else sits down, in another car, and then the driver whose record was kept.
const record = monitor.save();
monitor.forgetDriver();
monitor.setZones(zones.slice(0, 1));
monitor.restore(record);
monitor.free();
