// SPDX-License-Identifier: MIT
// The page: what the program tells goes to the picture and the panels, what the user does goes to the program.
'use strict';

let paused = false;

function show_state(state) {
  const texts = {words: state.words, step: state.step, time: short(state.time, 5), end: short(state.end, 5), dt: short(state.dt, 3),
    limit: state.limit ? `(${state.limit})` : '', remaining: duration(state.remaining),
    rate: state.rate === null ? '' : `${short(state.rate / 1e6, 3)} Mp-steps/s`};
  for (const [id, text] of Object.entries(texts)) by_id(id).textContent = text;
  by_id('done').style.width = state.end > 0 ? `${Math.min(100, 100 * state.time / state.end)}%` : 0;
  paused = state.words === 'paused';
  const runs = paused || state.words === 'running';
  by_id('words').className = paused ? 'paused' : '';
  by_id('pause').textContent = paused ? 'Go on' : 'Pause';
  for (const button of document.querySelectorAll('nav button, #options button')) button.disabled = !runs;
}

link.on('hello', (message) => {
  document.title = `${message.title} - Spume`;
  by_id('title').textContent = by_id('title').title = message.title;
  by_id('method').textContent = message.method;
  by_id('method').title = `Spume ${message.version}, results in ${message.folder}`;
  picture.set_domain(message);
  curves.set_columns(message.columns);
  show_options(message.options);
  show_plan(message.plan);
});
link.on('state', show_state);
link.on('series', curves.take);
link.on('log', show_lines);
link.on('ledger', show_ledger);
link.on('lost', () => {
  by_id('words').textContent = 'no connection to the run';
  by_id('words').className = 'lost';
});
link.on('frame', (frame) => {
  picture.show(frame, legends.limits);
  by_id('shown').replaceChildren(...frame.blocks.filter((block) => block.kind === 'particles').map((block) => {
    const thinned = block.count < block.total ? `, ${block.count.toLocaleString('en')} shown` : '';
    return element('div', '', `${block.family}: ${block.total.toLocaleString('en')}${thinned}`);
  }));
});

by_id('pause').onclick = () => link.send({do: paused ? 'go' : 'pause'});
by_id('one').onclick = () => link.send({do: 'step'});
by_id('checkpoint').onclick = () => link.send({do: 'checkpoint'});
by_id('snapshot').onclick = () => link.send({do: 'snapshot'});
by_id('stop').onclick = () => { if (confirm('End the run with a checkpoint?')) link.send({do: 'stop'}); };
by_id('points').onchange = () => {
  link.wish.points = Number(by_id('points').value);
  link.ready();
};
by_id('size').oninput = () => {
  picture.set_size(Number(by_id('size').value));
  link.ready();
};
const cut = () => picture.set_cut(Number(by_id('cut').value), Number(by_id('cutat').value));
by_id('cut').onchange = by_id('cutat').oninput = cut;
// On a small screen the picture comes first and few panels are open.
if (window.innerWidth <= 800) for (const panel of document.querySelectorAll('aside details')) panel.open = panel.querySelector('#curves') !== null;
link.open();
