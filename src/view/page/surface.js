// SPDX-License-Identifier: MIT
// Surfaces of equal value in values at the points of a grid, and the interface of particles as such a surface.
'use strict';

const surface = (() => {
  // Values at points (i, j, k), the last fastest, with one layer more where the field goes on periodically.
  function field_of(block) {
    const {codes, bits, low, high} = block.values, top = bits === 8 ? 254 : 65534;
    const points = block.points, full = points.map((count, axis) => count + (block.wraps[axis] ? 1 : 0));
    const values = new Float32Array(full[0] * full[1] * full[2]);
    let at = 0;
    for (let i = 0; i < full[0]; ++i)
      for (let j = 0; j < full[1]; ++j)
        for (let k = 0; k < full[2]; ++k) {
          const code = codes[((i % points[0]) * points[1] + j % points[1]) * points[2] + k % points[2]];
          values[at++] = code > top ? NaN : low + code / top * (high - low);
        }
    return {values, points: full, lower: block.lower, spacing: block.spacing};
  }

  // A vertex in every cell that the surface passes, at the mean of the places where it cuts the cell's edges, and a
  // quadrilateral of four of them across every edge that it cuts (surface nets: Gibson 1998).
  function in_space(field, level) {
    const {values, points: [nx, ny, nz], lower, spacing} = field;
    const strides = [ny * nz, nz, 1], corners = [];
    for (let c = 0; c < 8; ++c) corners.push((c & 1) * strides[0] + (c >> 1 & 1) * strides[1] + (c >> 2 & 1));
    const edges = [];
    for (let a = 0; a < 8; ++a) for (const bit of [1, 2, 4]) if (!(a & bit)) edges.push([a, a | bit]);
    const vertex = new Int32Array(values.length).fill(-1), places = [], triangles = [];
    for (let i = 0; i + 1 < nx; ++i)
      for (let j = 0; j + 1 < ny; ++j)
        for (let k = 0; k + 1 < nz; ++k) {
          const first = i * strides[0] + j * strides[1] + k;
          let above = 0;
          for (let c = 0; c < 8; ++c) if (values[first + corners[c]] > level) above |= 1 << c;
          if (above === 0 || above === 255) continue;
          const sum = [0, 0, 0];
          let cuts = 0;
          for (const [a, b] of edges) {
            if ((above >> a & 1) === (above >> b & 1)) continue;
            const low = values[first + corners[a]], share = (level - low) / (values[first + corners[b]] - low);
            if (!(share >= 0 && share <= 1)) continue;  // beside what is no number
            for (let axis = 0; axis < 3; ++axis) {
              const from = a >> axis & 1, to = b >> axis & 1;
              sum[axis] += from + share * (to - from);
            }
            ++cuts;
          }
          if (!cuts) continue;
          vertex[first] = places.length / 3;
          const cell = [i, j, k];
          for (let axis = 0; axis < 3; ++axis) places.push(lower[axis] + spacing[axis] * (cell[axis] + sum[axis] / cuts));
        }
    for (let i = 0; i < nx; ++i)
      for (let j = 0; j < ny; ++j)
        for (let k = 0; k < nz; ++k) {
          const point = [i, j, k], at = i * strides[0] + j * strides[1] + k, here = values[at] > level;
          for (let axis = 0; axis < 3; ++axis) {
            const b = (axis + 1) % 3, c = (axis + 2) % 3;
            if (point[axis] + 1 >= [nx, ny, nz][axis] || point[b] === 0 || point[c] === 0) continue;
            if (here === values[at + strides[axis]] > level) continue;
            const four = [at - strides[b] - strides[c], at - strides[c], at, at - strides[b]].map((cell) => vertex[cell]);
            if (four.includes(-1)) continue;
            const [p, q, r, s] = here ? four : [four[3], four[2], four[1], four[0]];
            triangles.push(p, q, r, p, r, s);
          }
        }
    return {places: new Float32Array(places), triangles: new Uint32Array(triangles)};
  }

  // Pairs of places in the plane of the first two axes, between which the line runs.
  function in_plane(field, level) {
    const {values, points: [nx, ny], lower, spacing} = field, ends = [];
    const around = [[0, 0], [1, 0], [1, 1], [0, 1]];
    for (let i = 0; i + 1 < nx; ++i)
      for (let j = 0; j + 1 < ny; ++j) {
        const value = around.map(([a, b]) => values[(i + a) * ny + j + b] - level), cuts = [];
        for (let e = 0; e < 4; ++e) {
          const f = (e + 1) % 4;
          if (value[e] > 0 === value[f] > 0) continue;
          const share = value[e] / (value[e] - value[f]);
          if (!(share >= 0 && share <= 1)) continue;
          cuts.push([0, 1].map((axis) => lower[axis] + spacing[axis] * ([i, j][axis] + around[e][axis] + share * (around[f][axis] - around[e][axis]))));
        }
        // Where all four edges are cut the middle tells which two corners belong together.
        if (cuts.length === 4 && value[0] > 0 === value[0] + value[1] + value[2] + value[3] > 0) cuts.push(cuts.shift());
        for (let c = 0; c + 1 < cuts.length; c += 2) ends.push(...cuts[c], 0, ...cuts[c + 1], 0);
      }
    return {places: new Float32Array(ends)};
  }

  // What of the room in cells of two spacings is taken by particles, or by those of a phase: the interface is where half
  // of it is. Cells beyond the box count as those beside them, so that walls are none.
  function share_of(block, phase, domain, spacing) {
    const dimensions = domain.flat ? 2 : 3, share = Math.pow(block.total / Math.max(block.count, 1), 1 / dimensions);
    const most = domain.flat ? 400 : 96;
    const wide = Math.max(2 * spacing * share, Math.max(...domain.extent) / most);
    const points = [0, 1, 2].map((axis) => axis < dimensions ? Math.max(1, Math.round(domain.extent[axis] / wide)) : 1);
    const sides = points.map((count, axis) => axis < dimensions ? domain.extent[axis] / count : 1);
    const own = new Float32Array(points[0] * points[1] * points[2]), all = new Float32Array(own.length);
    const {codes} = block.positions, d = block.dimensions;
    const scale = block.lower.map((low, axis) => (block.upper[axis] - low) / 65535 / sides[axis]);
    const start = block.lower.map((low, axis) => (low - domain.lower[axis]) / sides[axis]);
    for (let n = 0; n < block.count; ++n) {
      let at = 0;
      for (let axis = 0; axis < 3; ++axis) {
        const cell = axis < dimensions ? Math.floor(start[axis] + codes[n * d + axis] * scale[axis]) : 0;
        at = at * points[axis] + Math.max(0, Math.min(points[axis] - 1, cell));
      }
      all[at] += 1;
      if (phase < 0 || block.phases.codes[n] === phase) own[at] += 1;
    }
    const full = sides.slice(0, dimensions).reduce((product, side) => product * side, 1) / Math.pow(spacing * share, dimensions);
    for (let axis = 0; axis < dimensions; ++axis)
      for (const values of [own, all]) smooth(values, points, axis);
    for (let k = 0; k < own.length; ++k) own[k] /= phase < 0 ? full : Math.max(all[k], full / 2);
    // One cell more on each side, equal to the last: the surface then reaches the box.
    const wider = points.map((count, axis) => axis < dimensions ? count + 2 : 1), values = new Float32Array(wider[0] * wider[1] * wider[2]);
    const inside = (k, axis) => axis < dimensions ? Math.max(0, Math.min(points[axis] - 1, k - 1)) : 0;
    for (let i = 0; i < wider[0]; ++i)
      for (let j = 0; j < wider[1]; ++j)
        for (let k = 0; k < wider[2]; ++k)
          values[(i * wider[1] + j) * wider[2] + k] = own[(inside(i, 0) * points[1] + inside(j, 1)) * points[2] + inside(k, 2)];
    return {values, points: wider, lower: domain.lower.map((low, axis) => axis < dimensions ? low - sides[axis] / 2 : 0), spacing: sides};
  }
  // (1, 2, 1)/4 along an axis.
  function smooth(values, points, axis) {
    const stride = points.slice(axis + 1).reduce((product, count) => product * count, 1), count = points[axis];
    for (let at = 0; at < values.length; ++at) {
      if (Math.floor(at / stride) % count) continue;
      let before = values[at];
      for (let k = 0; k < count; ++k) {
        const here = values[at + k * stride], after = values[at + Math.min(k + 1, count - 1) * stride];
        values[at + k * stride] = (before + 2 * here + after) / 4;
        before = here;
      }
    }
  }

  // The surfaces between the phases of a block, or that of its particles where they have none: [{places, triangles}].
  function interfaces(block, domain, spacing) {
    if (!(spacing > 0) || !block.count) return [];
    const phases = block.phases ? 1 + block.phases.codes.reduce((most, phase) => Math.max(most, phase), 0) : 0;
    const wanted = phases > 1 ? [...Array(phases - 1).keys()] : [-1];
    const shapes = wanted.map((phase) => (domain.flat ? in_plane : in_space)(share_of(block, phase, domain, spacing), 0.5));
    for (const {places} of shapes)
      for (let n = 0; n < places.length; ++n) places[n] = Math.max(domain.lower[n % 3], Math.min(domain.upper[n % 3], places[n]));
    return shapes;
  }
  return {field_of, in_space, in_plane, interfaces};
})();
