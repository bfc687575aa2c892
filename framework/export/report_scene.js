// Scenes: a drawing in space that the reader turns, on a canvas. World: x east, y north, z up.

function rampColor(t, stops) {
  const at = clamp(t, 0, 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  const mix = stops[k].map((c, i) => Math.round(c + (stops[k + 1][i] - c) * (at - k)));
  return `rgb(${mix})`;
}

function makeScene(figure, spec) {
  const drawing = spec.drawing;
  const canvas = child(child(figure, "div", "plot"), "canvas", "");
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  const { low, high } = drawingBounds(drawing);
  const center = low.map((v, k) => (v + high[k]) / 2);
  const size = Math.max(Math.hypot(...low.map((v, k) => high[k] - v)) / 2, 1);
  // The ground is z = 0, unless everything is far from it or reaches below it.
  const ground = low[2] < 0 || low[2] > 2 * size ? low[2] : 0;
  const [least, most] = extent(drawing.lines.map((l) => l.values || []));
  const gridStep = roundTicks(0, 2 * size, 7).step;
  const from = [0, 1].map((k) => Math.floor(low[k] / gridStep) * gridStep);
  const to = [0, 1].map((k) => Math.ceil(high[k] / gridStep) * gridStep);
  for (const k of [0, 1]) if (to[k] === from[k]) { to[k] += gridStep; from[k] -= gridStep; }
  canvas.setAttribute("aria-label", `${spec.title}: ${drawing.lines.length} paths and ` +
    `${drawing.points.length} points in ${numberText(high[0] - low[0], 3)} m by ` +
    `${numberText(high[1] - low[1], 3)} m, up to ${numberText(high[2], 3)} m high; arrow keys ` +
    "turn, plus and minus zoom");
  let view, width, height, theme, cursorAt = null, queued = false;
  const home = { turn: -0.6, tilt: 0.42, zoom: 1, panX: 0, panY: 0 };
  view = { ...home };

  function readTheme() {
    const style = getComputedStyle(document.documentElement);
    const get = (name) => style.getPropertyValue(`--${name}`).trim();
    const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
    theme = { ink: get("ink"), muted: get("muted"), line: get("line"), grid: get("grid"),
      panel: get("panel"), accent: get("s1"), shade: get("shade"),
      zone: get("zone"), limit: get("limit"),
      series: [0, 1, 2, 3, 4, 5, 6, 7].map((i) => get(`s${i}`)),
      ramp: [0, 1, 2, 3].map((i) => rgb(get(`ramp${i}`))) };
  }

  // Scale and place so that everything just fits when seen from home.
  let fit = { scale: 1, x: 0, y: 0 };
  function fitHome() {
    const now = view;
    view = { ...home };
    fit = { scale: 1, x: 0, y: 0 };
    const [x, y] = [[], []];
    for (let i = 0; i < 16; ++i) {
      // The corners of everything, and those of the ground grid.
      const p = project(i < 8 ? [0, 1, 2].map((k) => (i >> k & 1 ? high : low)[k])
        : [...[0, 1].map((k) => (i >> k & 1 ? to : from)[k]), ground]);
      x.push(p.x);
      y.push(p.y);
    }
    const [left, right] = extent([x]), [top, bottom] = extent([y]);
    const scale = Math.min((width - 84) / (right - left), (height - 76) / (bottom - top));
    fit = { scale, x: (width / 2 - (left + right) / 2) * scale,
      y: (height / 2 - (top + bottom) / 2) * scale - 12 };
    view = now;
  }

  // Pixels, depth (larger is farther) and pixels per metre there.
  function project(p) {
    const c = Math.cos(view.turn), s = Math.sin(view.turn);
    const ct = Math.cos(view.tilt), st = Math.sin(view.tilt);
    const x = p[0] - center[0], y = p[1] - center[1], z = p[2] - center[2];
    const right = c * x + s * y, away = -s * x + c * y;
    const depth = away * ct - z * st, up = away * st + z * ct;
    const distance = 4.5 * size;
    const scale = fit.scale * view.zoom * distance / Math.max(distance + depth, 0.05 * distance);
    return { x: width / 2 + fit.x + view.panX + right * scale,
      y: height / 2 + fit.y + view.panY - up * scale, depth, scale };
  }

  const pen = canvas.getContext("2d");
  function stroke(points, style, lineWidth, dash) {
    pen.beginPath();
    points.forEach((p, i) => (i ? pen.lineTo(p.x, p.y) : pen.moveTo(p.x, p.y)));
    pen.strokeStyle = style;
    pen.lineWidth = lineWidth;
    pen.setLineDash(dash || []);
    pen.stroke();
  }
  function write(text, x, y, style, align) {
    pen.font = "11.5px system-ui, sans-serif";
    pen.textAlign = align || "center";
    pen.setLineDash([]);
    pen.lineWidth = 3;
    pen.lineJoin = "round";
    pen.strokeStyle = theme.panel;
    pen.strokeText(text, x, y);
    pen.fillStyle = style;
    pen.fillText(text, x, y);
  }

  function drawGround() {
    const at = (k, v, other) => project(k === 0 ? [v, other, ground] : [other, v, ground]);
    for (const k of [0, 1]) {
      const o = 1 - k;
      // Labels stand at the edge that is nearer to the reader.
      const near = at(k, from[k], from[o]).depth + at(k, to[k], from[o]).depth
        < at(k, from[k], to[o]).depth + at(k, to[k], to[o]).depth ? from[o] : to[o];
      const count = Math.round((to[k] - from[k]) / gridStep);
      let last = null;
      for (let i = 0; i <= count; ++i) {
        const v = from[k] + i * gridStep;
        stroke([at(k, v, from[o]), at(k, v, to[o])], theme.line, Math.abs(v) < 1e-9 ? 1.4 : 0.7);
        const p = at(k, v, near + (near === to[o] ? 0.35 : -0.35) * gridStep);
        if (last && Math.hypot(p.x - last.x, p.y - last.y) < 26) continue;
        last = p;
        write(numberText(v), p.x, p.y + 4, theme.muted);
      }
      if (width < 500) continue;  // no room; the corner names the directions
      const p = at(k, (from[k] + to[k]) / 2, near + (near === to[o] ? 1 : -1) * gridStep);
      write(k === 0 ? "east [m]" : "north [m]", clamp(p.x, 30, width - 30), p.y + 4, theme.muted);
    }
  }

  // Everything that hides something else: {depth, draw}.
  function collect() {
    const items = [];
    drawing.lines.forEach((l, index) => {
      const stride = Math.max(1, Math.ceil(l.x.length / 4000));
      let before = null;
      for (let i = 0; i < l.x.length; i = i + 1 < l.x.length ? Math.min(i + stride,
        l.x.length - 1) : l.x.length) {
        const p = linePoint(l, i);
        const now = p.every(finite) ? project(p) : null;
        if (before && now) {
          const [a, b] = [before, now];
          const style = l.values && finite(l.values[i])
            ? rampColor((l.values[i] - least) / Math.max(most - least, 1e-12), theme.ramp)
            : theme.series[index % 8];
          items.push({ depth: (a.depth + b.depth) / 2, draw: () => stroke([a, b], style, 2.6) });
        }
        before = now;
      }
    });
    for (const s of drawing.spheres) {
      const c = project(s.center), r = Math.max(s.radius * c.scale, 0);
      items.push({ depth: c.depth, draw() {
        const shine = pen.createRadialGradient(c.x - r / 3, c.y - r / 3, r / 8, c.x, c.y, r);
        shine.addColorStop(0, theme.shade);
        shine.addColorStop(1, theme.muted + "66");
        pen.beginPath();
        pen.arc(c.x, c.y, r, 0, 2 * Math.PI);
        pen.fillStyle = shine;
        pen.fill();
        pen.setLineDash([]);
        pen.strokeStyle = theme.muted;
        pen.lineWidth = 1;
        pen.stroke();
      } });
    }
    for (const b of drawing.boxes) items.push(...boxFaces(b));
    for (const z of drawing.zones) items.push(...zoneFaces(z));
    for (const s of drawing.solids) items.push(...solidFaces(s));
    return items.sort((a, b) => b.depth - a.depth);
  }

  function boxFaces(box) {
    const corner = (i) => project([0, 1, 2].map((k) => (i >> k & 1 ? box.upper : box.lower)[k]));
    return [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
      .map((face) => {
        const c = face.map(corner);
        return { depth: c.reduce((sum, p) => sum + p.depth, 0) / 4, draw() {
          stroke([...c, c[0]], theme.muted, 1);
          pen.fillStyle = theme.shade;
          pen.fill();
        } };
      });
  }

  function solidFaces(solid) {
    const corners = solid.corners.map(project);
    return solid.faces.map((face) => face.map((i) => corners[i]))
      .map((c) => ({ depth: c.reduce((sum, p) => sum + p.depth, 0) / 3, draw() {
        stroke([...c, c[0]], theme.muted, 0.5);
        pen.fillStyle = theme.shade;
        pen.fill();
      } }));
  }

  // Walls and, where it has one, its floor and its ceiling; without a bound it ends with the scene.
  function zoneFaces(zone) {
    const bottom = zone.floor === null ? Math.min(ground, low[2]) : zone.floor;
    const top = zone.ceiling === null ? Math.max(high[2], bottom) : zone.ceiling;
    const ring = (height) => zone.x.map((x, i) => [x, zone.y[i], height]);
    const lower = ring(bottom), upper = ring(top);
    const faces = lower.map((p, i) => {
      const k = (i + 1) % lower.length;
      return [p, lower[k], upper[k], upper[i]];
    });
    if (zone.floor !== null) faces.push(lower);
    if (zone.ceiling !== null) faces.push(upper);
    return faces.map((face) => {
      const c = face.map(project);
      return { depth: c.reduce((sum, p) => sum + p.depth, 0) / c.length, draw() {
        stroke([...c, c[0]], theme.limit, 0.8, [4, 3]);
        pen.fillStyle = theme.zone;
        pen.fill();
      } };
    });
  }

  function drawPoints() {
    const free = makeLabelSpace();
    const places = drawing.points.map((p) => project(p.at));
    for (const c of places) {
      pen.setLineDash([]);
      pen.beginPath();
      pen.arc(c.x, c.y, 3.5, 0, 2 * Math.PI);
      pen.fillStyle = theme.panel;
      pen.fill();
      pen.strokeStyle = theme.ink;
      pen.lineWidth = 1.5;
      pen.stroke();
    }
    drawing.points.forEach((p, i) => {
      const { x, y } = places[i], wide = labelWidth(p.label);
      if (p.label && free(x - wide / 2, y, wide)) write(p.label, x, y - 9, theme.ink);
    });
  }

  function drawAxesCorner() {
    const c = Math.cos(view.turn), s = Math.sin(view.turn), st = Math.sin(view.tilt);
    const o = { x: 44, y: 56 };
    if (width < 500) write("grid in m", width - 4, height - 6, theme.muted, "right");
    for (const [name, dx, dy] of [["east", c, s * st], ["north", s, -c * st],
      ["up", 0, -Math.cos(view.tilt)]]) {
      stroke([o, { x: o.x + 26 * dx, y: o.y + 26 * dy }], theme.muted, 1.4);
      if (Math.hypot(dx, dy) > 0.25) write(name, o.x + 38 * dx, o.y + 38 * dy + 4, theme.ink);
    }
  }

  function render() {
    queued = false;
    const ratio = window.devicePixelRatio || 1;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineCap = "round";
    drawGround();
    for (const l of drawing.lines) {  // the shadow at noon, which tells where the path is
      const shadow = [];
      for (let i = 0; i < l.x.length; ++i) {
        if (linePoint(l, i).every(finite)) shadow.push(project([l.x[i], l.y[i], ground]));
      }
      if (shadow.length) stroke(shadow, theme.shade, 3);
    }
    for (const p of drawing.points) {
      stroke([project(p.at), project([p.at[0], p.at[1], ground])], theme.muted, 0.8, [2, 3]);
    }
    const items = collect();
    for (const item of items) item.draw();
    drawPoints();
    drawAxesCorner();
    drawCursor();
    canvas.dataset.samples = drawing.lines.reduce((n, l) => n + l.x.length, 0);
    canvas.dataset.view = [view.turn, view.tilt, view.zoom, view.panX, view.panY]
      .map((v) => v.toFixed(3)).join(" ");
  }

  function drawCursor() {
    const line = drawing.lines.find((l) => l.along && l.along.length);
    if (cursorAt === null || !line) return;
    const p = linePoint(line, nearest(line.along, cursorAt));
    if (!p.every(finite)) return;
    const c = project(p), foot = project([p[0], p[1], ground]);
    stroke([c, foot], theme.accent, 1, [2, 3]);
    pen.beginPath();
    pen.arc(c.x, c.y, 5, 0, 2 * Math.PI);
    pen.fillStyle = theme.accent;
    pen.fill();
    write(`${numberText(p[2], 3)} m up`, c.x + 9, c.y + 4, theme.ink, "left");
  }

  function refresh() {
    if (!queued) requestAnimationFrame(render);
    queued = true;
  }
  function change(what) {
    Object.assign(view, what);
    view.tilt = clamp(view.tilt, -0.2, Math.PI / 2);
    view.zoom = clamp(view.zoom, 0.3, 30);
    refresh();
  }
  listenScene(canvas, () => view, change, home);

  const controls = child(figure, "div", "controls");
  if (drawing.lines.some((l) => l.values)) drawRamp(controls, drawing.value, least, most);
  for (const [name, to] of [["reset", home], ["from above", { ...home, turn: 0,
    tilt: Math.PI / 2 }], ["from the south", { ...home, turn: 0, tilt: 0 }]]) {
    child(controls, "button", "", name).addEventListener("click", () => change({ ...to }));
  }
  child(controls, "span", "hint", "drag to turn, wheel to zoom, shift-drag to move");
  cursors.push({ key: axisKey(drawing.along), source: figure, show(x) {
    cursorAt = x;
    refresh();
  } });

  return function draw() {
    width = Math.max(canvas.parentNode.clientWidth, 220);
    height = clamp(Math.round(width * 0.56), 230, 540);
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    canvas.style.height = `${height}px`;
    readTheme();
    fitHome();
    render();
  };
}

// Pointer, wheel and keys of a scene.
function listenScene(canvas, getView, change, home) {
  let drag = null;
  canvas.addEventListener("pointerdown", (event) => {
    drag = { x: event.clientX, y: event.clientY, move: event.shiftKey || event.button === 2 };
    if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const dx = event.clientX - drag.x, dy = event.clientY - drag.y, view = getView();
    [drag.x, drag.y] = [event.clientX, event.clientY];
    change(drag.move ? { panX: view.panX + dx, panY: view.panY + dy }
      : { turn: view.turn - dx * 0.008, tilt: view.tilt + dy * 0.008 });
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, () => { drag = null; });
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    change({ zoom: getView().zoom * Math.exp(-clamp(event.deltaY, -200, 200) * 0.0015) });
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const view = getView(), shift = event.shiftKey;
    const turn = (d) => (shift ? { panX: view.panX + 200 * d } : { turn: view.turn - d });
    const tilt = (d) => (shift ? { panY: view.panY + 200 * d } : { tilt: view.tilt + d });
    const step = { ArrowLeft: () => turn(-0.1), ArrowRight: () => turn(0.1),
      ArrowUp: () => tilt(-0.1), ArrowDown: () => tilt(0.1),
      "+": () => ({ zoom: view.zoom * 1.15 }), "=": () => ({ zoom: view.zoom * 1.15 }),
      "-": () => ({ zoom: view.zoom / 1.15 }), 0: () => ({ ...home }),
      Home: () => ({ ...home }) }[event.key];
    if (!step) return;
    event.preventDefault();
    change(step());
  });
}
