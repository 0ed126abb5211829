// SPDX-License-Identifier: MIT
// What stands beside the picture: legends, curves, options, stages, plan, log.
'use strict';

const element = (tag, name, text) => {
  const made = document.createElement(tag);
  if (name) made.className = name;
  if (text !== undefined) made.textContent = text;
  return made;
};
const by_id = (id) => document.getElementById(id);

// "0.0123", "1.2e-7": `digits` of them.
function short(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '';
  if (value === 0) return '0';
  const size = Math.abs(value);
  return size >= 1e-3 && size < 1e5 ? String(Number(value.toPrecision(digits))) : value.toExponential(Math.max(0, digits - 2));
}
function duration(seconds) {
  if (seconds === null || seconds === undefined || seconds < 0) return '?';
  const whole = Math.round(seconds), pad = (number) => String(number).padStart(2, '0');
  const clock = `${pad(Math.floor(whole / 60) % 60)}:${pad(whole % 60)}`;
  return whole >= 3600 ? `${Math.floor(whole / 3600)}:${clock}` : clock;
}

// Units and formulas of the fields, which the program tells.
const words = (() => {
  let known = {};
  // Of "velocity", "velocity_x".
  function of(name) {
    const found = known[name] || known[name.replace(/_[xyz]$/, '')];
    if (!found) return {unit: '', formula: 'a field of the case or of the file'};
    const part = known[name] ? '' : `${name.slice(-1)} component of `;
    return {unit: found.unit, formula: part + found.formula};
  }
  function title(name) {
    const {unit, formula} = of(name);
    return `${name}: ${formula}\nunit: ${unit || 'none'}`;
  }
  return {of, title, set: (fields) => { known = fields || {}; }};
})();

// One legend a family: what colours it, and from where to where. A bound that was typed stays; an empty one follows.
// Two runs beside each other share it, and the bounds are those of both.
const legends = (() => {
  const made = new Map();
  function make(block) {
    const box = element('div', 'legend'), choice = element('select'), scale = element('div', 'scale');
    const ends = element('div', 'ends'), low = element('input'), unit = element('span'), high = element('input');
    choice.title = 'what colours ' + block.family;
    low.title = high.title = 'bound of the colours; empty: that of the frame';
    scale.style.background = picture.css;
    const head = element('div', 'head'), formula = element('div', 'formula');
    head.append(element('span', '', block.family), unit);
    head.onclick = () => box.classList.toggle('open');  // where nothing hovers
    ends.append(low, high);
    box.append(head, formula, choice, scale, ends);
    let axis = null;
    if (block.kind === 'plane') {
      axis = element('select');
      axis.title = 'the plane through the field';
      axis.append(new Option('no plane', -1));
      for (const [k, name] of ['x', 'y', 'z'].entries()) axis.append(new Option('across ' + name, k));
      axis.value = block.axes[2];
      const at = element('input');
      Object.assign(at, {type: 'range', min: 0, max: 1, step: 0.01, value: link.wish.plane.at, title: 'place of the plane'});
      axis.onchange = at.oninput = () => {
        picture.set_planes(axis.value !== '-1');
        if (axis.value !== '-1') link.wish.plane = {axis: Number(axis.value), at: Number(at.value)};
        link.ready();
      };
      const both = element('label');
      both.append(axis, at);
      box.append(both, surface_choice());
    }
    by_id('legends').append(box);
    const one = {box, head, formula, choice, low, high, unit, names: '', wanted: {}};
    choice.onchange = () => {
      link.wish.fields[block.family] = choice.value;
      one.wanted = {};
      link.ready();
    };
    for (const [name, input] of [['low', low], ['high', high]])
      input.onchange = () => {
        const value = input.value.trim() === '' ? NaN : Number(input.value);
        if (Number.isFinite(value)) one.wanted[name] = value;
        else delete one.wanted[name];
        picture.show_again();
      };
    made.set(block.family, one);
    return one;
  }
  // A surface where the field that colours the plane has one value, from the left end of the colours to the right.
  function surface_choice() {
    const row = element('label'), on = element('input'), at = element('input');
    Object.assign(on, {type: 'checkbox', className: 'surface'});
    Object.assign(at, {type: 'range', min: 0, max: 1, step: 0.01, value: 0.5, className: 'level'});
    row.title = 'the surface on which the field has one value: its place between both ends of the colours';
    on.onchange = at.oninput = () => {
      picture.set_isovalue(on.checked ? Number(at.value) : null);
      const volume = on.checked ? 64 : 0;
      if (link.wish.volume !== volume) link.ready();
      link.wish.volume = volume;
    };
    row.append(on, document.createTextNode('surface'), at);
    return row;
  }
  // Values at both ends of the colours.
  function limits(block) {
    const one = made.get(block.family) || make(block);
    const names = block.colourings.join();
    if (one.names !== names) {
      one.choice.replaceChildren(...block.colourings.map((name) => new Option(name, name)));
      for (const option of one.choice.options) option.title = words.title(option.value);
      one.names = names;
    }
    if (document.activeElement !== one.choice) one.choice.value = block.field || '';
    one.unit.textContent = block.unit || '';
    one.box.title = block.field ? words.title(block.field) : '';
    one.formula.textContent = block.field ? words.of(block.field).formula : '';
    if (!block.values) return [0, 1];
    const bounds = one.bounds || [block.values.low, block.values.high];
    const ends = ['low', 'high'].map((name, k) => one.wanted[name] ?? bounds[k]);
    for (const [k, input] of [one.low, one.high].entries())
      if (document.activeElement !== input) input.value = short(ends[k], 4);
    one.ends = ends;
    return ends;
  }
  // Before a frame is shown: the bounds of each family over all of it.
  function measure(frame) {
    for (const one of made.values()) one.bounds = null;
    for (const block of frame.blocks) {
      if (!block.values || block.count === 0) continue;
      if (!made.has(block.family)) make(block);
      const one = made.get(block.family), {low, high} = block.values;
      one.bounds = one.bounds ? [Math.min(one.bounds[0], low), Math.max(one.bounds[1], high)] : [low, high];
    }
  }
  // What stands in the legends, for a picture that is saved.
  const texts = () => [...made].filter(([, one]) => one.ends && one.box.offsetParent)
    .map(([family, one]) => ({family, field: one.choice.value, unit: one.unit.textContent, ends: one.ends.map((end) => short(end, 4))}));
  // Families that are not there any more have no legend.
  function keep(families) {
    for (const [family, one] of made) one.box.hidden = !families.has(family);
  }
  return {limits, measure, texts, keep};
})();

// Of a second run that is shown beside the first, columns of the same name are drawn as well.
const curves = (() => {
  let columns = [], values = [], names = '', beside = null, besideValues = [];
  const plots = new Map();  // by the number of the column
  const choice = by_id('columns');

  function data(column) {
    const own = [values[1] || [], values[column] || []];
    if (!beside) return own;
    const time = beside.findIndex((one) => one.name === columns[1].name);
    const other = beside.findIndex((one) => one.name === columns[column].name);
    return uPlot.join([own, [besideValues[time] || [], besideValues[other] || []]]);
  }
  function remove(column) {
    plots.get(column).plot.destroy();
    plots.get(column).box.remove();
    plots.delete(column);
  }
  function add(column) {
    if (plots.has(column)) return;
    const box = element('div', 'curve'), head = element('div', 'name'), close = element('button', '', '×');
    const name = element('b', '', columns[column].name), last = element('span');
    name.title = columns[column].unit;
    close.title = 'take this curve away';
    close.onclick = () => remove(column);
    head.append(name, last, close);
    box.append(head);
    by_id('curves').append(box);
    const axis = {stroke: '#93a2b0', grid: {stroke: '#2c3844', width: 1}, ticks: {show: false}, font: '11px system-ui'};
    const numbers = (_, splits) => splits.map((value) => short(value, 4));
    const plot = new uPlot({
      width: Math.max(200, by_id('curves').clientWidth), height: 120, scales: {x: {time: false}},
      axes: [{...axis, size: 22, values: numbers}, {...axis, size: 58, values: numbers}], cursor: {y: false},
      series: [{}, {stroke: '#4fb3d9', width: 1.5, points: {show: false}, spanGaps: true},
        ...(beside ? [{stroke: '#e8a15a', width: 1.5, points: {show: false}, spanGaps: true}] : [])]}, data(column), box);
    plots.set(column, {box, plot, last});
    update(column);
  }
  function update(column) {
    const {plot, last} = plots.get(column);
    plot.setData(data(column));
    const own = values[column];
    last.textContent = own && own.length ? `${short(own[own.length - 1], 5)} ${columns[column].unit}` : '';
  }
  choice.onchange = () => {
    add(Number(choice.value));
    choice.selectedIndex = 0;
  };
  new ResizeObserver(() => {
    const width = by_id('curves').clientWidth;
    if (width > 0) for (const {plot} of plots.values()) if (plot.width !== width) plot.setSize({width, height: 120});
  }).observe(by_id('curves'));

  function set_columns(list, other) {
    const now = list.map((one) => one.name).join();
    beside = other && other.length ? other : null;
    if (now === names) return;
    names = now;
    for (const column of [...plots.keys()]) remove(column);
    columns = list;
    values = columns.map(() => []);
    choice.replaceChildren(new Option('a column of series.csv', ''));
    columns.forEach((one, k) => {
      if (k !== 1) choice.append(new Option(one.name, k));
      choice.lastChild.title = one.unit;
    });
    if (list.length < 4) return;
    // What every method tells of first, and the fastest particle.
    add(3);
    const fastest = columns.findIndex((one) => one.name === 'max_speed');
    if (fastest > 3) add(fastest);
  }
  function take(message) {
    const other = message.side === 1;
    if (message.anew && other) besideValues = (beside || []).map(() => []);
    if (message.anew && !other) values = columns.map(() => []);
    const kept = other ? besideValues : values;
    for (const row of message.rows) row.forEach((value, k) => kept[k].push(value));
    for (const column of plots.keys()) update(column);
  }
  return {set_columns, take};
})();

// After a change only the values are others: what is being typed elsewhere stays.
function show_options(options) {
  const fields = [...document.querySelectorAll('#options input')];
  if (fields.length && fields.map((field) => field.dataset.key).join() === options.map((option) => option.key).join()) {
    options.forEach((option, k) => {
      if (fields[k].dataset.value !== option.value) fields[k].value = fields[k].dataset.value = option.value;
    });
    return;
  }
  const rows = options.map((option) => {
    const row = element('form', 'option'), key = element('label', 'key', option.key), input = element('input');
    key.append(element('small', '', [option.unit, option.range].filter(Boolean).join(', ')));
    key.title = option.description;
    input.value = option.value;
    input.placeholder = 'not set';
    input.setAttribute('aria-label', option.key);
    input.dataset.key = option.key;
    input.dataset.value = option.value;
    row.append(key, input, element('button', '', 'Set'));
    row.onsubmit = (event) => {
      event.preventDefault();
      // A change is made once: what stands there already changes nothing.
      if (input.value.trim() !== input.dataset.value) link.send({do: 'steer', key: option.key, value: input.value.trim()});
    };
    return row;
  });
  by_id('options').replaceChildren(...rows);
}

function show_plan(stages) {
  by_id('plan').replaceChildren(...stages.map((stage) => {
    const line = element('li', stage.on ? '' : 'off', stage.name + (stage.on ? (stage.start ? ' (at the start)' : '') : ': off'));
    line.append(element('small', '', stage.reason));
    return line;
  }));
}

function show_ledger(message) {
  const most = 14;
  const sum = message.stages.reduce((total, stage) => total + stage.seconds, 0);
  const sorted = message.stages.filter((stage) => stage.seconds > 0).sort((a, b) => b.seconds - a.seconds).slice(0, most);
  by_id('ledger').replaceChildren(...sorted.map((stage) => {
    const row = element('div', 'stage'), line = element('div', 'line'), filled = element('div');
    filled.style.width = `${100 * stage.seconds / sorted[0].seconds}%`;
    line.append(filled);
    row.title = `${stage.calls} calls, ${short(stage.seconds, 3)} s`;
    row.append(element('span', '', stage.name), element('span', 'share', `${(100 * stage.seconds / sum).toFixed(1)} %`), line);
    return row;
  }));
}

function show_lines(message) {
  const log = by_id('log'), most = 400;
  if (message.anew) log.textContent = '';
  const below = log.scrollHeight - log.scrollTop - log.clientHeight < 20;
  log.textContent = (log.textContent + message.lines.map((line) => line + '\n').join('')).split('\n').slice(-most).join('\n');
  if (below) log.scrollTop = log.scrollHeight;
  const answers = message.lines.filter((line) => /^(refused|steered|replayed|checkpoint|snapshot)/.test(line));
  if (!answers.length) return;
  by_id('answer').textContent = answers[answers.length - 1];
  by_id('answer').classList.toggle('refused', answers[answers.length - 1].startsWith('refused'));
}
