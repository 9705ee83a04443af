// The table of labels: which are meshed, and their names. Labels of one name become one.
export class Labels {
  constructor(root, onChange) {
    this.body = root.querySelector("tbody");
    this.onChange = onChange;
    this.lines = [];
    root.querySelector("#tick-all").addEventListener("click", () => this.tickAll(true));
    root.querySelector("#tick-none").addEventListener("click", () => this.tickAll(false));
  }

  show(labels, shown) {
    this.lines = labels.map((label, at) => this.line(label, shown ? shown[at] : 0));
    this.body.replaceChildren(...this.lines.map(({ row }) => row));
  }

  line(label, index) {
    const row = document.createElement("tr");
    const [head, named, volume] = ["th", "td", "td"].map((tag) => row.appendChild(document.createElement(tag)));
    head.scope = "row";
    const [text, tick, patch] = ["label", "input", "i"].map((tag) => document.createElement(tag));
    Object.assign(tick, { type: "checkbox", checked: true });
    patch.style.background = label.colour;
    text.append(tick, patch, `${label.value}`);
    head.append(text);
    const name = named.appendChild(document.createElement("input"));
    Object.assign(name, { type: "text", value: label.name, maxLength: 80, placeholder: "no name" });
    name.setAttribute("aria-label", `Name of label ${label.value}`);
    volume.textContent = (label.volume_mm3 / 1000).toLocaleString("en", { maximumSignificantDigits: 4 });
    tick.addEventListener("input", () => this.changed());
    name.addEventListener("change", () => this.changed());
    return { label, index, row, tick, name, patch };
  }

  tickAll(isTicked) {
    for (const { tick } of this.lines) tick.checked = isTicked;
    this.changed();
  }

  changed() {
    for (const { lines } of this.groups()) for (const { patch } of lines) patch.style.background = lines[0].label.colour;
    this.onChange();
  }

  // The ticked lines by name; a line whose name is the image's own stays alone until another line is given that name.
  groups() {
    const groups = new Map();
    for (const line of this.lines.filter(({ tick }) => tick.checked)) {
      const name = line.name.value.trim();
      const key = name === "" ? line : name;
      groups.set(key, { name, lines: [...(groups.get(key)?.lines ?? []), line] });
    }
    const isOwn = ({ label, name }) => label.name === name.value.trim();
    return [...groups.values()].flatMap((group) => (
      group.lines.every(isOwn) ? group.lines.map((line) => ({ name: "", lines: [line] })) : [group]));
  }

  // The server's settings.
  settings() {
    const ticked = this.lines.filter(({ tick }) => tick.checked).map(({ label }) => label.value);
    return {
      keep: ticked.length === this.lines.length ? null : ticked,
      merges: this.groups().filter(({ name }) => name !== "")
        .map(({ name, lines }) => ({ name, values: lines.map(({ label }) => label.value) })),
    };
  }

  // Returns a line per label for slices.js: colour, name, and whether it is shown.
  paints() {
    const colours = new Map(this.groups().flatMap(({ lines }) => lines.map((line) => [line, lines[0].label.colour])));
    return this.lines.map((line) => ({ index: line.index, colour: colours.get(line) ?? line.label.colour,
      isShown: line.tick.checked, name: line.name.value }));
  }

  nameOf(value) {
    const line = this.lines.find(({ label }) => label.value === value);
    return line?.name.value.trim() || `label ${value}`;
  }
}
