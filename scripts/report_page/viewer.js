// Draws the cells of a mesh whose centres are on the near side of a plane. Cells are drawn whole, coloured by label.
// Every cell draws its four facets; outer facets hide the inner ones. Nothing is stored per facet: the vertex shader
// looks up corners in textures by the vertex number.
"use strict";

const vertexShader = `#version 300 es
precision highp float; precision highp int; precision highp usampler2D;
uniform usampler2D points, cells, labels;
uniform sampler2D palette;
uniform mat3 turn;
uniform vec3 middle, axis, scale;
uniform float cut;
out vec3 colour, weights, place;
const int corners[12] = int[](0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3);
ivec2 texel(int index) { return ivec2(index & 2047, index >> 11); }
vec3 point(uint index) { return vec3(texelFetch(points, texel(int(index)), 0).xyz); }
void main() {
  int cell = gl_VertexID / 12, corner = gl_VertexID % 12;
  uvec4 ids = texelFetch(cells, texel(cell), 0);
  vec3 center = (point(ids[0]) + point(ids[1]) + point(ids[2]) + point(ids[3])) / 4.0;
  vec4 shade = texelFetch(palette, ivec2(int(texelFetch(labels, texel(cell), 0).x), 0), 0);
  weights = vec3(corner % 3 == 0, corner % 3 == 1, corner % 3 == 2);
  colour = shade.rgb;
  place = turn * (point(ids[corners[corner]]) - middle);
  bool hidden = dot(center, axis) > cut || shade.a == 0.0;
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(place * scale, 1.0);
}`;

const fragmentShader = `#version 300 es
precision highp float;
in vec3 colour, weights, place;
out vec4 pixel;
void main() {
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  float light = 0.55 + 0.45 * max(dot(normal, normalize(vec3(-0.5, 0.6, 1.0))), 0.0)
              + 0.15 * max(dot(normal, vec3(0.9, 0.0, 0.4)), 0.0);
  vec3 near = weights / fwidth(weights);  // pixels to each edge
  float edge = 1.0 - smoothstep(0.4, 1.2, min(near.x, min(near.y, near.z)));
  pixel = vec4(colour * light * (1.0 - 0.5 * edge), 1.0);
}`;

async function inflate(data) {
  const packed = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

// A mesh in a page has `data`; a mesh from a server has `bytes`.
async function unpack(mesh) {
  const bytes = mesh.bytes ?? await inflate(mesh.data);
  const cellsAt = 6 * mesh.points, labelsAt = cellsAt + 16 * mesh.cells;
  return {
    points: new Uint16Array(bytes, 0, 3 * mesh.points),
    cells: new Uint32Array(bytes.slice(cellsAt, labelsAt)),
    labels: new Uint16Array(bytes.slice(labelsAt)),
  };
}

function compile(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return program;
}

// Uploads a texture of 2048 texels per row that holds `count` texels of `channels` numbers.
function upload(gl, unit, values, channels, count, [internal, format, type]) {
  const rows = Math.ceil(count / 2048), Kind = values.constructor;
  const padded = new Kind(2048 * rows * channels);
  padded.set(values);
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.deleteTexture(gl.getParameter(gl.TEXTURE_BINDING_2D));
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.texImage2D(gl.TEXTURE_2D, 0, internal, 2048, rows, 0, format, type, padded);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
}

// The camera looks along -z of its own axes. It turns by yaw about the object's z, then by pitch.
function turning(yaw, pitch) {
  const [c, s, d, t] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  const rows = [[c, s, 0], [-s * t, c * t, d], [s * d, -c * d, t]];
  return [0, 1, 2].flatMap((column) => rows.map((row) => row[column]));
}

// Returns the width and height on the screen of a turned box.
function extent(size, turn) {
  return [0, 1].map((row) => size.reduce((sum, length, column) => sum + length * Math.abs(turn[3 * column + row]), 0));
}

async function show(root, mesh) {
  const canvas = root.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) throw new Error("this browser offers no WebGL 2");
  const arrays = await unpack(mesh);
  const program = compile(gl);
  const uniform = (name) => gl.getUniformLocation(program, name);
  gl.useProgram(program);
  upload(gl, 0, arrays.points, 3, mesh.points, [gl.RGB16UI, gl.RGB_INTEGER, gl.UNSIGNED_SHORT]);
  upload(gl, 1, arrays.cells, 4, mesh.cells, [gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT]);
  upload(gl, 2, arrays.labels, 1, mesh.cells, [gl.R16UI, gl.RED_INTEGER, gl.UNSIGNED_SHORT]);
  ["points", "cells", "labels", "palette"].forEach((name, unit) => gl.uniform1i(uniform(name), unit));
  gl.uniform3fv(uniform("middle"), mesh.size.map((length) => length / 2));
  gl.enable(gl.DEPTH_TEST);
  gl.enable(gl.CULL_FACE);

  const view = { yaw: 0.6, pitch: 0.35, zoom: 1, hidden: new Set() };
  const axis = root.querySelector("[name=axis]"), cut = root.querySelector("[name=cut]");

  function paintLabels() {
    const colours = mesh.labels.flatMap(({ value, colour }) => [
      ...[1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)), view.hidden.has(value) ? 0 : 255]);
    upload(gl, 3, new Uint8Array(colours), 4, mesh.labels.length, [gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE]);
  }

  let isWaiting = false;
  function draw() {
    if (isWaiting) return;
    isWaiting = true;
    requestAnimationFrame(() => {
      isWaiting = false;
      const ratio = Math.min(devicePixelRatio, 2);
      canvas.width = canvas.clientWidth * ratio;
      canvas.height = canvas.clientHeight * ratio;
      gl.viewport(0, 0, canvas.width, canvas.height);
      const scale = 0.92 * view.zoom * Math.min(canvas.width / view.wide, canvas.height / view.tall);
      const depth = -1.9 / Math.hypot(...mesh.size);
      gl.uniform3f(uniform("scale"), 2 * scale / canvas.width, 2 * scale / canvas.height, depth);
      gl.uniformMatrix3fv(uniform("turn"), false, turning(view.yaw, view.pitch));
      gl.uniform3fv(uniform("axis"), [0, 1, 2].map((one) => Number(one === Number(axis.value))));
      gl.uniform1f(uniform("cut"), mesh.size[axis.value] * cut.value);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.drawArrays(gl.TRIANGLES, 0, 12 * mesh.cells);
    });
  }

  function move(yaw, pitch, zoom = 1) {
    view.yaw += yaw;
    view.pitch = Math.max(-1.57, Math.min(1.57, view.pitch + pitch));
    view.zoom = Math.max(0.5, Math.min(20, view.zoom * zoom));
    draw();
  }

  steer(canvas, move);
  list(root.querySelector("[data-labels]"), mesh.labels, (value, isShown) => {
    view.hidden[isShown ? "delete" : "add"](value);
    paintLabels();
    draw();
  });
  axis.addEventListener("input", () => {
    view.yaw = Number(axis.value) === 0 ? 1.2 : Number(axis.value) === 1 ? Math.PI - 0.4 : 0.3;
    view.pitch = Number(axis.value) === 2 ? 0.9 : 0.35;
    [view.wide, view.tall] = extent(mesh.size, turning(view.yaw, view.pitch));
    draw();
  });
  cut.addEventListener("input", draw);
  new ResizeObserver(draw).observe(canvas);
  paintLabels();
  axis.dispatchEvent(new Event("input"));
}

// Dragging or arrow keys turn; wheel, two fingers, + and - zoom.
function steer(canvas, move) {
  const fingers = new Map();
  const gap = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a.x - b.x, a.y - b.y); };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const wide = fingers.size === 2 ? gap() : 0;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2) move(0, 0, gap() / wide);
    else move((event.clientX - before.x) / 150, (event.clientY - before.y) / 150);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    move(0, 0, Math.exp(-event.deltaY / 500));
  }, { passive: false });
  const keys = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1],
    "+": [0, 0, 1.2], "-": [0, 0, 1 / 1.2] };
  canvas.addEventListener("keydown", (event) => {
    if (!keys[event.key]) return;
    event.preventDefault();
    move(...keys[event.key]);
  });
}

// Adds a switch for each label, the label with the most cells first.
function list(place, labels, toggle) {
  for (const { value, name, colour, cells } of [...labels].sort((a, b) => b.cells - a.cells)) {
    const [line, box, patch] = ["label", "input", "i"].map((name) => document.createElement(name));
    box.type = "checkbox";
    box.checked = true;
    box.addEventListener("input", () => toggle(value, box.checked));
    patch.style.background = colour;
    line.append(box, patch, ` ${name}`);
    line.title = `${cells.toLocaleString()} cells`;
    place.append(line);
  }
}

// Shows a mesh in the elements of viewer.py's FRAME, or says why it cannot.
async function showMesh(root, mesh) {
  await show(root, mesh).catch((error) => {
    root.querySelector("[data-fault]").textContent = `The mesh cannot be drawn: ${error.message}`;
    root.querySelector("canvas").hidden = true;
  });
}

const packedMesh = document.getElementById("mesh-data");
if (packedMesh) showMesh(document.getElementById("viewer"), JSON.parse(packedMesh.textContent));
