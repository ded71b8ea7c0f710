// Begin when the page has loaded.

document.addEventListener("DOMContentLoaded", () => {
  const rows = new Rows(JSON.parse(document.getElementById("rows").textContent));
  const explorer = explorerOf(rows);
  document.getElementById("explorer").append(explorer.element);
  explorer.arrange();
});
