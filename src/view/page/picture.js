// SPDX-License-Identifier: MIT
// The picture: particles as points of their own size, fields on a grid as a plane, drawn by three.js (revision 111).
// Codes of 16 bits go to the graphics card as they came; the shader makes positions and colours of them.
'use strict';

const picture = (() => {
  // viridis, by Nathaniel Smith and Stefan van der Walt (CC0).
  const viridis = ['#440154', '#482878', '#3e4989', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];
  const palette = viridis.map((colour) => new THREE.Color(colour));
  const css = `linear-gradient(to right, ${viridis.join(',')})`;

  const vertexShader = `
    attribute float value;
    attribute float size;
    uniform vec3 lower, extent, palette[10], cut;
    uniform vec2 range;      // values at both ends of the codes
    uniform vec2 limits;     // values at both ends of the colours
    uniform float full, diameter, largest, pixels, cutAt, flatness;
    varying vec3 colour;
    varying float hidden;
    void main() {
      vec3 place = lower + position * extent;
      hidden = dot(cut, cut) > 0.0 && dot(cut, place) > cutAt ? 1.0 : 0.0;
      float code = value * full;
      float share = clamp((mix(range.x, range.y, code) - limits.x) / max(limits.y - limits.x, 1e-30), 0.0, 1.0) * 9.0;
      colour = vec3(0.45);
      if (code <= 1.000005)
        for (int k = 0; k < 9; ++k)
          if (share >= float(k)) colour = mix(palette[k], palette[k + 1], min(share - float(k), 1.0));
      vec4 seen = modelViewMatrix * vec4(place, 1.0);
      gl_Position = projectionMatrix * seen;
      float width = largest > 0.0 ? size * largest : diameter;
      gl_PointSize = max(width * pixels / mix(-seen.z, 1.0, flatness), largest > 0.0 ? 3.0 : 1.5);
    }`;
  const fragmentShader = `
    varying vec3 colour;
    varying float hidden;
    uniform float flatness;
    void main() {
      vec2 from = 2.0 * gl_PointCoord - 1.0;
      float square = dot(from, from);
      if (square > 1.0 || hidden > 0.5) discard;
      gl_FragColor = vec4(colour * mix(0.55 + 0.45 * sqrt(1.0 - square), 1.0, flatness), 1.0);
    }`;

  const canvas = document.getElementById('canvas');
  const place = document.getElementById('picture');
  const renderer = new THREE.WebGLRenderer({canvas, antialias: true});
  renderer.setClearColor(0x10151b);
  const scene = new THREE.Scene();
  let camera = null, controls = null, domain = null, spacing = 0, enlarged = 1, dirty = false, cutAxis = -1, cutShare = 0.5;
  const drawn = new Map();  // by kind and family

  function draw() {
    dirty = false;
    if (!camera) return;
    const pixels = renderer.getPixelRatio() * place.clientHeight;
    for (const one of drawn.values()) {
      if (!one.uniforms) continue;
      one.uniforms.pixels.value = domain.flat ? pixels * camera.zoom / (camera.top - camera.bottom)
        : pixels / (2 * Math.tan(camera.fov * Math.PI / 360));
    }
    renderer.render(scene, camera);
  }
  function redraw() {
    if (!dirty) requestAnimationFrame(draw);
    dirty = true;
  }
  function resize() {
    const width = place.clientWidth, height = place.clientHeight;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    if (!camera) return;
    if (domain.flat) {
      // The whole domain, with a margin.
      const tall = 1.1 * Math.max(domain.extent[1], domain.extent[0] * height / width);
      camera.top = tall / 2;
      camera.bottom = -tall / 2;
      camera.right = tall * width / height / 2;
      camera.left = -camera.right;
    } else {
      camera.aspect = width / height;
    }
    camera.updateProjectionMatrix();
    redraw();
  }
  function see_all() {
    const [x, y, z] = domain.centre;
    controls.target.set(x, y, z);
    if (domain.flat) {
      camera.position.set(x, y, z + 1);
      camera.zoom = 1;
    } else {
      const radius = Math.hypot(...domain.extent) / 2;
      const angle = Math.min(camera.fov, 2 * Math.atan(Math.tan(camera.fov * Math.PI / 360) * place.clientWidth / place.clientHeight) * 180 / Math.PI);
      const far = radius / Math.sin(angle * Math.PI / 360);
      camera.position.set(x + 0.45 * far, y - 0.8 * far, z + 0.4 * far);
    }
    resize();
    controls.update();
  }

  // The box of the case, once per page: what is changed by hand does not change it.
  function set_domain(message) {
    spacing = message.spacing;
    if (domain) return;
    const flat = message.dimensions === 2;
    document.body.classList.toggle('flat', flat);
    const lower = [...message.lower, 0].slice(0, 3), upper = [...message.upper, 0].slice(0, 3);
    const extent = lower.map((low, axis) => upper[axis] - low);
    domain = {flat, lower, upper, extent, centre: lower.map((low, axis) => low + extent[axis] / 2)};
    const size = Math.max(...extent);
    camera = flat ? new THREE.OrthographicCamera(-1, 1, 1, -1, -10 * size, 10 * size + 2)
      : new THREE.PerspectiveCamera(40, 1, size / 1000, size * 100);
    if (!flat) camera.up.set(0, 0, 1);
    controls = new THREE.OrbitControls(camera, canvas);
    controls.screenSpacePanning = true;
    if (flat) {
      controls.enableRotate = false;
      controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
      controls.touches.ONE = THREE.TOUCH.PAN;
    }
    controls.addEventListener('change', redraw);
    controls.addEventListener('start', () => { document.getElementById('hint').hidden = true; });
    canvas.addEventListener('dblclick', see_all);
    const box = new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(...extent));
    const edges = new THREE.LineSegments(box, new THREE.LineBasicMaterial({color: 0x4a5866}));
    edges.position.set(...domain.centre);
    scene.add(edges);
    see_all();
  }

  function points_of(family) {
    const key = 'particles ' + family;
    if (drawn.has(key)) return drawn.get(key);
    const uniforms = {lower: {value: new THREE.Vector3()}, extent: {value: new THREE.Vector3()}, palette: {value: palette},
      range: {value: new THREE.Vector2()}, limits: {value: new THREE.Vector2()}, full: {value: 1}, diameter: {value: 0},
      largest: {value: 0}, pixels: {value: 1}, flatness: {value: 0}, cut: {value: new THREE.Vector3()}, cutAt: {value: 0}};
    const object = new THREE.Points(new THREE.BufferGeometry(), new THREE.ShaderMaterial({uniforms, vertexShader, fragmentShader}));
    object.frustumCulled = false;  // the box of its codes is not that of its places
    scene.add(object);
    const one = {object, uniforms};
    drawn.set(key, one);
    return one;
  }

  function show_particles(block, limits) {
    const one = points_of(block.family);
    one.object.geometry.dispose();
    const geometry = one.object.geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(block.positions.codes, block.dimensions, true));
    if (block.values) geometry.setAttribute('value', new THREE.BufferAttribute(block.values.codes, 1, true));
    if (block.sizes) geometry.setAttribute('size', new THREE.BufferAttribute(block.sizes.codes, 1, true));
    const u = one.uniforms, extent = block.lower.map((low, axis) => block.upper[axis] - low);
    u.lower.value.set(block.lower[0], block.lower[1], block.lower[2] || 0);
    u.extent.value.set(extent[0], extent[1], extent[2] || 0);
    if (block.values) {
      u.full.value = block.values.bits === 8 ? 255 / 254 : 65535 / 65534;
      u.range.value.set(block.values.low, block.values.high);
      u.limits.value.set(...limits);
    }
    u.largest.value = block.sizes ? block.sizes.largest * 65535 / 65534 * enlarged : 0;
    // Fewer particles than there are stand for more room each; without a spacing, a two-hundredth of the box.
    const share = Math.pow(block.total / Math.max(block.count, 1), 1 / block.dimensions);
    u.diameter.value = enlarged * (spacing > 0 ? spacing * share : Math.max(...domain.extent) / 200);
    u.flatness.value = domain.flat ? 1 : 0;
    // Bubbles in front of the liquid that they are in.
    one.object.renderOrder = block.sizes ? 1 : 0;
    one.object.material.depthTest = !(domain.flat && block.sizes);
    one.object.visible = block.count > 0;
    set_cut(one);
  }
  function set_cut(one) {
    one.uniforms.cut.value.set(0, 0, 0);
    if (cutAxis < 0) return;
    one.uniforms.cut.value.setComponent(cutAxis, 1);
    one.uniforms.cutAt.value = domain.lower[cutAxis] + cutShare * domain.extent[cutAxis];
  }

  function colour_table() {
    const table = new Uint8Array(4 * 256);
    for (let k = 0; k < 256; ++k) {
      const share = k / 255 * 9, at = Math.min(8, Math.floor(share));
      const colour = palette[at].clone().lerp(palette[at + 1], share - at);
      table.set([colour.r * 255, colour.g * 255, colour.b * 255, 255], 4 * k);
    }
    return table;
  }
  const table = colour_table();

  function show_plane(block, limits) {
    if (!block.values) return;
    const key = 'plane ' + block.family;
    if (!drawn.has(key)) {
      const object = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({side: THREE.DoubleSide}));
      object.frustumCulled = false;
      scene.add(object);
      drawn.set(key, {object});
    }
    const object = drawn.get(key).object;
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([a, b]) => {
      const at = [0, 0, 0];
      at[block.axes[0]] = a ? block.upper[0] : block.lower[0];
      at[block.axes[1]] = b ? block.upper[1] : block.lower[1];
      at[block.axes[2]] = block.place;
      return at;
    }).flat();
    object.geometry.dispose();
    object.geometry = new THREE.BufferGeometry();
    object.geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(corners), 3));
    object.geometry.setAttribute('uv', new THREE.BufferAttribute(new Float32Array([0, 0, 1, 0, 1, 1, 0, 1]), 2));
    object.geometry.setIndex([0, 1, 2, 0, 2, 3]);
    const {codes, bits, low, high} = block.values, top = bits === 8 ? 254 : 65534;
    const pixels = new Uint8Array(4 * codes.length);
    const scale = 255 / Math.max(limits[1] - limits[0], 1e-300);
    for (let k = 0; k < codes.length; ++k) {
      if (codes[k] > top) { pixels.set([115, 115, 115, 255], 4 * k); continue; }
      const value = low + codes[k] / top * (high - low);
      const at = 4 * Math.max(0, Math.min(255, Math.round((value - limits[0]) * scale)));
      for (let c = 0; c < 4; ++c) pixels[4 * k + c] = table[at + c];
    }
    if (object.material.map) object.material.map.dispose();
    const texture = new THREE.DataTexture(pixels, block.columns, block.rows, THREE.RGBAFormat);
    texture.magFilter = THREE.LinearFilter;
    texture.minFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    object.material.map = texture;
    object.material.needsUpdate = true;
  }

  // `limits_of(block)`: values at both ends of the colours.
  function show(frame, limits_of) {
    if (!domain) return;
    const there = new Set();
    for (const block of frame.blocks) {
      there.add(block.kind + ' ' + block.family);
      (block.kind === 'plane' ? show_plane : show_particles)(block, limits_of(block));
    }
    for (const [key, one] of drawn) if (!there.has(key)) one.object.visible = false;
    redraw();
  }
  new ResizeObserver(resize).observe(place);
  return {set_domain, show, css, redraw,
    set_size: (factor) => { enlarged = factor; },
    set_cut: (axis, share) => {
      cutAxis = axis;
      cutShare = share;
      for (const one of drawn.values()) if (one.uniforms) set_cut(one);
      redraw();
    }};
})();
