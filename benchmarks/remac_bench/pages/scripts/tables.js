(() => {
  "use strict";
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];

  // Sorting: a click on a heading, or Enter or Space on it.
  const value = (cell) => (cell.dataset.value === undefined ? null : Number(cell.dataset.value));
  const compare = (one, other) => {
    const [a, b] = [value(one), value(other)];
    if (a !== null && b !== null) return a - b;
    return one.textContent.trim().localeCompare(other.textContent.trim(), "en", { numeric: true });
  };
  const missing = (cell) => cell.dataset.value === undefined && ["-", "\u2013"].includes(cell.textContent.trim());
  for (const button of all(".sort")) {
    button.addEventListener("click", () => {
      const head = button.closest("th");
      const table = head.closest("table");
      const numeric = head.classList.contains("num");
      const order = { ascending: "descending", descending: "ascending" }[head.ariaSort] || (numeric ? "descending" : "ascending");
      for (const other of all("th", table)) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", order);
      const at = head.cellIndex;
      const sign = order === "ascending" ? 1 : -1;
      const rows = all("tbody tr", table);
      rows.sort((a, b) => missing(a.cells[at]) - missing(b.cells[at]) || sign * compare(a.cells[at], b.cells[at]));
      table.tBodies[0].append(...rows);
    });
  }

  const toggle = (selector, name) => {
    for (const box of all(selector)) {
      box.addEventListener("change", () => box.closest("section").classList.toggle(name, box.checked));
      box.closest("section").classList.toggle(name, box.checked);
    }
  };
  toggle("[data-extra]", "all-columns");
  toggle("[data-unscored]", "all-episodes");
})();
