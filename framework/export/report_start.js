// Draws every figure of the page from its data, and again when its width or its colours change.

performance.mark("draw-begin");
const data = JSON.parse(document.getElementById("report-data").textContent);

function resolve(node) {
  for (const s of node.series || []) {
    for (const key of ["x", "y", "spread"]) {
      if (s[key] !== undefined) s[key] = data.arrays[s[key]];
    }
  }
  for (const l of (node.drawing || {}).lines || []) {
    for (const key of ["x", "y", "z", "along", "values"]) {
      if (l[key] !== undefined) l[key] = data.arrays[l[key]];
    }
  }
  return node;
}

const makers = { chart: makeChart, path: makePath, scene: makeScene };
const drawn = new Map();
for (const figure of document.querySelectorAll("figure[data-block]")) {
  const block = resolve(data.blocks[figure.dataset.block]);
  const draw = makers[block.type](figure, block);
  draw();
  drawn.set(figure, { draw, width: figure.clientWidth });
}
performance.mark("draw-end");

const sizes = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    const entry = drawn.get(target);
    if (Math.abs(target.clientWidth - entry.width) < 1) continue;
    entry.width = target.clientWidth;
    entry.draw();
  }
});
for (const figure of drawn.keys()) sizes.observe(figure);
const redraw = () => { for (const { draw } of drawn.values()) draw(); };
for (const query of ["(prefers-color-scheme: dark)", "print"]) {
  matchMedia(query).addEventListener("change", redraw);
}
document.documentElement.dataset.ready = "true";
