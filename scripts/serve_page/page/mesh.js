// Shows how a run goes and what it makes: progress, the mesh in the viewer of all pages, claims.
import { bytes, get } from "./server.js";

const PHASES = { start: "starts", transform: "measures distances to surfaces", refine: "makes cells",
  perturb: "removes slivers", extract: "collects the mesh", measure: "measures the mesh", calibrate: "finds the radius" };
const one = (id) => document.getElementById(id);
let shownMesh = "";

function item(text) {
  return Object.assign(document.createElement("li"), { textContent: text });
}

function showProgress({ stage, phase, fraction, cells, seconds }) {
  one("progress").hidden = stage !== "meshing";
  one("progress").value = fraction ?? 0;
  if (stage === "meshing") {
    one("mesh-status").textContent = `${PHASES[phase] ?? phase}, ${Math.round(100 * fraction)} %, `
      + `${cells.toLocaleString("en")} cells, ${seconds.toFixed(1)} s`;
  }
}

async function turn(mesh) {
  if (mesh.sha256 === shownMesh) return;
  shownMesh = mesh.sha256;
  const [description, data] = await Promise.all([get("mesh"), bytes("mesh.bytes")]);
  const place = one("turned-frame");
  place.querySelector("canvas")?.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
  place.replaceChildren(one("frame").content.cloneNode(true));
  one("turned").hidden = false;
  await showMesh(one("viewer"), { ...description, bytes: data });
}

function showClaims({ stage, claims = [], undecided }) {
  const held = claims.filter(({ verdict }) => verdict === "pass").length;
  one("claims").hidden = stage !== "verifying" && stage !== "done";
  one("claims").querySelector("[role=status]").textContent = stage === "verifying" ? "podm-verify decides them …"
    : undecided ? `Not decided: ${undecided}.`
      : `podm-verify has proved ${held} of ${claims.length} claims about the file.`;
  one("claims").querySelector("ul").replaceChildren(...claims.map(({ name, verdict, reason }) => {
    const line = document.createElement("li");
    const [mark, why] = ["span", "small"].map((tag) => document.createElement(tag));
    mark.className = `verdict ${verdict}`;
    mark.textContent = verdict.replace("_", " ");
    why.textContent = reason;
    line.append(mark, `: ${name}`, why);
    return line;
  }));
}

// `state`: of the server. Returns true while a job runs.
export async function showState(state) {
  const { stage, mesh, fault } = state;
  const isBusy = stage === "meshing" || stage === "verifying";
  one("run").disabled = isBusy;
  one("stop").disabled = !isBusy;
  showProgress(state);
  showClaims(state);
  one("download").hidden = !mesh;
  one("unmet").replaceChildren(...[...(mesh?.unmet ?? []), ...(mesh?.warnings ?? [])].map(item));
  if (stage === "none") one("mesh-status").textContent = "";
  if (stage === "stopped" || stage === "failed") one("mesh-status").textContent = fault || "Stopped; there is no mesh.";
  if (mesh) {
    one("mesh-status").textContent = `${mesh.cells.toLocaleString("en")} cells, `
      + `${mesh.vertices.toLocaleString("en")} vertices, in ${mesh.seconds.toFixed(1)} s`
      + (mesh.turns ? "" : "; too many to turn here");
    if (mesh.turns) await turn(mesh);
  }
  if (!mesh || !mesh.turns) {
    one("turned").hidden = true;
    shownMesh = "";
  }
  return isBusy;
}
