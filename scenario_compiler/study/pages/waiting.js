// A page on which nothing is to be done: it is loaded again when there is.

const { base, token } = document.querySelector("#waiting").dataset;
const drawer = `${base} ${token.split("/")[0]}`; // of the form that may follow; earlier ones have arrived

for (const other of Object.keys(sessionStorage)) if (other !== drawer) sessionStorage.removeItem(other);

setInterval(async () => {
  try {
    const state = await (await fetch(`${base}/state`)).json();
    if (state.token !== token) location.reload();
  } catch {
    // the server has gone for a while: it is asked again
  }
}, 1000);
