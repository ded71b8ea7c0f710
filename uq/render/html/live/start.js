// Begin when the page has loaded.

document.addEventListener("DOMContentLoaded", () => {
  const rows = new Rows(JSON.parse(document.getElementById("rows").textContent));
  document.documentElement.style.setProperty("--limit", rows.colours.limit);
  const explorer = explorerOf(rows);
  document.getElementById("explorer").append(explorer.element);
  explorer.arrange();
  const tolerances = document.getElementById("other-tolerances");
  if (!tolerances) return;
  const found = tolerancesOf(rows);
  tolerances.append(found.element);
  found.update();
});
