// SPDX-License-Identifier: MIT
// The picture: particles as points of their own size, fields on a grid as a plane, surfaces; of one run, or of two beside
// each other that are looked at alike. Drawn by three.js (revision 111). Codes of 16 bits go to the graphics card as they
// came; the shader makes positions and colours of them.
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
  // Where the processor draws, smooth edges cost it four times the points in each pixel.
  const software = (() => {
    const gl = document.createElement('canvas').getContext('webgl'), told = gl && gl.getExtension('WEBGL_debug_renderer_info');
    return Boolean(told) && /swiftshader|llvmpipe|software/i.test(gl.getParameter(told.UNMASKED_RENDERER_WEBGL));
  })();
  const renderer = new THREE.WebGLRenderer({canvas, antialias: !software});
  let sharpness = 1;  // pixels that are drawn along a side of a pixel of the screen; fewer where that takes too long
  renderer.setClearColor(0x10151b);
  renderer.localClippingEnabled = true;
  renderer.autoClear = false;
  let camera = null, controls = null, domain = null, enlarged = 1, dirty = false, cutAxis = -1, cutShare = 0.5;
  const cutPlane = new THREE.Plane(), sun = new THREE.DirectionalLight(0xffffff, 0.75);
  // One a run: what is drawn by kind and family, the blocks as they came, and the spacing of the particles.
  const sides = [];
  const listeners = [];  // told after each picture

  // Where a side is drawn, from the lower left corner: beside each other, or above each other on a narrow screen.
  function part(side) {
    const width = place.clientWidth, height = place.clientHeight;
    if (sides.length < 2) return {x: 0, y: 0, width, height};
    return width >= height ? {x: side * width / 2, y: 0, width: width / 2, height}
      : {x: 0, y: (1 - side) * height / 2, width, height: height / 2};
  }
  function draw() {
    dirty = false;
    if (!camera) return;
    const began = performance.now();
    sun.position.copy(camera.position).sub(controls.target);
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(true);
    sides.forEach((side, k) => {
      const {x, y, width, height} = part(k), pixels = renderer.getPixelRatio() * height;
      renderer.setViewport(x, y, width, height);
      renderer.setScissor(x, y, width, height);
      for (const one of side.drawn.values()) {
        if (!one.uniforms) continue;
        one.uniforms.pixels.value = domain.flat ? pixels * camera.zoom / (camera.top - camera.bottom)
          : pixels / (2 * Math.tan(camera.fov * Math.PI / 360));
      }
      side.scene.add(sun);
      renderer.render(side.scene, camera);
    });
    for (const listener of listeners) listener(began);
  }
  function redraw() {
    if (!dirty) requestAnimationFrame(draw);
    dirty = true;
  }
  function resize() {
    renderer.setPixelRatio(sharpness * Math.min(window.devicePixelRatio, 2));
    renderer.setSize(place.clientWidth, place.clientHeight, false);
    if (!camera) return;
    const {width, height} = part(0);
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
      const {width, height} = part(0);
      const angle = Math.min(camera.fov, 2 * Math.atan(Math.tan(camera.fov * Math.PI / 360) * width / height) * 180 / Math.PI);
      const far = radius / Math.sin(angle * Math.PI / 360);
      camera.position.set(x + 0.45 * far, y - 0.8 * far, z + 0.4 * far);
    }
    resize();
    controls.update();
  }

  // The box of the case, once per page: what is changed by hand does not change it.
  function set_domain(message) {
    const runs = [message, message.beside].filter(Boolean);
    if (domain) {
      runs.forEach((run, k) => { sides[k].spacing = run.spacing; });
      return;
    }
    const flat = runs.every((run) => run.dimensions === 2);
    document.body.classList.toggle('flat', flat);
    // The box that holds those of both.
    const all = (corner, choose) => [0, 1, 2].map((axis) => choose(...runs.map((run) => run[corner][axis] || 0)));
    const lower = all('lower', Math.min), upper = all('upper', Math.max);
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
    canvas.addEventListener('dblclick', see_all);
    for (const run of runs) {
      const scene = new THREE.Scene(), low = [...run.lower, 0].slice(0, 3), high = [...run.upper, 0].slice(0, 3);
      const box = new THREE.EdgesGeometry(new THREE.BoxBufferGeometry(...low.map((from, axis) => high[axis] - from)));
      const edges = new THREE.LineSegments(box, new THREE.LineBasicMaterial({color: 0x4a5866}));
      edges.position.set(...low.map((from, axis) => (from + high[axis]) / 2));
      scene.add(edges, new THREE.AmbientLight(0xffffff, 0.45));
      sides.push({scene, drawn: new Map(), blocks: [], spacing: run.spacing});
    }
    see_all();
  }

  function points_of(side, family) {
    const key = 'particles ' + family;
    if (side.drawn.has(key)) return side.drawn.get(key);
    const uniforms = {lower: {value: new THREE.Vector3()}, extent: {value: new THREE.Vector3()}, palette: {value: palette},
      range: {value: new THREE.Vector2()}, limits: {value: new THREE.Vector2()}, full: {value: 1}, diameter: {value: 0},
      largest: {value: 0}, pixels: {value: 1}, flatness: {value: 0}, cut: {value: new THREE.Vector3()}, cutAt: {value: 0}};
    const object = new THREE.Points(new THREE.BufferGeometry(), new THREE.ShaderMaterial({uniforms, vertexShader, fragmentShader}));
    object.frustumCulled = false;  // the box of its codes is not that of its places
    side.scene.add(object);
    const one = {object, uniforms};
    side.drawn.set(key, one);
    return one;
  }

  function show_particles(side, block, limits) {
    const one = points_of(side, block.family);
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
    u.diameter.value = enlarged * (side.spacing > 0 ? side.spacing * share : Math.max(...domain.extent) / 200);
    u.flatness.value = domain.flat ? 1 : 0;
    // Bubbles in front of the liquid that they are in.
    one.object.renderOrder = block.sizes ? 1 : 0;
    one.object.material.depthTest = !(domain.flat && block.sizes);
    one.object.visible = block.count > 0 && !(interfaceWish === 'alone' && !block.sizes);
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

  function show_plane(side, block, limits) {
    if (!block.values) return;
    const key = 'plane ' + block.family;
    if (!side.drawn.has(key)) {
      const object = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({side: THREE.DoubleSide}));
      object.frustumCulled = false;
      side.scene.add(object);
      side.drawn.set(key, {object});
    }
    const object = side.drawn.get(key).object;
    object.visible = planes;
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

  // A surface, or in two dimensions a line: what surface.js makes.
  let planes = true, interfaceWish = 'none', isovalue = null;
  function show_surface(side, key, shapes) {
    const old = side.drawn.get(key);
    if (old) {
      old.object.children.forEach((child) => child.geometry.dispose());
      side.scene.remove(old.object);
    }
    const object = new THREE.Group();
    shapes.forEach((shape, k) => {
      const geometry = new THREE.BufferGeometry(), colour = [0x9fd3ee, 0xf2b36b, 0xb5de8b][k % 3];
      geometry.setAttribute('position', new THREE.BufferAttribute(shape.places, 3));
      const clippingPlanes = cutAxis < 0 ? [] : [cutPlane];
      let one;
      if (shape.triangles) {
        geometry.setIndex(new THREE.BufferAttribute(shape.triangles, 1));
        geometry.computeVertexNormals();
        one = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({color: colour, side: THREE.DoubleSide, clippingPlanes}));
      } else {
        one = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: 0xffffff, depthTest: false}));
        one.renderOrder = 2;
      }
      one.frustumCulled = false;
      object.add(one);
    });
    side.scene.add(object);
    side.drawn.set(key, {object});
  }
  function show_interface(side, block) {
    if (block.sizes) return;  // bubbles are drawn as such
    const key = 'interface ' + block.family;
    const wanted = interfaceWish !== 'none';
    if (wanted || side.drawn.has(key)) show_surface(side, key, wanted ? surface.interfaces(block, domain, side.spacing) : []);
  }
  // `limits`: the share of their range at which the surface lies is that of the colours.
  function show_volume(side, block, limits) {
    if (!block.values) return;
    const level = isovalue === null ? null : limits[0] + isovalue * (limits[1] - limits[0]);
    show_surface(side, 'volume ' + block.family, level === null ? [] : [surface.in_space(surface.field_of(block), level)]);
  }

  const showing = {plane: show_plane, particles: show_particles, volume: show_volume};
  let shown = null;
  // `limits_of(block)`: values at both ends of the colours.
  function show(frame, limits_of) {
    if (!domain) return;
    shown = {frame, limits_of};
    sides.forEach((side, k) => {
      const there = new Set();
      side.blocks = frame.blocks.filter((block) => (block.side || 0) === k);
      for (const block of side.blocks) {
        there.add(block.kind + ' ' + block.family);
        showing[block.kind](side, block, limits_of(block));
        if (block.kind !== 'particles') continue;
        show_interface(side, block);
        there.add('interface ' + block.family);
      }
      for (const [key, one] of side.drawn) if (!there.has(key)) one.object.visible = false;
    });
    redraw();
  }
  function show_again() { if (shown) show(shown.frame, shown.limits_of); }

  // From the left and from above, in pixels of the picture; null behind the eye.
  function on_screen(at, side = 0) {
    const seen = new THREE.Vector3(...at).project(camera), {x, y, width, height} = part(side);
    if (seen.z > 1) return null;
    return [x + (seen.x + 1) / 2 * width, place.clientHeight - y - height + (1 - seen.y) / 2 * height];
  }
  // What lies there: a particle, a place on a plane, or in two dimensions any place; {side, family, at}.
  function pick(left, top) {
    if (!domain) return null;
    let k = 0;
    sides.forEach((_, n) => {
      const {x, y, width, height} = part(n), above = place.clientHeight - y - height;
      if (left >= x && left < x + width && top >= above && top < above + height) k = n;
    });
    const side = sides[k], {x, y, width, height} = part(k);
    const to = [(left - x) / width * 2 - 1, 1 - (top - (place.clientHeight - y - height)) / height * 2];
    const near = 10;  // pixels; what is drawn larger is hit within its own size
    camera.updateMatrixWorld();
    const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    let best = null;
    for (const block of side.blocks) {
      if (block.kind !== 'particles' || !side.drawn.get('particles ' + block.family).object.visible) continue;
      const {codes} = block.positions, d = block.dimensions;
      const scale = block.lower.map((low, axis) => (block.upper[axis] - low) / 65535);
      const {diameter, pixels} = side.drawn.get('particles ' + block.family).uniforms;
      const wide = block.sizes ? 0 : diameter.value * pixels.value / renderer.getPixelRatio() / 2;
      const at = [0, 0, 0];
      for (let n = 0; n < block.count; ++n) {
        for (let axis = 0; axis < d; ++axis) at[axis] = block.lower[axis] + codes[n * d + axis] * scale[axis];
        if (cutAxis >= 0 && at[cutAxis] > -cutPlane.constant * cutPlane.normal.getComponent(cutAxis)) continue;
        const w = m[3] * at[0] + m[7] * at[1] + m[11] * at[2] + m[15];
        const right = ((m[0] * at[0] + m[4] * at[1] + m[8] * at[2] + m[12]) / w - to[0]) * width / 2;
        const up = ((m[1] * at[0] + m[5] * at[1] + m[9] * at[2] + m[13]) / w - to[1]) * height / 2;
        const off = Math.hypot(right, up);
        if (!(off <= Math.max(near, domain.flat ? wide : wide / w))) continue;
        const deep = (m[2] * at[0] + m[6] * at[1] + m[10] * at[2] + m[14]) / w;
        // Bubbles before liquid; in space what is in front, in a plane what is nearest.
        const rank = [block.sizes ? 0 : 1, domain.flat ? off : deep];
        if (!best || rank[0] < best.rank[0] || (rank[0] === best.rank[0] && rank[1] < best.rank[1]))
          best = {rank, side: k, family: block.family, at: at.slice(0, 3)};
      }
    }
    if (best) return best;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(...to), camera);
    const meshes = [...side.drawn].filter(([key, one]) => key.startsWith('plane') && one.object.visible).map(([, one]) => one.object);
    const hits = ray.intersectObjects(meshes);
    if (hits.length) return {side: k, family: null, at: hits[0].point.toArray()};
    if (!domain.flat) return null;
    return {side: k, family: null, at: [ray.ray.origin.x, ray.ray.origin.y, 0]};
  }

  new ResizeObserver(resize).observe(place);
  return {set_domain, show, show_again, css, viridis, redraw, pick, on_screen, canvas,
    draw_now: draw,
    after_drawing: (listener) => listeners.push(listener),
    // For who turns the picture without a hand, such as the tests.
    turn: (angle) => {
      const from = camera.position.clone().sub(controls.target);
      camera.position.copy(controls.target).add(from.applyAxisAngle(camera.up, angle));
      controls.update();
    },
    finish_drawing: () => {
      const gl = renderer.getContext();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    },
    sharpness: () => sharpness,
    set_sharpness: (share) => {
      sharpness = share;
      resize();
    },
    set_size: (factor) => { enlarged = factor; },
    set_planes: (on) => { planes = on; show_again(); },
    set_interface: (wish) => { interfaceWish = wish; show_again(); },
    set_isovalue: (share) => { isovalue = share; show_again(); },
    set_cut: (axis, share) => {
      cutAxis = axis;
      cutShare = share;
      if (axis >= 0 && domain) {
        cutPlane.normal.set(0, 0, 0).setComponent(axis, -1);
        cutPlane.constant = domain.lower[axis] + share * domain.extent[axis];
      }
      show_again();
    }};
})();
