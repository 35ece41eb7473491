// Three-dimensional view of the table (WebGL, no library): parts, what is joined, hands, the robot and where it points.
import {byId} from './dom.js';
import {colourOf, components} from './colours.js';

const HAND = 0.07;  // m
const CHEST = 0.06, HEAD = 0.075, NECK = 0.2;  // m, the robot's
const TRACKED = 0, OCCLUDED = 1, LOST = 3, ABSENT = 4, MADE = 1;
const GREEN = [0.11, 0.48, 0.27, 1], BLUE = [0.11, 0.37, 0.72, 1], WHITE = [0.95, 0.97, 0.98, 1], DARK = [0.14, 0.2, 0.27, 1];
const canvas = byId('table-canvas');
const gl = canvas.getContext('webgl', {antialias: true, alpha: false});
const eye = {turn: -0.5, tilt: 0.75, distance: 0.8};
const scene = {task: null, meshes: [], view: null, lesson: null};
let program, places, sphere, disc, stick, ground, pending = false, middle = [0, 0, 0];

const VERTEX = `attribute vec3 position, normal; uniform mat4 model, camera; varying vec3 n;
void main() { n = mat3(model) * normal; gl_Position = camera * model * vec4(position, 1.0); }`;
const FRAGMENT = `precision mediump float; varying vec3 n; uniform vec4 colour; uniform float lit;
void main() { float light = mix(1.0, 0.62 + 0.38 * max(dot(normalize(n), normalize(vec3(0.35, -0.45, 0.82))), 0.0), lit); gl_FragColor = vec4(colour.rgb * light, colour.a); }`;

export function setUpTable() {
  if (!gl) return;
  const compile = (type, source) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    return shader;
  };
  program = gl.createProgram();
  gl.attachShader(program, compile(gl.VERTEX_SHADER, VERTEX));
  gl.attachShader(program, compile(gl.FRAGMENT_SHADER, FRAGMENT));
  gl.linkProgram(program);
  gl.useProgram(program);
  places = {};
  for (const name of ['model', 'camera', 'colour', 'lit']) places[name] = gl.getUniformLocation(program, name);
  for (const name of ['position', 'normal']) places[name] = gl.getAttribLocation(program, name);
  sphere = upload(ball(10, 16));
  disc = upload(ring(0.75, 1, 40));
  stick = upload(tube(16));
  ground = upload(grid(0.6, 0.1));
  let held = null;
  canvas.addEventListener('pointerdown', (event) => { held = [event.clientX, event.clientY]; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener('pointermove', (event) => {
    if (!held) return;
    turn((event.clientX - held[0]) * 0.008, (event.clientY - held[1]) * 0.008);
    held = [event.clientX, event.clientY];
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, () => { held = null; });
  canvas.addEventListener('wheel', (event) => { event.preventDefault(); zoom(Math.exp(event.deltaY * 0.001)); }, {passive: false});
  canvas.addEventListener('keydown', (event) => {
    const step = {ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]}[event.key];
    if (step) { event.preventDefault(); turn(...step); }
    if (event.key === '+' || event.key === '-') zoom(event.key === '+' ? 0.9 : 1.1);
  });
  new ResizeObserver(draw).observe(canvas);
}

function turn(dx, dy) {
  eye.turn += dx;
  eye.tilt = Math.min(1.55, Math.max(0.1, eye.tilt + dy));
  draw();
}

function zoom(factor) {
  eye.distance = Math.min(2.5, Math.max(0.3, eye.distance * factor));
  draw();
}

/** @param lesson {seat: pose of the robot's chest, target: where it points, connections}; null if not known yet */
export function showTable(view, task, lesson) {
  if (!gl) return;
  if (task && task !== scene.task) {
    for (const mesh of scene.meshes) gl.deleteBuffer(mesh.buffer);
    scene.meshes = (task.types ?? []).map((type) => upload(flatShaded(type.mesh)));
    scene.task = task;
  }
  scene.view = view;
  scene.lesson = lesson;
  draw();
}

function draw() {
  if (pending || !gl) return;
  pending = true;
  requestAnimationFrame(() => { pending = false; render(); });
}

function render() {
  if (!canvas.offsetParent) return;
  const scale = Math.min(devicePixelRatio, 2), width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
  if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
  gl.viewport(0, 0, width, height);
  gl.clearColor(0.933, 0.941, 0.925, 1);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.enable(gl.DEPTH_TEST);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  followParts();
  gl.uniformMatrix4fv(places.camera, false, cameraMatrix(width / height));
  paint(ground, translation(Math.round(middle[0] * 10) / 10, Math.round(middle[1] * 10) / 10, 0), [0.8, 0.82, 0.79, 1], 0, gl.LINES);
  const parts = scene.view?.parts ?? [];
  if (scene.task?.parts?.length === parts.length) {
    parts.forEach((part, index) => {
      if (part.status === ABSENT || part.status === LOST) return;
      const type = scene.task.parts[index].type;
      const alpha = part.status === TRACKED ? 1 : part.status === OCCLUDED ? 0.6 : 0.3;
      paint(scene.meshes[type], poseMatrix(part.pose), [...components(colourOf(scene.task.types[type])), alpha], 1, gl.TRIANGLES);
    });
  }
  paintLesson(parts);
  // Hands are a hint behind which the parts stay visible; an arm or a body is no larger than a hand here.
  gl.depthMask(false);
  for (const [x, y, z, radius] of scene.view?.foreign ?? []) paint(sphere, translation(x, y, z, Math.min(radius, HAND)), [0.85, 0.62, 0.5, 0.25], 1, gl.TRIANGLES);
  gl.depthMask(true);
}

/** What is joined, the robot, and where it points. */
function paintLesson(parts) {
  if (!scene.lesson) return;
  const {seat, target, connections} = scene.lesson;
  for (const {state, part_a, part_b} of connections) {
    if (state === MADE && parts[part_a] && parts[part_b]) paintStick(above(parts[part_a].pose, 0.03), above(parts[part_b].pose, 0.03), 0.004, GREEN);
  }
  const chest = seat.slice(0, 3), head = above(seat, NECK), front = poseMatrix(seat).slice(0, 3);
  paint(sphere, translation(...chest, CHEST), WHITE, 1, gl.TRIANGLES);
  paintStick(chest, head, 0.04, WHITE);
  paint(sphere, translation(...head, HEAD), WHITE, 1, gl.TRIANGLES);
  for (const side of [-1, 1]) {
    const place = [head[0] + 0.062 * front[0] - side * 0.03 * front[1], head[1] + 0.062 * front[1] + side * 0.03 * front[0], head[2] + 0.01];
    paint(sphere, translation(...place, 0.018), DARK, 1, gl.TRIANGLES);
  }
  if (!target) return;
  paintStick(above(seat, 0.08), target, 0.003, BLUE);
  paint(disc, translation(target[0], target[1], target[2] + 0.03, 0.035), BLUE, 0, gl.TRIANGLES);
}

function paintStick(from, to, radius, colour) {
  const axis = minus(to, from), length = Math.hypot(...axis) || 1, z = axis.map((value) => value / length);
  const x = normalised(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z)), y = cross(z, x);
  paint(stick, new Float32Array([...x.map((v) => v * radius), 0, ...y.map((v) => v * radius), 0, ...axis, 0, ...from, 1]), colour, 1, gl.TRIANGLES);
}

/** The view stays on the middle of the parts, slowly. */
function followParts() {
  const seen = (scene.view?.parts ?? []).filter((part) => part.status <= OCCLUDED);
  if (!seen.length) return;
  for (let k = 0; k < 3; k++) middle[k] += 0.1 * (seen.reduce((sum, part) => sum + part.pose[k], 0) / seen.length - middle[k]);
}

function paint(mesh, model, colour, lit, mode) {
  gl.bindBuffer(gl.ARRAY_BUFFER, mesh.buffer);
  gl.enableVertexAttribArray(places.position);
  gl.vertexAttribPointer(places.position, 3, gl.FLOAT, false, 24, 0);
  gl.enableVertexAttribArray(places.normal);
  gl.vertexAttribPointer(places.normal, 3, gl.FLOAT, false, 24, 12);
  gl.uniformMatrix4fv(places.model, false, model);
  gl.uniform4fv(places.colour, colour);
  gl.uniform1f(places.lit, lit);
  gl.drawArrays(mode, 0, mesh.count);
}

function upload(numbers) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
  return {buffer, count: numbers.length / 6};
}

/** Position and normal of every corner of every triangle, metres. */
function flatShaded({vertices_mm: v, triangles}) {
  const numbers = [];
  for (let k = 0; k < triangles.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => [0, 1, 2].map((axis) => v[3 * triangles[k + corner] + axis] / 1000));
    const normal = normalised(cross(minus(b, a), minus(c, a)));
    for (const corner of [a, b, c]) numbers.push(...corner, ...normal);
  }
  return numbers;
}

function ball(rings, sectors) {
  const at = (i, j) => {
    const p = Math.PI * i / rings, q = 2 * Math.PI * j / sectors;
    return [Math.sin(p) * Math.cos(q), Math.sin(p) * Math.sin(q), Math.cos(p)];
  };
  const numbers = [];
  for (let i = 0; i < rings; i++) {
    for (let j = 0; j < sectors; j++) {
      for (const p of [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)]) numbers.push(...p, ...p);
    }
  }
  return numbers;
}

function ring(inner, outer, sectors) {
  const at = (radius, j) => [radius * Math.cos(2 * Math.PI * j / sectors), radius * Math.sin(2 * Math.PI * j / sectors), 0, 0, 0, 1];
  const numbers = [];
  for (let j = 0; j < sectors; j++) {
    for (const p of [at(inner, j), at(outer, j), at(outer, j + 1), at(inner, j), at(outer, j + 1), at(inner, j + 1)]) numbers.push(...p);
  }
  return numbers;
}

/** Without ends, of radius and length 1 along z. */
function tube(sectors) {
  const at = (j, z) => { const q = 2 * Math.PI * j / sectors; return [Math.cos(q), Math.sin(q), z, Math.cos(q), Math.sin(q), 0]; };
  const numbers = [];
  for (let j = 0; j < sectors; j++) {
    for (const p of [at(j, 0), at(j + 1, 0), at(j + 1, 1), at(j, 0), at(j + 1, 1), at(j, 1)]) numbers.push(...p);
  }
  return numbers;
}

function grid(half, step) {
  const numbers = [];
  for (let k = -half; k <= half + 1e-9; k += step) {
    numbers.push(k, -half, 0, 0, 0, 1, k, half, 0, 0, 0, 1, -half, k, 0, 0, 0, 1, half, k, 0, 0, 0, 1);
  }
  return numbers;
}

// Matrices are column major, as WebGL takes them.
const translation = (x, y, z, scale = 1) => new Float32Array([scale, 0, 0, 0, 0, scale, 0, 0, 0, 0, scale, 0, x, y, z, 1]);
const above = ([x, y, z], height) => [x, y, z + height];
const minus = (a, b) => a.map((value, k) => value - b[k]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
function normalised(a) { const length = Math.hypot(...a) || 1; return a.map((value) => value / length); }

/** [x, y, z, qw, qx, qy, qz] */
function poseMatrix([x, y, z, w, i, j, k]) {
  return new Float32Array([1 - 2 * (j * j + k * k), 2 * (i * j + w * k), 2 * (i * k - w * j), 0,
    2 * (i * j - w * k), 1 - 2 * (i * i + k * k), 2 * (j * k + w * i), 0,
    2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * (i * i + j * j), 0, x, y, z, 1]);
}

/** Perspective from a point on a sphere about the middle of the parts; the table's z is up. */
function cameraMatrix(aspect) {
  const {turn: a, tilt: b, distance: d} = eye;
  const back = [Math.sin(a) * Math.cos(b), -Math.cos(a) * Math.cos(b), Math.sin(b)];
  const position = back.map((value, k) => value * d + middle[k]);
  const right = normalised(cross([0, 0, 1], back)), up = cross(back, right);
  const f = 1 / Math.tan(0.35), near = 0.02, far = 6;
  const p = [f / Math.max(aspect, 1), f / Math.max(aspect, 1) * aspect, (far + near) / (near - far), 2 * far * near / (near - far)];
  const m = [];
  for (let k = 0; k < 3; k++) m.push(p[0] * right[k], p[1] * up[k], p[2] * back[k], -back[k]);
  m.push(-p[0] * dot(right, position), -p[1] * dot(up, position), -p[2] * dot(back, position) + p[3], dot(back, position));
  return new Float32Array(m);
}
