// The address: #task=HeatOnStove&result=success. It may come from anybody: it is read as text, and what is no use is said.
(() => {
  "use strict";
  const LONGEST = 500;
  const [SHOWN, MOST] = [60, 8];
  const note = document.querySelector(".filters .strange");
  // What was wrong with the address when it was read, and what is with the filters now.
  let [wrong, strange] = [[], []];

  const parameters = () => new URLSearchParams(location.hash.includes("=") ? location.hash.slice(1) : "");
  const replace = (now) => {
    const hash = now.toString();
    if (hash || location.hash.includes("=")) history.replaceState(null, "", hash ? `#${hash}` : "#");
  };
  // As on the rest of the page: what cannot be seen is shown as its number.
  const visible = (text) => text.replace(/[\p{Cc}\p{Cf}\p{Cs}\p{Zl}\p{Zp}]/gu, (each) => `\u27e8U+${each.codePointAt(0).toString(16).toUpperCase().padStart(4, "0")}\u27e9`);
  const quoted = (text) => {
    const node = document.createElement("bdi");
    const letters = [...text.slice(0, 4 * SHOWN)];
    node.textContent = `\u201c${visible(letters.slice(0, SHOWN).join(""))}${letters.length > SHOWN ? "\u2026" : ""}\u201d`;
    return node;
  };

  const say = () => {
    const all = [...wrong, ...strange];
    note.hidden = !all.length;
    note.replaceChildren(...all.slice(0, MOST).flatMap(([told, text], index) => [`${index ? " " : ""}${told} `, quoted(text), "."]));
    if (all.length > MOST) note.append(` And ${all.length - MOST} more.`);
  };

  remac.address = {
    // The texts of the names that there are; the last of two of one name counts.
    read: (names) => {
      wrong = [];
      const found = {};
      for (const [name, text] of parameters()) {
        if (!names.includes(name)) wrong.push(["Nothing here is filtered by", name]);
        else if (text.length > LONGEST) wrong.push([`Left out is the ${name} of the address, which is ${text.length} letters long:`, text]);
        else found[name] = text.trim();
      }
      return found;
    },
    write: (changes) => {
      const now = parameters();
      for (const [name, text] of Object.entries(changes)) {
        if (text) now.set(name, text); else now.delete(name);
      }
      replace(now);
      wrong = [];
      say();
    },
    // Leave nothing but these names.
    forget: (names) => {
      wrong = [];
      const now = parameters();
      for (const name of [...now.keys()]) if (!names.includes(name)) now.delete(name);
      replace(now);
    },
    // Add what is wrong with one name that the address has.
    wrong: (told, text) => wrong.push([told, text]),
    // Say what was wrong, and these: pairs of words of ours and text of somebody's.
    say: (more) => { strange = more; say(); },
  };
})();
