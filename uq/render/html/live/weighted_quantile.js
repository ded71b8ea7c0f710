// Quantiles of weighted rows, or of lives with laws, with intervals: as uq/assess/population.py.

const GROWING_STEPS = 60, NARROW = 1e-11;

class WeightedQuantile {
  constructor(reweighting, column) {
    const weights = reweighting.weights(column);
    Object.assign(this, {column, law: reweighting.lawOf(column), weights: weights?.weights ?? null});
    this.weighed = new Weighed(reweighting.rows, this.weights, row => column.states[row] < UNDEFINED);
    this.refusal = weights?.refusal || this.weighed.refusal;
    this.never = column.states.includes(NEVER) ? Infinity : NaN;
  }

  // Yield between its steps, and return the quantile with its interval.
  *of(probability) {
    if (this.refusal || !this.weighed.places.length) return {value: NaN, low: NaN, high: NaN};
    return yield* this.law ? this.alongTime(probability) : this.alongValues(probability);
  }

  // The probability of each row to lie below a value.
  below(value) {
    const {column: {values, states}, law, column} = this;
    return law ? law.below(column, value) : values.map((one, row) => Number(one < value && states[row] !== CENSORED));
  }

  // A function that is as cautious at all values as it must be at this one.
  near(value) {
    const hits = this.weighed.hits(this.weighed.of(this.below(value)));
    return at => this.weighed.share(this.below(at), hits);
  }

  *alongTime(probability) {
    const {column: {values}, weighed, never} = this;
    const logs = Array.from(weighed.places, row => Math.log(values[row])).filter(isFinite).sort((a, b) => a - b);
    if (!logs.length) return {value: Infinity, low: NaN, high: NaN};
    const middle = logs.length >> 1, mean = total(logs) / logs.length;
    const start = logs.length % 2 ? logs[middle] : Math.log((Math.exp(logs[middle - 1]) + Math.exp(logs[middle])) / 2);
    const unit = Math.max(Math.sqrt(total(logs.map(one => (one - mean) ** 2)) / logs.length), 0.01);
    const short = at => weighed.mean(this.below(Math.exp(at))) - probability, side = short(start) < 0 ? 1 : -1;
    const there = firstStep(start, side * unit, at => (short(at) >= 0) === (side > 0));
    const value = there ? Math.exp(yield* rootIn(short, there)) : side > 0 ? Infinity : 0;
    const share = this.near(Math.min(Math.max(value, 1e-300), 1e300));
    if (isNaN(share(value).low)) return {value, low: NaN, high: NaN};
    const isInside = value > 0 && value < Infinity;
    const end = function* (name) {
      const excess = x => {
        const found = share(Math.exp(x));
        return (found.more === "exact" ? found.share : found[name]) - probability;
      };
      const from = isInside ? Math.log(value) : start, isShort = excess(from) < 0, step = isInside ? unit / 30 : unit;
      const between = firstStep(from, isShort ? step : -step, x => (excess(x) >= 0) === isShort);
      if (!between) return isShort ? never : NaN;
      return Math.exp(yield* rootIn(excess, between));
    };
    const low = value === 0 ? 0 : Math.min(yield* end("high"), value);
    return {value, low, high: value === Infinity ? Infinity : Math.max(yield* end("low"), value)};
  }

  *alongValues(probability) {
    const {column: {values, states}, weighed, weights, never} = this;
    const known = weighed.places.filter(row => states[row] === ENDED && (!weights || weights[row] > 0));
    const places = [...new Set(known.map(row => values[row]))].sort((a, b) => a - b);
    if (!places.length) return {value: never, low: NaN, high: NaN};
    const after = place => places[place + 1] ?? Infinity;
    const least = function* (share, name) {
      let low = 0, high = places.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (share(after(middle))[name] >= probability - ROUNDING) high = middle; else low = middle + 1;
        yield;
      }
      return low;
    };
    const valueAt = place => place < places.length ? places[place] : never;
    const place = yield* least(at => ({share: weighed.mean(this.below(at))}), "share"), value = valueAt(place);
    if (weighed.places.some(row => states[row] === CENSORED && values[row] <= value)) return {value: NaN, low: NaN, high: NaN};
    const share = this.near(place < places.length ? after(place) : Infinity);
    return {value, low: valueAt(yield* least(share, "high")), high: valueAt(yield* least(share, "low"))};
  }
}

// The ends of the first growing step in which something is reached.
function firstStep(start, step, reached) {
  let before = start;
  for (let i = 0; i < GROWING_STEPS; i++) {
    const at = before + step;
    if (!(at > -700 && at < 700)) return null;
    if (reached(at)) return [before, at];
    [before, step] = [at, 1.3 * step];
  }
  return null;
}

// Where a function changes its sign: by secants, every third time by the middle.
function* rootIn(work, [first, last]) {
  let ends = [[first, work(first)], [last, work(last)]];
  for (let i = 0; i < 200 && Math.abs(ends[1][0] - ends[0][0]) > NARROW; i++) {
    const [[a, fa], [b, fb]] = ends, secant = a - fa * (b - a) / (fb - fa);
    const at = i % 3 < 2 && isFinite(secant) ? secant : (a + b) / 2, found = work(at);
    yield;
    if (found === 0) return at;
    ends = (found < 0) === (fa < 0) ? [[at, found], [b, fb]] : [[a, fa], [at, found]];
  }
  return ends[1][0];
}
