// A page on which nothing is to be done: it is loaded again when there is.

const { base, token } = document.querySelector("#waiting").dataset;

setInterval(async () => {
  try {
    const state = await (await fetch(`${base}/state`)).json();
    if (state.token !== token) location.reload();
  } catch {
    // the server has gone for a while: it is asked again
  }
}, 1000);
