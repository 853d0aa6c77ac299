// How far a run is, asked of the server that serves this page.
(() => {
  "use strict";
  const EVERY = 2000;
  const told = document.getElementById("live");
  const made = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });

  // The token of the address is in a cookie by now: it need not be seen, or be sent on with a copied address.
  if (location.search.includes("token=")) history.replaceState(null, "", location.pathname + location.hash);

  const follow = Object.assign(document.createElement("input"), { type: "checkbox" });
  follow.checked = sessionStorage.getItem("follow") === "yes";
  follow.addEventListener("change", () => sessionStorage.setItem("follow", follow.checked ? "yes" : "no"));
  const label = made("label", " show new ones at once");
  label.className = "check";
  label.prepend(follow);
  const again = made("button", "Show them");
  again.type = "button";
  again.addEventListener("click", () => location.reload());
  const words = made("span", "");

  let first = null;
  const show = (now) => {
    first ??= now;
    const more = now.stamp !== first.stamp;
    if (more && (follow.checked || !first.episodes)) { location.reload(); return; }
    const last = now.last ? ` Last: ${now.last.title}: ${now.last.result}.` : "";
    const broken = now.broken ? `, ${now.broken} not scored` : "";
    words.textContent = `${now.episodes} episodes recorded, ${now.solved} of ${now.scored} scored ones solved${broken}.${last} `;
    told.replaceChildren(words, ...(more ? [again] : []), label);
  };
  const ask = async () => {
    try {
      const answer = await fetch("/progress", { credentials: "same-origin" });
      if (!answer.ok) throw new Error(await answer.text());
      show(await answer.json());
    } catch (error) {
      told.textContent = `The server does not answer (${error.message.slice(0, 200)}).`;
    }
    setTimeout(ask, EVERY);
  };
  ask();
})();
