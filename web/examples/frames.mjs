// The frames of a y4m video of 8-bit luma, with or without chroma, as ffmpeg writes it:
//     ffmpeg -i drive.mp4 -pix_fmt yuv420p -f yuv4mpegpipe drive.y4m

import { readFileSync } from 'node:fs';

/**
 * Yields frames and their times [us].
 * @param {string} path
 */
export function* framesOf(path) {
  const bytes = readFileSync(path);
  const line = (at) => bytes.toString('latin1', at, bytes.indexOf('\n', at));
  const words = line(0).split(' ');
  const word = (letter) => words.find((each) => each.startsWith(letter))?.slice(1) ?? '';
  const [width, height] = [Number(word('W')), Number(word('H'))];
  const [rate, scale] = word('F').split(':').map(Number);
  const chroma = word('C') === 'mono' ? 0 : 2 * Math.ceil(width / 2) * Math.ceil(height / 2);
  let at = line(0).length + 1;
  for (let i = 0; at < bytes.length; i++) {
    at += line(at).length + 1;
    const data = bytes.subarray(at, at + width * height);
    yield { frame: { data, width, height }, timestampUs: (i * 1e6 * scale) / rate };
    at += data.length + chroma;
  }
}
