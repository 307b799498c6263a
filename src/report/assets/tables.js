// The tables of metrics and statistics.

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) if (value !== undefined && value !== null) made.setAttribute(key, value);
  made.append(...children.filter(child => child !== undefined && child !== null));
  return made;
}

function numberText(value) {
  if (typeof value !== 'number') return String(value);
  if (value === 0) return '0';
  if (Number.isInteger(value) && Math.abs(value) >= 1000) return value.toLocaleString('en').replaceAll(',', '\u202f');
  if (Number.isInteger(value)) return String(value);
  const magnitude = Math.abs(value);
  return magnitude >= 1e6 || magnitude < 1e-4 ? value.toExponential(3) : String(Number(value.toPrecision(4)));
}

function metricsTable(images) {
  const names = [], about = {};
  for (const image of images) {
    for (const metric of image.metrics) {
      if (!(metric.name in about)) names.push(metric.name);
      about[metric.name] = metric;
    }
  }
  if (!names.length) return null;
  const numeric = value => typeof value === 'number' ? value : value === 'inf' ? Infinity : value === '-inf' ? -Infinity : NaN;
  const valueOf = (image, name) => image.metrics.find(metric => metric.name === name)?.value;
  const head = element('tr', {}, element('th', {}, 'picture'),
    ...names.map(name => element('th', { title: [about[name].formula, about[name].larger_is_better ? 'larger is better' : 'smaller is better'].filter(Boolean).join(' – ') }, name)));
  const rows = images.filter(image => image.metrics.length).map(image => element('tr', {}, element('td', {}, image.name), ...names.map(name => {
    const value = valueOf(image, name);
    if (value === undefined) return element('td', {}, '–');
    const all = images.map(other => numeric(valueOf(other, name))).filter(other => !Number.isNaN(other));
    const best = all.length > 1 && numeric(value) === (about[name].larger_is_better ? Math.max(...all) : Math.min(...all));
    return element('td', best ? { class: 'best' } : {}, value === 'inf' ? '∞' : numberText(value));
  })));
  return element('table', {}, element('thead', {}, head), element('tbody', {}, ...rows));
}

// {"a": {"b": 1}} to [["a", "b", 1]]: group, key, value; arrays and deeper objects become text and longer keys.
function flatten(value, prefix = [], result = []) {
  if (value !== null && typeof value === 'object' && !Array.isArray(value)) {
    for (const [key, inner] of Object.entries(value)) flatten(inner, [...prefix, key], result);
  } else {
    const text = Array.isArray(value) ? value.map(entry => typeof entry === 'object' ? JSON.stringify(entry) : numberText(entry)).join(', ') : value;
    result.push([prefix.length > 1 ? prefix[0] : '', (prefix.length > 1 ? prefix.slice(1) : prefix).join('.'), text]);
  }
  return result;
}

function statisticText(key, value) {
  if (value === undefined || value === null) return '–';
  if (typeof value === 'number' && key.endsWith('bytes')) {
    const units = ['B', 'KiB', 'MiB', 'GiB', 'TiB'];
    let unit = 0;
    while (value >= 1024 && unit < 4) { value /= 1024; ++unit; }
    return `${numberText(Number(value.toPrecision(4)))} ${units[unit]}`;
  }
  return numberText(value);
}

function statisticsTable(images) {
  const with_statistics = images.filter(image => image.statistics !== null && image.statistics !== undefined);
  if (!with_statistics.length) return null;
  const columns = with_statistics.map(image => new Map(flatten(image.statistics).map(([group, key, value]) => [JSON.stringify([group, key]), value])));
  const groups = new Map();
  for (const column of columns) {
    for (const id of column.keys()) {
      const [group] = JSON.parse(id);
      if (!groups.has(group)) groups.set(group, new Set());
      groups.get(group).add(id);
    }
  }
  const body = element('tbody');
  for (const [group, ids] of groups) {
    if (group) body.append(element('tr', { class: 'group' }, element('td', { colspan: columns.length + 1 }, group)));
    for (const id of ids) {
      const key = JSON.parse(id)[1];
      body.append(element('tr', {}, element('td', {}, key), ...columns.map(column => element('td', {}, statisticText(key, column.get(id))))));
    }
  }
  const head = element('tr', {}, element('th', {}, ''), ...with_statistics.map(image => element('th', {}, image.name)));
  return element('table', {}, element('thead', {}, head), body);
}
