// The law of a life in each row, of which inputs that only scale it are integrated: as
// uq/assess/scaling.py and uq/assess/scale_laws.py.

// Inputs that are independent of all others.
class IndependentScale {
  constructor(scales, term, columns) {
    this.inputs = scales.map(one => one.name);
    this.term = term;
    this.drawn = new Float64Array(columns.get(this.inputs[0]).values.length);
    for (const {name, exponent} of scales) {
      columns.get(name).values.forEach((x, row) => { this.drawn[row] += exponent * Math.log(x); });
    }
  }

  // The logarithm of each life without what is integrated.
  bare({values}) {
    return values.map((life, row) => Math.log(life) - this.drawn[row]);
  }

  // The probability of each row that the life is shorter; 0 where there is none.
  below(column, time) {
    if (this.column !== column) [this.column, this.bares] = [column, this.bare(column)];
    const at = Math.log(time);
    return this.bares.map(bare => isNaN(bare) ? 0 : this.term.below(at - bare));
  }
}

// One input whose law depends on the other inputs of the row.
class ConditionalScale {
  constructor({name, exponent, times, slopes, deviation}, laws, columns) {
    Object.assign(this, {inputs: [name], exponent, deviation, law: laws.get(name)});
    this.drawn = columns.get(name).values;
    this.others = times ? columns.get(times).values : null;
    if (times) this.conditions = this.law.besides(this.others);
    if (slopes) {
      this.mean = new Float64Array(this.drawn.length);
      for (const [other, slope] of slopes) {
        laws.get(other).normal(columns.get(other).values).forEach((z, row) => { this.mean[row] += slope * z; });
      }
    }
  }

  below({values}, time) {
    return values.map((life, row) => this.belowIn(row, life, time));
  }

  belowIn(row, life, time) {
    if (isNaN(life)) return 0;
    const {law, others, exponent} = this, reached = this.drawn[row] * (time / life) ** (1 / exponent);
    if (others) return law.shares(reached / others[row], this.conditions[row])[exponent > 0 ? 0 : 1];
    const share = law.shares(reached)[0];
    const z = share <= 0 ? -Infinity : share >= 1 ? Infinity : normalAt(share);
    return normalBelow((exponent > 0 ? 1 : -1) * (z - this.mean[row]) / this.deviation);
  }
}

// The law that Python integrates, of the inputs that it may: all that are independent of the others, or
// the one that depends on others if it alone scatters the lives more.
function lifeLawOf({free, bound}, laws, columns) {
  const kept = [...free, ...bound].filter(({name, times}) => times || laws.get(name).isPositive);
  const terms = kept.filter(one => free.includes(one)).map(one => [one, logTermOf(laws.get(one.name), one.exponent)]);
  const others = kept.filter(one => bound.includes(one)).map(one => [one, reachOf(one, columns)]);
  const widest = others.reduce((best, one) => one[1] > best[1] ? one : best, [null, 0]);
  if (terms.length && (!widest[0] || Math.hypot(...terms.map(([, term]) => term.spread)) >= widest[1])) {
    return new IndependentScale(terms.map(([one]) => one), sumOf(terms.map(([, term]) => term)), columns);
  }
  return widest[0] && new ConditionalScale(widest[0], laws, columns);
}

// The standard deviation of the logarithms of lives that an input causes, given the others.
function reachOf({name, exponent, times, deviation}, columns) {
  const {values} = columns.get(name), others = times && columns.get(times).values;
  const logs = values.map((x, row) => Math.log(others ? x / others[row] : x)), mean = total(logs) / logs.length;
  return deviation * Math.abs(exponent) * Math.sqrt(total(logs.map(one => (one - mean) ** 2)) / logs.length);
}
