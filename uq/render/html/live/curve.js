// Curves of the share above each value, as steps.

const HIGH = 260, MOST_STEPS = 400;

// `lines` are {curve, name, half, band}: the share at each place, half the width of its band, or the ends
// of its intervals at some places.
function curvesOf(column, lines, title) {
  const scale = new Scale(column), wide = window.innerWidth < 500 ? 360 : 520; // letters of one size
  const x = value => LEFT + Math.min(Math.max(scale.place(value), 0), 1) * (wide - LEFT - EDGE);
  const y = share => HIGH - BOTTOM - share * (HIGH - BOTTOM - EDGE);
  const parts = [], times = column.thresholds.map(one => one.value);
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    parts.push(draw("line", {x1: LEFT, x2: wide - EDGE, y1: y(share), y2: y(share), class: "grid"}),
      draw("text", {x: LEFT - 6, y: y(share) + 4, "text-anchor": "end"}, percent(share).replace(".0", "")));
  }
  let free = -Infinity;
  for (const value of scale.ticks(wide / 100)) {
    const words = column.digits(value), half = LETTER * words.length / 2, at = Math.min(x(value), wide - half);
    if (at - half < free) continue;
    parts.push(draw("text", {x: at, y: HIGH - 8, "text-anchor": "middle"}, words));
    free = at + half + 8;
  }
  const asked = column.angle ? times.flatMap(time => [-time, time]) : times;
  for (const value of asked.filter(one => scale.has(one))) { // none beyond the axis
    parts.push(draw("line", {x1: x(value), x2: x(value), y1: y(0), y2: y(1), class: "threshold"}));
  }
  for (const {curve, name, half, band} of lines) {
    const steps = thinned(curve), drawn = curve.isSmooth ? smoothPath : path;
    if (band) {
      const every = Math.max(1, Math.ceil(band.at.length / MOST_STEPS));
      const known = band.at.map((_, i) => i).filter(i => i % every === 0 && isFinite(band.low[i]));
      const edge = (places, ends) => places.map(i => `${x(band.at[i]).toFixed(1)},${y(ends[i]).toFixed(1)}`);
      const around = [...edge(known, band.high), ...edge(known.reverse(), band.low)];
      if (around.length) parts.push(draw("path", {d: `M${around.join("L")}Z`, class: `band ${name}`}));
    }
    if (isFinite(half)) {
      const edge = shift => drawn(steps, x, share => y(Math.min(1, Math.max(0, share + shift))));
      const back = edge(-half).slice(1).split("L").reverse().join("L");
      parts.push(draw("path", {d: `${edge(half)}L${back}Z`, class: `band ${name}`}));
    }
    parts.push(draw("path", {d: drawn(steps, x, y), class: `line ${name}`}));
  }
  return draw("svg", {viewBox: `0 0 ${wide} ${HIGH}`, role: "img", "aria-label": title}, ...parts);
}

function thinned({at, share}) {
  const every = Math.max(1, Math.ceil(at.length / MOST_STEPS)), steps = [];
  for (let i = 0; i < at.length; i++) if (i % every === 0 || i === at.length - 1) steps.push([at[i], share[i]]);
  return steps;
}

function path(steps, x, y) {
  const points = [`${LEFT},${y(1).toFixed(1)}`];
  let height = y(1);
  for (const [value, share] of steps) {
    const place = x(value).toFixed(1);
    points.push(`${place},${height.toFixed(1)}`, `${place},${(height = y(share)).toFixed(1)}`);
  }
  points.push(`${x(Infinity).toFixed(1)},${height.toFixed(1)}`);
  return `M${points.join("L")}`;
}

function smoothPath(steps, x, y) {
  const points = steps.map(([value, share]) => `${x(value).toFixed(1)},${y(share).toFixed(1)}`);
  return points.length ? `M${points.join("L")}` : "";
}
