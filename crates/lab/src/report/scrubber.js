// The scrubber: a picture of the clip with landmarks, and the errors of the angles below.

/** Dots at landmarks, which are tenths of a pixel. */
function dots(points, kind) {
  const group = svg('g');
  for (let i = 0; i < points.length; i += 2) {
    group.append(svg('circle', { class: kind, cx: points[i] / 10, cy: points[i + 1] / 10,
      r: 1.6 }));
  }
  return group;
}

/** A picture with landmarks on it. */
function picture(url, width, height, alt) {
  const place = html('div', '', { class: 'picture' });
  const overlay = svg('svg', { viewBox: `0 0 ${width} ${height}`, 'aria-hidden': 'true' });
  place.append(html('img', '', { src: url, width, height, alt }), overlay);
  return { place, overlay };
}

/** The largest |value|, at least 2 and at most 30, rounded up. */
function reach(values) {
  const largest = values.reduce((a, b) => Math.max(a, Math.abs(b ?? 0)), 0);
  return Math.min(30, Math.max(2, Math.ceil(largest * 1.05)));
}

/** Fills the section of the scrubber; without pictures it goes. */
function scrubber(data, names) {
  const section = document.getElementById('scrubber');
  if (!data) {
    section.remove();
    return;
  }
  const byId = (id) => document.getElementById(`scrub-${id}`);
  const [systems, frame, number] = ['system', 'frame', 'number'].map(byId);
  byId('name').textContent = data.name;
  if (data.truth.every((points) => points.length === 0)) byId('truth').remove();
  systems.append(...names.map((name, i) => html('option', name, { value: i })));
  frame.max = data.frames - 1;
  frame.value = 0;
  const { place, overlay } = picture(data.jpegs[0], data.width, data.height, 'Frame of the clip');
  const image = place.querySelector('img');
  byId('picture').append(place);
  const errors = byId('errors');

  const series = () => {
    const system = Number(systems.value);
    const track = data.systems[system].errors;
    return ['yaw', 'pitch', 'roll'].map((name, dash) => ({ name, system, dash,
      points: track.map((error, i) => [i, error ? error[dash] : null]) }));
  };
  lines(errors, 'Errors of yaw, pitch and roll by frame', () => {
    const all = series();
    const limit = reach(all.flatMap(({ points }) => points.map(([, y]) => y)));
    return { x: { min: 0, max: Math.max(1, data.frames - 1), unit: '',
      name: 'frame (yaw ——, pitch – –, roll ···)' },
    y: { min: -limit, max: limit, unit: '°' }, series: all };
  }, () => Number(frame.value));

  const show = () => {
    const at = Number(frame.value);
    const shot = Math.min(Math.floor(at / data.every), data.jpegs.length - 1);
    image.src = data.jpegs[shot];
    const track = data.systems[Number(systems.value)];
    const points = track.points[shot];
    const found = points ? [dots(points, 'found')] : [];
    overlay.replaceChildren(dots(data.truth[shot], 'truth'), ...found);
    const error = track.errors[at];
    const text = error ? ['yaw', 'pitch', 'roll'].map((name, i) => `${name} ${error[i]}°`)
      .join(', ') : 'not tracked';
    number.textContent = `${at}: ${text}`;
    drawings.get(errors)();
  };
  frame.addEventListener('input', show);
  systems.addEventListener('change', show);
  show();
}
