// One row: its inputs, regime and outputs, and the command that computes it again.

function cardOf(rows, row, close) {
  const facts = rows.categories.map(one => [one, one.entry(row).label]);
  const list = pairs => make("dl", {}, ...pairs.flatMap(([one, words]) => [
    make("dt", {title: one.meaning}, ...named(one)), make("dd", {}, words)]));
  const of = role => rows.columns.filter(one => one.role === role).map(one => [one, one.wordsOfRow(row)]);
  return cardWith(rows, rows.numbers[row], close,
    make("div", {class: "facts"},
      make("div", {}, make("h4", {}, "Inputs"), list(of("input"))),
      make("div", {}, make("h4", {}, "Outputs"), list([...facts, ...of("output")]))));
}

// Of a row that the page does not hold: the command alone.
function cardElsewhere(rows, name, close) {
  const part = rows.count < rows.total ? `a random part of ${grouped(rows.total)}` : "those that count in its statistics";
  const words = `Not among the ${grouped(rows.count)} rows in this page, ${part}; the command computes it again.`;
  return cardWith(rows, name, close, make("p", {}, words));
}

function cardWith(rows, name, close, ...contents) {
  const command = `uq row ${rows.file} ${name}${rows.model}`;
  const done = make("span", {role: "status"});
  const copy = make("button", {type: "button", "on:click": () => copied(command, done)}, "Copy");
  return make("div", {class: "card", "data-row": name},
    make("h3", {}, `Row ${name}`),
    make("p", {class: "command"}, make("code", {}, command), " ", copy, " ",
      make("button", {type: "button", "on:click": close}, "Close"), " ", done),
    ...contents);
}

const SHORTLY = 2000; // ms

async function copied(text, done) {
  try {
    await navigator.clipboard.writeText(text);
    done.textContent = "Copied";
    setTimeout(() => { done.textContent = ""; }, SHORTLY);
  } catch {
    done.textContent = "Select the command to copy it.";
  }
}
