// The live picture of the table from above, as the child sees it: parts, hands, the robot at its place across the table
// and where it points.
import { add, apply, rotationOf } from "/body.js";

const kView = { left: -0.46, right: 0.46, near: -0.34, far: 0.62 };  // m from the table's middle: what must be seen
const kLargestHand = 0.08;  // m: an arm or a body is drawn no larger
const kLight = [0.35, -0.45, 0.82];

export class Table {
  constructor(canvas) {
    this.canvas = canvas;
    this.configure({ task: null, robot: { position: [0, 0, 0], orientation: [1, 0, 0, 0] } });
    this.parts = [];
    this.hands = [];
    this.texts = null;
  }

  configure({ task, robot }) {
    this.task = task;
    this.robot = { position: robot.position, rotation: rotationOf(robot.orientation) };
    // The robot faces the child: its front points down in the picture.
    const [[x], [y]] = this.robot.rotation, length = Math.hypot(x, y) || 1;
    this.front = [x / length, y / length];
    this.far = Math.max(kView.far, 0.12 - this.front[0] * robot.position[0] - this.front[1] * robot.position[1]);
  }

  /// @returns whether the number of parts in sight has changed
  show({ parts, hands }) {
    const before = this.parts.length;
    this.parts = parts.filter((part) => part.status !== "absent" && [...part.position, ...part.orientation].every(Number.isFinite));
    this.hands = hands;
    return before !== this.parts.length;
  }

  describe(texts) { return `${texts.table}: ${texts.parts(this.parts.length)}`; }

  draw(time, body, target) {
    const { canvas } = this;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.scale = Math.min(width / (kView.right - kView.left), height / (this.far - kView.near));
    this.x0 = width / 2;
    this.y0 = height / 2 + this.scale * (this.far + kView.near) / 2;
    this.drawWood(context, width, height);
    this.drawChild(context, height);
    for (const part of this.parts) this.drawShadow(context, part);
    for (const part of [...this.parts].sort((a, b) => a.position[2] - b.position[2])) this.drawPart(context, part);
    for (const hand of this.hands) this.drawHand(context, hand);
    this.drawRobot(context, body);
    if (target) this.drawTarget(context, time, body, target);
  }

  at([x, y]) {
    const [fx, fy] = this.front;
    return [this.x0 + this.scale * (fx * y - fy * x), this.y0 + this.scale * (fx * x + fy * y)];
  }

  drawWood(context, width, height) {
    const wood = context.createLinearGradient(0, 0, 0, height);
    wood.addColorStop(0, "#f6e9d2");
    wood.addColorStop(1, "#ecd6b1");
    context.fillStyle = wood;
    context.fillRect(0, 0, width, height);
    context.strokeStyle = "rgba(150, 108, 56, .10)";
    context.lineWidth = 1.5;
    for (let y = 14; y < height; y += 27) {
      context.beginPath();
      for (let x = 0; x <= width; x += 24) context.lineTo(x, y + 4 * Math.sin(x / 170 + y * 1.7) + 3 * Math.sin(x / 61 + y));
      context.stroke();
    }
  }

  drawChild(context, height) {
    context.fillStyle = "#5a4526";
    context.font = "700 17px ui-rounded, Nunito, system-ui, sans-serif";
    context.textAlign = "center";
    context.fillText(this.texts?.you ?? "", this.x0, height - 14);
    context.beginPath();
    context.arc(this.x0, height + 52, 118, Math.PI * 1.25, Math.PI * 1.75);
    context.strokeStyle = "rgba(90, 69, 38, .25)";
    context.lineWidth = 3;
    context.setLineDash([3, 9]);
    context.lineCap = "round";
    context.stroke();
    context.setLineDash([]);
  }

  typeOf(part) {
    const type = this.task?.types[this.task.parts[part.part]?.type];
    return type ?? { colour: "#8a93a0", shape: { vertices: [[-.03, -.015, 0], [.03, -.015, 0], [.03, .015, 0], [-.03, .015, 0]], triangles: [[0, 1, 2], [0, 2, 3]] } };
  }

  trianglesOf(part) {
    const { shape } = this.typeOf(part);
    const R = rotationOf(part.orientation);
    const vertices = shape.vertices.map((v) => add(apply(R, v), part.position));
    return shape.triangles.map((t) => t.map((i) => vertices[i]));
  }

  outline(context, triangles) {
    context.beginPath();
    for (const t of triangles) {
      context.moveTo(...this.at(t[0]));
      context.lineTo(...this.at(t[1]));
      context.lineTo(...this.at(t[2]));
      context.closePath();
    }
  }

  drawShadow(context, part) {
    if (part.status === "lost") return;
    context.save();
    context.shadowColor = "rgba(80, 50, 10, .45)";
    context.shadowBlur = 12 + 80 * Math.max(0, part.position[2]);
    context.shadowOffsetX = 3 + 60 * Math.max(0, part.position[2]);
    context.shadowOffsetY = 4 + 60 * Math.max(0, part.position[2]);
    context.fillStyle = "#8b6b3d";
    this.outline(context, this.trianglesOf(part).filter(facesUp));
    context.fill("nonzero");
    context.restore();
  }

  drawPart(context, part) {
    const colour = this.typeOf(part).colour;
    const triangles = this.trianglesOf(part).filter(facesUp).sort((a, b) => a[0][2] + a[1][2] + a[2][2] - b[0][2] - b[1][2] - b[2][2]);
    context.save();
    context.globalAlpha = part.status === "tracked" ? 1 : part.status === "lost" ? 0.25 : 0.55;
    context.lineJoin = "round";
    for (const triangle of triangles) {
      const normal = normalOf(triangle);
      const lift = 6 * ((triangle[0][2] + triangle[1][2] + triangle[2][2]) / 3 - part.position[2]);  // lower faces are darker
      const light = 0.72 + Math.max(-0.14, Math.min(0.14, lift)) + 0.34 * Math.max(0, normal[0] * kLight[0] + normal[1] * kLight[1] + normal[2] * kLight[2]);
      context.fillStyle = context.strokeStyle = shade(colour, light);
      context.lineWidth = 0.8;
      this.outline(context, [triangle]);
      context.fill();
      context.stroke();
    }
    context.restore();
  }

  drawHand(context, hand) {
    if (!hand.centre.every(Number.isFinite) || !Number.isFinite(hand.radius)) return;
    const [x, y] = this.at(hand.centre);
    const r = Math.max(14, this.scale * Math.min(hand.radius, kLargestHand));
    const glow = context.createRadialGradient(x, y, r * 0.2, x, y, r);
    glow.addColorStop(0, "rgba(236, 170, 130, .85)");
    glow.addColorStop(1, "rgba(236, 170, 130, .15)");
    context.fillStyle = glow;
    context.beginPath();
    context.arc(x, y, r, 0, 2 * Math.PI);
    context.fill();
  }

  toTable(p_R) { return add(apply(this.robot.rotation, p_R), this.robot.position); }

  limb(context, from, to, width, colour) {
    context.lineCap = "round";
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(...this.at(from));
    context.lineTo(...this.at(to));
    context.stroke();
  }

  dot(context, p, r, colour) {
    context.fillStyle = colour;
    context.beginPath();
    context.arc(...this.at(p), r, 0, 2 * Math.PI);
    context.fill();
  }

  drawRobot(context, body) {
    const unit = this.scale / 100;
    const head = body.head();
    const middle = this.toTable([0, 0, 0]);
    context.save();
    context.shadowColor = "rgba(60, 50, 30, .3)";
    context.shadowBlur = 10;
    context.shadowOffsetY = 3;
    this.limb(context, this.toTable([0, 0.07, 0]), this.toTable([0, -0.07, 0]), 11 * unit, "#e3eaf0");
    for (const side of ["L", "R"]) {
      const arm = body.arm(side);
      this.limb(context, this.toTable(arm.shoulder), this.toTable(arm.elbow), 4.6 * unit, "#f2f6f9");
      this.limb(context, this.toTable(arm.elbow), this.toTable(arm.hand), 4.2 * unit, "#ffffff");
    }
    this.dot(context, middle, 6.6 * unit, "#ffffff");
    context.restore();
    for (const side of [1, -1]) {  // ears and eyes show where it looks
      const ear = this.toTable(apply(head, [0, side * 0.066, 0])), eye = this.toTable(apply(head, [0.05, side * 0.028, 0]));
      this.dot(context, ear, 1.9 * unit, "#e8734a");
      this.dot(context, eye, 1.2 * unit, "#24374a");
    }
  }

  drawTarget(context, time, body, target) {
    const [x, y] = this.at(target);
    const sides = ["L", "R"].map((side) => body.arm(side)).sort((a, b) => b.hand[0] - a.hand[0]);
    const hand = this.at(this.toTable(sides[0].hand));
    context.save();
    context.strokeStyle = "rgba(232, 115, 74, .95)";
    context.lineWidth = 4;
    context.lineCap = "round";
    context.setLineDash([1, 13]);
    context.lineDashOffset = -time / 30;
    context.beginPath();
    context.moveTo(...hand);
    context.lineTo(x, y);
    context.stroke();
    context.setLineDash([]);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const beat = calm ? 0.5 : (time % 1400) / 1400;
    for (const [r, alpha] of [[26, 1], [26 + 22 * beat, 1 - beat]]) {
      context.globalAlpha = alpha;
      context.strokeStyle = "#fff";
      context.lineWidth = 8;
      ring(context, x, y, r);
      context.strokeStyle = "#d9541f";
      context.lineWidth = 4.5;
      ring(context, x, y, r);
    }
    context.restore();
  }
}

function ring(context, x, y, r) {
  context.beginPath();
  context.arc(x, y, r, 0, 2 * Math.PI);
  context.stroke();
}

function normalOf([a, b, c]) {
  const u = b.map((v, i) => v - a[i]), v = c.map((w, i) => w - a[i]);
  const m = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...m) || 1;
  return m.map((w) => w / length);
}
const facesUp = (triangle) => normalOf(triangle)[2] > 1e-3;

function shade(hex, light) {
  const value = parseInt(hex.slice(1), 16);
  const channel = (shift) => Math.min(255, Math.round(((value >> shift) & 255) * light));
  return `rgb(${channel(16)}, ${channel(8)}, ${channel(0)})`;
}
