// SPDX-License-Identifier: MIT
// Pictures and films of what is shown, with title, time and legends; and the times of results, one after the other.
'use strict';

const film = (() => {
  const slider = by_id('when'), button = by_id('play'), record = by_id('video');
  let times = [], playing = null, title = '', time = 0, recorder = null, answered = null;
  const sheet = document.createElement('canvas'), pen = sheet.getContext('2d');

  // The picture as it stands on the page, with its words.
  function compose() {
    picture.draw_now();
    const from = picture.canvas, scale = from.width / from.clientWidth;
    // Coders of films take even numbers of pixels.
    const width = from.width - from.width % 2, height = from.height - from.height % 2;
    if (sheet.width !== width || sheet.height !== height) Object.assign(sheet, {width, height});
    pen.drawImage(from, 0, 0);
    pen.save();
    pen.scale(scale, scale);
    pen.textBaseline = 'top';
    const write = (text, x, y, colour, align = 'left') => {
      pen.font = '13px system-ui, sans-serif';
      pen.textAlign = align;
      pen.fillStyle = colour;
      pen.fillText(text, x, y);
    };
    write(title, 12, 10, '#dfe7ee');
    write(`t = ${short(time, 5)}`, from.clientWidth - 12, 10, '#dfe7ee', 'right');
    let top = 36;
    for (const legend of legends.texts()) {
      const wide = 180, bar = pen.createLinearGradient(12, 0, 12 + wide, 0);
      write([legend.family, legend.field, legend.unit && `in ${legend.unit}`].filter(Boolean).join(' '), 12, top, '#dfe7ee');
      picture.viridis.forEach((colour, k) => bar.addColorStop(k / (picture.viridis.length - 1), colour));
      pen.fillStyle = bar;
      pen.fillRect(12, top + 18, wide, 9);
      write(legend.ends[0], 12, top + 30, '#93a2b0');
      write(legend.ends[1], 12 + wide, top + 30, '#93a2b0', 'right');
      top += 54;
    }
    pen.restore();
    return sheet;
  }
  function save(blob, ending) {
    const anchor = document.createElement('a');
    anchor.href = URL.createObjectURL(blob);
    anchor.download = `${title.replace(/[^\w-]+/g, '_') || 'spume'}-${short(time, 5)}.${ending}`;
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(anchor.href), 10000);
  }
  by_id('photo').onclick = () => compose().toBlob((blob) => save(blob, 'png'), 'image/png');

  const kinds = ['video/mp4;codecs=avc3', 'video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'];
  const kind = window.MediaRecorder && kinds.find((one) => MediaRecorder.isTypeSupported(one));
  if (!kind) {
    record.disabled = true;
    record.title = 'this browser records no video; spume plot DIR --animate writes one';
  }
  // While a run goes on: what is seen until the button is pressed again. Of results: all states, a twelfth of a second each.
  const per_second = 12;
  function start() {
    compose();
    const stream = sheet.captureStream(times.length ? 0 : 25), parts = [];
    recorder = new MediaRecorder(stream, {mimeType: kind, videoBitsPerSecond: 8e6});
    recorder.track = stream.getVideoTracks()[0];
    recorder.ondataavailable = (event) => { if (event.data.size) parts.push(event.data); };
    recorder.onstop = () => {
      save(new Blob(parts, {type: kind}), kind.startsWith('video/mp4') ? 'mp4' : 'webm');
      film.last = {bytes: parts.reduce((sum, part) => sum + part.size, 0), kind};
      recorder = null;
      record.textContent = 'Video';
      record.classList.remove('recording');
    };
    recorder.start(1000);
    record.textContent = 'Stop video';
    record.classList.add('recording');
  }
  const pause = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));
  async function film_all() {
    stop_playing();
    start();
    for (let k = 0; k < times.length && recorder; ++k) {
      const began = performance.now();
      await go_to(k);
      if (!recorder) return;
      compose();
      if (recorder.track.requestFrame) recorder.track.requestFrame();
      await pause(1000 / per_second - (performance.now() - began));
    }
    if (recorder) recorder.stop();
  }
  record.onclick = () => {
    if (recorder) recorder.stop();
    else if (times.length) film_all();
    else start();
  };

  // The state of results that is shown. Resolves when it is.
  function go_to(step) {
    slider.value = step;
    if (link.wish.snapshot === step) return Promise.resolve();
    link.wish.snapshot = step;
    link.now();
    return new Promise((resolve) => { answered = {step, resolve}; });
  }
  function stop_playing() {
    playing = null;
    button.textContent = 'Play';
  }
  async function play() {
    const own = playing = {};
    button.textContent = 'Halt';
    let step = Number(slider.value);
    if (step >= times.length - 1) step = -1;
    while (playing === own && step < times.length - 1) {
      const began = performance.now();
      await go_to(++step);
      await pause(Math.max(0, 1000 / per_second - (performance.now() - began)));
    }
    if (playing === own) stop_playing();
  }
  button.onclick = () => (playing ? stop_playing() : play());
  slider.oninput = () => {
    stop_playing();
    link.wish.snapshot = Number(slider.value);
    link.ready();
  };

  return {last: null, go_to,
    set: (message) => {
      title = message.title;
      if (!message.times) return;
      const first = !times.length, last = !first && Number(slider.value) === times.length - 1;
      times = message.times;
      slider.max = times.length - 1;
      document.body.classList.add('played');
      // A run that goes on is followed where its last state was looked at.
      if (last && !playing && Number(slider.max) > Number(slider.value)) go_to(times.length - 1);
    },
    frame: (frame) => {
      time = frame.time;
      if (recorder && !times.length) compose();
      if (answered && (frame.step === answered.step || link.wish.snapshot !== answered.step)) {
        const {resolve} = answered;
        answered = null;
        resolve();
      }
    },
    // One that cannot be read is passed over.
    unreadable: () => {
      if (answered) answered.resolve();
      answered = null;
    }};
})();
