// What is known of the chosen rows: probabilities, regimes, lives, beside those of all rows.

class Found {
  constructor(selection) {
    this.selection = selection;
    this.rows = selection.rows;
    this.events = [...this.asked(), ...this.regimes()];
    this.one = new Uint8Array(this.rows.count).fill(1);
    this.all = this.numbers(this.one);
    this.curves = new Map(); // of all rows, by column
    this.said = make("p", {class: "said", role: "status"});
    this.table = make("table", {class: "found"});
    this.picture = make("figure");
    this.element = make("div", {}, this.said, make("div", {class: "wide"}, this.table), this.picture,
      make("p", {class: "note"}, this.rows.intervals));
    selection.listeners.push(() => this.show());
  }

  asked() {
    return this.rows.columns.flatMap(column => column.thresholds.map(({value, words}) => ({
      key: `${column.name}/${value}`, words, column, value, hits: column.hits(value),
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
      if (!unknown) return shareOf(this.rows, hits, mask);
      const curve = outliving(column, mask), before = curve.at.filter(time => time < value).length;
      return {share: 1 - (before ? curve.share[before - 1] : 1), count: curve.count, low: NaN, high: NaN,
        more: "by Kaplan\u2013Meier, assuming that censoring is non-informative"};
    });
  }

  show(column = this.column) {
    this.column = column;
    const {selection, rows} = this, {isAll, mask, count} = selection;
    this.said.replaceChildren(...(isAll
      ? [rows.count < rows.total ? `All ${rows.count} rows in this page, a random part of ${rows.total}.` : `All ${rows.count} rows.`]
      : [data(count, `${count}`), ` of ${rows.count} rows, chosen after the fact: the intervals assume that the`
        + " choice was made before the rows were seen, and a difference from all rows need not be an effect of"
        + " what was chosen."]));
    const chosen = isAll ? this.all : this.numbers(mask);
    const heads = ["", ...(isAll ? [] : ["chosen rows"]), "all rows"].map(text => make("th", {scope: "col"}, text));
    const lines = this.events.map(({key, words, colour}, i) => make("tr", {"data-key": key},
      make("th", {scope: "row"}, ...dotOf(colour), words),
      ...(isAll ? [] : [cellOf(chosen[i])]), cellOf(this.all[i])));
    const everything = this.everything(column);
    const some = isAll ? everything : outliving(column, mask);
    lines.push(make("tr", {"data-key": "median"}, make("th", {scope: "row"}, `median of ${column.label}`),
      ...(isAll ? [] : [medianOf(column, some)]), medianOf(column, everything)));
    this.table.replaceChildren(make("thead", {}, make("tr", {}, ...heads)), make("tbody", {}, ...lines));
    this.drawCurves(column, everything, some, isAll);
  }

  everything(column) {
    if (!this.curves.has(column)) this.curves.set(column, outliving(column, this.one));
    return this.curves.get(column);
  }

  drawCurves(column, everything, some, isAll) {
    const what = column.life ? "Share that outlives each time" : "Share of rows above each value";
    const lines = [{curve: everything, name: "all", half: isAll ? bandOf(this.rows, everything) : NaN}];
    if (!isAll) lines.push({curve: some, name: "chosen", half: bandOf(this.rows, some)});
    const title = `${what}: ${column.title}`;
    const band = isFinite(lines.at(-1).half) ? ", 95 % band" : "";
    this.picture.replaceChildren(curvesOf(column, lines, title), make("figcaption", {},
      isAll ? `${title}${band}.` : `${title}: chosen rows (bold${band}) and all rows (thin).`));
  }
}

function cellOf({share, low, high, more}) {
  const ends = isFinite(low) ? `${percent(low).replace("\u00a0%", "")} to\u00a0${percent(high)}` : "";
  return make("td", {class: "number", "data-low": low, "data-high": high},
    isNaN(share) ? "\u2013" : data(share, percent(share)), make("small", {}, [ends, more].filter(Boolean).join("; ")));
}

function medianOf(column, curve) {
  const value = quantile(curve, 0.5);
  const words = value === Infinity ? (curve.never ? "never" : "beyond the horizon") : column.words(value, 3);
  return make("td", {class: "number"}, data(value, words));
}
