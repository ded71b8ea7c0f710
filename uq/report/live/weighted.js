// Weighted means of numbers between 0 and 1, with intervals: as uq/population/means.py.

// Student's quantile, from a table or by Cornish and Fisher's expansion.
function student(students, degrees) {
  if (degrees + 1 < students.length) return students[degrees + 1];
  const z = NORMAL, z3 = z ** 3, z5 = z ** 5, z7 = z ** 7;
  return z + (z3 + z) / (4 * degrees) + (5 * z5 + 16 * z3 + 3 * z) / (96 * degrees ** 2)
    + (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * degrees ** 3);
}

// What each independent part says of the mean: the mean, plus the influence of the part.
function pulls(numbers, weights, mean, part) {
  const average = total(weights) / weights.length;
  const influence = numbers.map((one, row) => weights[row] * (one - mean) / average);
  if (!part) return influence.map(one => mean + one);
  const sums = perSample(influence, part);
  return sums.map(one => mean + sums.length * one / numbers.length);
}

// `numbers` of the rows that take part, with their weights (or null) and independent parts.
function weightedShare(numbers, weights, {part, sample, students, independent}) {
  const worth = weights ?? new Float64Array(numbers.length).fill(1), sum = total(worth);
  if (!(sum > 0)) return {share: NaN, low: NaN, high: NaN};
  let mean = 0;
  numbers.forEach((one, row) => { mean += one * worth[row]; });
  mean = Math.min(1, Math.max(0, mean / sum));
  const none = more => ({share: mean, low: NaN, high: NaN, more});
  if (weights) {
    const tail = perSample(numbers.map((one, row) => worth[row] * (mean <= 0.5 ? one : 1 - one)), sample);
    const why = refusal(tailShape(tail), tail.length);
    if (why) return {share: NaN, low: NaN, high: NaN, more: why};
  }
  if (!independent && !part) return none();
  const found = pulls(numbers, worth, mean, part), parts = found.length;
  if (parts < 2) return none();
  const least = found.reduce((a, b) => Math.min(a, b)), most = found.reduce((a, b) => Math.max(a, b));
  const side = numbers.map(one => (mean <= 0.5 ? one : 1 - one)), largest = side.reduce((a, b) => Math.max(a, b), 0);
  const alike = side.every(one => Math.abs(one - side[0]) <= ROUNDING * largest);
  if (alike && mean > 0 && mean < 1) return none("exact");
  let low = mean, high = mean;
  if (mean > 0 && mean < 1) {
    const middle = total(found) / parts;
    const scatter = Math.sqrt(total(found.map(one => (one - middle) ** 2)) / (parts - 1) / parts);
    const half = student(students, parts - 1) * scatter / (mean * (1 - mean)), logit = Math.log(mean / (1 - mean));
    const outlier = 2 * ((most - mean) - (mean - least)) / parts;
    low = Math.max(1 / (1 + Math.exp(half - logit)) + Math.min(outlier, 0), 0);
    high = Math.min(1 / (1 + Math.exp(-half - logit)) + Math.max(outlier, 0), 1);
  }
  const rarer = side.map((one, row) => worth[row] * one);
  if (effectiveRows(perSample(rarer, sample)) < FEW_HITS) {
    const [a, b] = binomial(mean, effectiveRows(perSample(worth, sample)));
    low = Math.min(low, a);
    high = Math.max(high, b);
  }
  return {share: mean, low, high};
}
