// The share of chosen rows above each value: of lives, the share that outlives each time.

// As uq/analysis/kaplan_meier.py; rows without a value do not take part.
function outliving(column, mask) {
  const ended = [], cut = [];
  let never = 0;
  for (let row = 0; row < mask.length; row++) {
    if (!mask[row]) continue;
    const state = column.states[row], value = column.values[row];
    if (state === ENDED) ended.push(value);
    else if (state === CENSORED) cut.push(value);
    else if (state === NEVER) never++;
  }
  const times = Float64Array.from(ended).sort(), until = Float64Array.from(cut).sort();
  const count = times.length + until.length + never;
  const ending = column.neverKnownAtOnce ? 1 - never / count : 1;
  let atRisk = count - (column.neverKnownAtOnce ? never : 0), censored = 0, among = 1;
  const at = [], share = [];
  for (let i = 0; i < times.length;) {
    const time = times[i];
    let ends = 0;
    while (censored < until.length && until[censored] < time) { censored++; atRisk--; }
    while (i < times.length && times[i] === time) { i++; ends++; }
    among *= (atRisk - ends) / atRisk;
    atRisk -= ends;
    at.push(time);
    share.push(1 - ending + ending * among);
  }
  return {at, share, count, censored: until.length, never};
}

function shareAbove(curve, value) {
  let low = 0, high = curve.at.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (curve.at[middle] <= value) low = middle + 1; else high = middle;
  }
  return low ? curve.share[low - 1] : 1;
}

// The value that a share of the rows lies below; infinite where the curve does not fall so far.
function quantile(curve, probability) {
  const place = curve.share.findIndex(share => share <= 1 - probability + 1e-12);
  return place < 0 ? (curve.count ? Infinity : NaN) : curve.at[place];
}

// Half the width of Kolmogorov's 95 % band of the whole curve (M. A. Stephens, J. R. Stat. Soc. B 32,
// 115 (1970)): for independent rows, none of them censored.
function bandOf(rows, curve) {
  if (!rows.independent || curve.censored || !curve.count) return NaN;
  const root = Math.sqrt(curve.count);
  return 1.358 / (root + 0.12 + 0.11 / root);
}
