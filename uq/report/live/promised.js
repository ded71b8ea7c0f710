// What could be promised under other laws: the end of the interval of a quantile, beside the same as studied.

// Return an element and what fills it, in steps.
function promisedOf(rows) {
  const studied = new Reweighting(rows), known = new Map();
  const element = make("p", {class: "promised", role: "status"});
  const said = (column, one, bound) => data(bound, column.words(outwards(column, bound, one.upper), 3));

  function* boundOf(column, one, reweighting) {
    const found = yield* new WeightedQuantile(reweighting, column).of(one.probability);
    return one.upper ? found.high : found.low;
  }

  function* fill(column, reweighting, isChanged) {
    element.replaceChildren();
    const sentences = [];
    for (const one of column.promised) {
      if (sentences.length) sentences.push(" ");
      if (!isChanged) {
        sentences.push(`${one.opening} `, said(column, one, one.bound), ".");
        continue;
      }
      if (!known.has(one)) known.set(one, yield* boundOf(column, one, studied));
      const bound = yield* boundOf(column, one, reweighting), before = known.get(one);
      sentences.push(...(isFinite(bound)
        ? [`${one.then} `, said(column, one, bound), "; as studied, by the same estimate, ", said(column, one, before), "."]
        : ["What could then be promised is not known: too few rows carry it."]));
    }
    element.replaceChildren(...sentences);
  }

  return {element, fill};
}

// A bound that its digits do not make larger than it is.
function outwards(column, bound, isUpper) {
  const shown = bound / column.per, step = 10 ** (Math.floor(Math.log10(Math.abs(shown))) - 2 - column.common);
  if (!isFinite(step) || !step) return bound;
  const steps = shown / step, whole = Math.round(steps);
  const towards = Math.abs(steps - whole) < 1e-9 ? whole : isUpper ? Math.ceil(steps) : Math.floor(steps);
  return towards * step * column.per;
}
