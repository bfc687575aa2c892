// Charts: series over a common axis with limits, markers and spans, as SVG.

function extent(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) {
    for (const v of list) if (finite(v)) { if (v < low) low = v; if (v > high) high = v; }
  }
  return low <= high ? [low, high] : [0, 1];
}

// y shifted by its spread, up or down.
function bandEdge(series, sign) {
  return series.y.map((v, k) => (finite(v) && finite(series.spread[k])
    ? v + sign * series.spread[k] : null));
}

function chartDomain(spec) {
  const x = extent([...spec.series.map((s) => s.x), spec.markers.map((m) => m.x)]);
  if (x[0] === x[1]) { x[0] -= 0.5; x[1] += 0.5; }
  const limits = spec.limits.map((l) => l.value);
  if (spec.y.log) {
    const positive = [...spec.series.map((s) => s.y), limits].map((l) => l.filter((v) => v > 0));
    const [low, high] = extent(positive);
    return { x, y: low > 0 ? [low / 1.5, high * 1.5 + (low === high ? low : 0)] : [0.1, 10] };
  }
  let [low, high] = extent([...spec.series.map((s) => s.y),
    ...spec.series.flatMap((s) => (s.spread ? [bandEdge(s, 1), bandEdge(s, -1)] : [])), limits]);
  if (low > 0 && low < 0.5 * high) low = 0;
  if (high < 0 && high > 0.5 * low) high = 0;
  const pad = high > low ? 0.07 * (high - low) : Math.max(Math.abs(high) * 0.1, 0.5);
  if (high === low) return { x, y: [low - pad, high + pad] };
  return { x, y: [low === 0 ? 0 : low - pad, high === 0 ? 0 : high + pad] };
}

// Indices to draw: all, or first, lowest, highest and last of each pixel column of long series.
function thinned(ys, columns) {
  const n = ys.length;
  if (n <= 4 * columns) return ys.map((_, i) => i);
  const kept = [];
  for (let c = 0; c < columns; ++c) {
    const begin = Math.floor(c * n / columns), end = Math.floor((c + 1) * n / columns);
    let low = begin, high = begin, gap = -1;
    for (let i = begin; i < end; ++i) {
      if (!finite(ys[i])) gap = i;
      else if (!(ys[i] >= ys[low])) low = i;
      else if (!(ys[i] <= ys[high])) high = i;
    }
    const picked = new Set([begin, low, high, end - 1]);
    if (gap >= 0) picked.add(gap);
    kept.push(...[...picked].sort((a, b) => a - b));
  }
  return kept;
}

function seriesPath(series, sx, sy, log, columns) {
  let d = "", pen = false, count = 0;
  for (const i of thinned(series.y, columns)) {
    const v = series.y[i];
    if (!finite(v) || (log && v <= 0)) { pen = false; continue; }
    const x = sx(series.x[i]).toFixed(1), y = sy(v).toFixed(1);
    d += !pen ? `M${x} ${y}h0` : series.stepped ? `H${x}V${y}` : `L${x} ${y}`;
    pen = true;
    ++count;
  }
  return { d, count };
}

// Of linear axes.
function bandPath(series, sx, sy) {
  const above = bandEdge(series, 1), below = bandEdge(series, -1);
  const kept = series.x.map((_, k) => k).filter((k) => above[k] !== null);
  const at = (edge) => (k) => `${sx(series.x[k]).toFixed(1)} ${sy(edge[k]).toFixed(1)}`;
  if (!kept.length) return "";
  return `M${kept.map(at(above)).join("L")}L${kept.reverse().map(at(below)).join("L")}Z`;
}

function makeChart(figure, spec) {
  if (spec.series.length > 1) drawLegend(figure, spec.series);
  const plot = child(figure, "div", "plot");
  const tip = makeTip(plot);
  const domain = chartDomain(spec);
  const summary = `${spec.title}: ` + spec.series.map((s) => {
    const [low, high] = extent([s.y]);
    return `${s.name} from ${numberText(low)} to ${withUnit(numberText(high), spec.y.unit)}`;
  }).join(", ") + spec.limits.map((l) => `, ${l.label} ${numberText(l.value)}`).join("");
  let svg, sx, sy, area, cursor, shown = null;

  function draw() {
    const width = Math.max(plot.clientWidth, 220);
    const height = clamp(Math.round(width * 0.5), 190, 280);
    area = { left: 52, right: width - 12, top: spec.markers.length ? 34 : 22,
      bottom: height - 38 };
    const yTicks = spec.y.log ? powerTicks(...domain.y, 6)
      : roundTicks(...domain.y, (area.bottom - area.top) / 30, spec.y.whole).ticks;
    area.left = Math.max(30, ...yTicks.map((t) => 14 + labelWidth(t.text)));
    const [x0, x1] = domain.x, y = domain.y.map((v) => (spec.y.log ? Math.log10(v) : v));
    sx = (v) => area.left + (v - x0) / (x1 - x0) * (area.right - area.left);
    sy = (v) => area.bottom - ((spec.y.log ? Math.log10(v) : v) - y[0]) / (y[1] - y[0])
      * (area.bottom - area.top);
    const old = svg;
    svg = document.createElementNS(svgSpace, "svg");
    const set = { viewBox: `0 0 ${width} ${height}`, role: "img", tabindex: 0,
      "aria-label": summary };
    for (const key in set) svg.setAttribute(key, set[key]);
    drawSpans();
    const xTicks = roundTicks(x0, x1, (area.right - area.left) / 70, spec.x.whole).ticks;
    drawAxes(svg, area, xTicks, yTicks, sx, sy, axisTitle(spec.x), axisTitle(spec.y));
    drawMarkers();
    drawSeries();
    drawLimits();
    cursor = svgChild(svg, "g", { visibility: "hidden" });
    listen();
    if (old) old.replaceWith(svg); else plot.prepend(svg);
  }

  function drawSpans() {
    for (const s of spec.spans) {
      const from = clamp(sx(s.from), area.left, area.right);
      const to = clamp(sx(s.to), area.left, area.right);
      svgChild(svg, "rect", { class: "span", x: from, y: area.top, width: to - from,
        height: area.bottom - area.top });
      svgChild(svg, "text", { x: (from + to) / 2, y: area.bottom - 6, "text-anchor": "middle" },
        s.label);
    }
  }

  function drawMarkers() {
    const free = makeLabelSpace();
    const crowded = spec.markers.length * 16 > area.right - area.left;
    const stride = Math.ceil(spec.markers.length * 18 / (area.right - area.left));
    spec.markers.forEach((m, i) => {
      const x = sx(m.x), half = labelWidth(m.label) / 2;
      svgChild(svg, "line", { class: "marker", x1: x, x2: x, y1: area.top,
        y2: crowded ? area.top + 5 : area.bottom });
      const at = clamp(x, area.left + half, area.right - half);
      if (i % stride === 0 && free(at - half, 0, 2 * half)) {
        svgChild(svg, "text", { x: at, y: area.top - 4, "text-anchor": "middle" }, m.label);
      }
    });
  }

  function drawSeries() {
    let points = 0, samples = 0;
    spec.series.forEach((s, i) => {
      if (!s.spread || spec.y.log) return;
      svgChild(svg, "path", { class: "band", d: bandPath(s, sx, sy), style: `fill:${color(i)}` });
    });
    spec.series.forEach((s, i) => {
      const path = seriesPath(s, sx, sy, spec.y.log, Math.round(area.right - area.left));
      const line = svgChild(svg, "path", { class: "series", d: path.d,
        style: `stroke:${color(i)}` });
      if (i >= 8) line.setAttribute("stroke-dasharray", "5 3");
      if (path.count <= 24) {
        s.y.forEach((v, k) => {
          if (!finite(v) || (spec.y.log && v <= 0)) return;
          svgChild(svg, "circle", { cx: sx(s.x[k]), cy: sy(v), r: 2.6,
            style: `fill:${color(i)}` });
        });
      }
      points += path.count;
      samples += s.y.filter(finite).length;
    });
    svg.setAttribute("data-points", points);    // drawn
    svg.setAttribute("data-samples", samples);  // that they stand for
  }

  function drawLimits() {
    const free = makeLabelSpace();
    const [low, high] = domain.y;
    for (const l of spec.limits) {
      if (spec.y.log && l.value <= 0) continue;
      const y = sy(l.value), below = l.value < (low + high) / 2;
      svgChild(svg, "line", { class: "limit", x1: area.left, x2: area.right, y1: y, y2: y });
      const text = `${l.label} ${numberText(l.value, 3)}`;
      const at = y + (below ? -5 : 13);
      if (free(area.right - labelWidth(text), at, labelWidth(text))) {
        svgChild(svg, "text", { class: "limit-label", x: area.right - 2, y: at,
          "text-anchor": "end" }, text);
      }
    }
  }

  function show(x, own) {
    shown = x;
    if (x === null || x < domain.x[0] || x > domain.x[1]) {
      cursor.setAttribute("visibility", "hidden");
      tip.hide();
      return;
    }
    cursor.textContent = "";
    cursor.setAttribute("visibility", "visible");
    svgChild(cursor, "line", { class: "cursor", x1: sx(x), x2: sx(x), y1: area.top,
      y2: area.bottom });
    const rows = [];
    spec.series.forEach((s, i) => {
      if (!s.x.length) return;
      const v = s.y[nearest(s.x, x)];
      rows.push([s.name, withUnit(numberText(v), spec.y.unit)]);
      if (!finite(v) || (spec.y.log && v <= 0)) return;
      svgChild(cursor, "circle", { class: "dot", cx: sx(x), cy: sy(v), r: 4,
        style: `fill:${color(i)}` });
    });
    if (own) {
      tip.show(sx(x), (area.top + area.bottom) / 2,
        `${spec.x.label} ${withUnit(numberText(x), spec.x.unit)}`, rows);
    } else {
      tip.hide();
    }
  }

  const base = spec.series.reduce((a, s) => (s.x.length > a.length ? s.x : a), []);
  function listen() {
    svg.addEventListener("pointermove", (event) => {
      const box = svg.getBoundingClientRect();
      const px = (event.clientX - box.left) * svg.viewBox.baseVal.width / box.width;
      const x = domain.x[0] + (px - area.left) / (area.right - area.left)
        * (domain.x[1] - domain.x[0]);
      if (base.length) moveCursor(spec.x, base[nearest(base, x)], figure);
    });
    svg.addEventListener("pointerleave", () => moveCursor(spec.x, null, figure));
    svg.addEventListener("blur", () => moveCursor(spec.x, null, figure));
    svg.addEventListener("keydown", (event) => {
      const n = base.length, jump = event.shiftKey ? 10 : 1;
      const now = shown === null ? -1 : nearest(base, shown);
      const next = { ArrowRight: now + jump, ArrowLeft: now - jump, Home: 0, End: n - 1,
        Escape: null }[event.key];
      if (next === undefined || n === 0) return;
      event.preventDefault();
      moveCursor(spec.x, next === null ? null : base[clamp(next, 0, n - 1)], figure);
    });
  }

  cursors.push({ key: axisKey(spec.x), show, source: figure });
  return draw;
}
