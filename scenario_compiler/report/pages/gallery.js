// The gallery's search and filters: a card is shown if it contains every word and matches the chosen filters.

const search = document.querySelector("#search");
const chosen = ["group", "map", "cause"].map((name) => [name, document.querySelector(`#${name}`)]);
const cards = [...document.querySelectorAll(".cards li")].map((card) => [card, card.textContent.toLowerCase()]);

function filter() {
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  let count = 0;
  for (const [card, text] of cards) {
    const fits = chosen.every(([name, select]) => !select.value || card.dataset[name] === select.value);
    card.hidden = !(fits && words.every((word) => text.includes(word)));
    count += card.hidden ? 0 : 1;
  }
  for (const group of document.querySelectorAll(".group")) {
    group.hidden = !group.querySelector("li:not([hidden])");
  }
  document.querySelector("#count").textContent = count;
  document.querySelector("#none").hidden = count > 0;
}

search.form.addEventListener("submit", (event) => event.preventDefault());
search.form.addEventListener("input", filter);
filter();
