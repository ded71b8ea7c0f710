// Begin when the page has loaded.

function partsIn(id) {
  const place = document.getElementById(id);
  place.append(document.getElementById(`${id}-parts`).content);
  return place;
}

document.addEventListener("DOMContentLoaded", () => {
  const rows = new Rows(JSON.parse(document.getElementById("rows").textContent));
  document.documentElement.style.setProperty("--limit", rows.colours.limit);
  new Explorer(rows, partsIn("explorer")).arrange();
  if (rows.tolerances) new Tolerances(rows, partsIn("other-tolerances")).update();
});
