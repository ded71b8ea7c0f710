// What could be promised under other laws: the end of the interval of a quantile, beside the same as studied.

// Return an element and what fills it, in steps.
function promisedOf(rows) {
  const studied = new Reweighting(rows), known = new Map();
  const element = make("p", {class: "promised", role: "status"});
  const said = (column, one, bound) => data(bound, column.words(outwards(column, bound, one.upper), 3));

  function* fill(column, reweighting, isChanged) {
    element.replaceChildren();
    const sentences = [];
    for (const one of column.promised) {
      if (sentences.length) sentences.push(" ");
      if (!isChanged) {
        sentences.push(`${one.opening} `, said(column, one, one.bound), ".");
        continue;
      }
      if (!known.has(one)) known.set(one, yield* endOf(studied, column, one));
      const bound = yield* endOf(reweighting, column, one), before = known.get(one);
      const why = column.states.includes(FAILED) ? "too many rows failed, or" : "";
      sentences.push(...(isFinite(bound) && !(column.life && bound <= 0)
        ? [`${one.then} `, said(column, one, bound), "; as studied, ", said(column, one, before), "."]
        : [["What could then be promised is not known:", why, "too few rows carry it."].filter(Boolean).join(" ")]));
    }
    element.replaceChildren(...sentences);
  }

  return {element, fill};
}

// The end of the interval, with failed rows beyond it, as they are beyond the bound of now.
function* endOf(reweighting, column, {probability, upper}) {
  const end = function* (some) {
    const found = yield* new WeightedQuantile(reweighting, some).of(probability);
    return upper ? found.high : found.low;
  };
  const plain = yield* end(column);
  if (!column.states.includes(FAILED)) return plain;
  const worst = yield* end(column.withFailedAt(upper ? Infinity : column.life ? 0 : -Infinity));
  return upper ? Math.max(plain, worst) : Math.min(plain, worst);
}

// A bound that its digits do not make larger than it is.
function outwards(column, bound, isUpper) {
  const shown = bound / column.per, step = 10 ** (Math.floor(Math.log10(Math.abs(shown))) - 2 - column.common);
  if (!isFinite(step) || !step) return bound;
  const steps = shown / step, whole = Math.round(steps);
  const towards = Math.abs(steps - whole) < 1e-9 ? whole : isUpper ? Math.ceil(steps) : Math.floor(steps);
  return towards * step * column.per;
}
