// A box that takes the number of a row.

function listenToNumbers(rows, form, open, openElsewhere) {
  const [first, last] = rows.allowed, box = form.querySelector("input"), hint = form.querySelector("[role=status]");
  const places = new Map(Array.from(rows.numbers, (name, row) => [name, row]));
  form.addEventListener("submit", event => {
    event.preventDefault();
    const name = box.valueAsNumber, isAllowed = Number.isInteger(name) && name >= first && name <= last;
    box.setAttribute("aria-invalid", !isAllowed);
    hint.textContent = isAllowed ? "" : `Rows have the numbers ${grouped(first)} to ${grouped(last)}.`;
    if (!isAllowed) box.select();
    else if (places.has(name)) open(places.get(name));
    else openElsewhere(name);
  });
}
