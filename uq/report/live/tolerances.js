// Sliders of tolerances, and what the rows say of other laws.

function tolerancesOf(rows) {
  const reweighting = new Reweighting(rows), {inputs, without} = rows.tolerances;
  const outputs = rows.columns.filter(one => one.role === "output" && !(one.name in rows.tolerances.refused));
  const events = outputs.flatMap(column => column.thresholds.map(({value, words}) => ({
    key: `${column.name}/${value}`, words, column, value, hits: column.hits(value),
  })));
  let shown = outputs.find(one => one === rows.columns[rows.first[1]]) ?? outputs[0];
  const before = events.map(event => reweighting.probability(event)), curves = new Map();
  const said = make("p", {class: "said", role: "status"}), table = make("table", {class: "found"});
  const picture = make("figure"), done = make("span", {role: "status"}), command = make("code", {});
  const copy = make("button", {type: "button", "on:click": () => copied(command.textContent, done)}, "Copy");
  const reset = make("button", {type: "button", "on:click": () => sliders.forEach(one => one.reset())}, "As studied");
  const show = eventually(update);
  const sliders = inputs.map(input => toleranceOf(input, reweighting, show));

  const chooser = make("label", {}, "Output: ", make("select", {
    "on:change": event => { shown = outputs[event.target.value]; update(); },
  }, ...outputs.map((one, i) => make("option", {value: i, selected: one === shown}, one.title))));

  function update() {
    const changed = reweighting.changed.length > 0, problem = reweighting.problem;
    const used = [...new Set(outputs.map(column => reweighting.weights(column)))].filter(one => one && !one.refusal);
    const least = used.reduce((a, b) => b.effective < a.effective ? b : a, used[0]);
    const most = used.reduce((a, b) => b.k > a ? b.k : a, -Infinity);
    said.replaceChildren(...(problem ? [problem] : !changed ? ["The laws of the study."] : !least
      ? [reweighting.weights(shown).refusal]
      : ["These weights are worth ", data(least.effective, number(least.effective, 3)), ` of ${rows.count} rows`,
        isFinite(most) ? ` (Pareto k = ${number(most, 2)}).` : "."]));
    reset.disabled = !changed;
    command.textContent = reweighting.command;
    command.parentElement.hidden = !changed || Boolean(problem);
    const found = problem ? [] : events.map(event => reweighting.probability(event));
    const heads = ["", ...(changed ? ["these laws"] : []), "as studied"].map(text => make("th", {scope: "col"}, text));
    table.replaceChildren(make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...events.map((event, i) =>
      make("tr", {"data-key": event.key}, make("th", {scope: "row"}, event.words),
        ...(changed ? [cellOf(found[i] ?? {share: NaN})] : []), cellOf(before[i])))));
    if (!curves.has(shown)) curves.set(shown, new Reweighting(rows).curve(shown));
    const now = changed && !problem ? reweighting.curve(shown) : null;
    const lines = [{curve: curves.get(shown), name: "all", half: NaN}];
    if (now) lines.push({curve: now, name: "chosen", half: NaN});
    const title = `${shown.life ? "Share that outlives each time" : "Share above each value"}: ${shown.title}`;
    picture.replaceChildren(curvesOf(shown, lines, title),
      make("figcaption", {}, now ? `${title}: these laws (bold) and as studied (thin).` : `${title}.`));
  }

  const notes = [...without, ...Object.entries(rows.tolerances.refused)].map(([name, why]) => `${name}: ${why}.`);
  const element = make("div", {class: "explorer"},
    make("div", {}, ...sliders.map(one => one.element), reset,
      ...(notes.length ? [make("p", {class: "note"}, `Not here: ${notes.join(" ")}`)] : [])),
    make("div", {}, chooser, said, make("div", {class: "wide"}, table), picture,
      make("p", {class: "command"}, command, " ", copy, " ", done)));
  return {element, update};
}

// The two sliders of one input.
function toleranceOf(input, reweighting, moved) {
  const column = reweighting.columns.get(input.name), {bounded} = LAWS[input.distribution];
  const words = make("output", {class: "range-words"});
  const slider = (name, min, max, step, value) => make("input", {
    type: "range", min, max, step, value, "aria-label": `${column.label}, ${name}`, "on:input": move,
  });
  const factor = slider("width", 0.2, bounded ? 1 : 1.5, 0.05, 1), shift = slider("shift", -1.5, 1.5, 0.1, 0);

  function move() {
    reweighting.move(input.name, Number(factor.value), Number(shift.value));
    show();
    moved();
  }

  function show() {
    const {args} = reweighting.laws.get(input.name);
    const pairs = Object.entries(args).map(([key, value]) =>
      `${key} ${["cv", "sigma"].includes(key) ? number(value) : column.words(value)}`);
    shift.disabled = Boolean(bounded) && Number(factor.value) === 1; // there is no room
    words.textContent = pairs.join(", ");
    factor.setAttribute("aria-valuetext", `${percent(Number(factor.value))} of the width; ${words.textContent}`);
    shift.setAttribute("aria-valuetext", `${number(Number(shift.value))} standard deviations; ${words.textContent}`);
  }

  show();
  const element = make("div", {class: "tolerance", role: "group", "aria-label": column.label, "data-name": input.name},
    make("span", {}, column.label), words,
    make("label", {}, "width", factor), make("label", {}, "shift", shift));
  return {element, reset() { factor.value = 1; shift.value = 0; move(); }};
}
