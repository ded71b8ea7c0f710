// Pointwise intervals of a curve of steps, at some of its steps.

const MOST_ENDS = 48, WIDE_GAP = 0.02;

// Of the share of some rows that lies above each value.
function bandOfShares(rows, column, curve, mask) {
  const some = mask.map((one, row) => one && column.states[row] < UNDEFINED);
  return heldBand(column, curve, at => shareOf(rows, aboveOf(column, at), some));
}

function aboveOf({states, values}, at) {
  return Float64Array.from(values, (value, row) => Number(value > at || (states[row] === CENSORED && value === at)));
}

// Also at the steps either side of a wide gap; intervals hold from each step to the next.
function* heldBand(column, {at}, endsOf) {
  const scale = new Scale(column), every = Math.max(1, Math.ceil(at.length / MOST_ENDS));
  const isGap = i => scale.place(at[i + 1]) - scale.place(at[i]) > WIDE_GAP, found = {at: [], low: [], high: []};
  const add = (place, low, high) => { found.at.push(place); found.low.push(low); found.high.push(high); };
  for (let i = 0; i < at.length; i++) {
    if (i % every && i < at.length - 1 && !isGap(i) && !isGap(i - 1)) continue;
    if (found.at.length) add(at[i], found.low.at(-1), found.high.at(-1));
    const {low, high} = endsOf(at[i]);
    add(at[i], low, high);
    yield found;
  }
}
