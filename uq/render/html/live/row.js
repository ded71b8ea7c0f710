// One row: its inputs, regime and outputs, and the command that computes it again.

function cardOf(rows, row, close) {
  const facts = rows.categories.map(category => [category, category.entry(row).label]);
  const factsOf = role => rows.columns.filter(column => column.role === role)
    .map(column => [column, column.wordsOfRow(row)]);
  const listOf = (title, pairs) => make("div", {}, make("h4", {}, title), make("dl", {}, ...pairs.flatMap(
    ([column, words]) => [make("dt", {title: column.meaning}, ...named(column)), make("dd", {}, words)])));
  return cardWith(rows, rows.numbers[row], close, make("div", {class: "facts"},
    listOf("Inputs", factsOf("input")), listOf("Outputs", [...facts, ...factsOf("output")])));
}

// Of a row that the page does not hold: the command alone.
function cardElsewhere(rows, name, close) {
  const part = rows.count < rows.total ? `a random part of ${grouped(rows.total)}` : "those that count in its statistics";
  const words = `Not among the ${grouped(rows.count)} rows in this page, ${part}; the command computes it again.`;
  return cardWith(rows, name, close, make("p", {}, words));
}

function cardWith(rows, name, close, ...contents) {
  const command = `uq row ${rows.file} ${name}${rows.model}`, [copy, done] = copyButton(() => command);
  return make("div", {class: "card", "data-row": name},
    make("h3", {}, `Row ${name}`),
    make("p", {class: "command"}, make("code", {}, command), " ", copy, " ",
      make("button", {type: "button", "on:click": close}, "Close"), " ", done),
    ...contents);
}
