// Weighted means of numbers between 0 and 1, with intervals: as uq/stats/weighted_means.py.

// Rows that take part in a mean, with weights or null.
class Weighed {
  constructor(rows, weights, takesPart) {
    this.places = Array.from({length: rows.count}, (_, row) => row).filter(takesPart);
    const of = values => values ? values.constructor.from(this.places, row => values[row]) : null;
    this.rows = rows;
    this.weights = of(weights);
    this.worth = this.weights ?? new Float64Array(this.places.length).fill(1);
    this.sum = total(this.worth);
    this.sample = of(rows.sample);
    this.part = of(rows.replicate) ?? this.sample;
    this.ofSamples = perSample(this.worth, this.sample);
    this.refusal = this.weights ? refusal(tailShape(this.ofSamples), this.ofSamples.length) : "";
  }

  // Of numbers of all rows, those that take part.
  of(all) {
    return Float64Array.from(this.places, row => all[row]);
  }

  mean(all) {
    const {places, worth, sum} = this;
    let mean = 0;
    for (let i = 0; i < worth.length; i++) mean += all[places[i]] * worth[i];
    return Math.min(1, Math.max(0, mean / sum));
  }

  // The mean of the numbers of all rows; `hits` are those that its interval must allow for.
  share(all, hits) {
    const numbers = this.of(all);
    if (!(this.sum > 0)) return {share: NaN, low: NaN, high: NaN};
    if (this.refusal) return {share: NaN, low: NaN, high: NaN, more: this.refusal};
    const mean = numbers.every(one => one >= 1 - ROUNDING) ? 1 : this.mean(all); // the complement has no digits
    return {share: mean, low: NaN, high: NaN, ...this.ends(numbers, mean, hits ?? this.hits(numbers))};
  }

  // Of how many rows the interval is no narrower than that of hits, for the mean and its complement.
  hits(numbers) {
    return [numbers, numbers.map(one => 1 - one)].map(side => this.hitsBehind(side)).filter(({extent}) => extent > 0);
  }

  ends(numbers, mean, behind) {
    if (!this.rows.independent && !this.part) return {};
    const found = this.pulls(numbers, mean), parts = found.length;
    if (parts < 2) return {};
    const other = numbers.map(one => 1 - one);
    let least = Infinity, largest = 0;
    for (const one of mean <= 0.5 ? numbers : other) {
      if (one < least) least = one;
      if (one > largest) largest = one;
    }
    if (largest - least <= ROUNDING * largest && mean > 0 && mean < 1) return {more: "exact"};
    let low = mean, high = mean;
    if (mean > 0 && mean < 1) {
      const middle = total(found) / parts;
      let squares = 0, lowest = Infinity, highest = -Infinity;
      for (const one of found) {
        squares += (one - middle) ** 2;
        if (one < lowest) lowest = one;
        if (one > highest) highest = one;
      }
      const half = student(this.rows.students, parts - 1) * Math.sqrt(squares / (parts - 1) / parts) / (mean * (1 - mean));
      const logit = Math.log(mean / (1 - mean)), outlier = 2 * (highest + lowest - 2 * mean) / parts;
      low = Math.max(1 / (1 + Math.exp(half - logit)) + Math.min(outlier, 0), 0);
      high = Math.min(1 / (1 + Math.exp(-half - logit)) + Math.max(outlier, 0), 1);
    }
    const hits = behind.map(({rows, extent}) => [exact(mean, rows), extent]);
    return {
      low: Math.min(low, ...hits.map(([[end], extent]) => low + extent * Math.min(0, end - low))),
      high: Math.max(high, ...hits.map(([[, end], extent]) => high + extent * Math.max(0, end - high))),
    };
  }

  // Of how many rows the interval is no narrower than that of hits, and how far this counts: uq/stats/weighted_means.py.
  hitsBehind(side) {
    const {weights, worth, ofSamples} = this;
    const carried = perSample(weights ? side.map((one, i) => worth[i] * one) : side, this.sample);
    const extent = Math.min(1, 2 - effectiveRows(carried) / FEW_HITS);
    if (!(extent > 0)) return {extent};
    let most = 0, heaviest = 0, largest = 0;
    ofSamples.forEach((weight, i) => {
      most = Math.max(most, carried[i]);
      heaviest = Math.max(heaviest, weight * carried[i]);
      largest = Math.max(largest, weight);
    });
    return {rows: Math.min(effectiveRows(ofSamples), this.sum / (most > 0 ? heaviest / most : largest)), extent};
  }

  // What each independent part says of the mean: the mean, plus the influence of the part.
  pulls(numbers, mean) {
    const {worth, part} = this, average = this.sum / worth.length;
    const influence = numbers.map((one, i) => worth[i] * (one - mean) / average);
    if (!part) return influence.map(one => mean + one);
    const sums = perSample(influence, part);
    return sums.map(one => mean + sums.length * one / numbers.length);
  }
}
