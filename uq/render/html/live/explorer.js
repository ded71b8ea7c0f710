// What the page shows of its rows: chips, scatter plot, ranges, counts in the chosen rows, and one row.

class Explorer {
  constructor(rows, element) {
    Object.assign(this, {rows, element, selection: new Selection(rows)});
    this.chosen = new Chosen(this.selection, element.querySelector(".chosen"));
    this.scatter = new Scatter(this.selection, element.querySelector(".scatter"), (name, byKey) => this.open(name, byKey));
    const ranges = [...element.querySelectorAll(".range")];
    this.ranges = rows.columns.map((column, i) => new Range(this.selection, column, ranges[i]));
    [this.card, this.clear] = [".opened", ".clear"].map(name => element.querySelector(name));
    [this.x, this.y] = rows.first.map(place => rows.columns[place]);
    this.listenToControls();
    this.listenToPage();
    this.selection.listeners.push(() => this.showRanges());
  }

  listenToControls() {
    const {rows, element} = this;
    element.querySelectorAll(".chip").forEach(chip => this.listenToChip(chip));
    for (const select of element.querySelectorAll("select")) {
      select.addEventListener("change", () => { this[select.dataset.axis] = rows.columns[select.value]; this.arrange(); });
    }
    listenToNumbers(rows, element.querySelector("form"), name => this.open(name));
    this.clear.addEventListener("click", () => this.selection.clear());
  }

  listenToChip(chip) {
    const category = this.rows.categories.find(({name}) => name === chip.dataset.category);
    const place = Number(chip.dataset.place), refused = this.selection.refused.get(category);
    chip.addEventListener("click", () => this.selection.toggle(category, place));
    this.selection.listeners.push(() => chip.setAttribute("aria-pressed", !refused.has(place)));
  }

  listenToPage() {
    document.addEventListener("keydown", event => { // a click on what takes no focus leaves it to the page
      const isHere = this.element.contains(event.target) || event.target === document.body;
      if (event.key === "Escape" && isHere && this.card.hasChildNodes()) this.close();
    });
    new ResizeObserver(() => this.scatter.resize()).observe(this.scatter.element);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.scatter.draw());
  }

  // Scroll to the card of a row, but never the plot out of sight.
  open(name, byKey) {
    this.scatter.mark(this.rows.numbers.indexOf(name));
    this.card.replaceChildren(cardOf(this.rows, name, () => this.close()));
    if (byKey) this.card.querySelector("button").focus({preventScroll: true});
    const hidden = this.card.getBoundingClientRect().bottom - window.innerHeight;
    const room = this.scatter.element.getBoundingClientRect().top;
    window.scrollBy(0, Math.max(0, Math.min(hidden, room)));
  }

  close() { this.card.replaceChildren(); this.scatter.close(); }

  arrange() {
    this.scatter.show(this.x, this.y);
    this.showRanges();
    this.chosen.show(this.y.role === "output" ? this.y : this.rows.outputs[0]);
  }

  // Ranges of the columns drawn, and of those that were chosen before.
  showRanges() {
    for (const range of this.ranges) {
      const {column, element} = range;
      element.hidden = column !== this.x && column !== this.y && !this.selection.ranges.has(column);
      range.show();
    }
    this.clear.disabled = this.selection.isAll;
  }
}
