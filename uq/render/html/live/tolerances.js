// Sliders of tolerances, and what the rows say of other laws.

function tolerancesOf(rows) {
  const reweighting = new Reweighting(rows), {without, refused} = rows.tolerances;
  const outputs = rows.columns.filter(one => one.role === "output" && !(one.name in refused));
  const events = outputs.flatMap(column => column.thresholds.map(({value, words}) => ({
    key: `${column.name}/${value}`, words, column, value, hits: column.hits(value),
  })));
  let shown = outputs.find(one => one === rows.columns[rows.first[1]]) ?? outputs[0];
  const before = events.map(event => reweighting.probability(event)), curves = new Map();
  const said = make("p", {class: "said", role: "status"}), table = make("table", {class: "found"});
  const promised = promisedOf(rows), picture = make("figure"), done = make("span", {role: "status"}), command = make("code", {});
  const copy = make("button", {type: "button", "on:click": () => copied(command.textContent, done)}, "Copy");
  const reset = make("button", {type: "button", "on:click": () => sliders.forEach(one => one.reset())}, "As studied");
  const show = eventually(update), later = laterOf();
  const sliders = reweighting.names.map(name => slidersOf(name, reweighting, show));

  const chooser = make("label", {}, "Output: ", make("select", {
    "on:change": event => { shown = outputs[event.target.value]; update(); },
  }, ...outputs.map((one, i) => make("option", {value: i, selected: one === shown}, one.title))));

  function update() {
    const changed = reweighting.changed.length > 0, problem = reweighting.problem;
    say(changed, problem);
    reset.disabled = !changed;
    command.textContent = reweighting.command;
    command.parentElement.hidden = !changed || Boolean(problem);
    const found = problem ? [] : events.map(event => reweighting.probability(event));
    const heads = ["", ...(changed ? ["these laws"] : []), "as studied"].map(text => make("th", {scope: "col"}, text));
    table.replaceChildren(make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...events.map((event, i) =>
      make("tr", {"data-key": event.key}, make("th", {scope: "row"}, event.words),
        ...(changed ? [cellOf(found[i] ?? {share: NaN})] : []), cellOf(before[i])))));
    table.hidden = !events.length;
    if (!curves.has(shown)) curves.set(shown, asStudied().curve);
    const now = changed && !problem ? new WeightedCurve(reweighting, shown) : null, curve = now?.curve;
    drawCurves(curve);
    promised.element.replaceChildren();
    later(afterwards(now, curve, changed && !problem));
  }

  function say(changed, problem) {
    const all = problem ? [] : [...new Set(outputs.map(column => reweighting.weights(column)).filter(Boolean))];
    const used = all.filter(one => !one.refusal), why = [...new Set(all.map(one => one.refusal).filter(Boolean))];
    const least = used.reduce((a, b) => b.effective < a.effective ? b : a, used[0]);
    const most = used.reduce((a, b) => b.k > a ? b.k : a, -Infinity);
    said.replaceChildren(...(problem ? [problem] : !changed ? ["The laws of the study."] : !least ? [capitalized(`${why.join("; ")}.`)]
      : ["These weights are worth ", data(least.effective, number(least.effective, 3)), ` of ${grouped(least.rows)} ${rows.parts}${rows.count < rows.total ? " in this page" : ""}`,
        isFinite(most) ? ` (Pareto k = ${number(most, 2)}).` : ".",
        why.length ? ` Where a number is missing, ${why.join("; ")}.` : ""]));
  }

  function asStudied() {
    return new WeightedCurve(new Reweighting(rows), shown);
  }

  function drawCurves(curve, band) {
    const before = {curve: curves.get(shown), name: "all"}, lines = [before];
    if (curve) lines.push({curve, name: "chosen", band});
    else before.band = band;
    const title = `${shown.curveName}: ${shown.title}`;
    const intervals = band ? ", pointwise 95 % intervals" : "";
    picture.replaceChildren(curvesOf(shown, lines, title), make("figcaption", {},
      curve ? `${title}: these laws (bold${intervals}) and as studied (thin).` : `${title}${intervals}.`));
  }

  function* afterwards(now, curve, isChanged) {
    yield* promised.fill(shown, reweighting, isChanged);
    yield* withBand(now, curve);
  }

  // All rows take some time: for intervals, and for what was only sketched.
  function* withBand(now, curve) {
    let band;
    if (!now || curves.get(shown).isSketch) {
      for (band of asStudied().band()) yield;
      if (curves.get(shown).isSketch) curves.set(shown, trusted(null, band));
      if (!now && band?.low.some(isFinite)) drawCurves(null, band);
    }
    if (!curve) return;
    for (band of now.band()) yield;
    if (band) drawCurves(now.weights ? trusted(curve, band) : curve.isSketch ? trusted(null, band) : curve, band);
  }

  const notes = [...without, ...Object.entries(refused)].map(([name, why]) => `${name}: ${why}.`);
  const element = make("div", {class: "explorer"},
    make("div", {}, ...sliders.map(one => one.element), reset,
      ...(notes.length ? [make("p", {class: "note"}, `Not here: ${notes.join(" ")}`)] : [])),
    make("div", {}, chooser, said, make("div", {class: "wide"}, table), promised.element, picture,
      make("p", {class: "command"}, command, " ", copy, " ", done)));
  return {element, update};
}
