// Counts matrix, bars, chart, ranking and results again, from the episodes that the filters leave.
(() => {
  "use strict";
  const { all, mean, sum, fixed } = remac;
  const ALL = "all tasks";
  const LEVEL = 0.05;

  const there = () => remac.episodes.filter((each) => each.counts && each.scored && each.there);
  const of = (episodes, { agent, setting, task }) =>
    episodes.filter((each) => each.facts.agent === agent && each.facts.setting === setting && (task === undefined || task === ALL || each.facts.task === task));
  // With a filter on results or blame, what is counted is not success but those.
  const counted = (each) => (remac.view.outcome ? each.hit : each.won);
  const share = (episodes) => {
    if (!episodes.length) return {};
    const hits = episodes.filter(counted).length;
    const [low, high] = remac.wilson(hits, episodes.length);
    return { text: `${fixed((100 * hits) / episodes.length)}%`, value: hits / episodes.length, low, high, note: `${hits} of ${episodes.length}` };
  };
  const percent = (value) => (value === undefined ? {} : { text: `${fixed(100 * value)}%`, value });
  const number = (value, digits = 1) => (value === undefined ? {} : { text: fixed(value, digits), value });

  // What the server wrote comes back when no filter is left.
  const NAMES = ["class", "title", "data-value", "data-low", "data-high"];
  const kept = new Map();
  const keep = (cell) => {
    if (!kept.has(cell)) kept.set(cell, { names: NAMES.map((name) => cell.getAttribute(name)), inside: [...cell.childNodes].map((node) => node.cloneNode(true)) });
  };
  const restore = () => {
    for (const [cell, { names, inside }] of kept) {
      NAMES.forEach((name, index) => { if (names[index] === null) cell.removeAttribute(name); else cell.setAttribute(name, names[index]); });
      cell.replaceChildren(...inside.map((node) => node.cloneNode(true)));
    }
  };
  const set = (cell, name, value) => { if (value === undefined) cell.removeAttribute(name); else cell.setAttribute(name, value); };
  const show = (cell, { text = "-", value, low, high, note }) => {
    keep(cell);
    set(cell, "data-value", value ?? low);
    set(cell, "data-low", low);
    set(cell, "data-high", high);
    set(cell, "title", note);
    cell.querySelector(".cell").textContent = text;
    const span = cell.querySelector(".span");
    if (span) span.textContent = low === undefined ? "" : `${fixed(100 * low)}\u2013${fixed(100 * high)}`;
    const plot = cell.querySelector(".interval");
    if (plot) {
      plot.toggleAttribute("hidden", value === undefined);
      const at = (part) => 4 + 76 * (part ?? 0);
      set(plot.querySelector(".dot"), "cx", at(value));
      set(plot.querySelector(".range"), "x1", at(low));
      set(plot.querySelector(".range"), "x2", at(high));
    }
    if (cell.closest(".matrix")) remac.heat(cell);
  };
  remac.heat = (cell) => {
    for (let step = 0; step <= 5; step += 1) cell.classList.toggle(`heat-${step}`, cell.dataset.value !== undefined && Math.round(5 * Number(cell.dataset.value)) === step);
  };
  const tables = (kind) => all(`table[data-sheet^=${kind}]`);
  const column = (table, row, key) => {
    const head = table.querySelector(`th[data-key="${key}"]`);
    return head ? row.cells[head.cellIndex] : null;
  };

  // A task of which nothing is left; and all of them, where one is left.
  const isGone = (episodes, task) => {
    const tasks = new Set(episodes.map((each) => each.facts.task));
    return task === ALL ? tasks.size < 2 : !tasks.has(task);
  };

  const matrix = (episodes) => {
    for (const table of tables("matrix")) {
      const heads = all("th[data-task]", table);
      for (const head of heads) head.hidden = isGone(episodes, head.dataset.task);
      for (const row of all("tbody tr", table)) {
        const own = of(episodes, row.dataset);
        row.hidden = !own.length;
        for (const head of heads) {
          const cell = row.cells[head.cellIndex];
          cell.hidden = head.hidden;
          show(cell, share(of(own, { ...row.dataset, task: head.dataset.task })));
        }
      }
    }
    for (const task of all(".bars .task")) {
      task.hidden = isGone(episodes, task.dataset.task);
      for (const bar of all(".line", task)) {
        const own = of(episodes, { ...bar.dataset, task: task.dataset.task });
        const { text = "-", value = 0, low = 0, high = 0 } = share(own);
        bar.hidden = !own.length;
        set(bar.querySelector(".full"), "width", 100 * value);
        set(bar.querySelector(".range"), "x1", 100 * low);
        set(bar.querySelector(".range"), "x2", 100 * high);
        bar.querySelector(".figure").textContent = text;
      }
    }
  };

  const ranking = (episodes) => {
    for (const table of tables("ranking")) {
      const rows = all("tbody tr", table);
      const groups = rows.map((row) => of(episodes, row.dataset));
      const pairs = [];
      groups.forEach((one, first) => groups.slice(first + 1).forEach((other, index) => {
        const found = one.length && other.length ? remac.pair(one, other) : null;
        if (found) pairs.push({ ...found, first, second: first + 1 + index });
      }));
      const adjusted = remac.holm(pairs.map(({ p }) => p));
      const behind = pairs.map(({ difference, first, second }, index) => (adjusted[index] < LEVEL && difference ? (difference > 0 ? [second, first] : [first, second]) : []));
      rows.forEach((row, index) => {
        const own = groups[index];
        const better = behind.filter(([worse]) => worse === index).map(([, other]) => rows[other].dataset.agent).sort();
        // Nobody is first who solved nothing.
        const ranked = !remac.view.outcome && (better.length || own.some((each) => each.won));
        row.hidden = !own.length;
        const cells = {
          n: number(own.length, 0), tsr: share(own), problems: number(new Set(own.map((each) => each.problem)).size, 0),
          rank: ranked ? number(1 + better.length, 0) : {}, better: remac.view.outcome ? {} : { ...number(better.length, 0), note: better.join(", ") || undefined },
        };
        for (const [key, told] of Object.entries(cells)) if (column(table, row, key)) show(column(table, row, key), told);
      });
    }
  };

  const results = (episodes) => {
    for (const table of tables("results")) {
      for (const row of all("tbody tr", table)) {
        const own = of(episodes, row.dataset);
        row.hidden = !own.length || isGone(episodes, row.dataset.task);
        const tsr = share(own);
        const cells = { n: number(own.length, 0), problems: number(new Set(own.map((each) => each.problem)).size, 0), tsr };
        cells.interval = tsr.text ? { text: `${fixed(100 * tsr.low)}-${fixed(100 * tsr.high)}%`, low: tsr.low, high: tsr.high } : {};
        cells.crashed = number(own.filter((each) => each.crash).length, 0);
        const won = own.filter((each) => each.won);
        const known = remac.view.outcome ? [] : won;
        for (const [key, name] of [["seconds", "seconds"], ["ipl", "ipl"], ["fpl", "fpl"]]) cells[key] = number(mean(known.map((each) => each[name])));
        cells.scr = remac.view.outcome ? {} : percent(completion(own));
        for (const [key, told] of Object.entries(cells)) if (column(table, row, key)) show(column(table, row, key), told);
      }
    }
  };
  const completion = (own) => {
    const planned = own.filter((each) => each.fpl !== undefined);
    const usual = mean(planned.map((each) => each.fpl)) ?? 0;
    const length = sum(planned.map((each) => each.fpl)) + usual * own.filter((each) => each.crash && each.fpl === undefined).length;
    return length ? sum(planned.map((each) => each.done)) / length : undefined;
  };

  const chart = (episodes) => {
    for (const plot of all("svg.scatter")) {
      const [left, right, top, bottom] = plot.dataset.margins.split(" ").map(Number);
      const [width, height] = [plot.viewBox.baseVal.width, plot.viewBox.baseVal.height];
      const dots = all(".entry", plot).map((dot) => ({ dot, own: of(episodes, dot.dataset) })).map((each) => ({ ...each, cost: costOf(each.own, plot.dataset.cost) }));
      const most = Math.max(0, ...dots.map(({ cost }) => cost ?? 0)) || 1;
      const y = (part) => height - bottom - (height - top - bottom) * part;
      for (const { dot, own, cost } of dots) {
        dot.toggleAttribute("hidden", cost === undefined);
        if (cost === undefined) continue;
        const { value, low, high } = share(own);
        const x = left + ((width - left - right) * cost) / most;
        const circle = dot.querySelector("circle");
        const [name, line] = [dot.querySelector("text"), dot.querySelector("line")];
        // Names keep their distance from their dots, on the side where there is room.
        const back = x > width / 2;
        set(name, "x", x + (back ? -9 : 9));
        set(name, "y", y(value) + (value > 0.5 ? 15 : -8));
        set(name, "text-anchor", back ? "end" : "start");
        set(circle, "cx", x);
        set(circle, "cy", y(value));
        for (const end of ["x1", "x2"]) set(line, end, x);
        set(line, "y1", y(low));
        set(line, "y2", y(high));
      }
      const ticks = all(".along", plot);
      ticks.forEach((tick, index) => { tick.textContent = String(Number(((most * index) / (ticks.length - 1)).toPrecision(2))); });
    }
  };
  const costOf = (own, kind) => {
    if (!own.length) return undefined;
    if (kind !== "money") return mean(own.map((each) => (each.won ? each.seconds : each.cap)));
    const jobs = new Set(own.map((each) => each.job));
    const spent = remac.episodes.filter((each) => each.counts && jobs.has(each.job)).map((each) => each.money);
    return spent.includes(undefined) ? undefined : sum(spent) / jobs.size;
  };
  const originals = all("svg.scatter").map((plot) => [plot, [...plot.childNodes].map((node) => node.cloneNode(true))]);

  const recount = () => {
    restore();
    for (const [plot, nodes] of originals) plot.replaceChildren(...nodes.map((node) => node.cloneNode(true)));
    const episodes = there();
    const { any, outcome } = remac.view;
    const empty = any && !episodes.length;
    document.body.classList.toggle("filtered", any);
    document.body.classList.toggle("empty", empty);
    for (const note of all(".recounted")) {
      note.hidden = !any;
      note.textContent = empty ? "The filters leave no episode." : outcome
        ? `Counted again under the filters: the share of episodes whose result or blame is \u201c${outcome}\u201d, in place of success.`
        : `Counted again for the ${episodes.length} episodes that the filters leave${note.dataset.kind === "ranking" ? ", by Holm\u2019s p of the exact test alone" : ""}.`;
    }
    for (const each of all("table.counted [hidden], .bars [hidden]")) each.removeAttribute("hidden");
    if (!any) {
      for (const cell of all("table.matrix td[data-value]")) remac.heat(cell);
      return;
    }
    matrix(episodes);
    ranking(episodes);
    results(episodes);
    chart(episodes);
  };
  remac.listeners.push(recount);
})();
