// One row: its inputs, regime and outputs, and the command that computes it again.

function cardOf(rows, name, close) {
  const command = `uq row ${rows.file} ${name}${rows.model}`, [copy, done] = copyButton(() => command);
  const row = rows.numbers.indexOf(name);
  return make("div", {class: "card", "data-row": name},
    make("h3", {}, `Row ${name}`),
    make("p", {class: "command"}, make("code", {}, command), " ", copy, " ",
      make("button", {type: "button", "on:click": close}, "Close"), " ", done),
    row < 0 ? make("p", {}, rows.absence) : factsOf(rows, row));
}

function factsOf(rows, row) {
  const categories = rows.categories.map(category => [category, category.entries[category.places[row]].label]);
  const columnsOf = role => rows.columns.filter(column => column.role === role)
    .map(column => [column, column.wordsOfRow(row)]);
  const listOf = (title, pairs) => make("div", {}, make("h4", {}, title), make("dl", {}, ...pairs.flatMap(
    ([column, words]) => [make("dt", {title: column.meaning}, ...named(column)), make("dd", {}, words)])));
  return make("div", {class: "facts"},
    listOf("Inputs", columnsOf("input")), listOf("Outputs", [...categories, ...columnsOf("output")]));
}

// The box that takes the number of a row.
function listenToNumbers(rows, form, open) {
  const [first, last] = rows.allowed, box = form.querySelector("input"), hint = form.querySelector("[role=status]");
  form.addEventListener("submit", event => {
    event.preventDefault();
    const name = box.valueAsNumber, isAllowed = Number.isInteger(name) && name >= first && name <= last;
    box.setAttribute("aria-invalid", !isAllowed);
    hint.textContent = isAllowed ? "" : `Rows have the numbers ${grouped(first)} to ${grouped(last)}.`;
    if (isAllowed) open(name);
    else box.select();
  });
}
