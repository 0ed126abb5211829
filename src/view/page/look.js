// SPDX-License-Identifier: MIT
// What a click asks for: the values of a particle, which is then followed, and the history of the flow at that place.
'use strict';

const look = (() => {
  const panel = by_id('here'), table = by_id('picked'), marker = by_id('marker'), pin = by_id('pin'), choice = by_id('trace');
  let picked = null, place = null;  // the particle as it was told last; the place that was clicked
  let times = [], values = new Map(), plot = null, waiting = null;

  function row(name, value, unit) {
    const line = element('tr');
    line.title = words.title(name);
    line.append(element('td', '', name), element('td', 'number', value), element('td', 'unit', unit));
    return line;
  }
  function show_particle(told) {
    picked = told;
    const of = told ? `${told.family}${told.id === undefined ? '' : ` ${told.id}`}` : '';
    by_id('who').textContent = told ? of : picked === null && link.wish.pick ? 'it is gone' : '';
    table.replaceChildren();
    if (!told) return;
    table.append(row('place', told.place.map((x) => short(x, 4)).join(', '), 'length'));
    for (const {name, values: parts} of told.values) {
      if (name === 'id') continue;
      table.append(row(name, parts.map((x) => short(x, 4)).join(', '), words.of(name).unit));
    }
    // From now on this one, wherever it is.
    if (told.id !== undefined && link.wish.pick) link.wish.pick.id = told.id;
    if (link.wish.pick) link.wish.pick.at = told.place;
  }

  function make_plot() {
    if (plot) plot.destroy();
    plot = null;
    const width = by_id('history').clientWidth;
    if (!values.size || width <= 0) return;
    const axis = {stroke: '#93a2b0', grid: {stroke: '#2c3844', width: 1}, ticks: {show: false}, font: '11px system-ui'};
    const numbers = (_, splits) => splits.map((value) => short(value, 4));
    plot = new uPlot({width, height: 120, scales: {x: {time: false}}, cursor: {y: false},
      axes: [{...axis, size: 22, values: numbers}, {...axis, size: 58, values: numbers}],
      series: [{}, {stroke: '#e8c15a', width: 1.5, points: {show: false}}]}, data(), by_id('history'));
  }
  const data = () => [times, values.get(choice.value) || []];
  function add(time, list) {
    if (times.length && time <= times[times.length - 1]) return;
    for (const {name, unit} of list)
      if (!values.has(name)) {
        values.set(name, times.map(() => null));
        choice.append(new Option(unit ? `${name} in ${unit}` : name, name));
        choice.lastChild.title = words.title(name);
      }
    times.push(time);
    for (const [name, kept] of values) {
      const one = list.find((value) => value.name === name);
      kept.push(one ? one.value : null);
    }
    const most = 20000;  // half an hour of ten a second
    if (times.length > most) {
      times = times.filter((_, k) => k % 2 === 0);
      for (const [name, kept] of values) values.set(name, kept.filter((_, k) => k % 2 === 0));
    }
  }
  function draw_history() {
    choice.title = choice.value ? words.title(choice.value) : '';
    if (plot) plot.setData(data());
    else make_plot();
  }
  function forget() {
    times = [];
    values = new Map();
    choice.replaceChildren();
    if (plot) plot.destroy();
    plot = null;
  }
  choice.onchange = draw_history;
  new ResizeObserver(() => {
    const width = by_id('history').clientWidth;
    if (plot && width > 0 && plot.width !== width) plot.setSize({width, height: 120});
    else if (!plot) make_plot();
  }).observe(by_id('history'));

  function mark(sign, at) {
    const where = at && picture.on_screen(at);
    sign.hidden = !where;
    if (where) sign.style.transform = `translate(${where[0]}px, ${where[1]}px)`;
  }
  picture.after_drawing(() => {
    mark(marker, picked && picked.place);
    mark(pin, place);
  });

  function at(left, top) {
    const found = picture.pick(left, top);
    if (!found) return;
    place = found.at;  // of two runs: in the first one
    forget();
    if (found.family) link.wish.pick = {family: found.family, at: found.at};
    else delete link.wish.pick;
    link.wish.point = found.at;
    show_particle(null);
    by_id('where').textContent = `at ${found.at.map((x) => short(x, 4)).join(', ')}`;
    panel.hidden = false;
    panel.open = true;
    link.ready();
    picture.redraw();
  }
  function clear() {
    delete link.wish.pick;
    delete link.wish.point;
    place = picked = null;
    panel.hidden = true;
    forget();
    link.ready();
    picture.redraw();
  }
  by_id('unpick').onclick = (event) => { event.preventDefault(); clear(); };

  // A click is what neither moves nor lasts.
  let pressed = null;
  picture.canvas.addEventListener('pointerdown', (event) => { pressed = {x: event.clientX, y: event.clientY, at: performance.now()}; });
  picture.canvas.addEventListener('pointerup', (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > 5 || performance.now() - pressed.at > 500) return;
    const box = picture.canvas.getBoundingClientRect(), left = event.clientX - box.left, top = event.clientY - box.top;
    // The first click of a double click is one as well, and costs nothing.
    clearTimeout(waiting);
    waiting = setTimeout(() => at(left, top), 0);
  });

  return {at, clear,
    // Results come with the history from the first state to the last, apart from the frame.
    frame: (frame, played) => {
      if (link.wish.pick) show_particle(frame.picked || null);
      if (played || !frame.point || !place || frame.point.place.some((x, k) => x !== place[k])) return;
      add(frame.time, frame.point.values);
      draw_history();
    },
    history: (message) => {
      if (!place || message.place.some((x, k) => x !== place[k])) return;
      for (const row of message.rows) add(row.time, row.values);
      draw_history();
    }};
})();
