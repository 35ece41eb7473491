// The live picture with the parts' outlines and names. It can move to another page, show a range of colours, and be
// clicked.
import {byId, element, readable, rebuild, swatch} from './dom.js';
import {colourOf} from './colours.js';
import {t} from './words.js';

const TRACKED = 0, OCCLUDED = 1, LOST = 3;
const canvas = byId('camera-canvas'), context = canvas.getContext('2d', {alpha: false});
let decoding = false, last = null;  // {picture, view, task} that is shown
let tint = null, onPlace = null;
const cross = {x: 320, y: 240, shown: false};  // for those who don't click: arrow keys and Enter
const times = [];

/** Shows a view. A picture that comes while another is being decoded is left out. */
export async function showView(view, jpeg, task) {
  if (decoding) return;
  if (jpeg) {
    decoding = true;
    try {
      const picture = await createImageBitmap(new Blob([jpeg], {type: 'image/jpeg'}));
      last?.picture.close();
      last = {picture, view, task};
      countPicture();
      draw(last);
      byId('camera-note').hidden = true;
    } catch { /* a broken picture is followed by the next */ }
    decoding = false;
  }
  showParts(view, task);
}

function countPicture() {
  const now = performance.now();
  times.push(now);
  while (times.length && now - times[0] > 2000) times.shift();
}

/** Pictures a second over the last two seconds. */
export function pictureRate() {
  const now = performance.now();
  while (times.length && now - times[0] > 2000) times.shift();
  return times.length / 2;
}

function draw({picture, view, task}) {
  if (canvas.width !== picture.width || canvas.height !== picture.height) {
    canvas.width = picture.width;
    canvas.height = picture.height;
  }
  context.drawImage(picture, 0, 0);
  if (tint) greyOutside(tint);
  if (onPlace && cross.shown) drawCross();
  if (!task?.parts || task.parts.length !== view.parts.length) return;
  const unit = Math.max(1, picture.width / (canvas.clientWidth || picture.width));  // lines and names keep their size on the screen
  const named = [];
  view.parts.forEach((part, index) => {
    if (!part.outlines.length) return;
    const colour = colourOf(task.types[task.parts[index].type]);
    drawOutline(part, colour, unit);
    named.push({part, name: readable(task.parts[index].name), colour});
  });
  placeNames(named, unit);
}

/** Moves the picture into a container of another page. */
export function showPictureIn(container) {
  const stage = canvas.parentElement;
  if (stage.parentElement !== container) container.append(stage);
}

/** Greys out what is not in an HSV range {low, high} (OpenCV's 8 bits); null shows everything. */
export function tintPicture(range) {
  if (JSON.stringify(range) === JSON.stringify(tint)) return;
  tint = range;
  if (last) draw(last);
}

/** Calls handler(x, y) with the pixel that is clicked; null: the picture is not for clicking. */
export function picturePlace(handler) {
  onPlace = handler;
  canvas.tabIndex = handler ? 0 : -1;
  canvas.classList.toggle('pick', Boolean(handler));
  canvas.setAttribute('aria-label', t(handler ? 'setup.click_here' : 'camera_description'));
}

canvas.addEventListener('click', (event) => {
  const box = canvas.getBoundingClientRect(), scale = Math.min(box.width / canvas.width, box.height / canvas.height);
  const x = (event.clientX - box.left - (box.width - canvas.width * scale) / 2) / scale, y = (event.clientY - box.top - (box.height - canvas.height * scale) / 2) / scale;
  if (x >= 0 && y >= 0 && x < canvas.width && y < canvas.height) onPlace?.(Math.floor(x), Math.floor(y));
});
canvas.addEventListener('keydown', (event) => {
  const step = event.shiftKey ? 2 : 12, move = {ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step]}[event.key];
  if (!onPlace || (!move && event.key !== 'Enter')) return;
  event.preventDefault();
  cross.shown = true;
  if (!move) return onPlace(cross.x, cross.y);
  cross.x = Math.min(Math.max(cross.x + move[0], 0), canvas.width - 1);
  cross.y = Math.min(Math.max(cross.y + move[1], 0), canvas.height - 1);
});

function drawCross() {
  for (const [colour, width] of [['#fff', 5], ['#1d2a2a', 2]]) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.moveTo(cross.x - 14, cross.y); context.lineTo(cross.x + 14, cross.y);
    context.moveTo(cross.x, cross.y - 14); context.lineTo(cross.x, cross.y + 14);
    context.stroke();
  }
}

function greyOutside({low, high}) {
  const image = context.getImageData(0, 0, canvas.width, canvas.height), {data} = image;
  const wraps = low[0] > high[0];
  for (let k = 0; k < data.length; k += 4) {
    const r = data[k], g = data[k + 1], b = data[k + 2];
    const value = Math.max(r, g, b), span = value - Math.min(r, g, b);
    const saturation = value ? 255 * span / value : 0;
    let hue = 0;
    if (span) hue = 30 * (value === r ? ((g - b) / span + 6) % 6 : value === g ? (b - r) / span + 2 : (r - g) / span + 4);
    const inHue = wraps ? hue >= low[0] || hue <= high[0] : hue >= low[0] && hue <= high[0];
    if (inHue && saturation >= low[1] && saturation <= high[1] && value >= low[2] && value <= high[2]) continue;
    data[k] = data[k + 1] = data[k + 2] = 60 + 0.25 * (0.3 * r + 0.6 * g + 0.1 * b);
  }
  context.putImageData(image, 0, 0);
}

function drawOutline(part, colour, unit) {
  const path = new Path2D();
  for (const polygon of part.outlines) {
    for (let k = 0; k < polygon.length; k += 2) k ? path.lineTo(polygon[k], polygon[k + 1]) : path.moveTo(polygon[0], polygon[1]);
    path.closePath();
  }
  context.lineJoin = 'round';
  context.setLineDash(part.status === TRACKED ? [] : part.status === OCCLUDED ? [7 * unit, 5 * unit] : [2 * unit, 5 * unit]);
  context.strokeStyle = 'rgb(255 255 255 / 0.9)';
  context.lineWidth = 4 * unit;
  context.stroke(path);
  context.strokeStyle = part.status === LOST ? '#b3261e' : colour;
  context.lineWidth = 2.2 * unit;
  context.stroke(path);
  context.setLineDash([]);
}

/** Names sit in the middle of their parts and are moved down until they don't cover each other. */
function placeNames(named, unit) {
  context.font = `600 ${13 * unit}px system-ui, "Noto Sans", "Liberation Sans", "DejaVu Sans", sans-serif`;
  context.textBaseline = 'middle';
  const taken = [];
  for (const {part, name, colour} of named.sort((a, b) => middle(a.part)[1] - middle(b.part)[1])) {
    const [x, y] = middle(part);
    const width = context.measureText(name).width + 26 * unit, height = 22 * unit;
    const box = {x: Math.min(Math.max(x - width / 2, 2), canvas.width - width - 2), y: Math.max(y - height / 2, 2), width, height};
    for (const other of taken) {
      const apart = box.x + width < other.x || other.x + other.width < box.x;
      if (!apart && Math.abs(box.y - other.y) < height) box.y = other.y + height + 2 * unit;
    }
    taken.push(box);
    context.fillStyle = part.status === TRACKED ? 'rgb(255 255 255 / 0.92)' : 'rgb(255 255 255 / 0.7)';
    context.beginPath();
    context.roundRect(box.x, box.y, width, height, height / 2);
    context.fill();
    context.fillStyle = colour;
    context.beginPath();
    context.arc(box.x + 11 * unit, box.y + height / 2, 4.5 * unit, 0, 7);
    context.fill();
    context.fillStyle = '#1d2a2a';
    context.fillText(name, box.x + 19 * unit, box.y + height / 2 + unit);
  }
}

function middle(part) {
  let left = Infinity, right = -Infinity, top = Infinity, bottom = -Infinity;
  for (const polygon of part.outlines) {
    for (let k = 0; k < polygon.length; k += 2) {
      left = Math.min(left, polygon[k]); right = Math.max(right, polygon[k]);
      top = Math.min(top, polygon[k + 1]); bottom = Math.max(bottom, polygon[k + 1]);
    }
  }
  return [(left + right) / 2, (top + bottom) / 2];
}

function showParts(view, task) {
  if (!task?.parts || task.parts.length !== view.parts.length) return;
  rebuild(byId('parts'), [task.revision, document.documentElement.lang, view.parts.map((part) => part.status)], () =>
    task.parts.map((part, index) => element('li', {},
      swatch(colourOf(task.types[part.type])), readable(part.name), element('small', {}, t(`status.${view.parts[index].status}`)))));
}
