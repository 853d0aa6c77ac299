(() => {
  "use strict";
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];

  // Copying: what is shown, as it is shown; in CSV numbers with all their digits.
  const seen = (cell) => getComputedStyle(cell).display !== "none";
  const plain = (cell) => cell.textContent.trim().replace(/\s+/g, " ");
  const guard = (text) => (/^[=+\-@\t\r]/.test(text) && text !== "-" ? `'${text}` : text);
  const quote = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const exact = (cell) => (cell.dataset.low === undefined && cell.dataset.value !== undefined ? cell.dataset.value : guard(plain(cell)));
  const parts = (cell) => (cell.dataset.low === undefined ? [exact(cell)] : [cell.dataset.value ?? "", cell.dataset.low, cell.dataset.high]);
  const heads = (cell, ranged) => (ranged ? [plain(cell), `${plain(cell)} low`, `${plain(cell)} high`] : [plain(cell)]);
  const csv = (table, rows) => {
    const at = [...table.tHead.rows[0].cells].filter(seen);
    const ranged = at.map((head) => rows.some((row) => row.cells[head.cellIndex].dataset.low !== undefined));
    const first = at.flatMap((head, index) => heads(head, ranged[index]));
    const rest = rows.map((row) => at.flatMap((head, index) => {
      const made = parts(row.cells[head.cellIndex]);
      return ranged[index] && made.length === 1 ? [...made, "", ""] : made;
    }));
    return [first, ...rest].map((line) => line.map(quote).join(",")).join("\n") + "\n";
  };
  const markdown = (table, rows) => {
    const safe = (cell) => plain(cell).replaceAll("|", "\\|").replaceAll("<", "&lt;");
    const at = [...table.tHead.rows[0].cells].filter(seen);
    const rule = at.map((head) => (head.classList.contains("num") ? "---:" : "---"));
    const lines = rows.map((row) => at.map((head) => safe(row.cells[head.cellIndex])));
    return [at.map(safe), rule, ...lines].map((line) => `| ${line.join(" | ")} |`).join("\n") + "\n";
  };
  const fallback = (text) => {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    const done = document.execCommand("copy");
    area.remove();
    return done;
  };
  for (const button of all("[data-copy]")) {
    const title = button.textContent;
    button.addEventListener("click", async () => {
      const table = button.closest("section").querySelector("table");
      const rows = all("tbody tr", table).filter(seen);
      const text = (button.dataset.copy === "csv" ? csv : markdown)(table, rows);
      let done = true;
      try { await navigator.clipboard.writeText(text); } catch { done = fallback(text); }
      button.textContent = done ? "Copied" : "The browser refused";
      setTimeout(() => { button.textContent = title; }, 1500);
    });
  }
})();
