// Shows what a run will cost and lose.
const MOST_LISTED = 20;
const KINDS = { whole: "a whole component", bridge: "a bridge", detail: "a detail" };

function fact(name, text) {
  const [term, value] = ["dt", "dd"].map((tag) => document.createElement(tag));
  term.textContent = name;
  value.textContent = text;
  return [term, value];
}

const short = (number) => number.toLocaleString("en", { maximumSignificantDigits: 3 });

// `onPlace` gets the voxel of a part that is to be looked at.
export function showPrediction(root, plan, nameOf, onPlace) {
  const { thin_parts: parts } = plan;
  root.querySelector("dl").replaceChildren(
    ...fact("cells", `about ${short(plan.cells)}`),
    ...fact("memory", `about ${short(plan.memory_bytes / 2 ** 20)} MiB`),
    ...fact("time", `about ${short(plan.seconds)} s`),
    ...fact("delta", `${short(plan.delta_mm)} mm`),
    ...fact("may be lost", lost(parts)));
  root.querySelector(".lost").replaceChildren(...(parts.length ? [list(parts, nameOf, onPlace)] : []));
}

function lost(parts) {
  const count = (kind) => parts.filter((part) => part.kind === kind).length;
  if (!parts.length) return "nothing: no part is thinner than delta can show";
  return `${count("whole")} whole components, ${count("bridge")} bridges, ${count("detail")} details`;
}

function list(parts, nameOf, onPlace) {
  const lines = parts.slice(0, MOST_LISTED).map((part) => {
    const [line, button] = ["li", "button"].map((tag) => document.createElement(tag));
    button.type = "button";
    button.textContent = "show";
    button.addEventListener("click", () => onPlace(part.voxel));
    const text = `${nameOf(part.label)}: ${KINDS[part.kind]}, ${short(part.thickness_mm)} mm thick, `
      + `${short(part.volume_mm3)} mm³ `;
    button.setAttribute("aria-label", `Show ${text}in the slices`);
    line.append(text, button);
    return line;
  });
  const all = document.createElement("ul");
  all.append(...lines);
  if (parts.length > MOST_LISTED) {
    all.append(Object.assign(document.createElement("li"), { textContent: `and ${parts.length - MOST_LISTED} more` }));
  }
  return all;
}
