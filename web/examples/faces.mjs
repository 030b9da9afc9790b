// faces.mjs VIDEO.y4m - tracks each face of the first frame with a tracker of its own.

import { load } from 'posewise';
import { framesOf } from './frames.mjs';

const engine = await load();

/** The faces of a frame, the largest first. */
function found(frame) {
  const finder = engine.createTracker();
  const faces = [];
  for (let finished = false; !finished;) {
    // A later call may find a face again.
    finder.setExcluded(faces.map(({ faceBox }) => faceBox));
    const detected = finder.detect(frame);
    faces.push(...detected.faces);
    finished = detected.finished;
  }
  finder.free();
  const area = ({ faceBox: [, , width, height] }) => width * height;
  return faces.sort((a, b) => area(b) - area(a));
}

const group = engine.createGroup();
let trackers = [];
let results = [];

for (const { frame, timestampUs } of framesOf(process.argv[2])) {
  if (trackers.length > 0) {
    results = group.step(trackers, frame, timestampUs);
    continue;
  }
  trackers = found(frame).map(({ faceBox, yawDeg, rollDeg }) => {
    const tracker = engine.createTracker();
    results.push(tracker.stepAt(frame, timestampUs, { faceBox, yawDeg, rollDeg }));
    return tracker;
  });
  console.log(`${trackers.length} faces`);
}
for (const { state, faceBox, yawDeg } of results) {
  console.log(`${state} at ${faceBox.map((number) => number.toFixed())}, yaw ${yawDeg.toFixed()}`);
}
