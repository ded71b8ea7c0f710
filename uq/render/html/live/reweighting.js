// The rows as those of a study with other laws: weighted, and lives integrated over what scales them.
// As uq/assess/reweighting.py.

const OUTSIDE_AT_MOST = 1e-6;

class Reweighting {
  constructor(rows) {
    this.rows = rows;
    const {laws, sliders, lives} = rows.tolerances;
    this.names = sliders;
    this.columns = new Map(rows.columns.map(one => [one.name, one]));
    this.old = new Map(laws.map(one => [one.name, new Law(one)]));
    this.laws = new Map(this.old);
    this.lives = lives;
    this.correlated = rows.tolerances.correlated[0]?.names ?? [];
    this.forget();
  }

  move(name, factor, shift) {
    this.laws.set(name, this.old.get(name).moved(factor, shift));
    this.forget();
  }

  forget() {
    this.found = new Map();
    this.lifeLaws = new Map();
  }

  get changed() {
    return this.names.filter(name => this.laws.get(name) !== this.old.get(name));
  }

  // Why these laws are none of the parameters, or "".
  get problem() {
    const {columns, laws} = this, label = name => columns.get(name).label;
    const empty = this.changed.find(name => !(laws.get(name).given([-Infinity, Infinity]).kept > 0));
    if (empty) return `${label(empty)}: nothing of this law is left by its truncation.`;
    const outside = this.changed.find(name => !laws.get(name).plain.times && !(laws.get(name).outside <= OUTSIDE_AT_MOST));
    return outside ? `${label(outside)}: this law has more than a millionth of its probability outside the`
      + " bounds of the parameter." : "";
  }

  // The law of a life in each row; null where nothing is integrated.
  lawOf({name}) {
    if (!this.lives[name]) return null;
    if (!this.lifeLaws.has(name)) this.lifeLaws.set(name, lifeLawOf(this.lives[name], this.laws, this.columns));
    return this.lifeLaws.get(name);
  }

  // The weights for an output; null where nothing changes.
  weights(column) {
    const {changed} = this, integrated = this.lawOf(column)?.inputs ?? [];
    if (!changed.length) return null;
    const key = integrated.join();
    if (!this.found.has(key)) this.found.set(key, smoothed(this.logRatio(changed, integrated), this.rows.sample));
    return this.found.get(key);
  }

  // The logarithm of the new density of each row's inputs over the old one.
  logRatio(changed, integrated) {
    const logs = new Float64Array(this.rows.count);
    const add = of => {
      const [now, before] = [of(this.laws), of(this.old)];
      now?.forEach((one, row) => { logs[row] += one - before[row]; });
    };
    for (const name of changed) if (!integrated.includes(name)) add(laws => this.densities(laws.get(name), name));
    if (changed.some(name => this.correlated.includes(name))) {
      const without = integrated.find(name => this.correlated.includes(name));
      add(laws => logCopula(this.rows.tolerances.correlated, without, laws, this.columns));
    }
    return logs;
  }

  densities(law, name) {
    const {values} = this.columns.get(name), {times} = law.plain;
    if (!times) return law.logDensities(values);
    const others = this.columns.get(times).values, factors = values.map((x, row) => x / others[row]);
    return law.logDensities(law.kind.discrete ? factors.map(Math.round) : factors, others);
  }

  // The probability of what the study asks for; NaN where weights are refused.
  probability({column, value, hits}) {
    const weights = this.weights(column), law = this.lawOf(column);
    if (weights?.refusal) return {share: NaN, low: NaN, high: NaN};
    const unknown = hits.reduce((sum, one, row) => sum + (isNaN(one) && column.states[row] !== FAILED), 0);
    if (unknown) return {share: NaN, low: NaN, high: NaN, more: `${unknown} rows were censored before that time`};
    if (!weights && !law) return shareOf(this.rows, hits, new Uint8Array(hits.length).fill(1));
    const weighed = new Weighed(this.rows, weights?.weights, row => column.states[row] !== FAILED);
    return weighed.share(law ? law.below(column, value) : hits);
  }

  // The command that computes the same.
  get command() {
    const sets = this.changed.flatMap(name => this.laws.get(name).changes(this.old.get(name)).map(([key, value]) =>
      ` --set ${quoted(`uncertain.${name}.${key}=${tomlOf(value, this.laws.get(name).kind.discrete)}`)}`));
    return `uq what-if ${this.rows.file}${sets.join("")}`;
  }
}

function tomlOf(value, isWhole) {
  if (Array.isArray(value)) return `[${value.map(one => tomlOf(one, isWhole)).join(", ")}]`;
  const text = String(value);
  return isWhole || /[.e]/.test(text) ? text : `${text}.0`;
}

function quoted(text) {
  return /^[\w.=+-]*$/.test(text) ? text : `'${text}'`;
}
