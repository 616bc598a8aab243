'use strict';
// The page: turns the pointer, keys and the slider into a camera and isovalues, has workers draw bands of rows,
// and shows them. What is drawn coarser while something moves is drawn in full when it rests, then with 4 and
// 16 samples a pixel.
(() => {
const $ = id => document.getElementById(id), canvas = $('canvas'), say = text => { $('say').textContent = text; };
const facts = JSON.parse($('facts').textContent), { volume, labels } = facts, [low, high] = volume ? volume.range : [0, 0];
const SAMPLES = [1, 4, 16], FRAME_MS = 40, REST_MS = 150, COARSEST = 4, SIDE = 4096;
// What the canvas shows, and from how many cells on moving pictures are of every second voxel. Tests look at it.
const state = { samples: 0, frames: 0, halves: 0, drawn: null, halfCells: 1e6 };
window.isopoint = state;

// ---- what is shown
const first = () => ({
  camera: [...facts.camera.position, ...facts.camera.focal, ...facts.camera.up, facts.camera.angle, facts.camera.scale],
  isovalues: facts.surfaces.map(s => s.isovalue),
  depth: 0,
});
let view = first(), moves = [], size = facts.size, cells = 0;

// A parallel projection is written as mm per pixel: its scale is what that number gives.
function settleScale(camera, height) {
  if (facts.camera.orthographic) camera[10] = 2 * camera[10] / height * height / 2;
  return camera;
}

// The point of the cut's plane, moved along its normal by view.depth mm.
function clipNumbers() {
  const [x, y, z, offset] = facts.plane, at = offset + view.depth;
  return [x * at, y * at, z * at, x, y, z];
}

// ---- the command that draws what is shown
const quote = text => /^[\w@%+=:,./-]+$/.test(text) && text[0] !== '-' ? text : `'${text.replace(/'/g, "'\\''")}'`;
const hex = color => color.toString(16).padStart(6, '0');
state.command = () => {
  const d = state.drawn, c = d.camera, list = (a, b) => c.slice(a, b).join(',');
  const name = facts.name[0] === '-' ? './' + facts.name : facts.name, png = facts.name.replace(/(\.\w+)?\.\w+$/, '') || 'picture';
  const words = ['isorender', ...facts.withoutInput ? [] : [quote(name)], quote((png[0] === '-' ? './' : '') + png + '.png'),
    ...facts.options.map(o => o.replace(/^(--[\w-]+=?)(.*)$/s, (_, option, value) => option + (value && quote(value)))),
    ...volume ? [`--isovalue=${d.isovalues.join(',')}`, `--color=${facts.surfaces.map(s => hex(s.color)).join(',')}`] : [],
    `--background=${hex(facts.background)}`, `--camera-position=${list(0, 3)}`, `--camera-focal-point=${list(3, 6)}`,
    `--camera-view-up=${list(6, 9)}`];
  if (facts.camera.orthographic) words.push(`--mm-per-pixel=${2 * c[10] / d.height}`);
  else words.push(`--view-angle=${c[9]}`);
  if (facts.plane.some(n => n)) words.push(`--clip=${d.clip.slice(0, 3).join(',')}:${d.clip.slice(3, 6).join(',')}`);
  words.push(`--resolution=${d.width}x${d.height}`, `--samples=${d.samples}`);
  return words.join(' ');
};

// ---- drawing
const workers = [];
let queue = [], frame = null, wanted = false, moving = false, timer = 0, coarse = 1, number = 0;

// Makes the picture as large as there is room; whether its size has changed.
function fit() {
  const before = size, box = canvas.parentElement, ratio = window.devicePixelRatio || 1, [w, h] = facts.size;
  const scale = Math.min(box.clientWidth * ratio / w, box.clientHeight * ratio / h, SIDE / Math.max(w, h));
  size = [w, h].map(n => Math.max(16, Math.floor(n * scale)));
  const changed = size.some((n, i) => n !== before[i]);
  canvas.style.width = size[0] / ratio + 'px';
  canvas.style.height = size[1] / ratio + 'px';
  return changed;
}

function give(worker) {
  const band = queue.shift();
  worker.idle = !band;
  if (band) worker.postMessage(band);
}

// Draws the view: coarser while it moves, else with so many samples. Bands of an earlier picture that no
// worker has begun are dropped.
function draw(samples) {
  if (frame && frame.left - queue.length > 0) { // a picture is being drawn: its bands end first
    wanted = true;
    frame.left -= queue.length;
    frame.dropped ||= queue.length > 0;
    queue = [];
    return;
  }
  wanted = false;
  const [width, height] = size.map(n => Math.max(16, Math.round(n / (moving ? coarse : 1))));
  const bands = Math.min(height, workers.length * (moving ? 1 : samples === 1 ? 2 : 8)), clip = clipNumbers();
  frame = { number: ++number, width, height, samples, moving, coarse: moving ? coarse : 1, left: bands, start: performance.now(),
    image: new ImageData(width, height), isovalues: [...view.isovalues], clip, half: moving && !!volume && cells > state.halfCells };
  const job = { frame: frame.number, width, height, samples, half: frame.half, moves: moves.splice(0),
    camera: settleScale(view.camera.slice(), height), clip: [...clip, facts.cap],
    surfaces: [...facts.surfaces.map((s, i) => ({ ...s, isovalue: view.isovalues[i], group: 0 })),
      ...labels ? labels.groups.map((s, i) => ({ ...s, isovalue: 0, group: i + 1 })) : []] };
  for (let i = 0; i < bands; i++) {
    const from = Math.floor(height * i / bands), to = Math.floor(height * (i + 1) / bands);
    queue.push({ ...job, first: from, rows: to - from });
  }
  workers.filter(w => w.idle).forEach(give);
}

function take(worker, m) {
  if (m.failed) return fail(m.failed);
  give(worker);
  frame.image.data.set(m.pixels, m.first * frame.width * 4);
  view.camera = m.camera.slice();
  if (m.cells) cells = m.cells;
  if (--frame.left) return;
  const done = frame, ms = performance.now() - done.start;
  frame = null;
  if (!done.dropped) show(done, m.camera, ms);
  next(done);
}

function show(done, camera, ms) {
  if (canvas.width !== done.width || canvas.height !== done.height) [canvas.width, canvas.height] = [done.width, done.height];
  canvas.getContext('2d', { alpha: false }).putImageData(done.image, 0, 0);
  document.body.classList.add('live');
  state.drawn = { camera, isovalues: done.isovalues, clip: done.clip, width: done.width, height: done.height, samples: done.samples };
  state.samples = done.moving || wanted ? 0 : done.samples;
  state.frames++;
  if (done.half) state.halves++;
  // (a browser's first pictures are slow: its compiler is still at work)
  if (done.moving && state.frames > 3) coarse = Math.max(1, Math.min(COARSEST, done.coarse * Math.sqrt(ms / FRAME_MS)));
  $('speed').textContent = `${done.width} × ${done.height}${done.samples > 1 ? `, ${done.samples} samples` : ''}, ${ms.toFixed(0)} ms`;
}

// What is drawn after a picture: what has moved meanwhile, or more samples.
function next(done) {
  if (wanted) return draw(1);
  if (moving) return;
  const better = done.moving ? 1 : SAMPLES[SAMPLES.indexOf(done.samples) + 1];
  if (better) draw(better);
}

function move(...what) {
  if (what.length) moves.push(what);
  state.samples = 0;
  moving = true;
  clearTimeout(timer);
  timer = setTimeout(() => { moving = false; draw(1); }, REST_MS);
  draw(1);
}

function fail(why) {
  document.body.classList.remove('live');
  ['reset', 'save', 'copy', 'rows'].forEach(id => { $(id).hidden = true; });
  say(`This is a still picture: ${why}.`);
  state.failed = why;
}

// ---- pointers, wheel and keys
const fingers = new Map();
const unit = () => 1 / Math.min(canvas.clientWidth, canvas.clientHeight);
const spread = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };

canvas.addEventListener('pointerdown', event => {
  canvas.focus();
  canvas.setPointerCapture(event.pointerId);
  fingers.set(event.pointerId, { x: event.clientX, y: event.clientY, pans: event.button > 0 || event.shiftKey });
});
canvas.addEventListener('pointermove', event => {
  const finger = fingers.get(event.pointerId);
  if (!finger) return;
  const before = fingers.size === 2 ? spread() : 0, dx = event.clientX - finger.x, dy = event.clientY - finger.y;
  [finger.x, finger.y] = [event.clientX, event.clientY];
  if (fingers.size === 2) {
    if (before > 0) move('zoom', spread() / before);
    move('pan', dx / 2 / canvas.clientHeight, dy / 2 / canvas.clientHeight);
  } else if (finger.pans) move('pan', dx / canvas.clientHeight, dy / canvas.clientHeight);
  else move('orbit', -180 * dx * unit(), 180 * dy * unit());
});
['pointerup', 'pointercancel'].forEach(name => canvas.addEventListener(name, event => fingers.delete(event.pointerId)));
canvas.addEventListener('contextmenu', event => event.preventDefault());
canvas.addEventListener('wheel', event => {
  event.preventDefault();
  const pixels = event.deltaY * (event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1);
  if (pixels) move('zoom', Math.exp(Math.max(-0.5, Math.min(0.5, -pixels / 500))));
}, { passive: false });
const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
canvas.addEventListener('keydown', event => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const turn = turns[event.key], step = (high - low) / 100;
  if (turn && event.shiftKey) move('pan', turn[0] / 20, -turn[1] / 20);
  else if (turn) move('orbit', 10 * turn[0], 10 * turn[1]);
  else if (event.key === '+' || event.key === '=') move('zoom', 1.1);
  else if (event.key === '-') move('zoom', 1 / 1.1);
  else if (volume && (event.key === '[' || event.key === ']')) setIsovalue(0, view.isovalues[0] + (event.key === ']' ? step : -step));
  else if (event.key === 'Home') reset();
  else if (event.key === 's') save();
  else if (event.key === 'c' && facts.options) copy();
  else return;
  event.preventDefault();
});

// ---- isovalues, and what else there is to press
const rows = [];
function setIsovalue(i, value) {
  if (!Number.isFinite(value)) return;
  view.isovalues[i] = Math.max(low, Math.min(high, value));
  showIsovalue(i);
  move();
}
function showIsovalue(i) {
  const text = String(+view.isovalues[i].toPrecision(8));
  rows[i].number.value = text;
  rows[i].slider.value = view.isovalues[i];
  describe();
}
function describe() {
  const what = [volume && `Surface of ${facts.name} at isovalue ${view.isovalues.join(', ')}`, labels && `Labels: ${drawnLabels().map(l => l.name).join(', ')}`,
    facts.lines.length && `${facts.lines.reduce((sum, l) => sum + l.lines, 0)} lines`];
  canvas.setAttribute('aria-label', what.filter(text => text).join('. ') + '. Arrow keys turn it, with Shift they move it; plus and minus zoom; ' +
    (volume ? 'brackets change the isovalue; ' : '') + 'Home resets; S saves a PNG; C copies the command.');
}
function element(name, attributes) {
  const made = Object.assign(document.createElement(name), attributes);
  return made;
}
function makeSwatch(color) {
  const swatch = element('span', { className: 'swatch' });
  swatch.style.background = '#' + hex(color);
  return swatch;
}
const drawnLabels = () => labels.items.filter(label => label.group);
function makeLegend() {
  drawnLabels().forEach(label => {
    const item = element('li', {});
    item.append(makeSwatch(label.color), label.name);
    $('legend').append(item);
  });
  $('legend').hidden = false;
}
function makeRow(i) {
  const row = element('div', { className: 'row' }), label = element('label', { textContent: 'Isovalue', htmlFor: 'slider' + i });
  const slider = element('input', { type: 'range', id: 'slider' + i, min: low, max: high, step: (high - low) / 1000 || 'any' });
  const number = element('input', { type: 'number', id: 'number' + i, min: low, max: high, step: 'any' });
  number.setAttribute('aria-label', `Isovalue, ${low} to ${high}`);
  slider.disabled = !(high > low);
  slider.addEventListener('input', () => setIsovalue(i, slider.valueAsNumber));
  number.addEventListener('change', () => setIsovalue(i, number.valueAsNumber));
  if (facts.surfaces.length > 1 || labels) row.append(makeSwatch(facts.surfaces[i].color));
  row.append(label, slider, number);
  $('rows').append(row);
  rows[i] = { slider, number };
  showIsovalue(i);
}
// Where the plane of the cut is: between the ends of the volume along its normal.
function makeCut() {
  const [x, y, z, offset] = facts.plane, { dims, transform: t } = volume || labels || facts.box;
  if (!(x || y || z)) return;
  const ends = [0, 1, 2, 3, 4, 5, 6, 7].map(corner => {
    const index = [0, 1, 2].map(a => (corner >> a & 1) * (dims[a] - 1) * t[3 + a]);
    const world = [0, 1, 2].map(row => t[row] + [0, 1, 2].reduce((sum, a) => sum + t[6 + 3 * row + a] * index[a], 0));
    return x * world[0] + y * world[1] + z * world[2] - offset;
  });
  const [least, most] = [Math.min(...ends), Math.max(...ends)], row = element('div', { className: 'row' });
  const slider = element('input', { type: 'range', id: 'cut', min: least, max: most, step: (most - least) / 1000 || 'any', value: 0 });
  slider.addEventListener('input', () => { view.depth = slider.valueAsNumber; move(); });
  row.append(element('label', { textContent: 'Cut', htmlFor: 'cut' }), slider);
  $('rows').append(row);
  resets.push(() => { slider.value = 0; });
}
const resets = [];
function reset() {
  view = first();
  view.isovalues.forEach((_, i) => showIsovalue(i));
  resets.forEach(f => f());
  moves = [];
  move();
}
function download(blob, name) {
  const link = element('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
function save() {
  canvas.toBlob(blob => download(blob, facts.name.replace(/(\.\w+)?\.\w+$/, '') + '.png'));
}
async function copy() {
  const text = state.command();
  try {
    await navigator.clipboard.writeText(text);
    say('Copied: ' + text);
  } catch {
    say(text);
    getSelection().selectAllChildren($('say'));
  }
}

// ---- beginning
async function unpack(id) {
  const text = $(id).textContent, packed = new Uint8Array(text.length / 4 * 3 - (text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0));
  const PART = 1 << 20; // characters at a time: strings of megabytes are slow
  for (let at = 0; at < text.length; at += PART) {
    const bytes = atob(text.slice(at, at + PART));
    for (let i = 0, to = at / 4 * 3; i < bytes.length; i++) packed[to + i] = bytes.charCodeAt(i);
  }
  $(id).remove();
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();
}

// A function that returns a vector: what a browser with SIMD accepts.
const simd = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11);

function startWorker(url, message) {
  return new Promise((done, failed) => {
    const worker = new Worker(url);
    worker.onerror = event => { event.preventDefault(); failed(new Error('its workers cannot start' + (event.message ? `: ${event.message}` : ''))); };
    worker.onmessage = ({ data }) => {
      if (data.failed) return failed(new Error(data.failed));
      worker.onerror = event => fail(event.message || 'a worker has stopped');
      worker.onmessage = reply => take(worker, reply.data);
      worker.idle = true;
      workers.push(worker);
      done();
    };
    worker.postMessage(message);
  });
}

async function begin() {
  if (typeof WebAssembly !== 'object') throw new Error('this browser has no WebAssembly, or it is switched off');
  if (!WebAssembly.validate(simd)) throw new Error('this browser has no WebAssembly with SIMD (browsers from 2023 on have it)');
  if (typeof DecompressionStream !== 'function') throw new Error('this browser cannot unpack the page (browsers from 2023 on can)');
  const dark = [16, 8, 0].reduce((sum, shift) => sum + (facts.background >> shift & 255), 0) < 384;
  document.body.style.setProperty('--paper', '#' + hex(facts.background));
  document.body.style.setProperty('--ink', dark ? '#eee' : '#222');
  const none = new ArrayBuffer(0);
  const [engine, voxels, numbers, lines] = await Promise.all([unpack('engine'), volume ? unpack('voxels') : none, labels ? unpack('labels') : none,
    facts.lines.length ? unpack('lines') : none]);
  const module = await WebAssembly.compile(engine), url = URL.createObjectURL(new Blob([$('worker').textContent], { type: 'text/javascript' }));
  // Each worker has the voxels, and cells of about as many bytes; labels take more: their numbers and level sets; of lines there is a copy.
  const room = Math.floor(1e9 / (2 * voxels.byteLength + 6 * numbers.byteLength + 2 * lines.byteLength + 2e7)), count = Math.max(1, Math.min(8, navigator.hardwareConcurrency || 1, room));
  await Promise.all(Array.from({ length: count }, () => startWorker(url, { module, voxels, labels: numbers, lines, facts })));
  facts.surfaces.forEach((_, i) => makeRow(i));
  if (labels) makeLegend();
  describe();
  makeCut();
  ['reset', 'save', ...facts.options ? ['copy'] : []].forEach(id => { $(id).hidden = false; });
  $('reset').onclick = reset;
  $('save').onclick = save;
  $('copy').onclick = copy;
  say('Drag to turn, wheel or pinch to zoom, Shift and drag to move.');
  fit();
  draw(1);
  new ResizeObserver(() => { if (fit()) move(); }).observe(canvas.parentElement);
}
begin().catch(error => fail(error.message || String(error)));
})();
