// The share of weighted rows above each value, or of lives with laws outliving each time.

const BINS = 500, PLACES = 200, SKETCHED = 1000;

class WeightedCurve {
  constructor(reweighting, column) {
    Object.assign(this, {reweighting, column, rows: reweighting.rows});
    this.law = reweighting.lawOf(column);
    const found = reweighting.weights(column);
    this.refusal = found?.refusal ?? "";
    this.weights = found?.weights ?? null;
  }

  // Quick enough to follow a slider.
  get curve() {
    if (this.refusal) return null;
    if (!this.law) return this.steps();
    return this.law.term ? this.smooth() : this.sketch();
  }

  steps() {
    const {column, weights} = this, of = row => weights ? weights[row] : 1, at = [], share = [];
    const order = column.order, sum = order.reduce((before, row) => before + of(row), 0);
    let above = sum;
    for (const row of order) {
      if (column.states[row] !== ENDED) break; // beyond the first censored row the share is not known
      above -= of(row);
      if (at.at(-1) === column.values[row]) share.pop();
      else at.push(column.values[row]);
      share.push(Math.max(0, above / sum));
    }
    return {at, share};
  }

  // For a picture, lives without what is integrated are counted in narrow bins.
  smooth() {
    const {column, law, weights} = this, bare = law.bare(column), scale = new Scale(column);
    let low = Infinity, high = -Infinity, sum = 0, atOnce = 0;
    for (const one of bare) {
      if (!isFinite(one)) continue;
      low = Math.min(low, one);
      high = Math.max(high, one);
    }
    if (low > high) return {at: [], share: []};
    const width = (high - low) / BINS || 1, bins = new Float64Array(BINS + 1);
    bare.forEach((one, row) => {
      if (isNaN(one)) return;
      const weight = weights ? weights[row] : 1;
      sum += weight;
      if (one === -Infinity) atOnce += weight;
      else if (isFinite(one)) bins[Math.round((one - low) / width)] += weight;
    });
    // Times between which the logarithm of lives grows by whole bins.
    const last = Math.log(scale.high), from = Math.max(Math.log(scale.low), last - 50) - low, to = last - low;
    const every = Math.max(1, Math.round((to - from) / width / PLACES)), at = [], share = [];
    const length = Math.ceil((to - from) / width) + BINS + 2;
    const shares = Float64Array.from({length}, (_, i) => law.term.below(from + (i - BINS) * width));
    for (let place = 0; from + place * width <= to; place += every) {
      let ended = atOnce;
      for (let bin = 0; bin <= BINS; bin++) ended += bins[bin] * shares[BINS + place - bin];
      at.push(Math.exp(low + from + place * width));
      share.push(1 - ended / sum);
    }
    return {isSmooth: true, at, share};
  }

  // A first sketch, from some of the rows.
  sketch() {
    const at = this.places(), {column: {values}, weights, law} = this, every = Math.ceil(values.length / SKETCHED);
    const rows = [...values.keys()].filter(row => row % every === 0 && !isNaN(values[row]));
    const worth = rows.map(row => weights ? weights[row] : 1), sum = total(worth);
    return {isSmooth: true, isSketch: true, at, share: at.map(time =>
      1 - total(rows.map((row, i) => worth[i] * law.belowIn(row, values[row], time))) / sum)};
  }

  // Where intervals are computed.
  places() {
    const scale = new Scale(this.column);
    return Array.from({length: MOST_ENDS + 1}, (_, i) => scale.value(i / MOST_ENDS));
  }

  // Yield the ends of the intervals of the share above each of some values, as Python has them on the same rows.
  *band() {
    if (this.refusal) return;
    const {rows, column, law, weights} = this, takesPart = row => column.states[row] < UNDEFINED;
    if (!law && !weights) return yield* bandOfShares(rows, column, this.steps(), new Uint8Array(rows.count).fill(1));
    const weighed = new Weighed(rows, weights, takesPart);
    if (!law) return yield* heldBand(column, this.steps(), at => weighed.share(aboveOf(column, at)));
    const found = {at: this.places(), share: [], low: [], high: []};
    for (const at of found.at) {
      const {share, low, high} = weighed.share(law.below(column, at).map(one => 1 - one));
      found.share.push(share);
      found.low.push(low);
      found.high.push(high);
      yield found;
    }
  }
}

// A curve where its shares can be trusted, from the ends of their intervals.
function trusted(curve, {at, share, low}) {
  const known = at.filter((_, i) => isFinite(low[i]));
  if (share) return {isSmooth: true, at: known, share: share.filter((_, i) => isFinite(low[i]))};
  const inside = curve.at.map((_, i) => i).filter(i => curve.at[i] >= known[0] && curve.at[i] <= known.at(-1));
  const corners = inside.flatMap((i, nth) => nth ? [[i, i - 1], [i, i]] : [[i, i]]);
  return {isSmooth: true, at: corners.map(([i]) => curve.at[i]), share: corners.map(([, i]) => curve.share[i])};
}
