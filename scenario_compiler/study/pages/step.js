// A page with a form: it may be sent after its least time, and is loaded again when the experimenter pauses. What has been
// answered is kept in this tab and stands in the form again, until the page of another step shows that it has arrived.

const form = document.querySelector("form");
const { base, token, least } = form.dataset;
const buttons = [...form.querySelectorAll("button")];
const drawer = `${base} ${form.elements.step.value}`;

for (const [name, value] of JSON.parse(sessionStorage.getItem(drawer) ?? "[]")) {
  if (name !== "step" && form.elements[name]) form.elements[name].value = value; // of radio buttons this chooses one
}
form.addEventListener("input", () => sessionStorage.setItem(drawer, JSON.stringify([...new FormData(form)])));
for (const other of Object.keys(sessionStorage)) if (other !== drawer) sessionStorage.removeItem(other);

if (Number(least) > 0) {
  const texts = buttons.map((button) => button.textContent);
  const end = performance.now() + 1000 * Number(least);
  const tick = () => {
    const left = Math.ceil((end - performance.now()) / 1000);
    buttons.forEach((button, k) => {
      button.disabled = left > 0;
      button.textContent = left > 0 ? `${texts[k]} (${left} s)` : texts[k];
    });
    if (left > 0) setTimeout(tick, 200);
  };
  tick();
}

setInterval(async () => {
  try {
    const state = await (await fetch(`${base}/state`)).json();
    const [now, before] = [state.token.split("/"), token.split("/")];
    if (now[0] !== before[0] || (now[1] !== before[1] && !document.activeElement?.matches("textarea"))) location.reload();
  } catch {
    // the server has gone for a while: it is asked again
  }
}, 2000);
