// SPDX-License-Identifier: MIT
// The socket to the program, and its messages: texts are JSON, frames are binary (include/spume/view/frame.hpp).
'use strict';

const link = (() => {
  const token = new URLSearchParams(location.search).get('token');
  const retry = 2000;  // milliseconds
  let socket = null;
  let ended = false;
  let waiting = false;  // a frame was shown and not acknowledged, since nobody looks
  const wish = {points: 200000, bits: 16, fields: {}, plane: {axis: 2, at: 0.5}};
  const handlers = {};

  function send(message) {
    if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
  }
  function ready() {
    waiting = document.hidden;
    if (!waiting) send({do: 'ready', ...wish});
  }
  // For sliders, which change more often than the program listens.
  let planned = null;
  function ready_soon() {
    if (planned === null) planned = setTimeout(() => { planned = null; ready(); }, 100);
  }
  document.addEventListener('visibilitychange', () => { if (waiting) ready(); });

  // The arrays of a block are views of the message: nothing is copied.
  function decode(buffer) {
    const start = 4, length = new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, start + length)));
    for (const block of header.blocks) {
      const count = {plane: block.columns * block.rows, particles: block.count, volume: block.points && block.points.reduce((a, b) => a * b)}[block.kind];
      if (block.positions) block.positions.codes = new Uint16Array(buffer, start + block.positions.at, count * block.dimensions);
      if (block.sizes) block.sizes.codes = new Uint16Array(buffer, start + block.sizes.at, count);
      if (block.phases) block.phases.codes = new Uint8Array(buffer, start + block.phases.at, count);
      if (block.values) block.values.codes = new (block.values.bits === 8 ? Uint8Array : Uint16Array)(buffer, start + block.values.at, count);
    }
    return header;
  }

  function open() {
    socket = new WebSocket(`ws://${location.host}/socket?token=${token}`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = ready;
    socket.onmessage = (event) => {
      if (typeof event.data === 'string') {
        const message = JSON.parse(event.data);
        if (message.type === 'state') ended = !['running', 'paused', 'preparing', 'results'].includes(message.words);
        handlers[message.type](message);
      } else {
        handlers.frame(decode(event.data));
        ready();  // where nothing has changed nothing comes
      }
    };
    socket.onclose = () => {
      if (ended) return;
      handlers.lost();
      setTimeout(open, retry);
    };
  }
  return {open, send, wish, ready: ready_soon, now: ready, on: (type, handler) => { handlers[type] = handler; }};
})();
