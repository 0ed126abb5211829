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

// One legend a family: what colours it, and from where to where. A bound that was typed stays; an empty one follows.
const legends = (() => {
  const made = new Map();
  function make(block) {
    const box = element('div', 'legend'), choice = element('select'), scale = element('div', 'scale');
    const ends = element('div', 'ends'), low = element('input'), unit = element('span'), high = element('input');
    choice.title = 'what colours ' + block.family;
    low.title = high.title = 'bound of the colours; empty: that of the frame';
    scale.style.background = picture.css;
    const head = element('div', 'head');
    head.append(element('span', '', block.family), unit);
    ends.append(low, high);
    box.append(head, choice, scale, ends);
    let axis = null;
    if (block.kind === 'plane') {
      axis = element('select');
      for (const [k, name] of ['x', 'y', 'z'].entries()) axis.append(new Option('across ' + name, k));
      axis.value = block.axes[2];
      const at = element('input');
      Object.assign(at, {type: 'range', min: 0, max: 1, step: 0.01, value: link.wish.plane.at, title: 'place of the plane'});
      axis.onchange = at.oninput = () => {
        link.wish.plane = {axis: Number(axis.value), at: Number(at.value)};
        link.ready();
      };
      const both = element('label');
      both.append(axis, at);
      box.append(both);
    }
    by_id('legends').append(box);
    const one = {choice, low, high, unit, names: '', wanted: {}};
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
        link.ready();
      };
    made.set(block.kind + block.family, one);
    return one;
  }
  // Values at both ends of the colours.
  function limits(block) {
    const one = made.get(block.kind + block.family) || make(block);
    const names = block.colourings.join();
    if (one.names !== names) {
      one.choice.replaceChildren(...block.colourings.map((name) => new Option(name, name)));
      one.names = names;
    }
    if (document.activeElement !== one.choice) one.choice.value = block.field || '';
    one.unit.textContent = block.unit || '';
    if (!block.values) return [0, 1];
    const ends = ['low', 'high'].map((name) => one.wanted[name] ?? block.values[name]);
    for (const [k, input] of [one.low, one.high].entries())
      if (document.activeElement !== input) input.value = short(ends[k], 4);
    return ends;
  }
  return {limits};
})();

const curves = (() => {
  let columns = [], values = [], names = '';
  const plots = new Map();  // by the number of the column
  const choice = by_id('columns');

  function data(column) { return [values[1] || [], values[column] || []]; }
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
      series: [{}, {stroke: '#4fb3d9', width: 1.5, points: {show: false}}]}, data(column), box);
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

  function set_columns(list) {
    const now = list.map((one) => one.name).join();
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
    // What every method tells of first, and the fastest particle.
    add(3);
    const fastest = columns.findIndex((one) => one.name === 'max_speed');
    if (fastest > 3) add(fastest);
  }
  function take(message) {
    if (message.anew) values = columns.map(() => []);
    for (const row of message.rows) row.forEach((value, k) => values[k].push(value));
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
  const below = log.scrollHeight - log.scrollTop - log.clientHeight < 20;
  log.textContent = (log.textContent + message.lines.map((line) => line + '\n').join('')).split('\n').slice(-most).join('\n');
  if (below) log.scrollTop = log.scrollHeight;
  const answers = message.lines.filter((line) => /^(refused|steered|replayed|checkpoint|snapshot)/.test(line));
  if (!answers.length) return;
  by_id('answer').textContent = answers[answers.length - 1];
  by_id('answer').classList.toggle('refused', answers[answers.length - 1].startsWith('refused'));
}
