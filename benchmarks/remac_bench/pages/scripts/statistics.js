// The statistics of remac_bench.judging.statistics, for what the filters leave.
const remac = {};
(() => {
  "use strict";
  const Z = 1.959964;

  remac.wilson = (won, n) => {
    const [rate, squared] = [won / n, Z * Z];
    const middle = (rate + squared / (2 * n)) / (1 + squared / n);
    const half = (Z / (1 + squared / n)) * Math.sqrt((rate * (1 - rate)) / n + squared / (4 * n * n));
    return [won === 0 ? 0 : middle - half, won === n ? 1 : middle + half];
  };

  // Neumaier's sum: what rounding takes is kept apart, so that the order of the values does not show.
  remac.sum = (values) => {
    let [total, lost] = [0, 0];
    for (const each of values) {
      const next = total + each;
      lost += Math.abs(total) >= Math.abs(each) ? total - next + each : each - next + total;
      total = next;
    }
    return total + lost;
  };
  remac.mean = (values) => {
    const known = values.filter((each) => each !== undefined);
    return known.length ? remac.sum(known) / known.length : undefined;
  };

  // Exact two-sided p of the sign-flip test; `differences`: a whole number for each problem.
  remac.signFlip = (differences) => {
    const sizes = differences.map(Math.abs).filter((each) => each);
    const span = remac.sum(sizes);
    let chances = new Array(2 * span + 1).fill(0);
    chances[span] = 1;
    for (const size of sizes) {
      const before = chances;
      chances = before.map((_, at) => 0.5 * ((before[at - size] ?? 0) + (before[at + size] ?? 0)));
    }
    const far = Math.abs(remac.sum(differences));
    return Math.min(1, remac.sum(chances.slice(0, span - far + 1)) + remac.sum(chances.slice(span + far)));
  };

  // Holm's adjusted p, in the order of the values.
  remac.holm = (values) => {
    const order = values.map((_, index) => index).sort((a, b) => values[a] - values[b]);
    const adjusted = new Array(values.length).fill(1);
    let worst = 0;
    order.forEach((index, rank) => {
      worst = Math.max(worst, Math.min(1, (values.length - rank) * values[index]));
      adjusted[index] = worst;
    });
    return adjusted;
  };

  // Numbers as the tables write them: a tie goes to the even digit.
  remac.fixed = (value, digits = 0) => {
    const scaled = value * 10 ** digits;
    const tie = Number.isInteger(value * 2 ** (digits + 1)) && Math.abs(scaled % 1) === 0.5;
    return tie ? (2 * Math.round(scaled / 2) / 10 ** digits).toFixed(digits) : value.toFixed(digits);
  };
})();
