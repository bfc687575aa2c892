// Path views: a drawing projected onto a plane, both axes to the same scale, as SVG.

const projections = {
  above: { across: 0, up: 1, names: ["east", "north"] },
  from_south: { across: 0, up: 2, names: ["east", "up"] },
  from_east: { across: 1, up: 2, names: ["north", "up"] },
  from_north: { across: 0, up: 2, names: ["west", "up"], mirrored: true },
  from_west: { across: 1, up: 2, names: ["south", "up"], mirrored: true },
};

// Lowest and highest corner of everything in a drawing that is finite.
function drawingBounds(drawing) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const include = (p) => {
    if (!p.every(finite)) return;
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], p[k]);
      high[k] = Math.max(high[k], p[k]);
    }
  };
  for (const l of drawing.lines) for (let i = 0; i < l.x.length; ++i) include(linePoint(l, i));
  for (const p of drawing.points) include(p.at);
  for (const s of drawing.spheres) {
    include(s.center.map((v) => v - s.radius));
    include(s.center.map((v) => v + s.radius));
  }
  for (const b of drawing.boxes) { include(b.lower); include(b.upper); }
  for (const s of drawing.solids) s.corners.forEach(include);
  for (const z of drawing.zones) {
    // Where a zone has no bound, whatever else is drawn says how much of it shows.
    const heights = [z.floor, z.ceiling].filter((v) => v !== null);
    if (!heights.length) heights.push(low[2] <= high[2] ? low[2] : 0);
    z.x.forEach((x, i) => heights.forEach((h) => include([x, z.y[i], h])));
  }
  return low[0] <= high[0] ? { low, high } : { low: [-1, -1, -1], high: [1, 1, 1] };
}
const linePoint = (line, i) => [line.x[i], line.y[i], line.z[i]];

const shades = 16;  // of a line that is coloured by its values

// A colour of the ramp for a share of it.
function shadeColor(share) {
  const place = clamp(share, 0, 1) * 3, low = Math.min(Math.floor(place), 2);
  return `color-mix(in srgb, var(--ramp${low + 1}) ${(100 * (place - low)).toFixed(0)}%, ` +
    `var(--ramp${low}))`;
}

function makePath(figure, spec) {
  const drawing = spec.drawing, view = projections[spec.projection];
  if (drawing.lines.length > 1) drawLegend(figure, drawing.lines);
  const plot = child(figure, "div", "plot");
  const tip = makeTip(plot);
  const { low, high } = drawingBounds(drawing);
  const [least, most] = extent(drawing.lines.map((l) => l.values || []));
  if (drawing.lines.some((l) => l.values)) drawRamp(figure, drawing.value, least, most);
  const side = view.mirrored ? -1 : 1;
  const flat = (p) => [side * p[view.across], p[view.up]];
  // Lower and higher end across, of what reaches from one place to another.
  const across = (p, q) => [p, q].map((v) => flat(v)[0]).sort((a, b) => a - b);
  let svg, sx, sy, cursor;

  function draw() {
    const width = Math.max(plot.clientWidth, 220), left = 46, right = width - 14, top = 22;
    let [x0, x1] = across(low, high), y0 = low[view.up], y1 = high[view.up];
    const pad = Math.max(0.06 * Math.max(x1 - x0, y1 - y0), 0.5);
    x0 -= pad; x1 += pad; y0 -= pad; y1 += pad;
    const wanted = (right - left) * (y1 - y0) / (x1 - x0);
    const tall = clamp(wanted, 210, width < 600 ? 300 : 420);
    const scale = Math.min((right - left) / (x1 - x0), tall / (y1 - y0));
    // The direction with room to spare shows more of the world, centred.
    const halfX = (right - left) / scale / 2, halfY = tall / scale / 2;
    [x0, x1] = [(x0 + x1) / 2 - halfX, (x0 + x1) / 2 + halfX];
    [y0, y1] = [(y0 + y1) / 2 - halfY, (y0 + y1) / 2 + halfY];
    const area = { left, right, top, bottom: top + tall };
    sx = (v) => left + (v - x0) * scale;
    sy = (v) => area.bottom - (v - y0) * scale;
    const old = svg;
    svg = document.createElementNS(svgSpace, "svg");
    const set = { viewBox: `0 0 ${width} ${area.bottom + 38}`, role: "img", tabindex: 0,
      "aria-label": `${spec.title}: ${view.names[0]} from ` +
        `${across(low, high).map((v) => numberText(v)).join(" to ")} m, ${view.names[1]} from ${numberText(flat(low)[1])} to ` +
        `${numberText(flat(high)[1])} m` };
    for (const key in set) svg.setAttribute(key, set[key]);
    const step = roundTicks(x0, x1, (right - left) / 70).step;
    const yStep = Math.max(step, roundTicks(y0, y1, tall / 26).step);
    drawAxes(svg, area, roundTicks(x0, x1, (x1 - x0) / step).ticks,
      roundTicks(y0, y1, (y1 - y0) / yStep).ticks, sx, sy, `${view.names[0]} [m]`,
      `${view.names[1]} [m]`);
    drawZones(area);
    drawBodies();
    drawSolids();
    drawLines();
    drawPoints();
    cursor = svgChild(svg, "circle", { class: "dot", r: 5, visibility: "hidden",
      style: "fill:var(--s1)" });
    listen();
    if (old) old.replaceWith(svg); else plot.prepend(svg);
  }

  // Zones lie under everything else; a bound that is missing is the drawing's own edge.
  function drawZones(area) {
    for (const z of drawing.zones) {
      let corners = z.x.map((x, i) => [sx(x), sy(z.y[i])]);
      if (view.up === 2) {
        const sides = (view.across === 0 ? z.x : z.y).map((v) => side * v);
        const [left, right] = [sx(Math.min(...sides)), sx(Math.max(...sides))];
        const bottom = z.floor === null ? area.bottom : sy(z.floor);
        const top = z.ceiling === null ? area.top : sy(z.ceiling);
        corners = [[left, bottom], [right, bottom], [right, top], [left, top]];
      }
      const node = svgChild(svg, "polygon", { class: "zone",
        points: corners.map((p) => p.map((v) => v.toFixed(1)).join(",")).join(" ") });
      svgChild(node, "title", {}, z.label);
    }
  }

  function drawBodies() {
    for (const s of drawing.spheres) {
      const [x, y] = flat(s.center);
      const node = svgChild(svg, "circle", { class: "body", cx: sx(x), cy: sy(y),
        r: Math.max(0, sx(x + s.radius) - sx(x)) });
      svgChild(node, "title", {}, s.label);
    }
    for (const b of drawing.boxes) {
      const [x0, x1] = across(b.lower, b.upper), y0 = b.lower[view.up], y1 = b.upper[view.up];
      const node = svgChild(svg, "rect", { class: "body", x: sx(x0), y: sy(y1),
        width: Math.max(0, sx(x1) - sx(x0)), height: Math.max(0, sy(y0) - sy(y1)) });
      svgChild(node, "title", {}, b.label);
    }
  }

  function drawSolids() {
    for (const s of drawing.solids) {
      const corners = s.corners.map(flat).map(([x, y]) => `${sx(x).toFixed(1)},${sy(y).toFixed(1)}`);
      const node = svgChild(svg, "path", { class: "body",
        d: s.faces.map((face) => `M${face.map((i) => corners[i]).join("L")}Z`).join("") });
      svgChild(node, "title", {}, s.label);
    }
  }

  function drawLines() {
    let points = 0;
    drawing.lines.forEach((l, index) => {
      // One path, or one for every shade of the values along it.
      const shadeOf = (i) => !l.values || !finite(l.values[i]) ? -1
        : Math.min(shades - 1, Math.floor(shades * (l.values[i] - least) / (most - least || 1)));
      const paths = new Map();
      let pen = false, lastX = NaN, lastY = NaN, lastShade = -1;
      for (let i = 0; i < l.x.length; ++i) {
        const p = linePoint(l, i);
        if (!p.every(finite)) { pen = false; continue; }
        ++points;
        const [a, b] = flat(p), x = sx(a), y = sy(b), shade = shadeOf(i);
        if (pen && i + 1 < l.x.length && Math.hypot(x - lastX, y - lastY) < 0.3) continue;
        const from = pen ? `M${lastX.toFixed(1)} ${lastY.toFixed(1)}` : "";
        const here = `${x.toFixed(1)} ${y.toFixed(1)}`;
        const fresh = pen && (shade !== lastShade || !paths.has(shade)) ? from : "";
        paths.set(shade, (paths.get(shade) || "") + fresh + (pen ? `L${here}` : `M${here}h0`));
        [pen, lastX, lastY, lastShade] = [true, x, y, shade];
      }
      for (const [shade, d] of paths)
        svgChild(svg, "path", { class: "series", d, style: "stroke:" +
          (shade < 0 ? color(index) : shadeColor((shade + 0.5) / shades)) });
    });
    svg.setAttribute("data-samples", points);
  }

  function drawPoints() {
    const free = makeLabelSpace();
    for (const p of drawing.points) {
      const [x, y] = [sx(flat(p.at)[0]), sy(flat(p.at)[1])];
      svgChild(svg, "circle", { class: "point", cx: x, cy: y, r: 3.5 });
    }
    for (const p of drawing.points) {
      const [x, y] = [sx(flat(p.at)[0]), sy(flat(p.at)[1])];
      const wide = labelWidth(p.label);
      // Right of the point, else left of it, else above or below; else the point stands alone.
      for (const [dx, dy] of [[7, -5], [-7 - wide, -5], [-wide / 2, -10], [-wide / 2, 18],
        [7, 14]]) {
        if (!free(x + dx, y + dy, wide)) continue;
        svgChild(svg, "text", { class: "point-label", x: x + dx, y: y + dy }, p.label);
        break;
      }
    }
  }

  function show(x, own) {
    tip.hide();
    cursor.setAttribute("visibility", "hidden");
    const line = drawing.lines.find((l) => l.along && l.along.length);
    if (x === null || !line) return;
    const i = nearest(line.along, x), p = linePoint(line, i);
    if (!p.every(finite)) return;
    const [a, b] = flat(p);
    cursor.setAttribute("cx", sx(a));
    cursor.setAttribute("cy", sy(b));
    cursor.setAttribute("visibility", "visible");
    if (!own) return;
    const rows = view.names.map((name, k) => [name, `${numberText(flat(p)[k])} m`]);
    if (line.values) {
      rows.push([drawing.value.label, withUnit(numberText(line.values[i]), drawing.value.unit)]);
    }
    tip.show(sx(a), sy(b), `${drawing.along.label} ` +
      withUnit(numberText(line.along[i]), drawing.along.unit), rows);
  }

  function listen() {
    svg.addEventListener("pointermove", (event) => {
      const box = svg.getBoundingClientRect(), zoom = svg.viewBox.baseVal.width / box.width;
      const px = (event.clientX - box.left) * zoom, py = (event.clientY - box.top) * zoom;
      let best = 30, found = null;
      for (const l of drawing.lines) {
        for (let i = 0; l.along && i < l.x.length; ++i) {
          if (!linePoint(l, i).every(finite)) continue;
          const [a, b] = flat(linePoint(l, i));
          const distance = Math.hypot(sx(a) - px, sy(b) - py);
          if (distance < best) [best, found] = [distance, l.along[i]];
        }
      }
      moveCursor(drawing.along, found, figure);
    });
    svg.addEventListener("pointerleave", () => moveCursor(drawing.along, null, figure));
  }

  cursors.push({ key: axisKey(drawing.along), show, source: figure });
  return draw;
}
