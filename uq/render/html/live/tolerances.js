// Sliders of tolerances: each stop has weights of the rows, and the numbers that Python estimates there.

// The width and the shift of one input: a change of one takes back the other.
class Slider {
  constructor({name, tracks}, element, moved) {
    Object.assign(this, {name, element, tracks, stop: null});
    this.handles = [...element.querySelectorAll("input")];
    this.handles.forEach((handle, i) => handle.addEventListener("input", () => { this.move(i); moved(); }));
    this.reset();
  }

  move(moved) {
    const {stops} = this.tracks[moved], stop = stops[this.handles[moved].value];
    this.stop = stop.options ? stop : null;
    this.handles.forEach((handle, i) => { if (i !== moved) handle.value = this.tracks[i].studied; });
    this.element.querySelector("output").textContent = stop.words;
    for (const handle of this.handles) handle.setAttribute("aria-valuetext", stop.words);
  }

  reset() {
    this.handles[0].value = this.tracks[0].studied;
    this.move(0);
  }
}

// The product of the weights of several stops.
function productOf(rows, stops) {
  const logs = new Float64Array(rows.count);
  for (const {weights: {top, step, bytes}} of stops) {
    numbersOf(bytes, Uint8Array).forEach((byte, row) => {
      logs[row] += byte === rows.tolerances.impossible ? -Infinity : top - step * byte;
    });
  }
  return logs.map(Math.exp);
}

// The number of rows of equal weight that are worth as much (L. Kish, Survey Sampling, 1965).
function worthOf(weights) {
  const sum = weights.reduce((before, weight) => before + weight, 0);
  return sum ** 2 / weights.reduce((before, weight) => before + weight ** 2, 0) || 0;
}

class Tolerances {
  constructor(rows, element) {
    Object.assign(this, {rows, element, ...rows.tolerances, column: rows.columns[rows.first[1]]});
    const show = eventually(() => this.update()), parts = [...element.querySelectorAll(".tolerance")];
    this.sliders = rows.tolerances.sliders.map((plain, i) => new Slider(plain, parts[i], show));
    this.events = rows.events.filter(event => event.output);
    const choose = event => { this.column = rows.columns[event.target.value]; this.update(); };
    element.querySelector("select").addEventListener("change", choose);
    this.button = element.querySelector(".as-studied");
    this.button.addEventListener("click", () => { this.sliders.forEach(slider => slider.reset()); this.update(); });
    this.command = make("code");
    const [copy, done] = copyButton(() => this.command.textContent);
    element.querySelector(".command").append(this.command, " ", copy, " ", done);
  }

  update() {
    const changed = this.sliders.filter(slider => slider.stop), stops = changed.map(slider => slider.stop);
    const weights = stops.length && stops.every(stop => stop.weights) ? productOf(this.rows, stops) : null;
    const why = this.whyNot(changed, stops, weights), part = name => this.element.querySelector(name);
    this.button.disabled = !stops.length;
    this.command.textContent = ["uq what-if", this.rows.file, ...stops.map(stop => stop.options)].join(" ");
    part(".command").hidden = !stops.length;
    part(".status").textContent = why || this.quality(stops, weights);
    this.fillTable(stops, why ? null : weights);
    const bounds = stops.length > 1 ? [] : (stops[0] ?? this.studied).promised?.[this.column.name] ?? [];
    part(".promised").textContent = bounds.join(" ");
    const curves = weights && !why ? [[weights, "chosen"], [this.rows.all, "all"]] : [[this.rows.all, "all"]];
    showCurves(part("figure"), this.column, curves, curves.length > 1 ? ": these laws (bold) and as studied (thin)" : "");
  }

  // Why these changes have no numbers, or "".
  whyNot(changed, stops, weights) {
    if (stops.length < 2) return "";
    if (changed.filter(slider => this.correlated.includes(slider.name)).length > 1) {
      return "These inputs depend on each other: the command weights the rows for both at once.";
    }
    if (weights && this.worth(weights) >= this.fewest) return "";
    return "Too few rows support all these changes together; the command states how many are required.";
  }

  worth(weights) { return worthOf(weights) * this.parts / this.rows.count; }

  quality(stops, weights) {
    if (stops.length < 2) return (stops[0] ?? this.studied).quality;
    return `These weights are worth ${number(this.worth(weights), 3)} of ${grouped(this.parts)} ${this.partsName}.`;
  }

  // One change has the estimates of Python, several are counted by weight.
  fillTable(stops, weights) {
    const isCounted = stops.length > 1, table = this.element.querySelector(".counted");
    const lines = this.events.map(event => {
      const cells = isCounted ? [weights, this.rows.all].map(each => countedCell(event, each))
        : [...stops, this.studied].map(({events}) => estimatedCell(events?.[event.key]));
      return make("tr", {"data-key": event.key}, make("th", {scope: "row"}, event.words), ...cells);
    });
    const heads = ["", ...(stops.length ? ["these laws"] : []), "as studied"];
    fill(table, heads.map(head => head && isCounted ? `${head}, counted` : head), lines);
    table.hidden = !lines.length;
  }
}

function estimatedCell({value = null, low, high, text = "\u2013", ends = "", more = ""} = {}) {
  const small = [ends, more].filter(Boolean).join("; ");
  return cell(value ?? NaN, text, small, {"data-low": low ?? NaN, "data-high": high ?? NaN});
}
