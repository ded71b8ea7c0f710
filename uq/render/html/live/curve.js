// Curves of the share above each value.

const HIGH = 260;

// Of rows with several weights, each with the name of its line.
function showCurves(figure, column, weighted, more) {
  const scale = new Scale(column), wide = window.innerWidth < 500 ? 360 : 520; // letters of one size
  const x = value => LEFT + Math.min(Math.max(scale.place(value), 0), 1) * (wide - LEFT - EDGE);
  const y = share => HIGH - BOTTOM - share * (HIGH - BOTTOM - EDGE);
  const line = (x1, x2, y1, y2, name) => make("line", {x1, x2, y1, y2, class: name});
  const grid = [0, 0.25, 0.5, 0.75, 1].flatMap(share => [
    line(LEFT, wide - EDGE, y(share), y(share), "grid"),
    make("text", {x: LEFT - 6, y: y(share) + 4, "text-anchor": "end"}, `${100 * share}\u00a0%`),
  ]);
  const labels = scale.ticks.map(value => {
    const text = column.digits(value), most = wide - LETTER * text.length / 2;
    return make("text", {x: Math.min(x(value), most), y: HIGH - 8, "text-anchor": "middle"}, text);
  });
  const thresholds = column.lines.map(value => line(x(value), x(value), y(0), y(1), "threshold"));
  const curves = weighted.map(([weights, name]) =>
    make("path", {d: pathOf(sharesAbove(column, scale, weights), x, y), class: `line ${name}`}));
  const title = `${column.curve}: ${column.title}`, attributes = {viewBox: `0 0 ${wide} ${HIGH}`, role: "img", "aria-label": title};
  figure.replaceChildren(make("p", {class: "axis-title"}, column.curve), // of the vertical axis; below that of the horizontal one
    make("svg", attributes, ...grid, ...labels, ...thresholds, ...curves.reverse()),
    make("figcaption", {}, `${column.title[0].toUpperCase()}${column.title.slice(1)}${more}`));
}

function pathOf({at, share}, x, y) {
  const points = at.map((value, i) => `${x(value).toFixed(1)},${y(share[i]).toFixed(1)}`);
  return points.length ? `M${LEFT},${y(1)}L${points.join("L")}` : "";
}
