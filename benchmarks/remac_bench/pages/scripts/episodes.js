// The episodes of the list at the end of the page, as facts and numbers: all that is counted is counted from them.
(() => {
  "use strict";
  remac.all = (selector, root = document) => [...root.querySelectorAll(selector)];

  remac.episodes = remac.all("#episodes tbody tr").map((row) => ({
    row,
    facts: { ...row.dataset },
    ...JSON.parse(row.dataset.numbers),
    counts: row.dataset.counts === "yes",
    link: row.querySelector("a").getAttribute("href"),
  }));

  const groups = (episodes, key) => {
    const found = new Map();
    for (const each of episodes) {
      const name = key(each);
      if (!found.has(name)) found.set(name, []);
      found.get(name).push(each);
    }
    return found;
  };
  remac.groups = groups;

  // Two agents on the episodes that both have played, of one setting: see remac_bench.judging.ranking.
  remac.pair = (ones, others) => {
    const second = new Map(others.map((each) => [each.episode, each]));
    const shared = ones.map((each) => [each, second.get(each.episode)]).filter(([one, other]) => other && sameStart(one, other));
    if (!shared.length) return null;
    const alike = groups(shared, ([one]) => one.problem);
    const differences = [...alike.values()].map((pairs) => remac.sum(pairs.map(([one, other]) => one.won - other.won)));
    return { shared, difference: remac.sum(differences), problems: alike.size, p: remac.signFlip(differences) };
  };
  const sameStart = (one, other) =>
    one.facts.robots !== other.facts.robots || one.start === undefined || other.start === undefined || one.start === other.start;
})();
