// Two agents side by side, episode by episode. The last of the leaderboard's scripts: it starts what listens.
(() => {
  "use strict";
  const { all } = remac;
  const section = document.getElementById("compare");
  const MOST = 2000;
  const sides = section ? all("select", section) : [];
  const differing = section?.querySelector("[data-differing]");

  const made = (tag, text, classes = "") => {
    const node = document.createElement(tag);
    node.textContent = text;
    node.className = classes;
    return node;
  };
  const isolated = (text) => made("bdi", text);
  const result = (each) => {
    const cell = document.createElement("td");
    const link = made("a", "", `pill ${each.won ? "good" : "bad"}`);
    link.textContent = each.facts.result;
    link.setAttribute("href", each.link);
    cell.append(link);
    return cell;
  };
  const rounds = (each) => {
    const cell = made("td", each.won ? each.row.dataset.rounds : "\u2013", "num wide");
    if (each.won) cell.dataset.value = each.row.dataset.rounds;
    return cell;
  };

  const line = ([one, other]) => {
    const row = document.createElement("tr");
    const facts = one.facts;
    const first = document.createElement("td");
    first.append(isolated(facts.task), made("small", ` seed ${one.row.dataset.seed}`));
    const where = made("td", "", "wide");
    where.append(isolated([facts.style, facts.layout].filter((part) => part).join(", ") || "\u2013"));
    row.append(first, where, result(one), rounds(one), result(other), rounds(other));
    return row;
  };

  const side = (agent, setting) => remac.episodes.filter((each) => each.counts && each.scored && each.there && each.facts.agent === agent && each.facts.setting === setting);
  const compare = () => {
    const [first, second] = sides.map((select) => select.value);
    const settings = [...new Set(remac.episodes.map((each) => each.facts.setting))].sort();
    const found = first === second ? [] : settings.map((setting) => remac.pair(side(first, setting), side(second, setting))).filter((each) => each);
    const shared = found.flatMap((each) => each.shared).filter(([one, other]) => one.hit || other.hit);
    const lines = shared.filter(([one, other]) => !differing.checked || one.won !== other.won);
    const count = (test) => shared.filter(([one, other]) => test(one.won, other.won)).length;
    const told = section.querySelector(".told");
    if (!shared.length) {
      told.textContent = first === second ? "Choose two agents." : "They share no episode that the filters leave.";
    } else {
      const p = found.length === 1 && !remac.view.outcome ? ` The exact sign-flip test over ${found[0].problems} problems gives p = ${found[0].p < 0.001 ? "<0.001" : found[0].p.toFixed(3)}, not corrected for other comparisons.` : "";
      told.textContent = `Of ${shared.length} shared episodes, ${count((a, b) => a && b)} were solved by both, ${count((a, b) => a && !b)} by the first alone, ${count((a, b) => b && !a)} by the second alone and ${count((a, b) => !a && !b)} by neither.${p}`;
    }
    const table = section.querySelector("table");
    table.hidden = !lines.length;
    for (const head of all("th", table)) head.removeAttribute("aria-sort");
    all("th.first .sort", table).forEach((head) => { head.textContent = first; });
    all("th.second .sort", table).forEach((head) => { head.textContent = second; });
    table.tBodies[0].replaceChildren(...lines.slice(0, MOST).map(line));
    section.querySelector(".more").textContent = lines.length > MOST ? `and ${lines.length - MOST} more` : "";
  };

  if (section) {
    sides.forEach((select) => select.addEventListener("change", () => { remac.address.write({ [select.dataset.side]: select.value }); compare(); }));
    remac.readers.push((now) => sides.forEach((select, index) => {
      const wanted = now[select.dataset.side];
      const names = all("option", select).map((option) => option.value);
      if (wanted && !names.includes(wanted)) remac.address.wrong("No agent here is called", wanted);
      select.value = names.includes(wanted) ? wanted : names[index];
    }));
    differing.addEventListener("change", compare);
    section.hidden = false;
    remac.listeners.push(compare);
  }
  remac.start();
})();
