// A box that takes the number of a row.

function rowByNumber(rows, open, openElsewhere) {
  const [first, last] = rows.allowed, hint = make("span", {id: "row-hint", role: "status"});
  const box = make("input", {
    type: "number", min: first, max: last, step: 1, inputmode: "numeric", "aria-describedby": "row-hint",
  });
  const places = new Map(Array.from(rows.numbers, (name, row) => [name, row]));

  function show(event) {
    event.preventDefault();
    const name = box.valueAsNumber, isAllowed = Number.isInteger(name) && name >= first && name <= last;
    box.setAttribute("aria-invalid", !isAllowed);
    hint.textContent = isAllowed ? "" : `Rows have the numbers ${grouped(first)} to ${grouped(last)}.`;
    if (!isAllowed) box.select();
    else if (places.has(name)) open(places.get(name));
    else openElsewhere(name);
  }

  return make("form", {class: "by-number", novalidate: true, "on:submit": show},
    make("label", {}, "Row ", box), " ", make("button", {}, "Show"), " ", hint);
}
