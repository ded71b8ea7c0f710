// The share of chosen rows above each value: of lives, the share that outlives each time.

// As uq/stats/kaplan_meier.py; rows without a value do not take part.
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
  let atRisk = count - (column.neverKnownAtOnce ? never : 0), censored = 0, among = 1, spread = 0;
  const at = [], share = [], variance = [];
  for (let i = 0; i < times.length;) {
    const time = times[i];
    let ends = 0;
    while (censored < until.length && until[censored] < time) { censored++; atRisk--; }
    while (i < times.length && times[i] === time) { i++; ends++; }
    among *= (atRisk - ends) / atRisk;
    spread += ends / (atRisk * (atRisk - ends));
    atRisk -= ends;
    at.push(time);
    share.push(1 - ending + ending * among);
    const ofAmong = among > 0 ? among ** 2 * spread : until.length ? NaN : 0;
    variance.push((1 - among) ** 2 * ending * (1 - ending) / count + ending ** 2 * ofAmong);
  }
  return {at, share, variance, count, censored: until.length, never, last: Math.max(times.at(-1) ?? 0, until.at(-1) ?? 0)};
}

const FEW_ENDS = 4;

// The interval of each share of independent rows, by the exponential Greenwood formula, exact where few have
// ended or are left: as uq/assess/survival.py.
function greenwood({share, variance}) {
  const ends = share.map((one, i) => {
    if (!(one > 0 && one < 1)) return NONE;
    const worth = one * (1 - one) / variance[i];
    if (areFew(one, worth, FEW_ENDS)) return exact(one, worth);
    const middle = Math.log(-Math.log(one)), half = NORMAL * Math.sqrt(variance[i]) / (one * -Math.log(one));
    return [Math.exp(-Math.exp(middle + half)), Math.exp(-Math.exp(middle - half))];
  });
  return {low: ends.map(one => one[0]), high: ends.map(one => one[1])};
}

// The same from independent parts: replicates, or samples dealt into groups.
function scatteredEnds(rows, column, mask, {at, share}) {
  const some = [...mask.keys()].filter(row => mask[row] && column.states[row] < UNDEFINED);
  const group = groupsOf(rows, some), groups = new Map();
  some.forEach((row, i) => {
    if (!groups.has(group[i])) groups.set(group[i], new Uint8Array(mask.length));
    groups.get(group[i])[row] = 1;
  });
  const curves = [...groups.values()].map(own => ({...outliving(column, own), place: 0}));
  const cut = Float64Array.from(some.filter(row => column.states[row] === CENSORED), row => column.values[row]).sort();
  let gone = 0;
  const ends = at.map((time, i) => {
    while (gone < cut.length && cut[gone] <= time) gone++;
    const estimates = curves.map(one => {
      while (one.place < one.at.length && one.at[one.place] <= time) one.place++;
      return one.place ? one.share[one.place - 1] : 1;
    });
    const known = share[i] > 0 && share[i] < 1;
    return known ? scattered(share[i], some.length - gone, estimates, rows.students, rows.samples) : NONE;
  });
  return {low: ends.map(one => one[0]), high: ends.map(one => one[1])};
}

// As uq/stats/clusters.py deals samples, for what is not a mean.
function groupsOf({replicate, sample}, some) {
  if (replicate) return some.map(row => replicate[row]);
  const names = [...new Set(some.map(row => sample[row]))].sort((a, b) => a - b), parts = names.length;
  const place = new Map(names.map((name, i) => [name, i]));
  const groups = Math.min(parts, Math.max(8, Math.min(32, Math.floor(parts / 8))));
  return some.map(row => Math.floor(place.get(sample[row]) * groups / parts));
}

const KNOWN_ENDS = new WeakMap(); // of chosen rows, by column

function endsOf(rows, column, mask) {
  if (!KNOWN_ENDS.has(mask)) KNOWN_ENDS.set(mask, new Map());
  const known = KNOWN_ENDS.get(mask), curve = outliving(column, mask);
  if (!known.has(column)) {
    known.set(column, rows.independent ? greenwood(curve) : rows.replicate || rows.sample
      ? scatteredEnds(rows, column, mask, curve) : {low: [], high: []});
  }
  return known.get(column);
}

// The share that has ended by a time, assuming that censoring is non-informative.
function endedBy(rows, column, mask, time) {
  const curve = outliving(column, mask), place = curve.at.findLastIndex(one => one < time);
  if (time > curve.last) return {share: NaN, low: NaN, high: NaN, more: "it is after the last observation"};
  const {low, high} = endsOf(rows, column, mask);
  return {share: place < 0 ? 0 : 1 - curve.share[place], low: 1 - (high[place] ?? NaN), high: 1 - (low[place] ?? NaN),
    more: KAPLAN_MEIER};
}

// The time by which a share has ended, likewise.
function lifeBy(rows, column, mask, probability) {
  const curve = outliving(column, mask), {low, high} = endsOf(rows, column, mask);
  const first = shares => curve.at[shares.findIndex(one => one <= 1 - probability)] ?? NaN;
  const value = first(curve.share), least = first(low);
  return {value, low: least === curve.at[0] ? NaN : least, high: first(high), more: KAPLAN_MEIER};
}

// Half the width of Kolmogorov's 95 % band of the whole curve (M. A. Stephens, J. R. Stat. Soc. B 32,
// 115 (1970)): for independent rows, none of them censored.
function bandOf(rows, curve) {
  if (!rows.independent || curve.censored || !curve.count) return NaN;
  const root = Math.sqrt(curve.count);
  return 1.358 / (root + 0.12 + 0.11 / root);
}
