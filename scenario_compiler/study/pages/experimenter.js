// The experimenter's page: the participants and the possible actions. Rows are changed in place, so that a note that
// is being written stays.

const body = document.querySelector("#participants");
const status = document.querySelector("#status");
const GONE = "The server has gone.";
const rows = new Map();
let answers = 0; // to orders; rows that were asked for before one are older than it

function cell(row, text = "") {
  const found = row.insertCell();
  found.textContent = text;
  return found;
}

function button(action, label, participant) {
  const found = Object.assign(document.createElement("button"), { type: "button", textContent: label });
  found.setAttribute("aria-label", `${label}, participant ${participant}`);
  found.addEventListener("click", () => {
    if (action !== "abort" || confirm(`End the run of participant ${participant}? It is not driven again.`)) order({ participant, action });
  });
  return found;
}

function made(one) {
  const row = body.insertRow();
  row.id = one.id;
  const cells = { step: null, what: null, presence: null, run: null };
  const head = document.createElement("th");
  head.scope = "row";
  head.textContent = one.id;
  row.append(head);
  for (const name of Object.keys(cells)) cells[name] = cell(row);
  const buttons = {};
  const actions = cell(row);
  for (const [action, label] of [["start", "Start"], ["pause", "Pause"], ["abort", "Abort"], ["request", "Request"]]) {
    buttons[action] = button(action, label, one.participant);
    actions.append(buttons[action], " ");
  }
  const form = document.createElement("form");
  const note = Object.assign(document.createElement("input"), { maxLength: 2000, required: true });
  note.setAttribute("aria-label", `Note on participant ${one.participant}`);
  const count = document.createElement("span");
  form.append(note, " ", Object.assign(document.createElement("button"), { textContent: "Keep" }), " ", count);
  form.addEventListener("submit", async (event) => {
    event.preventDefault();
    if (await order({ participant: one.participant, action: "note", text: note.value })) note.value = "";
  });
  cell(row).append(form);
  return { cells, buttons, count };
}

function show(one) {
  if (!rows.has(one.participant)) rows.set(one.participant, made(one));
  const { cells, buttons, count } = rows.get(one.participant);
  const run = one.run && `${one.run.t.toFixed(1)} s, ${one.run.held || one.run.state.replace("_", " ")}${one.page ? "" : ", page gone"}`;
  cells.step.textContent = `${one.session}: ${one.step} of ${one.steps}`;
  cells.what.textContent = one.what;
  cells.presence.textContent = one.presence;
  cells.run.textContent = run ?? (one.fault || (one.page ? "page open" : ""));
  cells.run.classList.toggle("fault", !run && Boolean(one.fault));
  buttons.start.disabled = one.presence === "started" || one.presence === "declined";
  buttons.pause.disabled = one.presence !== "started";
  buttons.abort.disabled = !one.run;
  buttons.request.disabled = !["automated", "warning"].includes(one.run?.state); // later it has been requested, or a person drives
  count.textContent = one.notes ? `${one.notes} kept` : "";
}

async function order(what) {
  const answer = await fetch("/experimenter/do", { method: "POST", body: JSON.stringify(what) });
  status.textContent = answer.ok ? "" : await answer.text();
  if (answer.ok) show(await answer.json());
  answers += 1;
  return answer.ok;
}

async function look() {
  const before = answers;
  try {
    const found = await (await fetch("/experimenter/state")).json();
    if (before === answers) found.forEach(show);
    if (status.textContent === GONE) status.textContent = "";
  } catch {
    status.textContent = GONE;
  }
  setTimeout(look, 1000);
}

look();
