(() => {
  "use strict";
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];

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
    for (const each of bars) if (!("begins" in each.dataset) && each.dataset.round === String(number)) each.classList.add("now");
    document.getElementById(anchor(number))?.classList.add("now");
  };
  // By the event clock bars begin and end when they do, not with the decision point that is shown.
  const bars = all(".bar");
  const during = (second) => {
    for (const { dataset, classList } of bars) {
      if ("begins" in dataset) classList.toggle("now", Number(dataset.begins) <= second + 1e-6 && second + 1e-6 < Number(dataset.ends));
    }
  };
  const playhead = gantt.querySelector(".playhead");
  const put = (second) => {
    const x = Number(gantt.dataset.left) + (Number(gantt.dataset.inner) * second) / total;
    playhead.setAttribute("x1", x);
    playhead.setAttribute("x2", x);
    gantt.classList.add("synced");
    const round = starts.slice(0, -1).findLastIndex((each) => each <= second + 1e-6);
    mark(Math.max(round, 0));
    during(second);
  };
  const asked = () => Number((/^#round-(\d+)$/.exec(location.hash) || [])[1] ?? NaN) - 1;
  const seek = (number, second = starts[number]) => {
    if (!(number >= 0 && number < starts.length - 1)) return;
    if (video && video.readyState > 0) video.currentTime = Math.min(mapped(second, starts, times()) + 1e-3, video.duration);
    put(second);
    mark(number);
    during(second);
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
    for (const bar of bars) {
      bar.addEventListener("click", (event) => {
        event.preventDefault();
        history.replaceState(null, "", `#${anchor(Number(bar.dataset.round))}`);
        seek(Number(bar.dataset.round), bar.dataset.begins && Number(bar.dataset.begins));
      });
    }
  }
  window.addEventListener("hashchange", () => seek(asked()));
  seek(asked());
})();
