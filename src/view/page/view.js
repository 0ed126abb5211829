// SPDX-License-Identifier: MIT
// The page: what the program tells goes to the picture and the panels, what the user does goes to the program.
'use strict';

let paused = false, played = false, preparing = false, may_steer = true;

function show_state(state) {
  played = state.words === 'results';
  const texts = {words: state.words, step: state.step, time: short(state.time, 5), end: short(state.end, 5), dt: short(state.dt, 3),
    limit: state.limit ? `(${state.limit})` : '', remaining: duration(state.remaining),
    rate: !state.rate ? '' : `${short(state.rate / 1e6, 3)} Mp-steps/s`};
  for (const [id, text] of Object.entries(texts)) by_id(id).textContent = text;
  by_id('done').style.width = state.end > 0 ? `${Math.min(100, 100 * state.time / state.end)}%` : 0;
  preparing = state.words === 'preparing';
  paused = state.words === 'paused' || preparing && state.held;
  const runs = paused || preparing || state.words === 'running';
  by_id('words').className = paused ? 'paused' : '';
  by_id('pause').textContent = paused ? 'Go on' : 'Pause';
  for (const button of document.querySelectorAll('#steer button, #options button')) button.disabled = !runs;
}

link.on('hello', (message) => {
  document.title = `${message.title} - Spume`;
  const title = message.beside && message.beside.title !== message.title ? `${message.title} | ${message.beside.title}` : message.title;
  by_id('title').textContent = by_id('title').title = title;
  by_id('method').textContent = message.method;
  by_id('method').title = `Spume ${message.version}, results in ${message.folder}${message.beside ? ` and ${message.beside.folder}` : ''}`;
  may_steer = message.may_steer;
  document.body.classList.toggle('looks', !may_steer);
  document.body.classList.toggle('two', Boolean(message.beside));
  by_id('left').textContent = message.beside ? message.folder : '';
  by_id('right').textContent = message.beside ? message.beside.folder : '';
  words.set(message.fields);
  picture.set_domain(message);
  film.set(message);
  curves.set_columns(message.columns, message.beside && message.beside.columns);
  for (const [id, there] of [['curves', message.columns.length], ['plan', message.plan.length]]) by_id(id).closest('details').hidden = !there;
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
link.on('history', look.history);
link.on('unreadable', film.unreadable);
let phases = null;
link.on('frame', (frame) => {
  by_id('hint').hidden = true;
  if (phases === null && frame.blocks.length) begin_with(frame);
  legends.measure(frame);
  picture.show(frame, legends.limits);
  legends.keep(new Set(frame.blocks.map((block) => block.family)));
  look.frame(frame, played);
  film.frame(frame);
  by_id('shown').replaceChildren(...frame.blocks.filter((block) => block.kind === 'particles').map((block) => {
    const blunt = picture.sharpness() < 1 ? `, at ${Math.round(100 * picture.sharpness())} % of the resolution` : '';
    const why = density.automatic() ? `, as many as this browser draws ${density.per_second} times a second${blunt}` : '';
    const thinned = block.count < block.total ? `, ${block.count.toLocaleString('en')} shown${why}` : '';
    return element('div', '', `${block.family}: ${block.total.toLocaleString('en')}${thinned}`);
  }));
});
// Where there are phases, the interface between them is drawn from the start.
function begin_with(frame) {
  phases = frame.blocks.some((block) => block.colourings.includes('phase'));
  if (!phases) return;
  by_id('interface').value = 'with';
  set_interface();
}
function set_interface() {
  const wish = by_id('interface').value;
  link.wish.phases = wish !== 'none';
  picture.set_interface(wish);
  link.ready();
}
by_id('interface').onchange = set_interface;

// As many particles as can be drawn thirty times a second; what a picture takes is measured every few pictures, since
// waiting for its end costs some of the time.
const density = (() => {
  const per_second = 30, least = 10000, few = 100000, bluntest = 0.4, most = 2000000, between = 5, own = by_id('points');
  let pictures = 0, seconds = null;
  picture.after_drawing((began) => {
    if (!automatic() || ++pictures % between) return;
    picture.finish_drawing();
    const took = (performance.now() - began) / 1000;
    seconds = seconds === null ? took : 0.7 * seconds + 0.3 * took;
    // A third of the time is left to the page. Points that stand for more each are larger, so that most of the time goes
    // into their pixels: where few points still take too long, fewer pixels are drawn.
    const share = (2 / 3) / per_second / seconds, sharpness = picture.sharpness();
    if ((share < 0.75 && link.wish.points <= few && sharpness > bluntest) || (share > 1.5 && sharpness < 1)) {
      picture.set_sharpness(Math.max(bluntest, Math.min(1, sharpness * Math.sqrt(Math.min(share, 2)))));
      seconds = null;
      return;
    }
    const wanted = Math.max(least, Math.min(most, link.wish.points * share));
    if (wanted > 0.75 * link.wish.points && wanted < 1.33 * link.wish.points) return;
    // Not in one leap: what was measured was for another number.
    link.wish.points = Math.round(Math.max(link.wish.points / 2, Math.min(link.wish.points * 2, wanted)));
    seconds = null;
    link.ready();
  });
  function automatic() { return own.value === 'auto'; }
  own.onchange = () => {
    if (!automatic()) link.wish.points = Number(own.value);
    link.ready();
  };
  return {automatic, per_second};
})();

by_id('pause').onclick = () => link.send({do: paused ? 'go' : 'pause'});
by_id('one').onclick = () => link.send({do: 'step'});
by_id('checkpoint').onclick = () => link.send({do: 'checkpoint'});
by_id('snapshot').onclick = () => link.send({do: 'snapshot'});
by_id('stop').onclick = () => { if (confirm(preparing ? 'End the run before its first step?' : 'End the run with a checkpoint?')) link.send({do: 'stop'}); };
by_id('size').oninput = () => {
  picture.set_size(Number(by_id('size').value));
  picture.show_again();
};
const cut = () => picture.set_cut(Number(by_id('cut').value), Number(by_id('cutat').value));
by_id('cut').onchange = by_id('cutat').oninput = cut;
// On a small screen the picture comes first and few panels are open.
if (window.innerWidth <= 800) for (const panel of document.querySelectorAll('aside details')) panel.open = panel.querySelector('#curves') !== null;
// The gestures are shown to who has not seen them: a cookie holds for all ports of this machine.
const seen = document.cookie.includes('spume_gestures=seen');
by_id('welcome').hidden = seen;
by_id('understood').onclick = () => {
  by_id('welcome').hidden = true;
  document.cookie = 'spume_gestures=seen; max-age=31536000; SameSite=Strict';
};
by_id('help').onclick = () => { by_id('welcome').hidden = !by_id('welcome').hidden; };
link.open();
