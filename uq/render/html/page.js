"use strict";
// Tables sort by a click on a heading, again for the other way round. Without script they stay.
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0], headings = [...table.tHead.rows[0].cells];
  if (body.rows.length < 2) continue;
  headings.forEach((heading, column) => {
    const button = Object.assign(document.createElement("button"), {type: "button", textContent: heading.textContent});
    heading.replaceChildren(button);
    const compare = (a, b, down) => {
      const [first, second] = [a, b].map(row => row.cells[column]);
      const [x, y] = [first, second].map(cell => Number(cell.dataset.key ?? NaN));
      if (isNaN(x) && isNaN(y)) return down * first.textContent.localeCompare(second.textContent, "en", {numeric: true});
      return isNaN(x) || isNaN(y) ? isNaN(x) - isNaN(y) : down * (x - y || 0); // what has no number comes last
    };
    button.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      for (const sorted of headings) sorted.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", down > 0 ? "ascending" : "descending");
      body.append(...[...body.rows].sort((a, b) => compare(a, b, down)));
    });
  });
}
