// Which rows are chosen: by categories and by ranges of columns.

class Selection {
  constructor(rows) {
    this.rows = rows;
    this.ranges = new Map(); // column -> [low, high]; an end that is open is infinite
    this.refused = new Map(rows.categories.map(category => [category, new Set()])); // places of entries
    this.listeners = [];
    this.changed = eventually(() => {
      this.update();
      for (const listener of this.listeners) listener();
    });
    this.update();
  }

  range(column) { return this.ranges.get(column) ?? [-Infinity, Infinity]; }

  setRange(column, low, high) {
    if (low === -Infinity && high === Infinity) this.ranges.delete(column);
    else this.ranges.set(column, [low, high]);
    this.changed();
  }

  toggle(category, place) {
    const places = this.refused.get(category);
    if (!places.delete(place)) places.add(place);
    this.changed();
  }

  clear() {
    this.ranges.clear();
    for (const places of this.refused.values()) places.clear();
    this.changed();
  }

  // A life that never ends, or is censored, lies above every finite value.
  update() {
    const isInside = ({values, states}, [low, high], row) =>
      values[row] >= low && (states[row] === CENSORED ? high === Infinity : values[row] <= high);
    const ranges = [...this.ranges], refused = [...this.refused].filter(([, places]) => places.size);
    const isChosen = row => ranges.every(([column, range]) => isInside(column, range, row))
      && !refused.some(([category, places]) => places.has(category.places[row]));
    this.isAll = !ranges.length && !refused.length;
    this.mask = Uint8Array.from(this.rows.numbers, (_, row) => Number(isChosen(row)));
    this.count = this.mask.reduce((sum, chosen) => sum + chosen, 0);
  }
}
