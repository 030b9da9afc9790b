// faces.mjs VIDEO.y4m - tracks each face of the first frame with a tracker of its own. A tracker
// that has no face leaves those alone that the others have. ffi-examples/faces.c also says who has
// the face where two come to the same one.

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

/** Each has a tracker, and the result of its last step. */
let all = [];

const hasFace = ({ result }) => result?.state === 'tracking';

/** Steps one of them, away from the faces of the others. */
function step(own, frame, timestampUs, hint) {
  const others = all.filter((other) => other !== own && hasFace(other));
  own.tracker.setExcluded(hasFace(own) ? [] : others.map(({ result }) => result.faceBox));
  own.result = hint
    ? own.tracker.stepAt(frame, timestampUs, hint)
    : own.tracker.step(frame, timestampUs);
}

for (const { frame, timestampUs } of framesOf(process.argv[2])) {
  if (all.length === 0) {
    const faces = found(frame);
    console.log(`${faces.length} faces`);
    all = faces.map(() => ({ tracker: engine.createTracker() }));
    faces.forEach(({ faceBox, yawDeg, rollDeg }, i) => {
      step(all[i], frame, timestampUs, { faceBox, yawDeg, rollDeg });
    });
  } else {
    // Those that have a face go first.
    for (const own of [...all].sort((a, b) => hasFace(b) - hasFace(a))) {
      step(own, frame, timestampUs);
    }
  }
}
for (const { result: { state, faceBox, yawDeg } } of all) {
  console.log(`${state} at ${faceBox.map((number) => number.toFixed())}, yaw ${yawDeg.toFixed()}`);
}
