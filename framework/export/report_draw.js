// What all drawings of a report share: elements, numbers, ticks, the common cursor, the readout.

const svgSpace = "http://www.w3.org/2000/svg";

function svgChild(parent, name, attributes, text) {
  const node = document.createElementNS(svgSpace, name);
  for (const key in attributes) node.setAttribute(key, attributes[key]);
  if (text !== undefined) node.textContent = text;
  parent.appendChild(node);
  return node;
}

function child(parent, name, className, text) {
  const node = document.createElement(name);
  if (className) node.className = className;
  if (text !== undefined) node.textContent = text;
  parent.appendChild(node);
  return node;
}

const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
const finite = (v) => v !== null && Number.isFinite(v);
const color = (index) => `var(--s${index % 8})`;

// As number_text of the page's tables: a true minus sign, a dash for a gap.
function numberText(v, digits = 4) {
  if (!finite(v)) return "\u2013";
  if (v === 0) return "0";
  const size = Math.abs(v);
  const text = size >= 1e6 || size < 1e-4
    ? v.toExponential(digits - 1).replace(/\.?0+e/, "e").replace("+", "")
    : size >= 10 ** digits ? v.toFixed(0) : String(Number(v.toPrecision(digits)));
  return text.replace(/-/g, "\u2212");
}

const withUnit = (text, unit) => (unit ? `${text} ${unit}` : text);
const axisTitle = (axis) => (axis.unit ? `${axis.label} [${axis.unit}]` : axis.label);

// Round numbers (1, 2, 5 times a power of ten) within [low, high], about `count` of them.
function roundTicks(low, high, count, whole) {
  const rough = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  let step = power * [1, 2, 5, 10].find((f) => f * power >= rough * 0.999);
  if (whole) step = Math.max(Math.round(step), 1);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + step * 1e-9; ++i) {
    const value = i * step;
    const text = Math.abs(value) >= 1e6 || decimals > 4
      ? numberText(value, 3) : value.toFixed(decimals).replace("-", "\u2212");
    ticks.push({ value, text: i === 0 ? "0" : text });
  }
  return { ticks, step };
}

function powerTicks(low, high, count) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  const stride = Math.max(1, Math.ceil((last - first + 1) / count));
  const digits = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";
  const ticks = [];
  for (let e = first; e <= last; e += stride) {
    const raised = [...String(Math.abs(e))].map((d) => digits[d]).join("");
    ticks.push({ value: 10 ** e, text: e === 0 ? "1" : e === 1 ? "10"
      : `10${e < 0 ? "\u207b" : ""}${raised}` });
  }
  return ticks;
}

// Index of the entry of ascending `xs` that is nearest to x.
function nearest(xs, x) {
  let low = 0, high = xs.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= x) low = middle; else high = middle;
  }
  return xs.length > 1 && Math.abs(xs[high] - x) < Math.abs(xs[low] - x) ? high : low;
}

// Drawings that count along the same axis share a cursor: hover over one, read all.
const cursors = [];
const axisKey = (axis) => `${axis.label}|${axis.unit}`;
function moveCursor(axis, x, source) {
  for (const c of cursors) if (c.key === axisKey(axis)) c.show(x, c.source === source);
}

// The readout box of a plot, beside (x, y) and never outside the plot.
function makeTip(plot) {
  const tip = child(plot, "div", "tip");
  tip.setAttribute("role", "status");
  tip.hidden = true;
  return {
    hide() { tip.hidden = true; },
    show(x, y, title, rows) {
      tip.textContent = "";
      child(tip, "b", "", title);
      for (const [name, value] of rows) child(tip, "div", "", `${name} ${value}`);
      tip.hidden = false;
      const left = x + 14 + tip.offsetWidth > plot.clientWidth ? x - 14 - tip.offsetWidth : x + 14;
      tip.style.left = `${Math.max(0, left)}px`;
      tip.style.top = `${clamp(y - tip.offsetHeight / 2, 0,
        Math.max(0, plot.clientHeight - tip.offsetHeight))}px`;
    },
  };
}

// Grid, tick labels and axis titles of a plot over [left, right] x [top, bottom] pixels.
function drawAxes(svg, area, xTicks, yTicks, sx, sy, xTitle, yTitle) {
  for (const t of yTicks) {
    const y = sy(t.value);
    svgChild(svg, "line", { class: "gridline", x1: area.left, x2: area.right, y1: y, y2: y });
    svgChild(svg, "text", { x: area.left - 7, y: y + 4, "text-anchor": "end" }, t.text);
  }
  for (const t of xTicks) {
    const x = sx(t.value);
    svgChild(svg, "line", { class: "gridline", x1: x, x2: x, y1: area.top, y2: area.bottom });
    svgChild(svg, "text", { x, y: area.bottom + 16, "text-anchor": "middle" }, t.text);
  }
  svgChild(svg, "path", { class: "frame", d: `M${area.left} ${area.top}V${area.bottom}` +
    `H${area.right}` });
  svgChild(svg, "text", { x: area.right, y: area.bottom + 32, "text-anchor": "end" }, xTitle);
  svgChild(svg, "text", { x: 0, y: 11 }, yTitle);
}

function drawLegend(figure, entries) {
  const legend = child(figure, "div", "legend");
  entries.forEach((e, i) => {
    const entry = child(legend, "span", "");
    child(entry, "i", "").style.cssText = `border-color:${color(i)};` +
      (i >= 8 ? "border-top-style:dashed" : "");
    entry.append(e.name);
  });
}

// What the colours of lines with values stand for.
function drawRamp(parent, value, least, most) {
  const ramp = child(parent, "span", "ramp");
  const rounding = 1e-9 * Math.abs(most);  // a vehicle at rest has a speed of 1e-13 m/s
  ramp.append(`${value.label} ${numberText(Math.abs(least) < rounding ? 0 : least, 3)}`);
  child(ramp, "i", "");
  ramp.append(withUnit(numberText(most, 3), value.unit));
}

// Where labels already are, so that a new one is left out rather than written over them.
function makeLabelSpace() {
  const taken = [];
  return (x, y, width) => {
    const free = taken.every((b) => Math.abs(b.y - y) > 12 || x > b.x + b.width + 3
      || b.x > x + width + 3);
    if (free) taken.push({ x, y, width });
    return free;
  };
}
const labelWidth = (text) => 6.6 * text.length;
