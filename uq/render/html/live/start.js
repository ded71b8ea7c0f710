// Begin when the page has loaded.

document.addEventListener("DOMContentLoaded", () => {
  const partsIn = id => {
    document.getElementById(id).append(document.getElementById(`${id}-parts`).content);
    return document.getElementById(id);
  };
  const rows = new Rows(JSON.parse(document.getElementById("rows").textContent));
  new Explorer(rows, partsIn("explorer")).arrange();
  if (rows.tolerances) new Tolerances(rows, partsIn("other-tolerances")).update();
});
