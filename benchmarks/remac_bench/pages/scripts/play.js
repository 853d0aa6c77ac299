// A person plays: what is on the table is asked of the server, and orders go back to it.
(() => {
  "use strict";
  const EVERY = 400;
  const at = (id) => document.getElementById(id);
  const made = (tag, text, classes = "") => {
    const node = document.createElement(tag);
    node.textContent = text;
    node.className = classes;
    return node;
  };
  const isolated = (text, classes = "") => made("bdi", text, classes);

  // The token of the address is in a cookie by now.
  if (location.search.includes("token=")) history.replaceState(null, "", location.pathname);

  let seen = { version: -1, turn: 0, robots: [], commands: {}, rounds: [], left: {}, holding: {}, pictures: 0 };
  let draft = {};
  let added = [];
  let robot = 0;
  let choice = 0;
  let shown = 0;
  let sent = 0; // the turn in which the last order was

  // -- what is sent -----------------------------------------------------------------------------------------
  const yours = () => seen.phase === "asked" && seen.turn > sent;
  const add = (text) => {
    draft[seen.robots[robot]].push(text);
    added.push(seen.robots[robot]);
    at("search").value = "";
    choice = 0;
    draw();
  };
  const remove = (name, index) => {
    draft[name].splice(index, 1);
    added.splice(added.lastIndexOf(name), 1);
    draw();
  };
  const undo = () => {
    const name = added.at(-1);
    if (name) remove(name, draft[name].length - 1);
  };
  const post = async (rows) => {
    const headers = { "Content-Type": "application/json" };
    try {
      const answer = await fetch("/orders", { method: "POST", headers, body: JSON.stringify({ rows }), credentials: "same-origin" });
      const { problem } = await answer.json();
      if (problem) { at("status").textContent = problem; return false; }
      return true;
    } catch (error) {
      at("status").textContent = `The server does not answer (${error.message.slice(0, 200)}).`;
      return false;
    }
  };
  const planned = () => seen.robots.some((name) => draft[name].length);
  const put = (rows) => {
    draft = rows;
    added = seen.robots.flatMap((name) => draft[name].map(() => name));
    draw();
  };
  const send = async (most) => {
    if (!yours() || !planned()) return;
    const rows = Object.fromEntries(seen.robots.map((name) => [name, draft[name].slice(0, most)]));
    const rest = Object.fromEntries(seen.robots.map((name) => [name, draft[name].slice(rows[name].length)]));
    sent = seen.turn; // before an answer: rounds may be over sooner than it is here
    put(rest);
    if (await post(rows)) { ask(true); return; }
    const problem = at("status").textContent;
    sent = 0;
    put(Object.fromEntries(seen.robots.map((name) => [name, [...rows[name], ...draft[name]]])));
    at("status").textContent = problem;
  };
  const finish = async () => {
    if (yours() && window.confirm("End the episode here? What has been reached by now counts.")) {
      await post({});
      ask(true);
    }
  };

  // -- what is shown ----------------------------------------------------------------------------------------
  const found = () => {
    const words = at("search").value.toLowerCase().split(/\s+/).filter((word) => word);
    const commands = seen.commands[seen.robots[robot]] ?? [];
    const fits = commands.filter((text) => words.every((word) => text.includes(word)));
    const begins = (text) => !text.startsWith(words.join(" "));
    return fits.sort((a, b) => begins(a) - begins(b));
  };
  const drawCommands = () => {
    const fits = found();
    choice = Math.min(Math.max(choice, 0), Math.max(0, fits.length - 1));
    at("commands").replaceChildren(...fits.map((text, index) => {
      const button = made("button", "", "command");
      button.type = "button";
      button.append(isolated(text));
      button.disabled = !yours();
      button.addEventListener("click", () => add(text));
      const item = document.createElement("li");
      item.role = "option";
      item.ariaSelected = String(index === choice);
      item.append(button);
      return item;
    }));
    at("commands").children[choice]?.scrollIntoView({ block: "nearest" });
  };
  const drawRows = () => {
    at("rows").replaceChildren(...seen.robots.map((name, index) => {
      const row = made("div", "", "row");
      const who = made("button", "", "who");
      who.type = "button";
      who.ariaPressed = String(index === robot);
      who.append(isolated(name), made("small", seen.holding[name] ? ` holds ${seen.holding[name]}` : ""));
      who.addEventListener("click", () => { robot = index; draw(); at("search").focus(); });
      const list = document.createElement("ol");
      list.append(...(draft[name] ?? []).map((text, place) => {
        const item = document.createElement("li");
        const out = made("button", "\u00d7");
        out.type = "button";
        out.ariaLabel = `remove ${text}`;
        out.addEventListener("click", () => remove(name, place));
        item.append(isolated(text), out);
        return item;
      }));
      row.append(who, list);
      return row;
    }));
  };
  const drawRounds = () => {
    const lines = seen.rounds.map((round) => {
      const line = document.createElement("li");
      for (const [who, text, failed] of round) {
        const part = made("span", "", failed ? "is-false" : "");
        part.append(isolated(who, "quiet"), " ", isolated(text));
        line.append(part);
      }
      return line;
    });
    at("rounds").replaceChildren(...(lines.length ? lines : [made("li", "Nothing yet.", "quiet none")]));
    at("rounds").scrollTop = at("rounds").scrollHeight;
  };
  const drawPicture = () => {
    const picture = at("picture");
    picture.hidden = !shown;
    if (shown) picture.src = `/picture/${shown}`;
    at("rewind").hidden = seen.pictures < 2;
    at("rewind").querySelector("span").textContent = shown === 1 ? "at the start" : `after round ${shown - 1}`;
  };
  const STATUS = {
    beginning: "The kitchen is being set up \u2026",
    asked: "Your turn.",
    playing: "The robots are at it \u2026",
    recording: "The episode is over and is being recorded \u2026",
  };
  const drawStatus = () => {
    const status = at("status");
    status.className = `note${seen.phase === "broken" ? " bad" : ""}`;
    const left = yours() && Object.keys(seen.left).length ? " A command failed; what was not played is in the rows again." : "";
    const phase = seen.phase === "asked" && !yours() ? "playing" : seen.phase;
    status.textContent = `${STATUS[phase] ?? ""}${left} ${phase === seen.phase ? seen.problem : ""}`.trim();
    if (seen.phase === "ended") {
      const link = made("a", "Look at the episode");
      link.setAttribute("href", seen.page);
      status.replaceChildren(isolated(seen.result), ` in ${seen.rounds.length} rounds. `, link, ".");
    }
    for (const id of ["send", "step"]) at(id).disabled = !yours() || !planned();
    at("undo").disabled = !added.length;
    at("finish").disabled = !yours();
  };
  const draw = () => { drawRows(); drawCommands(); drawStatus(); };

  const take = (now) => {
    const before = seen;
    const turned = now.turn !== before.turn; // a turn may be over between two questions
    seen = now;
    for (const name of seen.robots) draft[name] ??= [];
    if (turned) put(Object.fromEntries(seen.robots.map((name) => [name, [...(seen.left[name] ?? []), ...draft[name]]])));
    at("goal").textContent = seen.goal;
    at("told").querySelector("bdi").textContent = seen.scene;
    at("blind").textContent = seen.blind;
    at("blind").hidden = !seen.blind;
    // What has not changed stays: a button that is made anew under a finger is not pressed.
    const changed = (...names) => names.some((name) => JSON.stringify(before[name]) !== JSON.stringify(seen[name]));
    if (changed("pictures")) { shown = seen.pictures; drawPicture(); }
    if (changed("rounds")) drawRounds();
    if (changed("phase", "turn", "robots", "commands", "left", "holding", "problem", "result", "page")) draw();
    if (turned) at("search").focus();
  };
  let waiting;
  const ask = async (once = false) => {
    clearTimeout(waiting);
    try {
      const answer = await fetch(`/state?after=${seen.version}`, { credentials: "same-origin" });
      if (answer.status === 200) take(await answer.json());
      else if (!answer.ok) throw new Error(await answer.text());
    } catch (error) {
      at("status").textContent = `The server does not answer (${error.message.slice(0, 200)}).`;
    }
    waiting = setTimeout(ask, EVERY);
  };

  // -- keys and buttons -------------------------------------------------------------------------------------
  at("search").addEventListener("input", () => { choice = 0; drawCommands(); });
  document.addEventListener("keydown", (event) => {
    const search = document.activeElement === at("search");
    const number = event.altKey ? Number(/^Digit(\d)$/.exec(event.code)?.[1] ?? 0) : 0;
    if (number && number <= seen.robots.length) { robot = number - 1; draw(); at("search").focus(); }
    else if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) send(undefined);
    else if (event.key === "Enter" && event.shiftKey) send(1);
    else if (event.key === "Enter" && search) { const text = found()[choice]; if (yours() && text) add(text); }
    else if (event.key === "Backspace" && search && !at("search").value) undo();
    else if (event.key === "ArrowDown" && search) { choice += 1; drawCommands(); }
    else if (event.key === "ArrowUp" && search) { choice -= 1; drawCommands(); }
    else return;
    event.preventDefault();
  });
  at("send").addEventListener("click", () => send(undefined));
  at("step").addEventListener("click", () => send(1));
  at("undo").addEventListener("click", undo);
  at("finish").addEventListener("click", finish);
  for (const button of document.querySelectorAll("[data-turn]")) {
    button.addEventListener("click", () => {
      shown = Math.min(Math.max(shown + Number(button.dataset.turn), 1), seen.pictures);
      drawPicture();
    });
  }
  drawRounds();
  ask();
})();
