// Shows three slices of the image by NiiVue. Sliders move them, so that no mouse is needed.
import { address } from "./server.js";

const AXES = ["i", "j", "k"];
const GROUND = { light: [255, 255, 255], dark: [29, 33, 41] };  // --panel of page.css
let viewer = null, places = [], painted = [];

const isDark = matchMedia("(prefers-color-scheme: dark)");
const ground = () => GROUND[isDark.matches ? "dark" : "light"];

function setGround() {
  viewer.opts.backColor = [...ground().map((part) => part / 255), 1];
  paint(painted);
}

async function start(root) {
  viewer = new niivue.Niivue({
    fontColor: [0.5, 0.5, 0.5, 1], crosshairColor: [0.5, 0.5, 0.5, 1], crosshairWidth: 0.25,
    isOrientationTextVisible: true, dragAndDropEnabled: false, multiplanarShowRender: niivue.SHOW_RENDER.NEVER,
    isNearestInterpolation: true, loadingText: "", logLevel: "error", scrollRequiresFocus: true,
  });
  await viewer.attachToCanvas(root.querySelector("canvas"));
  viewer.setSliceType(viewer.sliceTypeMultiplanar);
  viewer.onLocationChange = ({ vox }) => places.forEach((place, axis) => place.show(vox[axis]));
  isDark.addEventListener("change", setGround);
  setGround();
}

function makePlaces(root, size) {
  const group = root.querySelector(".places");
  group.replaceChildren();
  places = size.map((length, axis) => {
    const [line, label, range, output] = ["div", "label", "input", "output"].map((tag) => document.createElement(tag));
    line.className = "place";
    label.htmlFor = range.id = `place-${AXES[axis]}`;
    label.textContent = AXES[axis];
    Object.assign(range, { type: "range", min: 0, max: length - 1, step: 1 });
    const show = (voxel) => { range.value = voxel; output.textContent = `${Math.round(voxel)} of ${length}`; };
    range.addEventListener("input", () => moveTo(places.map((place) => place.voxel())));
    line.append(label, range, output);
    group.append(line);
    return { show, voxel: () => Number(range.value) };
  });
}

export function moveTo(voxel) {
  places.forEach((place, axis) => place.show(voxel[axis]));
  if (!viewer?.volumes.length) return;
  viewer.scene.crosshairPos = viewer.vox2frac(voxel);
  viewer.drawScene();
}

// Shows an image; `info` is the server's. Returns a sentence if it cannot be shown.
export async function show(root, info) {
  root.hidden = info.shown === null;
  if (root.hidden) return "It is too large for slices here.";
  root.removeAttribute("data-drawn");
  makePlaces(root, info.size);
  try {
    if (!viewer) await start(root);
    await viewer.loadVolumes([{ url: address("image"), name: "image.nii" }]);
  } catch (error) {
    root.hidden = true;
    return `Its slices cannot be drawn: ${error.message}.`;
  }
  moveTo(info.size.map((length) => Math.floor(length / 2)));
  root.dataset.drawn = "yes";
  return "";
}

// Colours the voxels: one {index, colour, isShown} for each label.
export function paint(labels) {
  painted = labels;
  if (!viewer?.volumes.length) return;
  const [R, G, B] = ground().map((part) => [part]);
  const table = { R, G, B, A: [255], I: [0], labels: [""] };
  for (const { index, colour, isShown, name } of [...labels].sort((a, b) => a.index - b.index)) {
    [R, G, B].forEach((part, at) => {
      const own = parseInt(colour.slice(2 * at + 1, 2 * at + 3), 16);
      part.push(isShown ? own : Math.round(0.85 * part[0] + 0.15 * own));  // pale where the label is not ticked
    });
    table.A.push(255);
    table.I.push(index);
    table.labels.push(name);
  }
  viewer.volumes[0].setColormapLabel(table);
  viewer.updateGLVolume();
}
