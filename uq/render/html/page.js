"use strict";
// Tables sort by a click on a heading, again for the other way round. Without script they stay.
for (const table of document.querySelectorAll("table")) {
  const body = table.tBodies[0];
  if (body.rows.length < 2) continue;
  [...table.tHead.rows[0].cells].forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = heading.textContent;
    heading.replaceChildren(button);
    button.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
      for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", down > 0 ? "ascending" : "descending");
      const key = row => Number(row.cells[column].dataset.key ?? NaN);
      const text = row => row.cells[column].textContent;
      const compare = (a, b) => {
        const [x, y] = [key(a), key(b)];
        if (isNaN(x) && isNaN(y)) return down * text(a).localeCompare(text(b), "en", {numeric: true});
        if (isNaN(x) || isNaN(y)) return isNaN(x) - isNaN(y); // what has no number comes last
        return x === y ? 0 : down * (x < y ? -1 : 1);
      };
      body.append(...[...body.rows].sort(compare));
    });
  });
}
