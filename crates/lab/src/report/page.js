// Fills the page from its data.

const COLUMNS = [
  ['tracked_percent', 'tracked %', 1], ['within_percent', 'within 20° %', 1],
  ['yaw_deg', 'E_yaw °', -1], ['pitch_deg', 'E_pitch °', -1], ['roll_deg', 'E_roll °', -1],
  ['mean_deg', 'E_m °', -1], ['centred_deg', 'E_m, centred °', -1],
  ['nme_percent', 'NME %', -1], ['jitter_percent', 'jitter %', -1],
  ['milliseconds', 'ms', -1],
];

/** Confidences in a part of their range from which on it is shown. */
const LEAST = 10;

const { figures, worst, scrubber: scrubbed } = JSON.parse(
  document.getElementById('data').textContent);
const { systems, clips } = figures;
const names = systems.map(({ row }) => row.method);

/** A table of rows, the best value of each column bold. */
function table(place, rows) {
  const head = html('tr');
  const titles = ['tracker', 'frames', ...COLUMNS.map(([, title]) => title)];
  head.append(...titles.map((title) => html('th', title, { scope: 'col' })));
  const body = rows.map((row) => {
    const line = html('tr');
    line.append(html('th', row.method, { scope: 'row' }), html('td', row.frames));
    for (const [key, , sign] of COLUMNS) {
      const values = rows.map((other) => other[key]).filter((value) => value !== null);
      const best = Math.max(...values.map((value) => sign * value));
      const text = row[key] === null ? '–' : row[key].toFixed(2);
      const isBest = row[key] !== null && rows.length > 1 && sign * row[key] === best;
      line.append(html('td', text, isBest ? { class: 'best' } : {}));
    }
    return line;
  });
  const parts = ['thead', 'tbody'].map((name) => html(name));
  parts[0].append(head);
  parts[1].append(...body);
  place.replaceChildren(...parts);
}

/** Colours, with a box to switch a system off in the charts. */
function legend() {
  const list = document.getElementById('legend');
  names.forEach((name, system) => {
    const label = html('label');
    const box = html('input', '', { type: 'checkbox', checked: '' });
    const mark = svg('svg', { width: 18, height: 10, 'aria-hidden': 'true' });
    mark.append(svg('line', { x1: 0, x2: 18, y1: 5, y2: 5, 'stroke-width': 3,
      'stroke-dasharray': DASHES[dashOf(system)], style: `stroke:${colour(system)}` }));
    label.append(box, mark, name);
    box.addEventListener('change', () => {
      if (box.checked) hidden.delete(system);
      else hidden.add(system);
      drawAll();
    });
    const item = html('li');
    item.append(label);
    list.append(item);
  });
}

/** What the legend has not switched off. */
const seen = () => systems.map((figures, system) => ({ figures, system, name: names[system] }))
  .filter(({ system }) => !hidden.has(system));

/** Shares by error. */
function shares(id, key, unit, title) {
  lines(document.getElementById(id), title, () => {
    const all = seen().map(({ figures: { [key]: curve }, system, name }) => ({ name, system,
      points: curve.shares.map((share, i) =>
        [curve.limit * i / (curve.shares.length - 1), 100 * share]) }));
    return { x: { min: 0, max: systems[0]?.[key].limit ?? 1, unit, name: title },
      y: { min: 0, max: 100, unit: '%' }, series: all };
  });
}

/** A mean error by true yaw. */
function byYaw(id, title, value, isSigned) {
  lines(document.getElementById(id), title, () => {
    const series = seen().map(({ figures: { bands }, system, name }) => ({ name, system,
      dots: true, points: bands.map((band) => [band.yaw_deg, value(band)]) }));
    const points = series.flatMap((one) => one.points);
    const limit = reach(points.map(([, y]) => y));
    const far = Math.max(10, ...points.map(([x]) => Math.abs(x) + 5));
    return { x: { min: -far, max: far, unit: '°', name: 'true yaw' },
      y: { min: isSigned ? -limit : 0, max: limit, unit: '°' }, series };
  });
}

/** Confidence against correctness, of the first system that gives confidences. */
function calibration() {
  const figure = document.getElementById('calibration-figure');
  const system = systems.findIndex((one) => one.calibration);
  if (system < 0) {
    figure.remove();
    return;
  }
  const { face, landmarks, errors } = systems[system].calibration;
  const digits = (error) => error?.toFixed(3) ?? '–';
  const caption = `Calibration of ${names[system]}: share that is right by confidence. Face (line, `
    + `error ${digits(errors[0])}), landmarks (dashes, error ${digits(errors[1])}); the `
    + 'diagonal is perfect. Right is within a tenth of the inter-ocular distance, without the jaw. '
    + `Parts with fewer than ${LEAST} are left out.`;
  document.getElementById('calibration-caption').textContent = caption;
  const points = (bins) => bins.filter(({ count }) => count >= LEAST)
    .map(({ confidence, right }) => [100 * confidence, 100 * right]);
  lines(document.getElementById('calibration'), 'Share that is right by confidence', () => ({
    x: { min: 0, max: 100, unit: '%', name: 'confidence' },
    y: { min: 0, max: 100, unit: '%' },
    series: [
      { name: 'perfect', plain: true, colour: 'var(--edge)', points: [[0, 0], [100, 100]] },
      { name: 'face', system, dash: 0, dots: true, points: points(face) },
      { name: 'landmarks', system, dash: 1, dots: true, points: points(landmarks) },
    ],
  }));
}

/** Pictures of the worst frames of each system. */
function worstFrames() {
  const list = document.getElementById('worst-list');
  systems.forEach((figures, system) => {
    const shots = worst[system].flatMap((shot, i) => {
      if (!shot) return [];
      const { clip, frame, mean_deg: mean, signed_deg: signed } = figures.worst[i];
      const { place, overlay } = picture(shot.jpeg, 220, 220, `Frame ${frame} of ${clips[clip]}`);
      overlay.append(dots(shot.truth, 'truth'), dots(shot.found, 'found'));
      const figure = html('figure');
      const errors = signed.map((e) => `${Math.round(e) || 0}°`).join(', ');
      figure.append(place, html('figcaption',
        `${clips[clip]}, frame ${frame}: ${mean.toFixed(1)}° (yaw, pitch, roll ${errors})`));
      return [figure];
    });
    if (shots.length === 0) return;
    const row = html('div', '', { class: 'row' });
    row.append(...shots);
    list.append(html('h3', names[system]), row);
  });
  if (!list.hasChildNodes()) document.getElementById('worst').remove();
}

function main() {
  const frames = systems[0]?.row.frames ?? 0;
  document.getElementById('about').textContent = `${clips.length} clips, ${frames} frames that `
    + 'count: those with at least half of the landmarks in the picture. Written by posewise-lab.';
  table(document.getElementById('table'), systems.map(({ row }) => row));
  const choice = document.getElementById('clip');
  choice.append(...clips.map((name, i) => html('option', name, { value: i })));
  const showClip = () => table(document.getElementById('by-clip'),
    systems.map((one) => one.clips[Number(choice.value)]));
  choice.addEventListener('change', showClip);
  showClip();
  legend();
  shares('robustness', 'robustness', '°', 'mean error of the three angles');
  // Real heads may have a labelled pose and no labelled landmarks.
  const isMarked = systems.some(({ row }) => row.nme_percent !== null);
  if (isMarked) shares('ced', 'ced', '%', 'mean error of the inner landmarks');
  else document.getElementById('ced').closest('figure').remove();
  ['yaw', 'pitch', 'roll'].forEach((name, i) => byYaw(name, `${name} error by true yaw`,
    ({ signed_deg: signed }) => signed?.[i] ?? null, true));
  byYaw('mean', 'Mean absolute error by true yaw', ({ mean_deg: mean }) => mean, false);
  const timed = systems.flatMap(({ time }, system) => (time
    ? [{ name: names[system], system, time }] : []));
  times(document.getElementById('time'), 'Processor time of a step', timed);
  calibration();
  scrubber(scrubbed, names);
  worstFrames();
}

main();
