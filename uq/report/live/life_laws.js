// The law of a life in each row, of which the inputs that only scale it are integrated: as
// uq/population/scale_laws.py and uq/population/sums.py.

// Chebyshev polynomials between ascending ends: the probability of a sum of logarithms.
function tabulated({ends, coefficients}) {
  return value => {
    if (value <= ends[0]) return 0;
    if (value >= ends.at(-1)) return 1;
    let piece = 0;
    while (ends[piece + 1] < value) piece++;
    const x = (2 * value - ends[piece] - ends[piece + 1]) / (ends[piece + 1] - ends[piece]);
    const c = coefficients[piece];
    let [one, two] = [0, 0];
    for (let i = c.length - 1; i > 0; i--) [one, two] = [2 * x * one - two + c[i], one];
    return Math.min(1, Math.max(0, x * one - two + c[0]));
  };
}

// A multiple of the logarithm of an input.
function logarithmOf(law, exponent) {
  return value => {
    const share = law.probability(Math.exp(value / exponent));
    return exponent > 0 ? share : 1 - share;
  };
}

class LifeLaw {
  constructor(plain) {
    this.inputs = plain.inputs;
    this.plain = plain;
    this.drawn = numbersOf(plain.drawn, Float64Array);
    this.bares = new Map();
  }

  // The probability of less than a sum of logarithms, under the laws that are asked for.
  below(laws) {
    return this.plain.table ? tabulated(this.plain.table) : logarithmOf(laws.get(this.inputs[0]), this.plain.exponent);
  }

  // The logarithm of each life without what is integrated.
  bare(column) {
    if (!this.bares.has(column)) {
      this.bares.set(column, column.values.map((life, row) => Math.log(life) - this.drawn[row]));
    }
    return this.bares.get(column);
  }
}
