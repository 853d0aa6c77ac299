// Filters: what they say stands in the address, and everything on the page follows them.
(() => {
  "use strict";
  const { all } = remac;
  const form = document.querySelector(".filters");
  const fields = all("[data-filter]", form);
  const told = form.querySelector("output");
  const fold = form.querySelector(".fold");
  // What an episode came to is what is counted; the others say which episodes there are.
  const OUTCOMES = ["result", "blame"];
  // The agents that are compared stand in the address, too.
  const SIDES = ["first", "second"];

  const chosen = () => Object.fromEntries(fields.map((field) => [field.dataset.filter, field.value.trim()]).filter(([, text]) => text));
  const known = (name) => new Set(all("option", document.getElementById(`choices-${name}`)).map((option) => option.value));
  const choices = Object.fromEntries(fields.map((field) => [field.dataset.filter, known(field.dataset.filter)]));
  const lower = Object.fromEntries(Object.entries(choices).map(([name, each]) => [name, new Set([...each].map((text) => text.toLowerCase()))]));

  // A name that there is means itself; other words mean every name that holds one of them.
  const wordsOf = (wanted) => wanted.toLowerCase().split(",").map((word) => word.trim()).filter((word) => word);
  const matches = (name, fact = "", wanted) => {
    if (choices[name].has(wanted)) return fact === wanted;
    const words = wordsOf(wanted);
    return words.some((word) => (lower[name].has(word) ? fact.toLowerCase() === word : fact.toLowerCase().includes(word)));
  };
  const fits = (facts, wanted) => Object.entries(wanted).every(([name, text]) => matches(name, facts[name], text));

  // Words that nothing here holds: a filter that leaves no episode says why.
  const strangers = (name, wanted) => {
    if (choices[name].has(wanted)) return [];
    const names = [...lower[name]];
    return wordsOf(wanted).filter((word) => !names.some((each) => each.includes(word)));
  };

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
      note.textContent = `This table is of all episodes: it is not split by ${blind.join(", ")}.`;
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
    remac.address.say(Object.entries(wanted).flatMap(([name, text]) => strangers(name, text).map((word) => [`No ${name} here is called`, word])));
    const count = remac.episodes.filter((each) => each.scored && !each.row.hidden).length;
    told.textContent = `${count} scored episode${count === 1 ? "" : "s"}`;
    remac.view = { wanted, any: Object.keys(wanted).length > 0, outcome: Object.values(outcome).join(", ") };
    for (const listener of remac.listeners) listener();
  };
  remac.listeners = [];
  remac.readers = [];

  // On a phone the fields would fill the first screen: they are shown where one is in use, or asked for.
  const unfold = (open) => { form.classList.toggle("folded", !open); fold.setAttribute("aria-expanded", String(open)); };
  fold.addEventListener("click", () => unfold(form.classList.contains("folded")));

  const write = () => remac.address.write(Object.fromEntries(fields.map((field) => [field.dataset.filter, field.value.trim()])));
  const read = () => {
    const now = remac.address.read([...Object.keys(choices), ...SIDES]);
    for (const field of fields) field.value = now[field.dataset.filter] ?? "";
    for (const reader of remac.readers) reader(now);
    if (Object.keys(chosen()).length) unfold(true);
    apply();
  };

  let waiting;
  for (const field of fields) {
    field.addEventListener("input", () => {
      clearTimeout(waiting);
      waiting = setTimeout(() => { write(); apply(); }, choices[field.dataset.filter].has(field.value) ? 0 : 150);
    });
  }
  form.addEventListener("reset", () => setTimeout(() => { remac.address.forget(SIDES); apply(); }));
  form.addEventListener("submit", (event) => event.preventDefault());
  window.addEventListener("hashchange", read);
  form.hidden = false;
  remac.start = read;
})();
