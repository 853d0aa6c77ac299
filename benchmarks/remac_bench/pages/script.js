"use strict";
(() => {
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

  // Filters: a row without a fact is not about it and stays.
  const selects = all("select[data-filter]");
  const filter = () => {
    let rows = 0;
    for (const row of all("tbody tr")) {
      row.hidden = selects.some(({ value: wanted, dataset }) => {
        const fact = row.dataset[dataset.filter];
        return wanted && fact !== undefined && fact !== wanted;
      });
      if (!row.hidden && row.closest("#episodes") && !row.classList.contains("unscored")) rows += 1;
    }
    const told = document.querySelector(".filters output");
    if (told) told.textContent = `${rows} scored episodes`;
  };
  for (const select of selects) select.addEventListener("change", filter);
  const form = document.querySelector(".filters");
  if (form) form.addEventListener("reset", () => setTimeout(filter));
  if (form) form.addEventListener("submit", (event) => event.preventDefault());
  if (selects.length) filter();

  const toggle = (selector, name) => {
    for (const box of all(selector)) {
      box.addEventListener("change", () => box.closest("section").classList.toggle(name, box.checked));
      box.closest("section").classList.toggle(name, box.checked);
    }
  };
  toggle("[data-extra]", "all-columns");
  toggle("[data-unscored]", "all-episodes");

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

  // The timeline: bars seek the video, and the playhead goes with it.
  const gantt = document.querySelector(".gantt");
  if (!gantt) return;
  const video = document.querySelector("video");
  const numbers = (text) => (text ? text.split(" ").map(Number) : []);
  const starts = numbers(gantt.dataset.starts);
  const total = starts.at(-1) || 1;
  const times = () => {
    const told = numbers(gantt.dataset.video);
    // Older records do not say when rounds begin in the video: it is then taken for even.
    return told.length === starts.length - 1 ? [...told, video.duration] : starts.map((second) => (second / total) * video.duration);
  };
  const mapped = (x, from, to) => {
    let index = from.findLastIndex((each) => each <= x);
    index = Math.min(Math.max(index, 0), from.length - 2);
    if (from.length < 2) return to[0] ?? 0;
    const width = from[index + 1] - from[index];
    const share = width > 0 ? Math.min(1, (x - from[index]) / width) : 0;
    return to[index] + share * (to[index + 1] - to[index]);
  };
  // Rounds are counted from 0 in `data-round`, and from 1 where people read: headings, links, titles.
  const anchor = (number) => `round-${number + 1}`;
  const mark = (number) => {
    for (const each of all(".round.now, .bar.now")) each.classList.remove("now");
    for (const each of all(`.bar[data-round="${number}"]`)) each.classList.add("now");
    document.getElementById(anchor(number))?.classList.add("now");
  };
  const playhead = gantt.querySelector(".playhead");
  const put = (second) => {
    const x = Number(gantt.dataset.left) + (Number(gantt.dataset.inner) * second) / total;
    playhead.setAttribute("x1", x);
    playhead.setAttribute("x2", x);
    gantt.classList.add("synced");
    const round = starts.slice(0, -1).findLastIndex((each) => each <= second + 1e-6);
    mark(Math.max(round, 0));
  };
  const asked = () => Number((/^#round-(\d+)$/.exec(location.hash) || [])[1] ?? NaN) - 1;
  const seek = (number) => {
    if (!(number >= 0 && number < starts.length - 1)) return;
    if (video && video.readyState > 0) video.currentTime = Math.min(times()[number] + 1e-3, video.duration);
    put(starts[number]);
    mark(number);
  };
  if (video) {
    const follow = () => { if (video.duration) put(mapped(video.currentTime, times(), starts)); };
    const tick = () => { follow(); if (!video.paused) requestAnimationFrame(tick); };
    const begin = () => {
      // A symbolic episode has one or two pictures a round: shown slowly, or nobody sees them.
      video.playbackRate = video.defaultPlaybackRate = Math.min(1, Math.max(0.1, video.duration / (0.6 * Math.max(1, starts.length - 1))));
      seek(asked());
    };
    video.addEventListener("play", tick);
    video.addEventListener("timeupdate", () => { if (!video.paused) follow(); });
    video.addEventListener("ended", follow);
    if (video.readyState > 0) begin(); else video.addEventListener("loadedmetadata", begin);
    for (const bar of all(".bar")) {
      bar.addEventListener("click", (event) => {
        event.preventDefault();
        history.replaceState(null, "", `#${anchor(Number(bar.dataset.round))}`);
        seek(Number(bar.dataset.round));
      });
    }
  }
  window.addEventListener("hashchange", () => seek(asked()));
  seek(asked());
})();
