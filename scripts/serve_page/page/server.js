// The server, as this page talks to it. All paths are relative, because the page's address holds the token.
let page = "";

class Fault extends Error {}

async function answer(response) {
  const value = response.headers.get("Content-Type") === "application/json" ? await response.json() : null;
  if (!response.ok) throw new Fault(value?.fault ?? `The server answered ${response.status}.`);
  return value;
}

async function send(method, path, body, signal) {
  try {
    return await answer(await fetch(path, { method, body, signal }));
  } catch (error) {
    if (error instanceof Fault || error.name === "AbortError") throw error;
    throw new Fault("The server does not answer; it may have ended.");
  }
}

export const address = (action) => `pages/${page}/${action}`;
export const get = (action) => send("GET", address(action));
export const post = (action, value, signal) => send("POST", address(action), value && JSON.stringify(value), signal);
export const put = (file) => send("PUT", address(`file/${encodeURIComponent(file.name)}`), file);
export const bytes = async (action) => (await fetch(address(action))).arrayBuffer();

// Opens this page's place on the server. `onState` gets each state. The place is gone with the page.
export async function begin(onState) {
  page = (await send("POST", "pages/new")).page;
  const events = new EventSource(address("events"));
  events.addEventListener("message", (event) => onState(JSON.parse(event.data)));
  addEventListener("pagehide", () => navigator.sendBeacon(address("leave")));
  addEventListener("pageshow", (event) => { if (event.persisted) location.reload(); });
}
