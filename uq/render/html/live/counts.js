// Counts of rows; with weights, sums of these.

const MISS = 0, HIT = 1, UNKNOWN = 3; // sides of an event; other rows take no part

// The share of hits among rows with weights; not known where the side of any is not.
function shareOf({sides}, weights) {
  let hits = 0, all = 0, unknown = 0;
  sides.forEach((side, row) => {
    if (side === HIT) hits += weights[row];
    if (side === HIT || side === MISS) all += weights[row];
    if (side === UNKNOWN && weights[row]) unknown++;
  });
  if (unknown) return {share: NaN, more: `${grouped(unknown)} rows were censored before that time`};
  return {share: hits / all, hits, all, more: ""};
}

// A cell with such a share, and what it is a share of.
function countedCell(event, weights, wordsOf = () => "") {
  const {share, hits, all, more} = weights ? shareOf(event, weights) : {share: NaN};
  return cell(share, percent(share), more || wordsOf(hits, all));
}

// The lowest and the highest value among rows that have one.
function extremesOf({values, states}, mask) {
  const ended = values.filter((_, row) => mask[row] && states[row] === ENDED).sort();
  return [ended[0], ended.at(-1)];
}

// The share of rows above the end of each of some narrow bins, as far as it is known.
const BINS = 200;

function sharesAbove({values, states}, scale, weights) {
  const inBin = new Float64Array(BINS + 1);
  let all = 0, last = BINS;
  values.forEach((value, row) => {
    if (states[row] >= UNDEFINED) return;
    all += weights[row];
    if (states[row] === NEVER) return;
    const bin = Math.max(Math.ceil(scale.place(value) * BINS - 1e-9), 0);
    if (states[row] === ENDED) inBin[bin] += weights[row];
    else if (weights[row]) last = Math.min(last, bin - 1);
  });
  const at = [], share = [];
  for (let bin = 0, above = all; all && bin <= last; bin++) {
    above -= inBin[bin];
    at.push(scale.value(bin / BINS));
    share.push(Math.max(above / all, 0));
  }
  return {at, share};
}
