"use strict";
// Tables sort by a click on a heading, again for the other way round, and are saved as CSV. Without script they stay.
const plainText = text => text.normalize("NFKC").replaceAll("\u2212", "-").replace(/ \u00d7 10(?=-?\d)/g, "e").trim();
const quoted = text => /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
// What the cells of a table show; small print is a column of its own.
function csvOf(table) {
  const rows = [...table.rows], hasMore = column => rows.some(row => row.cells[column].querySelector("small"));
  const textsOf = (cell, column) => {
    const more = cell.querySelector("small")?.textContent ?? "", all = cell.textContent;
    return (hasMore(column) ? [all.slice(0, all.length - more.length), more] : [all]).map(plainText).map(quoted);
  };
  return rows.map(row => [...row.cells].flatMap(textsOf).join(",")).join("\r\n");
}
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], headings = [...table.tHead.rows[0].cells];
  if (table.caption) {
    const save = Object.assign(document.createElement("a"), {href: "#", textContent: "CSV"});
    save.download = `${plainText(table.caption.textContent).replace(/[^\w.=-]+/g, "-")}.csv`;
    save.addEventListener("click", () => { save.href = `data:text/csv;charset=utf-8,${encodeURIComponent(csvOf(table))}`; });
    table.caption.append(save);
  }
  if (body.rows.length < 2) continue;
  headings.forEach((heading, column) => {
    if (!heading.textContent) return;
    const button = Object.assign(document.createElement("button"), {type: "button", textContent: heading.textContent});
    heading.replaceChildren(button);
    const numberIn = row => Number(row.cells[column].dataset.key ?? NaN);
    const inText = (a, b) => a.cells[column].textContent.localeCompare(b.cells[column].textContent, "en", {numeric: true});
    const inOrder = (a, b) => isNaN(numberIn(a)) ? inText(a, b) : numberIn(a) - numberIn(b) || 0;
    const isLast = row => isNaN(numberIn(row)); // what has no number comes last
    button.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      for (const sorted of headings) sorted.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", down > 0 ? "ascending" : "descending");
      body.append(...[...body.rows].sort((a, b) => isLast(a) - isLast(b) || down * inOrder(a, b)));
    });
  });
}
// A link of the contents opens its section; that of the section in sight is marked.
const links = new Map([...document.querySelectorAll("nav a")].map(link => [document.querySelector(link.hash), link]));
const inSight = new IntersectionObserver(entries => {
  for (const {target, isIntersecting} of entries) links.get(target).ariaCurrent = isIntersecting;
}, {rootMargin: "-25% 0px -74%"});
for (const [section, link] of links) {
  inSight.observe(section);
  link.addEventListener("click", () => section.querySelector("details.fold")?.setAttribute("open", ""));
}
