// What is known of the chosen rows: probabilities, regimes, lives, beside those of all rows.

const PROBABILITIES = [0.1, 0.5];

class Found {
  constructor(selection) {
    this.selection = selection;
    this.rows = selection.rows;
    this.events = [...this.asked(), ...this.regimes()];
    this.one = new Uint8Array(this.rows.count).fill(1);
    this.all = this.numbers(this.one);
    this.curves = new Map(); // of all rows, by column
    this.later = laterOf();
    this.said = make("p", {class: "said", role: "status"});
    this.table = make("table", {class: "found"});
    this.picture = make("figure");
    this.element = make("div", {}, this.said, make("div", {class: "wide"}, this.table),
      new InputsApart(selection).element, this.picture,
      make("p", {class: "note"}, this.rows.intervals));
    selection.listeners.push(() => this.show());
  }

  asked() {
    return this.rows.columns.flatMap(column => column.thresholds.map(({value, words}) => ({
      key: `${column.name}/${value}`, words: countedOf(column, words), column, value, hits: column.hits(value),
    })));
  }

  regimes() {
    const {regime, failed} = this.rows;
    if (!regime) return [];
    const takesPart = row => regime.codes[row] >= 0 || !failed[row];
    return regime.entries.filter(entry => entry.code >= 0).map(({code, label, colour}) => ({
      key: `regime/${label}`, words: `in ${label}`, colour,
      hits: Float64Array.from(regime.codes, (one, row) => takesPart(row) ? Number(one === code) : NaN),
    }));
  }

  numbers(mask) {
    return this.events.map(({column, value, hits}) => {
      const isUnknown = (state, row) => mask[row] && state === CENSORED && column.values[row] < value;
      const unknown = column?.life && column.states.some(isUnknown);
      return unknown ? endedBy(this.rows, column, mask, value) : shareOf(this.rows, hits, mask);
    });
  }

  show(column = this.column) {
    this.column = column;
    const {selection, rows} = this, {isAll, mask, count} = selection;
    this.said.replaceChildren(...(isAll
      ? [rows.count < rows.total ? `All ${grouped(rows.count)} rows in this page, a random part of ${grouped(rows.total)}.`
        : rows.count === 1 ? "The only row." : `All ${grouped(rows.count)} rows.`]
      : [data(count, grouped(count)), ` of ${grouped(rows.count)} rows, chosen after the fact: the intervals assume that the`
        + " choice was made before the rows were seen, and a difference from all rows need not be an effect of"
        + " what was chosen."]));
    const chosen = isAll ? this.all : this.numbers(mask);
    const heads = ["", ...(isAll ? [] : ["chosen rows"]), "all rows"].map(text => make("th", {scope: "col"}, text));
    const lines = this.events.map(({key, words, colour}, i) => make("tr", {"data-key": key},
      make("th", {scope: "row"}, ...dotOf(colour), words),
      ...(isAll ? [] : [cellOf(chosen[i])]), cellOf(this.all[i])));
    const everything = this.everything(column);
    const some = isAll ? everything : {curve: outliving(column, mask), quantiles: this.quantiles(column, mask)};
    PROBABILITIES.forEach((probability, i) => lines.push(make("tr", {"data-key": `quantile/${probability}`},
      make("th", {scope: "row"}, countedOf(column, `${column.quantileName(probability)} of ${column.label}`)),
      ...(isAll ? [] : [quantileCell(column, some.quantiles[i])]), quantileCell(column, everything.quantiles[i]))));
    this.table.replaceChildren(make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...lines));
    this.drawCurves(column, everything.curve, some.curve, isAll);
    this.later(this.withBand(column, everything.curve, some.curve, isAll, mask));
  }

  everything(column) {
    if (!this.curves.has(column)) {
      this.curves.set(column, {curve: outliving(column, this.one), quantiles: this.quantiles(column, this.one)});
    }
    return this.curves.get(column);
  }

  quantiles(column, mask) {
    return quantilesAmong(this.rows, column, mask, PROBABILITIES);
  }

  drawCurves(column, everything, some, isAll, pointwise) {
    const lines = [{curve: everything, name: "all"}];
    if (!isAll) lines.push({curve: some, name: "chosen"});
    const half = bandOf(this.rows, some), band = pointwise ?? this.censoredBand(column, some, isAll ? this.one : this.selection.mask);
    Object.assign(lines.at(-1), {half, band});
    const title = `${column.curveName}: ${column.title}`;
    const words = isFinite(half) ? ", 95 % band" : band ? ", pointwise 95 % intervals" : "";
    this.picture.replaceChildren(curvesOf(column, lines, title), make("figcaption", {},
      isAll ? `${title}${words}.` : `${title}: chosen rows (bold${words}) and all rows (thin).`));
  }

  censoredBand(column, curve, mask) {
    return curve.censored ? {at: curve.at, ...endsOf(this.rows, column, mask)} : undefined;
  }

  // The intervals of rows that are not independent take some time.
  *withBand(column, everything, some, isAll, mask) {
    if (this.rows.independent || some.censored) return;
    let band;
    for (band of bandOfShares(this.rows, column, some, mask)) yield;
    if (band?.low.some(isFinite)) this.drawCurves(column, everything, some, isAll, band);
  }
}

// Of lives whose rows the answer integrates: this is not the same number.
function countedOf(column, words) {
  return column.counted ? `${words}, counted` : words;
}

function cellOf({share, low, high, more}) {
  const first = percent(low), last = percent(high);
  const both = first === last ? "exact to these digits" : `${first.replace("\u00a0%", "")} to ${last}`;
  const ends = isFinite(low) ? both : "";
  return intervalCell(isNaN(share) ? "\u2013" : data(share, percent(share)), low, high, ends, more);
}

function quantileCell(column, {value, low, high, more}) {
  const words = one => one === Infinity && column.life ? "never" : column.words(one, 3);
  const ends = isNaN(low) && !(high < Infinity) ? "" : isNaN(low) ? `at most ${words(high)}` : isNaN(high)
    ? `at least ${words(low)}` : `${high < Infinity ? column.digits(low, 3) : words(low)} to ${words(high)}`;
  return intervalCell(isNaN(value) ? "\u2013" : data(value, words(value)), low, high, ends, more);
}

function intervalCell(shown, low, high, ends, more) {
  const parts = [ends && make("span", {class: "ends"}, ends), ends && more && "; ", more].filter(Boolean);
  return make("td", {class: "number", "data-low": low, "data-high": high}, shown, make("small", {}, ...parts));
}
