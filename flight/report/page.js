// SPDX-License-Identifier: BSD-3-Clause
// One cursor for all charts over time, a dot on the path where the vehicle was then, and a path in space
// that turns. The page is complete without: this only adds what needs a hand on the mouse.
'use strict';
(() => {
  const svgNs = document.querySelector('svg').namespaceURI;
  const numbers = (text) => text.trim().split(/\s+/).map(Number);
  const add = (parent, tag, css) => {
    const node = document.createElementNS(svgNs, tag);
    node.setAttribute('class', css);
    node.style.display = 'none';
    return parent.appendChild(node);
  };
  document.body.classList.add('live');
  const track = JSON.parse(document.getElementById('track').textContent);

  // ---- charts over time
  // Points of a path as written: runs of x and y; a new run begins at each gap.
  const runsOf = (d) => d.split('M').filter(Boolean).map((run) => numbers(run.replace(/h0/g, '').replace(/L/g, ' ')));
  const nearest = (runs, x) => {
    for (const run of runs) {
      const last = run.length - 2;
      if (x < run[0] - 1.5 || x > run[last] + 1.5) continue;
      let low = 0, high = last / 2;
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (run[2 * middle] <= x) low = middle; else high = middle;
      }
      const x0 = run[2 * low], x1 = run[2 * high];
      const share = x1 > x0 ? Math.min(Math.max((x - x0) / (x1 - x0), 0), 1) : 0;
      return run[2 * low + 1] + share * (run[2 * high + 1] - run[2 * low + 1]);
    }
    return NaN;
  };
  const charts = [...document.querySelectorAll('svg.time')].map((svg) => {
    const keys = svg.closest('figure').querySelectorAll('.key output');
    const curves = [...svg.querySelectorAll('path.curve')].map((path) => ({path, out: keys[path.dataset.k]}));
    const [top, bottom] = numbers(svg.dataset.y);
    const line = add(svg, 'path', 'cursor');
    const label = add(svg, 'text', 'tick cursor-time');
    label.setAttribute('text-anchor', 'middle');
    return {svg, curves, top, bottom, line, label, t: numbers(svg.dataset.t), x: numbers(svg.dataset.x),
      v: svg.dataset.v ? numbers(svg.dataset.v) : null, decimals: Number(svg.dataset.d || 0)};
  });
  const read = (chart, x) => {
    for (const curve of chart.curves) {
      curve.runs = curve.runs || runsOf(curve.path.getAttribute('d'));
      const y = nearest(curve.runs, x);
      const share = (y - chart.top) / (chart.bottom - chart.top);
      const value = chart.v[0] + share * (chart.v[1] - chart.v[0]);
      curve.out.textContent = Number.isFinite(value) ? value.toFixed(chart.decimals) : '–';
    }
  };
  const showCharts = (t) => {
    for (const chart of charts) {
      const hidden = t === null;
      chart.line.style.display = chart.label.style.display = hidden ? 'none' : '';
      if (hidden) {
        for (const curve of chart.curves) curve.out.textContent = '';
        continue;
      }
      const x = chart.x[0] + (t - chart.t[0]) / (chart.t[1] - chart.t[0]) * (chart.x[1] - chart.x[0]);
      chart.line.setAttribute('d', `M${x} ${chart.top}V${chart.bottom}`);
      chart.label.setAttribute('x', Math.min(Math.max(x, chart.x[0] + 18), chart.x[1] - 18));
      chart.label.setAttribute('y', chart.bottom + 16);
      chart.label.textContent = t.toFixed(2) + ' s';
      read(chart, x);
    }
  };

  // ---- the vehicle on the maps
  const placeAt = (t) => {
    let low = 0, high = track.t.length - 1;
    if (high < 0) return null;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (track.t[middle] <= t) low = middle; else high = middle;
    }
    const span = track.t[high] - track.t[low];
    const share = span > 0 ? Math.min(Math.max((t - track.t[low]) / span, 0), 1) : 0;
    const between = (list) => list[low] === null || list[high] === null ? NaN
      : list[low] + share * (list[high] - list[low]);
    return {n: between(track.n), e: between(track.e), u: between(track.u)};
  };
  const maps = [...document.querySelectorAll('svg.map[data-across]')].map((svg) => {
    const axis = (text) => {
      const [letter, ...rest] = text.split(' ');
      const [v0, v1, p0, p1] = rest.map(Number);
      return (place) => p0 + (place[letter] - v0) / (v1 - v0) * (p1 - p0);
    };
    const dot = add(svg, 'circle', 'here');
    dot.setAttribute('r', 6);
    return {dot, across: axis(svg.dataset.across), up: axis(svg.dataset.up)};
  });
  const putDot = (dot, x, y) => {
    const known = Number.isFinite(x) && Number.isFinite(y);
    dot.style.display = known ? '' : 'none';
    if (!known) return;
    dot.setAttribute('cx', x);
    dot.setAttribute('cy', y);
  };
  const showMaps = (place) => {
    for (const map of maps) putDot(map.dot, place ? map.across(place) : NaN, place ? map.up(place) : NaN);
    space.mark(place);
  };

  // ---- the path in space
  const space = (() => {
    const svg = document.getElementById('space');
    const known = [];
    for (let k = 0; k < track.t.length; ++k) {
      if (track.n[k] !== null && track.e[k] !== null && track.u[k] !== null) {
        known.push([track.n[k], track.e[k], track.u[k]]);
      }
    }
    if (!svg || known.length < 2) {
      if (svg) svg.closest('figure').style.display = 'none';
      return {mark: () => {}};
    }
    const all = known.concat(track.waypoints);
    const low = [0, 1, 2].map((k) => Math.min(...all.map((p) => p[k])));
    const high = [0, 1, 2].map((k) => Math.max(...all.map((p) => p[k])));
    low[2] = Math.min(low[2], 0);
    const [, , width, height] = numbers(svg.getAttribute('viewBox'));
    const span = Math.max(high[0] - low[0], high[1] - low[1], 1);
    const step = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000].find((s) => span / s <= 9) || span / 8;
    const from = [0, 1].map((k) => Math.floor(low[k] / step) * step);
    const to = [0, 1].map((k) => Math.ceil(high[k] / step) * step);
    // The corners of the box around everything: what must stay inside the drawing as it turns.
    const corners = [from[0], to[0]].flatMap((n) => [from[1], to[1]].flatMap((e) => [low[2], high[2]].map((u) => [n, e, u])));
    let azimuth = -0.55, elevation = 0.42, marked = null, scale = 1, centre = [0, 0];
    const turn = ([n, e, u]) => {
      const across = e * Math.cos(azimuth) + n * Math.sin(azimuth);
      const away = n * Math.cos(azimuth) - e * Math.sin(azimuth);
      return [across, -(u * Math.cos(elevation) + away * Math.sin(elevation))];
    };
    const fit = () => {
      const turned = corners.map(turn);
      const ends = [0, 1].map((k) => [Math.min(...turned.map((p) => p[k])), Math.max(...turned.map((p) => p[k]))]);
      centre = ends.map(([a, b]) => (a + b) / 2);
      scale = Math.min((width - 50) / (ends[0][1] - ends[0][0]), (height - 40) / (ends[1][1] - ends[1][0]));
    };
    const project = (point) => {
      const [x, y] = turn(point);
      return [width / 2 + scale * (x - centre[0]), height / 2 + scale * (y - centre[1])];
    };
    const line = (points) => points.map((p, k) => (k ? 'L' : 'M') + project(p).map((v) => v.toFixed(1)).join(' ')).join('');
    const layer = (css) => {
      const node = add(svg, 'path', css);
      node.style.display = '';
      return node;
    };
    const floor = layer('grid'), shadow = layer('shadow'), plumbs = layer('plumb'), path = layer('curve actual');
    const labels = track.waypoints.map((_, k) => {
      const group = add(svg, 'g', 'waypoint');
      group.style.display = '';
      const circle = add(group, 'circle', ''), text = add(group, 'text', '');
      circle.style.display = text.style.display = '';
      circle.setAttribute('r', 8);
      text.setAttribute('text-anchor', 'middle');
      text.setAttribute('y', 4);
      text.textContent = k + 1;
      return group;
    });
    const north = add(svg, 'text', 'tick');
    north.style.display = '';
    north.setAttribute('text-anchor', 'middle');
    north.textContent = 'N';
    const dot = add(svg, 'circle', 'here');
    dot.setAttribute('r', 6);
    const draw = () => {
      fit();
      let grid = '';
      for (let n = from[0]; n <= to[0] + step / 2; n += step) grid += line([[n, from[1], 0], [n, to[1], 0]]);
      for (let e = from[1]; e <= to[1] + step / 2; e += step) grid += line([[from[0], e, 0], [to[0], e, 0]]);
      floor.setAttribute('d', grid);
      shadow.setAttribute('d', line(known.map(([n, e]) => [n, e, 0])));
      path.setAttribute('d', line(known));
      plumbs.setAttribute('d', track.waypoints.map(([n, e, u]) => line([[n, e, 0], [n, e, u]])).join(''));
      labels.forEach((label, k) => {
        const [x, y] = project(track.waypoints[k]);
        label.setAttribute('transform', `translate(${x.toFixed(1)} ${y.toFixed(1)})`);
      });
      const [x, y] = project([to[0] + step * 0.4, (from[1] + to[1]) / 2, 0]);
      north.setAttribute('x', x);
      north.setAttribute('y', y);
      mark(marked);
    };
    const mark = (place) => {
      marked = place;
      const [x, y] = place ? project([place.n, place.e, place.u]) : [NaN, NaN];
      putDot(dot, x, y);
    };
    svg.addEventListener('pointerdown', (event) => svg.setPointerCapture(event.pointerId));
    svg.addEventListener('pointermove', (event) => {
      if (!event.buttons) return;
      azimuth += event.movementX * 0.01;
      elevation = Math.min(Math.max(elevation + event.movementY * 0.01, 0), Math.PI / 2);
      draw();
    });
    draw();
    return {mark};
  })();

  const show = (t) => {
    showCharts(t);
    showMaps(t === null ? null : placeAt(t));
  };
  for (const chart of charts) {
    const follow = (event) => {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.svg.getScreenCTM().inverse());
      const share = (point.x - chart.x[0]) / (chart.x[1] - chart.x[0]);
      show(chart.t[0] + Math.min(Math.max(share, 0), 1) * (chart.t[1] - chart.t[0]));
    };
    chart.svg.addEventListener('pointermove', follow);
    chart.svg.addEventListener('pointerdown', follow);
    chart.svg.addEventListener('pointerleave', () => show(null));
  }
})();
