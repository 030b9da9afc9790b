// What a caller writes in TypeScript; it is only checked.

import {
  FaceTracker, PosewiseError, load, type MonitorEvent, type Observation, type Tracked, type Zone,
} from '../posewise.js';

export async function inAWorker(video: HTMLVideoElement): Promise<string[]> {
  const tracker = await FaceTracker.create({ model: 'research.posewise', config: { minFacePx: 60 } });
  const tracked: Tracked = await tracker.track(video, 1e6 * video.currentTime);
  const { state, yawDeg, faceBox, loss } = tracked.result;
  const [x, y, width, height]: [number, number, number, number] = faceBox;
  if (state === 'tracking' && loss === 'none') console.log(yawDeg, x + y + width + height);
  // @ts-expect-error A state has one of three names.
  if (state === 'lost') console.log('never');
  const nose = tracked.landmarks[30];
  console.log(nose.x, nose.xMm, nose.visibility, tracked.animation[0]);
  if (tracker.model?.terms === 'research') console.log(tracker.model.name, tracker.parts);
  tracker.close();
  return tracker.animationNames;
}

export async function inThisThread(data: Uint8Array): Promise<number> {
  const engine = await load({ model: new URL('research.posewise', 'https://example.org/') });
  const tracker = engine.createTracker({ lens: { model: 'brown', coefficients: [0, 0, 0, 0, 0] } });
  const result = tracker.step({ data, width: 640, height: 480, format: 'NV12' }, 0);
  // @ts-expect-error The height is missing.
  tracker.step({ data, width: 640 }, 1);
  for (const { kind, timestampUs } of tracker.events().events) console.log(kind, timestampUs);
  return result.rotationSigmaDeg[1];
}

export async function aDriver(video: HTMLVideoElement): Promise<MonitorEvent[]> {
  const road: Zone = { kind: 'angles', yawDeg: [-20, 20], pitchDeg: [-15, 15], isRoad: true };
  // @ts-expect-error A box has corners.
  const box: Zone = { kind: 'box', yawDeg: [-20, 20], pitchDeg: [-15, 15] };
  const tracker = await FaceTracker.create({
    config: { gaze: 'natural' }, monitor: { preset: 'euro-ncap', fixedPose: true }, zones: [road],
  });
  const { monitor } = await tracker.track(video, 0, { faceBox: [1, 2, 30, 40] });
  // @ts-expect-error There may be no monitor.
  console.log(monitor.state);
  if (monitor?.state.eyes === 'closed' && monitor.state.zone !== 'unknown') console.log(box);
  await tracker.setZones([road]);
  await tracker.forgetDriver();
  return monitor?.events ?? [];
}

export async function observed(seen: Observation): Promise<number | undefined> {
  const monitor = (await load()).createMonitor({ preset: 'eu-ddaw' });
  try {
    monitor.update({ ...seen, state: 'tracking', eyeOpen: [1, 1] }, 0);
  } catch (error) {
    if (error instanceof PosewiseError && error.code === 'E_TIME') return error.status;
  }
  // @ts-expect-error No preset has this name.
  (await load()).createMonitor({ preset: 'generous' });
  return monitor.state().perclos60.p80;
}
