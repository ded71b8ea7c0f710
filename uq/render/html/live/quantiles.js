// Quantiles of the chosen rows: as uq/stats/order_statistics.py and uq/assess/life_quantiles.py.

// Median-unbiased (R. J. Hyndman, Y. Fan, Am. Stat. 50, 361 (1996), type 8), of ascending numbers.
function quantileOf(values, probability) {
  const n = values.length, rank = probability * (n + 1);
  if (!(rank >= 1 - ROUNDING && rank <= n * (1 + ROUNDING))) return NaN;
  const place = Math.min(Math.max(n * probability + (probability + 1) / 3 - 1, 0), n - 1), before = Math.floor(place);
  const [low, high] = [values[before], values[Math.min(before + 1, n - 1)]];
  return low === high || place === before ? low : low + (place - before) * (high - low);
}

// The least number of hits that P(X > hits) does not exceed.
function hitsExceeded(share, n, probability) {
  let low = -1, high = n;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (betaBelow(middle + 1, n - middle, probability) <= share) high = middle; else low = middle;
  }
  return high;
}

// From order statistics of independent rows, or from the scatter between their parts (R. S. Woodruff,
// J. Am. Stat. Assoc. 47, 635 (1952)).
function quantileEnds(rows, values, parts, probability) {
  const n = values.length, nth = rank => rank >= 1 && rank <= n ? values[rank - 1] : NaN;
  if (rows.independent) {
    return [nth(n - hitsExceeded(0.025, n, 1 - probability)), nth(hitsExceeded(0.025, n, probability) + 1)];
  }
  const value = quantileOf(values, probability);
  if (!parts || isNaN(value)) return NONE;
  const below = Array.from(values, one => Number(value === Infinity ? one < value : one <= value));
  const {share, estimates} = estimatesOf(below, parts, Boolean(rows.replicate));
  const [low, high] = scattered(probability, rows.replicate ? null : n, estimates, rows.students, rows.samples, share);
  return [low * n >= 1 ? quantileOf(values, low) : NaN, (1 - high) * n >= 1 ? quantileOf(values, high) : NaN];
}

// Quantiles of the chosen rows, valid whenever censored rows end, else by Kaplan and Meier.
function quantilesAmong(rows, column, mask, probabilities) {
  const order = column.order.filter(row => mask[row]), part = rows.replicate ?? rows.sample;
  const isCut = row => column.states[row] === CENSORED;
  const of = some => ({values: some.map(row => column.values[row]), parts: part && some.map(row => part[row])});
  const first = of(order), last = of(order.filter(row => !isCut(row)).concat(order.filter(isCut)));
  if (order.some(isCut)) last.values.fill(Infinity, last.values.length - order.filter(isCut).length);
  return probabilities.map(probability => {
    const value = quantileOf(first.values, probability);
    const [early, late] = [first, last].map(one => quantileEnds(rows, one.values, one.parts, probability));
    const isOpen = early[1] < Infinity && late[1] === Infinity; // as nobody knows when censored rows end
    const found = {value, low: early[0], high: early[1] === Infinity ? Infinity : isOpen ? NaN : late[1]};
    if (isNaN(value)) return {...found, more: first.values.length ? "too few rows" : ""};
    if (!(value < quantileOf(last.values, probability))) return found;
    const guess = lifeBy(rows, column, mask, probability);
    return isNaN(guess.value) ? {...found, value: NaN, more: "beyond the horizon"} : guess;
  });
}
