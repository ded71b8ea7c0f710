// What the page shows of its rows: chips, scatter plot, ranges, what is known of the chosen rows, and one row.

function explorerOf(rows) {
  const selection = new Selection(rows), found = new Found(selection);
  const {columns} = rows, outputs = columns.filter(one => one.role === "output");
  let x = columns[rows.first[0]], y = columns[rows.first[1]];
  const card = make("div", {"aria-live": "polite"});
  const scatter = new Scatter(selection, columns, (row, byKey) => {
    present(cardOf(rows, row, close));
    if (byKey) card.querySelector("button").focus({preventScroll: true});
  });
  const byNumber = rowByNumber(rows, row => scatter.open(row), name => {
    scatter.mark(-1);
    present(cardElsewhere(rows, name, close));
  });
  const ranges = new Map(), shelf = make("div", {class: "ranges"});

  const chooser = (label, chosen, choose) => make("label", {}, `${label} `,
    make("select", {"on:change": event => choose(columns[event.target.value])},
      ...["input", "output"].map(role => make("optgroup", {label: `${role}s`}, ...columns.flatMap((one, place) =>
        one.role === role ? [make("option", {value: place, selected: one === chosen, title: one.meaning}, one.title)] : [])))));

  function present(shown) {
    card.replaceChildren(shown);
    reveal();
  }

  // Scroll to the card, but never the plot out of sight.
  function reveal() {
    const hidden = card.getBoundingClientRect().bottom - window.innerHeight;
    const room = scatter.element.getBoundingClientRect().top;
    window.scrollBy(0, Math.max(0, Math.min(hidden, room)));
  }

  function close() {
    card.replaceChildren();
    scatter.close();
  }

  function arrange() {
    scatter.show(x, y);
    showRanges();
    found.show(y.role === "output" ? y : outputs[0]);
  }

  // Ranges of the columns drawn, and of those that were chosen before.
  function showRanges() {
    const shown = [...new Set([x, y, ...selection.ranges.keys()])];
    for (const one of shown) if (!ranges.has(one)) ranges.set(one, rangeOf(selection, one));
    const elements = shown.map(one => ranges.get(one).element);
    if (elements.some((one, i) => one !== shelf.children[i]) || elements.length !== shelf.children.length) {
      const focused = document.activeElement;
      shelf.replaceChildren(...elements);
      if (shelf.contains(focused)) focused.focus();
    }
    for (const one of shown) ranges.get(one).show();
  }

  const chips = rows.categories.filter(one => one.entries.length > 1).map(category => {
    const buttons = category.entries.map(({code, label, colour, count}) => {
      const chip = make("button", {type: "button", class: "chip", "on:click": () => selection.toggle(category, code)},
        ...dotOf(colour), `${label} (${grouped(count)})`);
      selection.listeners.push(() => press());
      const press = () => chip.setAttribute("aria-pressed", selection.shows(category, code));
      press();
      return chip;
    });
    return make("div", {class: "chips", role: "group", "aria-label": category.label}, `${category.label} `, ...buttons);
  });

  const hint = make("p", {class: "note"}, "Click one to exclude or include its rows.");
  const clear = make("button", {type: "button", class: "clear", "on:click": () => selection.clear()}, "Choose all rows");
  selection.listeners.push(showRanges, () => { clear.disabled = selection.isAll; });
  clear.disabled = true;
  const keys = make("p", {class: "note", id: "keys"}, "Drag over points to choose rows, or move the handles; click"
    + " a point to see its row, or give its number. On the plot, the arrow keys go from row to row, Enter opens one, and"
    + " Escape closes it.");
  const element = make("div", {},
    make("div", {class: "explorer"},
      make("div", {}, ...chips, ...(chips.length ? [hint] : []), chooser("Vertical:", y, one => { y = one; arrange(); }), scatter.element,
        chooser("Horizontal:", x, one => { x = one; arrange(); }), byNumber, card, keys, shelf, clear),
      found.element));
  document.addEventListener("keydown", event => { // a click on what takes no focus leaves it to the page
    const isHere = element.contains(event.target) || event.target === document.body;
    if (event.key === "Escape" && isHere && card.hasChildNodes()) close();
  });
  new ResizeObserver(() => scatter.resize()).observe(scatter.element);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => scatter.draw());
  return {element, arrange};
}
