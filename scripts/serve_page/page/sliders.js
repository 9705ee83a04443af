// The sliders of the cells' sizes. Each has a number beside it, and a tick: without it the option is not given.
const STEPS = 100;
const NAMES = { radius: "radius", delta: "delta", smooth: "smoothing", "min-dihedral": "dihedral angle",
  "drop-islands": "islands" };

// The range of each option for an image: [least, largest, first value, is it given at first]. Lengths follow the
// voxels; the first radius makes a mesh within seconds.
function ranges({ spacing_mm: spacing, labels, voxel_volume_mm3: voxel }) {
  const step = Math.cbrt(spacing[0] * spacing[1] * spacing[2]);
  const volume = labels.reduce((sum, label) => sum + label.volume_mm3, 0);
  const extent = Math.cbrt(volume);
  const radius = Math.max(Math.cbrt(volume / 2e4), 2.5 * step);
  return {
    radius: [step / 2, Math.max(extent / 2, 4 * step), radius, true], delta: [step / 2, extent / 4, 2 * step, false],
    smooth: [step / 4, 4 * step, 1.5 * step, false], "min-dihedral": [1, 30, 8, false],
    "drop-islands": [voxel, Math.max(volume / 100, 10 * voxel), 10 * voxel, false],
  };
}

const rounded = (number) => Number(number.toPrecision(3));

export class Sliders {
  constructor(root, options, onChange) {
    this.onChange = onChange;
    this.sliders = options.map((option) => this.slider(option));
    root.replaceChildren(...this.sliders.map(({ line }) => line));
  }

  slider({ name, help, unset, type }) {
    const line = document.createElement("div");
    line.className = "slider";
    const [label, tick, range, number, note] = ["label", "input", "input", "input", "small"]
      .map((tag) => document.createElement(tag));
    label.className = "given";
    Object.assign(tick, { type: "checkbox" });
    label.append(tick, NAMES[name]);
    Object.assign(range, { type: "range", min: 0, max: STEPS, step: 1 });
    Object.assign(number, { type: "number", step: "any" });
    range.setAttribute("aria-label", `${NAMES[name]}, slider`);
    number.setAttribute("aria-label", `${NAMES[name]}, ${unit(type)}`);
    number.title = unit(type);
    note.id = `note-${name}`;
    note.textContent = `${help.replaceAll("\n", " ")}; not ticked: ${unset}`;
    for (const one of [tick, range, number]) one.setAttribute("aria-describedby", note.id);
    line.append(label, range, number, note);
    const slider = { name, line, tick, range, number, least: 1, most: 2 };
    range.addEventListener("input", () => this.given(slider, rounded(
      slider.least * (slider.most / slider.least) ** (range.value / STEPS))));
    number.addEventListener("change", () => this.given(slider, Number(number.value)));
    tick.addEventListener("input", () => this.onChange());
    return slider;
  }

  given(slider, value) {
    if (!(value > 0)) return;
    slider.number.value = value;
    slider.range.value = STEPS * Math.log(value / slider.least) / Math.log(slider.most / slider.least);
    slider.range.setAttribute("aria-valuetext", `${value}`);
    slider.tick.checked = true;
    this.onChange();
  }

  // Sets all to the first values for an image.
  show(info) {
    const of = ranges(info);
    const { onChange } = this;
    this.onChange = () => {};
    for (const slider of this.sliders) {
      const [least, most, first, isGiven] = of[slider.name];
      Object.assign(slider, { least, most });
      this.given(slider, rounded(first));
      slider.tick.checked = isGiven;
    }
    this.onChange = onChange;
  }

  settings() {
    const given = this.sliders.filter(({ tick, number }) => tick.checked && Number(number.value) > 0);
    return { numbers: Object.fromEntries(given.map(({ name, number }) => [name, Number(number.value)])) };
  }
}

function unit(type) {
  return { MM: "mm", DEG: "degrees", MM3: "mm³" }[type] ?? type;
}
