// The compare report: state, controls, keys, and the page's check of itself.

const root = document.documentElement;
const find = id => document.getElementById(id);
const data = JSON.parse(find('data').textContent);

function fail(reason) {
  if (root.dataset.selfCheck?.startsWith('failed')) return;
  root.dataset.selfCheck = `failed: ${reason}`;
  document.body.prepend(element('p', { class: 'problem' }, `This report is damaged: ${reason}`));
}
window.addEventListener('error', event => fail(event.message));
window.addEventListener('unhandledrejection', event => fail(event.reason?.message ?? event.reason));

const MODES = { wipe: 'Wipe', side: 'Side by side', single: 'Single', error: 'Error' };
const state = { mode: 'wipe', left: 0, right: data.images.length > 1 ? 1 : 0, exposure: 0, tone: 'srgb', kind: 'relative', range: 1, rangeChosen: false };
const pictures = [];  // decoded pictures with their canvases
let viewport;

// A picture's canvas under the exposure and tone map in force; drawn again only when these have changed.
function tonedCanvas(k) {
  const picture = pictures[k], key = `${state.tone} ${state.exposure}`;
  if (picture.tonedKey !== key) {
    drawToned(picture, picture.toned, toneTable(state.tone, state.exposure));
    picture.tonedKey = key;
  }
  return picture.toned;
}

function errorValues(k) {
  const picture = pictures[k];
  picture.errors ??= {};
  return picture.errors[state.kind] ??= errorMap(picture, pictures[0], state.kind);
}

function errorCanvas(k) {
  const picture = pictures[k], values = errorValues(k);
  if (!state.rangeChosen) {
    // Powers of two keep the legend's numbers short.
    const usual = usualError(values);
    setRange(usual > 0 ? Math.ceil(Math.log2(usual)) : 0);
  }
  const key = `${state.kind} ${state.range}`;
  if (picture.errorKey !== key) {
    picture.errorCanvas ??= element('canvas', { width: data.width, height: data.height });
    drawError(values, state.kind, state.range, picture.errorCanvas);
    picture.errorKey = key;
  }
  return picture.errorCanvas;
}

function setRange(exponent) {
  state.range = 2 ** exponent;
  find('error-range').value = exponent;
  find('error-range-value').textContent = numberText(Number(state.range.toPrecision(3)));
}

function errorOf() { return state.right !== 0 ? state.right : Math.min(1, pictures.length - 1); }

function refresh() {
  const label = k => data.images[k].name, pane = k => ({ canvas: tonedCanvas(k), label: label(k) });
  let panes, legend = null;
  if (state.mode === 'single') {
    panes = [pane(state.right)];
  } else if (state.mode === 'error') {
    const k = errorOf(), kind = ERROR_KINDS[state.kind];
    panes = [{ canvas: errorCanvas(k), label: label(k) }];
    const high = numberText(Number(state.range.toPrecision(3)));
    legend = { table: colorTable(kind.signed ? 'balance' : 'heat'), low: kind.signed ? `−${high}` : '0', high, label: kind.label };
  } else {
    panes = [pane(state.left), pane(state.right)];
  }
  viewport.show(state.mode, panes, legend);
  document.querySelector('.stage').classList.toggle('shows-error', state.mode === 'error');
  for (const button of find('modes').children) button.setAttribute('aria-pressed', button.dataset.mode === state.mode);
  const two = state.mode === 'wipe' || state.mode === 'side';
  [...find('pictures').children].forEach((button, k) => {
    const right = k === (state.mode === 'error' ? errorOf() : state.right), left = two && k === state.left;
    const text = [left && 'L', right && (two ? 'R' : '●')].filter(Boolean).join(' ');
    button.querySelector('.side').textContent = text;
    if (text) button.dataset.side = text; else delete button.dataset.side;
  });
}

function probe(at) {
  if (!at) { find('probe').textContent = ''; return; }
  const i = at.y * data.width + at.x;
  const shown = state.mode === 'single' ? [state.right] : state.mode === 'error' ? [0, errorOf()] : [state.left, state.right];
  const parts = shown.map(k => `${data.images[k].name}  ${pictures[k].channels.map(channel => numberText(HALF_VALUES[channel[i]])).join('  ')}`);
  if (state.mode === 'error') parts.push(`error  ${numberText(errorValues(errorOf())[i])}`);
  find('probe').textContent = `(${at.x}, ${at.y})    ${parts.join('    ')}`;
}

function choose(k, asLeft) {
  if (k >= pictures.length) return;
  if (asLeft) state.left = k; else state.right = k;
  refresh();
}

function setMode(mode) {
  state.mode = mode;
  refresh();
}

function setExposure(value) {
  state.exposure = Math.min(10, Math.max(-10, Math.round(value * 10) / 10));
  find('exposure').value = state.exposure;
  find('exposure-value').textContent = (state.exposure > 0 ? '+' : '') + state.exposure.toFixed(1);
  refresh();
}

// A link can say what to show first: #mode=error&right=2&exposure=1.5&tone=aces&kind=signed
function readFragment() {
  const wanted = new URLSearchParams(location.hash.slice(1)), index = name => Number(wanted.get(name));
  if (wanted.get('mode') in MODES) state.mode = wanted.get('mode');
  if (wanted.get('tone') in TONE_MAPS) state.tone = find('tonemap').value = wanted.get('tone');
  if (wanted.get('kind') in ERROR_KINDS) state.kind = find('error-kind').value = wanted.get('kind');
  for (const side of ['left', 'right']) if (wanted.has(side) && index(side) in pictures) state[side] = index(side);
  if (Number.isFinite(index('exposure'))) setExposure(index('exposure'));
}

function buildControls() {
  for (const [mode, label] of Object.entries(MODES)) {
    const button = element('button', { 'data-mode': mode, title: `${label} (${mode[0].toUpperCase()})` }, label);
    button.addEventListener('click', () => setMode(mode));
    find('modes').append(button);
  }
  for (const name of Object.keys(TONE_MAPS)) find('tonemap').append(element('option', { value: name }, name));
  for (const [kind, { label }] of Object.entries(ERROR_KINDS)) find('error-kind').append(element('option', { value: kind }, label));
  find('error-kind').value = state.kind;
  find('exposure').addEventListener('input', event => setExposure(Number(event.target.value)));
  find('exposure').addEventListener('dblclick', () => setExposure(0));
  find('tonemap').addEventListener('change', event => { state.tone = event.target.value; refresh(); });
  find('error-kind').addEventListener('change', event => { state.kind = event.target.value; state.rangeChosen = false; refresh(); });
  find('error-range').addEventListener('input', event => { state.rangeChosen = true; setRange(Number(event.target.value)); refresh(); });
  find('fit').addEventListener('click', () => viewport.fit());
  find('pixels').addEventListener('click', () => viewport.zoomTo(1 / (window.devicePixelRatio || 1)));
  window.addEventListener('keydown', event => {
    if (event.target.matches('input, select') || event.ctrlKey || event.metaKey || event.altKey) return;
    if (/^Digit[0-9]$/.test(event.code)) { choose(Number(event.code[5]), event.shiftKey); return; }
    const actions = {
      w: () => setMode('wipe'), s: () => setMode('side'), i: () => setMode('single'), e: () => setMode('error'), f: () => viewport.fit(),
      '+': () => setExposure(state.exposure + 0.5), '-': () => setExposure(state.exposure - 0.5),
      ArrowRight: () => choose((state.right + 1) % pictures.length), ArrowLeft: () => choose((state.right + pictures.length - 1) % pictures.length),
    };
    actions[event.key]?.();
  });
}

function buildPictureList() {
  data.images.forEach((image, k) => {
    const thumbnail = element('canvas', { width: 180, height: Math.max(1, Math.round(180 * data.height / data.width)) });
    const context = thumbnail.getContext('2d');
    context.imageSmoothingQuality = 'high';
    context.drawImage(tonedCanvas(k), 0, 0, thumbnail.width, thumbnail.height);
    const facts = k === 0 ? 'reference' : image.metrics.slice(0, 2).map(metric => `${metric.name} ${numberText(metric.value)}`).join('   ');
    const button = element('button', { class: 'picture', title: `${image.name}: click shows it right of the divider, with Shift left of it (key ${k})` }, thumbnail,
      element('span', { class: 'name' }, image.name, element('span', { class: 'side' })), element('span', { class: 'facts' }, facts));
    button.addEventListener('click', event => choose(k, event.shiftKey));
    find('pictures').append(button);
  });
}

function fillSheet(id, title, content) {
  if (content) find(id).append(element('h2', {}, title), content);
}

// What the page promises, tried out: the pictures are those that were packed, they can be drawn in every mode, the tables are there.
function checkSelf() {
  pictures.forEach((picture, k) => {
    const mean = meanLuminance(picture), expected = data.images[k].mean_luminance;
    if (!(Math.abs(mean - expected) <= 1e-9 * Math.max(1, Math.abs(expected)))) fail(`picture ${k} has mean ${mean} instead of ${expected}`);
  });
  const shown = state.mode;
  const sample = element('canvas', { width: 64, height: 64 }).getContext('2d', { willReadFrequently: true });
  for (const mode of Object.keys(MODES)) {
    setMode(mode);
    sample.clearRect(0, 0, 64, 64);
    sample.drawImage(viewport.canvas, 0, 0, 64, 64);
    const drawn = sample.getImageData(0, 0, 64, 64).data.some((value, i) => i % 4 === 3 && value > 0);
    if (!drawn) fail(`nothing is drawn in mode ${mode}`);
  }
  for (const kind of Object.keys(ERROR_KINDS)) {
    const differs = errorMap(pictures[0], pictures[0], kind).some(value => value !== 0 && !Number.isNaN(value));
    if (differs) fail(`the ${kind} error of the reference against itself is not zero`);
  }
  setMode(shown);
  if (data.images.some(image => image.metrics.length) && !document.querySelector('#metrics tbody tr')) fail('the table of metrics is empty');
  if (data.images.some(image => image.statistics) && !document.querySelector('#statistics tbody tr')) fail('the table of statistics is empty');
  if (!root.dataset.selfCheck) root.dataset.selfCheck = 'ok';
}

async function start() {
  find('title').textContent = data.title;
  find('subtitle').textContent = `${data.width} × ${data.height}, ${data.images.length} pictures`;
  for (const image of data.images) {
    const picture = await decodePicture(image.pixels, data.width, data.height);
    image.pixels = null;
    picture.toned = element('canvas', { width: data.width, height: data.height });
    pictures.push(picture);
  }
  viewport = new Viewport(find('viewport'), data.width, data.height);
  viewport.onProbe = probe;
  viewport.onChange = () => { find('zoom').textContent = `${Math.round(100 * viewport.zoom * (window.devicePixelRatio || 1))} %`; };
  buildControls();
  buildPictureList();
  fillSheet('metrics', 'Metrics', metricsTable(data.images));
  fillSheet('statistics', 'Statistics', statisticsTable(data.images));
  fillSheet('notes', 'Notes', data.notes.length ? element('ul', {}, ...data.notes.map(note => element('li', {}, note))) : null);
  const key = text => element('kbd', {}, text);
  find('footer').append(data.command ? `${data.command} · ` : '', key('0'), '–', key('9'), ' picture (with ', key('Shift'), ' the left one)  ', key('←'), ' ', key('→'),
    ' next  ', key('W'), ' ', key('S'), ' ', key('I'), ' ', key('E'), ' view  ', key('+'), ' ', key('−'), ' exposure  ', key('F'), ' fit; wheel zooms, dragging moves');
  viewport.fit();
  readFragment();
  refresh();
  checkSelf();
}

start().catch(error => fail(error.message));
