// Filters: what they say stands in the address, and everything on the page follows them.
(() => {
  "use strict";
  const { all } = remac;
  const form = document.querySelector(".filters");
  const fields = all("[data-filter]", form);
  const told = form.querySelector("output");
  // What an episode came to is what is counted; the others say which episodes there are.
  const OUTCOMES = ["result", "blame"];

  const chosen = () => Object.fromEntries(fields.map((field) => [field.dataset.filter, field.value.trim()]).filter(([, text]) => text));
  const known = (name) => new Set(all("option", document.getElementById(`choices-${name}`)).map((option) => option.value));
  const choices = Object.fromEntries(fields.map((field) => [field.dataset.filter, known(field.dataset.filter)]));
  const lower = Object.fromEntries(Object.entries(choices).map(([name, each]) => [name, new Set([...each].map((text) => text.toLowerCase()))]));

  // A name that there is means itself; other words mean every name that holds one of them.
  const matches = (name, fact = "", wanted) => {
    if (choices[name].has(wanted)) return fact === wanted;
    const words = wanted.toLowerCase().split(",").map((word) => word.trim()).filter((word) => word);
    return words.some((word) => (lower[name].has(word) ? fact.toLowerCase() === word : fact.toLowerCase().includes(word)));
  };
  const fits = (facts, wanted) => Object.entries(wanted).every(([name, text]) => matches(name, facts[name], text));

  const split = (wanted) => {
    const entries = Object.entries(wanted);
    const isOutcome = ([name]) => OUTCOMES.includes(name);
    return [Object.fromEntries(entries.filter((each) => !isOutcome(each))), Object.fromEntries(entries.filter(isOutcome))];
  };

  // A table that is not counted again leaves out rows by the facts that they have; if it has not all, it says so.
  const filterRows = (wanted) => {
    for (const section of all("section.report")) {
      const rows = all("tbody tr", section);
      for (const row of rows) {
        row.hidden = Object.entries(wanted).some(([name, text]) => row.dataset[name] !== undefined && !matches(name, row.dataset[name], text));
      }
      const blind = Object.keys(wanted).filter((name) => !rows.some((row) => row.dataset[name] !== undefined));
      const note = section.querySelector(".blind");
      note.hidden = !blind.length;
      note.textContent = `This table is of all episodes: ${blind.join(", ")} does not split it.`;
    }
  };

  const apply = () => {
    const wanted = chosen();
    const [where, outcome] = split(wanted);
    for (const each of remac.episodes) {
      each.there = fits(each.facts, where);
      each.hit = fits(each.facts, outcome);
      each.row.hidden = !(each.there && each.hit);
    }
    filterRows(wanted);
    const count = remac.episodes.filter((each) => each.scored && !each.row.hidden).length;
    told.textContent = `${count} scored episode${count === 1 ? "" : "s"}`;
    remac.view = { wanted, any: Object.keys(wanted).length > 0, outcome: Object.values(outcome).join(", ") };
    for (const listener of remac.listeners) listener();
  };
  remac.listeners = [];

  // The address: #task=HeatOnStove&result=success; first and second are the agents that are compared.
  remac.address = {
    read: () => new URLSearchParams(location.hash.includes("=") ? location.hash.slice(1) : ""),
    write: (changes) => {
      const now = remac.address.read();
      for (const [name, text] of Object.entries(changes)) {
        if (text) now.set(name, text); else now.delete(name);
      }
      const hash = now.toString();
      if (hash || location.hash.includes("=")) history.replaceState(null, "", hash ? `#${hash}` : "#");
    },
  };
  const write = () => remac.address.write(Object.fromEntries(fields.map((field) => [field.dataset.filter, field.value.trim()])));
  const read = () => {
    const now = remac.address.read();
    for (const field of fields) field.value = now.get(field.dataset.filter) ?? "";
    apply();
  };

  let waiting;
  for (const field of fields) {
    field.addEventListener("input", () => {
      clearTimeout(waiting);
      waiting = setTimeout(() => { write(); apply(); }, choices[field.dataset.filter].has(field.value) ? 0 : 150);
    });
  }
  form.addEventListener("reset", () => setTimeout(() => { write(); apply(); }));
  form.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", read);
  form.hidden = false;
  remac.start = read;
})();
