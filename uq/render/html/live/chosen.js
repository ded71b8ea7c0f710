// What is counted in the chosen rows: events and regimes, extremes and a curve, beside all rows.

class Chosen {
  constructor(selection, element) {
    Object.assign(this, {selection, element, rows: selection.rows});
    this.quarters = new Quarters(selection, element.querySelector(".by-quarters"));
    selection.listeners.push(() => this.show());
  }

  show(column = this.column) {
    this.column = column;
    const {isAll, mask} = this.selection, masks = isAll ? [this.rows.all] : [mask, this.rows.all];
    this.tell();
    const heads = ["", ...(isAll ? [] : ["chosen rows"]), "all rows"];
    fill(this.element.querySelector(".counted"), heads, [...this.lines(masks), this.extremes(masks)]);
    this.drawCurves(masks);
    this.quarters.show();
  }

  tell() {
    const {rows, selection: {isAll, count}} = this, words = ` of ${grouped(rows.count)} rows, chosen after the fact: a`
      + " difference from all rows need not be an effect of what was chosen.";
    const chosen = [make("data", {value: count}, grouped(count)), words];
    this.element.querySelector(".status").replaceChildren(...(isAll ? [rows.extent] : chosen));
  }

  // As long as no rows are chosen, a number that the answer integrates is that of the answer.
  lines(masks) {
    const estimates = this.selection.isAll ? this.rows.tolerances?.studied.events ?? {} : {};
    return this.rows.events.map(event => {
      const isEstimated = event.counted && event.key in estimates;
      const cells = isEstimated ? [estimatedCell(estimates[event.key])]
        : masks.map(mask => countedCell(event, mask, (hits, all) => `${grouped(hits)} of ${grouped(all)}`));
      const words = [event.words, isEstimated ? "" : event.counted], style = `--dot: ${event.colour}`;
      return make("tr", {"data-key": event.key}, make("th", {scope: "row", style}, ...words), ...cells);
    });
  }

  extremes(masks) {
    const cells = masks.map(mask => {
      const [low, high] = extremesOf(this.column, mask);
      const words = low === undefined ? "\u2013" : this.column.between(low, high);
      return make("td", {class: "number", "data-low": low, "data-high": high}, words);
    });
    const words = `lowest and highest ${this.column.label}`;
    return make("tr", {"data-key": "extremes"}, make("th", {scope: "row"}, words), ...cells);
  }

  drawCurves(masks) {
    const isPair = masks.length > 1, names = isPair ? ["chosen", "all"] : ["all"];
    const more = isPair ? ": chosen rows (bold) and all rows (thin)" : "";
    showCurves(this.element.querySelector("figure"), this.column, masks.map((mask, i) => [mask, names[i]]), more);
  }
}
