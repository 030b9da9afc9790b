// steps.mjs URL MODULE... - prints how long a step with each module takes in Chromium [ms]: in the
// quickest eight steps in a row, because other programs delay most of them, and the browser's clock
// is coarse. URL is where the page is served.

import { launch } from './browser.mjs';

const [url, ...modules] = process.argv.slice(2);
const browser = await launch();
try {
  const page = await browser.newPage();
  await page.goto(url);
  const ms = await page.evaluate(times, modules);
  for (const module of modules) console.log(`${module} ${ms[module].toFixed(4)}`);
} finally {
  await browser.close();
}

/** The shortest time of a step with each module, on the demo clip [ms]; they take turns. */
async function times(modules) {
  const { load, frameOf } = await import('/posewise.js');
  const video = document.createElement('video');
  document.body.append(video);
  video.muted = true;
  video.src = '/demo/clip.webm';
  const frames = [];
  for (let i = 0; i < 40; i++) {
    await new Promise((resolve) => {
      video.onseeked = resolve;
      video.currentTime = 0.025 + 0.05 * i;
    });
    const picture = new VideoFrame(video, { timestamp: 0 });
    const { data, ...rest } = await frameOf(picture);
    picture.close();
    frames.push({ data: data.slice(), ...rest });
  }
  const trackers = {};
  const least = {};
  for (const module of modules) {
    const engine = await load({ wasm: `/${module}`, model: '/posewise.posewise' });
    trackers[module] = engine.createTracker();
    least[module] = Infinity;
  }
  const STEPS = 8;
  for (let first = 0; first < 800; first += STEPS) {
    for (const module of modules) {
      const start = performance.now();
      for (let i = first; i < first + STEPS; i++) {
        trackers[module].step(frames[39 - Math.abs(39 - i % 78)], 50_000 * i);
      }
      const ms = (performance.now() - start) / STEPS;
      if (first >= 100) least[module] = Math.min(least[module], ms);
    }
  }
  return least;
}
