// The page: files come in, settings change, jobs run.
import { address, begin, get, post, put } from "./server.js";
import { Labels } from "./labels.js";
import { Sliders } from "./sliders.js";
import { showState } from "./mesh.js";
import { showPrediction } from "./prediction.js";
import * as slices from "./slices.js";

const one = (id) => document.getElementById(id);
const QUIET_MS = 300;  // after the last change, before a prediction
let options, labels, sliders, isBusy = false, timer = 0, asking = new AbortController(), showing = new AbortController();

// Shows a fault as one sentence; none clears it.
function say(fault = "") {
  one("fault").textContent = fault;
  one("fault").hidden = fault === "";
}

async function attempt(action) {
  say();
  try {
    await action();
  } catch (error) {
    if (error.name !== "AbortError") say(error.message);
  }
}

const settings = () => ({ ...labels.settings(), ...sliders.settings() });

// Answers may overtake each other; only that of the last request counts.
async function showLines() {
  showing.abort();
  showing = new AbortController();
  const { command, python } = await post("lines", settings(), showing.signal);
  one("command").textContent = command;
  one("python").textContent = python;
}

function changed() {
  slices.paint(labels.paints());
  attempt(showLines);
  clearTimeout(timer);
  one("prediction").classList.add("old");
  timer = setTimeout(predict, QUIET_MS);
}

async function predict() {
  asking.abort();
  asking = new AbortController();
  if (isBusy) return;
  const { signal } = asking;
  await attempt(async () => {
    const plan = await post("plan", settings(), signal);
    if (signal.aborted || plan === null) return;
    showPrediction(one("prediction"), plan, (value) => labels.nameOf(value), slices.moveTo);
    one("prediction").classList.remove("old");
  });
}

async function take(files) {
  const status = one("image-status");
  const all = files.reduce((sum, file) => sum + file.size, 0);
  if (files.length === 0) return;
  if (all > options.most_bytes) {
    throw new Error(`${(all / 2 ** 20).toFixed(1)} MiB are more than the ${(options.most_bytes / 2 ** 20).toFixed(1)} MiB `
      + "that this server takes (--max-upload-mib).");
  }
  await post("begin");  // refused while a mesh is made: its Stop button stays
  one("settings").hidden = one("slices").hidden = true;
  status.textContent = "The image is read …";
  try {
    for (const file of files) await put(file);
    const info = await post("open");
    labels.show(info.labels, info.shown);
    sliders.show(info);
    one("settings").hidden = false;
    status.textContent = `${info.path}: ${info.size.join(" × ")} voxels of `
      + `${info.spacing_mm.map((mm) => Number(mm.toPrecision(4))).join(" × ")} mm, ${info.labels.length} labels. `
      + info.warnings.join(" ");
    changed();
    status.append(await slices.show(one("slices"), info));
    slices.paint(labels.paints());
  } catch (error) {
    status.textContent = "";
    throw error;
  }
}

function takeFiles() {
  const { body } = document;
  one("files").addEventListener("change", ({ target }) => attempt(() => take([...target.files])));
  addEventListener("dragover", (event) => { event.preventDefault(); body.classList.add("dropping"); });
  addEventListener("dragleave", () => body.classList.remove("dropping"));
  addEventListener("drop", (event) => {
    event.preventDefault();
    body.classList.remove("dropping");
    attempt(() => take([...event.dataTransfer.files]));
  });
}

async function copy(id) {
  const text = one(id).textContent;
  await navigator.clipboard.writeText(text);
  one("copied").textContent = id === "command" ? "The command is copied." : "The lines are copied.";
}

function showFormats(formats) {
  one("format").replaceChildren(...formats.map((format) => Object.assign(document.createElement("option"), {
    value: format, textContent: format })));
  const show = () => { one("download-link").href = address(`download/${one("format").value}`); };
  one("format").addEventListener("change", show);
  show();
}

await attempt(async () => {
  await begin(async (state) => {
    const was = isBusy;
    isBusy = await showState(state);
    if (was && !isBusy && one("prediction").classList.contains("old")) predict();
  });
  options = await get("options");
  labels = new Labels(one("labels"), changed);
  sliders = new Sliders(document.querySelector(".sliders"), options.sliders, changed);
  showFormats(options.formats);
  one("run").addEventListener("click", () => attempt(async () => { clearTimeout(timer); await post("run", settings()); }));
  one("stop").addEventListener("click", () => attempt(() => post("stop")));
  for (const button of document.querySelectorAll("[data-copy]")) {
    button.addEventListener("click", () => attempt(() => copy(button.dataset.copy)));
  }
  takeFiles();
});
document.body.dataset.ready = "yes";
