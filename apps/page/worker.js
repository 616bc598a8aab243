'use strict';
// One engine: draws rows of pictures. The first message has what it needs, each later one is a band of rows.
let engine, facts;
const floats = (at, count) => new Float64Array(engine.memory.buffer, at, count); // made anew: memory grows

function errorText() {
  const bytes = new Uint8Array(engine.memory.buffer, engine.error_text()), end = bytes.indexOf(0);
  return new TextDecoder().decode(bytes.slice(0, end)) || 'out of memory';
}

function check(status) {
  if (status) throw new Error(errorText());
}

// Copies bytes into the engine's memory; where they are.
function keep(buffer) {
  const at = engine.alloc(buffer.byteLength);
  if (!at) throw new Error('out of memory');
  new Uint8Array(engine.memory.buffer, at, buffer.byteLength).set(new Uint8Array(buffer));
  return at;
}

async function start(m) {
  const missing = name => () => { throw new Error('the engine has no ' + name); };
  const imports = {
    wasi_snapshot_preview1: new Proxy({}, { get: () => () => 8 }), // no files
    env: new Proxy({}, { get: (_, name) => missing(name) }),
  };
  facts = m.facts;
  engine = (await WebAssembly.instantiate(m.module, imports)).exports;
  const { volume, labels } = facts;
  if (volume) check(engine.volume(...volume.dims, volume.type, keep(m.voxels), volume.scale, volume.offset, keep(Float64Array.from(volume.transform).buffer), volume.levelSet));
  if (labels) {
    check(engine.labels(...labels.dims, labels.type, keep(m.labels), keep(Float64Array.from(labels.transform).buffer), labels.items.length + 1));
    labels.items.forEach((label, i) => engine.label(i + 1, label.group, label.color));
    check(engine.groups(labels.groups.length, labels.shared, facts.cap));
  }
  let at = 0;
  for (const l of facts.lines) {
    const origin = keep(Float64Array.from(l.origin).buffer);
    check(engine.lines(l.vertices, l.lines, keep(m.lines.slice(at, at += l.bytes)), l.has, origin, l.radius ?? NaN, l.minPixels, l.style, l.caps, l.color, l.opacity, l.constant, l.absorption, l.layers));
  }
  engine.background(facts.background);
  postMessage({ ready: true });
}

function draw(m) {
  const start = performance.now(), c = engine.camera();
  floats(c, 10).set(m.camera.slice(0, 10));
  floats(c, 12)[11] = m.camera[10];
  m.moves.forEach(([name, ...numbers]) => engine[name](...numbers));
  m.surfaces.forEach((s, i) => engine.surface(i, s.isovalue, s.color, s.opacity, s.constant, s.absorption, s.layers, s.group));
  engine.clip(...m.clip);
  const at = engine.draw(m.width, m.height, m.first, m.rows, m.samples, facts.camera.orthographic, m.half);
  if (!at) throw new Error(errorText());
  const pixels = new Uint8ClampedArray(engine.memory.buffer, at, m.width * m.rows * 4).slice();
  const numbers = floats(c, 12), camera = [...numbers.slice(0, 10), numbers[11]];
  postMessage({ frame: m.frame, first: m.first, rows: m.rows, pixels, camera, cells: m.half ? 0 : engine.cells(), ms: performance.now() - start }, [pixels.buffer]);
}

onmessage = async ({ data }) => {
  try {
    if (data.module) await start(data);
    else draw(data);
  } catch (error) {
    postMessage({ failed: String(error.message || error) });
  }
};
