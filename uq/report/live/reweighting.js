// The rows as those of a study with other laws: weighted, and lives integrated over what scales them.
// As uq/population/reweighting.py.

const OUTSIDE_AT_MOST = 1e-6, BINS = 500, PLACES = 200;

class Reweighting {
  constructor(rows) {
    this.rows = rows;
    const {inputs, laws, of} = rows.tolerances;
    this.names = inputs.map(one => one.name);
    this.columns = new Map(rows.columns.map(one => [one.name, one]));
    this.old = new Map(inputs.map(one => [one.name, new Law(one)]));
    this.lifeLaws = laws.map(one => new LifeLaw(one));
    this.lawOf = column => this.lifeLaws[of[column.name]];
    this.laws = new Map(this.old);
    this.found = new Map();
    this.orders = new Map();
  }

  move(name, factor, shift) {
    this.laws.set(name, this.old.get(name).moved(factor, shift));
    this.found.clear();
  }

  get changed() {
    return this.names.filter(name => this.laws.get(name) !== this.old.get(name));
  }

  // Why these laws are none of the parameters, or "".
  get problem() {
    const wrong = this.changed.find(name => this.laws.get(name).outside > OUTSIDE_AT_MOST);
    return wrong ? `${this.columns.get(wrong).label}: this law has more than a millionth of its probability outside the`
      + " bounds of the parameter." : "";
  }

  // The weights for an output; null where nothing changes.
  weights(column) {
    const changed = this.changed, integrated = this.lawOf(column)?.inputs ?? [];
    if (!changed.length) return null;
    const taking = changed.filter(name => !integrated.includes(name)), key = taking.join();
    if (!this.found.has(key)) {
      const logs = new Float64Array(this.rows.count);
      for (const name of taking) {
        const {values} = this.columns.get(name);
        const [now, before] = [this.laws, this.old].map(laws => laws.get(name).logDensities(values));
        for (let row = 0; row < logs.length; row++) logs[row] += now[row] - before[row];
      }
      this.found.set(key, smoothed(logs, this.rows.sample));
    }
    return this.found.get(key);
  }

  // The probability of what the study asks for.
  probability({column, value, hits}) {
    const weights = this.weights(column), law = this.lawOf(column);
    if (weights?.refusal) return {share: NaN, low: NaN, high: NaN, more: weights.refusal};
    const unknown = hits.reduce((sum, one, row) => sum + (isNaN(one) && column.states[row] !== FAILED), 0);
    if (unknown) return {share: NaN, low: NaN, high: NaN, more: `${unknown} rows were censored before that time`};
    if (!weights && !law) return shareOf(this.rows, hits, new Uint8Array(hits.length).fill(1));
    let numbers = hits;
    if (law) {
      const below = law.below(this.laws), at = Math.log(value);
      numbers = law.bare(column).map((bare, row) => column.states[row] === FAILED ? NaN : isNaN(bare) ? 0 : below(at - bare));
    }
    const {independent, students} = this.rows, part = this.rows.replicate ?? this.rows.sample;
    const kept = some => some?.filter((_, row) => column.states[row] !== FAILED) ?? null;
    return weightedShare(kept(numbers), kept(weights?.weights), {
      part: kept(part), sample: kept(this.rows.sample), students, independent,
    });
  }

  // The share above each value, or of lives with laws outliving each time.
  curve(column) {
    const weights = this.weights(column), law = this.lawOf(column);
    if (weights?.refusal) return null;
    return law ? this.smoothCurve(column, law, weights?.weights) : this.steps(column, weights?.weights);
  }

  steps(column, weights) {
    if (!this.orders.has(column)) {
      const rows = [...column.states.keys()].filter(row => column.states[row] < UNDEFINED);
      this.orders.set(column, rows.sort((a, b) => column.values[a] - column.values[b]));
    }
    const order = this.orders.get(column), of = row => weights ? weights[row] : 1, at = [], share = [];
    const sum = order.reduce((before, row) => before + of(row), 0);
    let above = sum;
    for (const row of order) {
      if (column.states[row] !== ENDED) break; // beyond the first censored row the share is not known
      above -= of(row);
      at.push(column.values[row]);
      share.push(Math.max(0, above / sum));
    }
    return {at, share};
  }

  // For a picture, lives without what is integrated are counted in narrow bins.
  smoothCurve(column, law, weights) {
    const bare = law.bare(column), below = law.below(this.laws), scale = new Scale(column);
    let low = Infinity, high = -Infinity, sum = 0;
    for (let row = 0; row < bare.length; row++) {
      if (!isFinite(bare[row])) continue;
      low = Math.min(low, bare[row]);
      high = Math.max(high, bare[row]);
    }
    const width = (high - low) / BINS || 1, bins = new Float64Array(BINS + 1);
    bare.forEach((one, row) => {
      if (isNaN(one)) return;
      const weight = weights ? weights[row] : 1;
      sum += weight;
      if (isFinite(one)) bins[Math.round((one - low) / width)] += weight;
    });
    // Times between which the logarithm of lives grows by whole bins.
    const from = Math.log(scale.low) - low, to = Math.log(scale.high) - low;
    const every = Math.max(1, Math.round((to - from) / width / PLACES)), at = [], share = [];
    const length = Math.ceil((to - from) / width) + BINS + 2;
    const shares = Float64Array.from({length}, (_, i) => below(from + (i - BINS) * width));
    for (let place = 0; from + place * width <= to; place += every) {
      let ended = 0;
      for (let bin = 0; bin <= BINS; bin++) ended += bins[bin] * shares[BINS + place - bin];
      at.push(Math.exp(low + from + place * width));
      share.push(1 - ended / sum);
    }
    return {at, share};
  }

  // The command that computes the same.
  get command() {
    const sets = this.changed.flatMap(name => this.laws.get(name).changes(this.old.get(name))
      .map(([key, value]) => ` --set uncertain.${name}.${key}=${tomlOf(value)}`));
    return `uq what-if ${this.rows.file}${sets.join("")}`;
  }
}

function tomlOf(value) {
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}
