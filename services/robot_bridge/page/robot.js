// Draws the robot as the child sees it from across the table: its joints in perspective, its face on a ball that turns.
import { add, apply } from "/body.js";

const kScale = 1230;      // px a metre at the torso
const kDistance = 0.95;   // m from the eye to the torso
const kOrigin = [300, 418];
const kHeadCentre = [0, 0, 0.212];
const kHeadRadius = 0.108;
const kCoral = "#e8734a", kLine = "#b9c8d4", kDark = "#24374a";

function project([x, y, z]) {
  const s = kDistance / (kDistance - x);
  return { x: kOrigin[0] + kScale * s * y, y: kOrigin[1] - kScale * s * z, s };
}

const attributes = (values) => Object.entries(values).map(([key, value]) => ` ${key}="${value}"`).join("");
const tag = (name, values, inner = "") => `<${name}${attributes(values)}>${inner}</${name}>`;
const n = (value) => value.toFixed(1);

/// The outline around two circles.
function capsule(a, ra, b, rb) {
  const dx = b.x - a.x, dy = b.y - a.y, length = Math.hypot(dx, dy);
  if (length <= Math.abs(ra - rb) + 0.1) {
    const big = ra > rb ? [a, ra] : [b, rb];
    return `M${n(big[0].x - big[1])} ${n(big[0].y)}a${n(big[1])} ${n(big[1])} 0 1 0 ${n(2 * big[1])} 0a${n(big[1])} ${n(big[1])} 0 1 0 ${n(-2 * big[1])} 0z`;
  }
  const along = Math.atan2(dy, dx), open = Math.acos((ra - rb) / length);
  const at = (c, r, angle) => `${n(c.x + r * Math.cos(angle))} ${n(c.y + r * Math.sin(angle))}`;
  return `M${at(a, ra, along + open)}A${n(ra)} ${n(ra)} 0 1 1 ${at(a, ra, along - open)}L${at(b, rb, along - open)}` +
    `A${n(rb)} ${n(rb)} 0 ${open > Math.PI / 2 ? 1 : 0} 1 ${at(b, rb, along + open)}z`;
}

function drawArm(body, side, pointing) {
  const arm = body.arm(side);
  const shoulder = project(arm.shoulder), elbow = project(arm.elbow), wrist = project(arm.wrist), hand = project(arm.hand);
  const skin = { fill: "url(#shell)", stroke: kLine, "stroke-width": 2.5, "stroke-linejoin": "round" };
  let out = tag("path", { d: capsule(shoulder, 33, elbow, 25 * elbow.s), ...skin });
  out += tag("circle", { cx: n(shoulder.x), cy: n(shoulder.y), r: 15, fill: kCoral, opacity: 0.9 });
  out += tag("path", { d: capsule(elbow, 26 * elbow.s, wrist, 30 * wrist.s), ...skin });
  out += tag("circle", { cx: n(elbow.x), cy: n(elbow.y), r: n(11 * elbow.s), fill: kCoral, opacity: 0.9 });
  // A straight elbow is a pointing arm: it shows its finger.
  const stretched = Math.abs(body.angles[side + "ElbowRoll"] ?? 1) < 0.12;
  const across = side === "L" ? -1 : 1;
  const thumb = { x: hand.x + across * 19 * hand.s, y: hand.y - 12 * hand.s };
  out += tag("path", { d: capsule(hand, 9 * hand.s, thumb, 8 * hand.s), ...skin });
  if (stretched && pointing) {
    const tip = project(add(arm.hand, arm.direction.map((d) => d * 0.06)));
    out += tag("path", { class: "finger", d: capsule(hand, 12 * hand.s, tip, 9 * tip.s), ...skin });
    out += tag("circle", { cx: n(hand.x), cy: n(hand.y), r: n(22 * hand.s), ...skin });
    out += tag("path", { d: capsule(hand, 9 * hand.s, tip, 8 * tip.s), fill: "url(#shell)" });
    out += tag("circle", { cx: n(tip.x), cy: n(tip.y), r: n(6 * tip.s), fill: kCoral });
  } else {
    out += tag("circle", { cx: n(hand.x), cy: n(hand.y), r: n(24 * hand.s), ...skin });
    for (const dx of [-8, 0, 8]) {
      out += tag("path", { d: `M${n(hand.x + dx * hand.s)} ${n(hand.y + 9 * hand.s)}v${n(9 * hand.s)}`, stroke: kLine,
        "stroke-width": 2.2, "stroke-linecap": "round" });
    }
  }
  return out;
}

function drawTorso(breath) {
  const y = kOrigin[1];
  const d = `M212 ${y - 118}C214 ${y - 152} 386 ${y - 152} 388 ${y - 118}C398 ${y - 30} 384 ${y + 70 + breath} 366 ${y + 150}` +
    `H234C216 ${y + 70 + breath} 202 ${y - 30} 212 ${y - 118}z`;
  let out = tag("path", { d, fill: "url(#shell)", stroke: kLine, "stroke-width": 2.5 });
  out += tag("path", { d: `M228 ${y - 70}Q300 ${y - 30} 372 ${y - 70}`, fill: "none", stroke: "#d7e0e8", "stroke-width": 3 });
  out += tag("circle", { cx: 300, cy: y - 8, r: 21, fill: "#fff", stroke: kLine, "stroke-width": 2.5 });
  out += tag("circle", { cx: 300, cy: y - 8, r: 12, fill: kCoral });
  return tag("path", { d: `M268 ${y - 150}h64v40h-64z`, fill: "#c3d0db" }) + out;  // the neck behind
}

/// A place on the head's ball: its middle on the screen, and how much it is seen from the side.
function onHead(head, azimuth, elevation, radius = kHeadRadius) {
  const direction = [Math.cos(elevation) * Math.cos(azimuth), Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation)];
  const d = apply(head, direction);
  const p = project(add(kHeadCentre, d.map((c) => c * radius)));
  return { ...p, facing: d[0], wide: Math.sqrt(Math.max(0.05, 1 - d[1] * d[1])), high: Math.sqrt(Math.max(0.05, 1 - d[2] * d[2])) };
}

function drawEar(head, side) {
  const p = onHead(head, side * Math.PI / 2, 0.02, 0.118);
  const wide = 14 + 26 * Math.abs(p.facing);
  return tag("ellipse", { cx: n(p.x), cy: n(p.y), rx: n(wide), ry: 36, fill: kCoral }) +
    tag("ellipse", { cx: n(p.x), cy: n(p.y), rx: n(wide * 0.6), ry: 22, fill: "#f6a283" });
}

function drawEye(head, side, { time, asleep, eyes }) {
  const p = onHead(head, side * 0.40, 0.06);
  if (p.facing < 0.05) return "";
  const phase = (time % 4300) / 4300;
  const open = asleep ? 0 : phase > 0.965 ? Math.abs(phase - 0.9825) / 0.0175 : 1;
  const rx = 31 * p.wide, ry = 33 * p.high;
  const frame = `translate(${n(p.x)} ${n(p.y)})`;
  if (open < 0.15) {
    return tag("path", { d: `M${n(-rx)} 4Q0 ${n(ry * 0.75)} ${n(rx)} 4`, fill: "none", stroke: kDark, "stroke-width": 6,
      "stroke-linecap": "round", transform: frame });
  }
  const ring = `<ellipse rx="${n(rx)}" ry="${n(ry)}" fill="${kDark}"/>` +
    `<ellipse rx="${n(rx * 0.82)}" ry="${n(ry * 0.82)}" fill="none" stroke="${eyes}" stroke-width="${n(9)}" ` +
    `pathLength="80" stroke-dasharray="8.600 1.400" filter="url(#glow)"/>` +
    `<ellipse rx="${n(rx * 0.50)}" ry="${n(ry * 0.50)}" fill="#101d2a"/>` +
    `<circle cx="${n(-rx * 0.2)}" cy="${n(-ry * 0.24)}" r="6.500" fill="#fff"/><circle cx="${n(rx * 0.2)}" cy="${n(ry * 0.2)}" r="3" fill="#fff" opacity=".8"/>`;
  return tag("g", { transform: `${frame} scale(1 ${n(open)})` }, ring);
}

function drawMouth(head, { time, talking, asleep }) {
  const p = onHead(head, 0, -0.46);
  if (p.facing < 0.1) return "";
  const w = 27 * p.wide;
  const frame = `translate(${n(p.x)} ${n(p.y)})`;
  if (talking) {
    const h = 5 + 9 * Math.abs(Math.sin(time / 88) * Math.sin(time / 213 + 1)) + 2 * Math.sin(time / 40);
    return tag("g", { transform: frame }, `<ellipse rx="${n(w * 0.8)}" ry="${n(h)}" fill="#9c3d2a"/>` +
      `<ellipse cy="${n(h * 0.5)}" rx="${n(w * 0.45)}" ry="${n(h * 0.4)}" fill="#f08a76"/>`);
  }
  const bend = asleep ? 4 : 17;
  return tag("path", { d: `M${n(-w)} -4Q0 ${bend} ${n(w)} -4`, fill: "none", stroke: "#9c3d2a", "stroke-width": 6,
    "stroke-linecap": "round", transform: frame });
}

function drawHead(body, look) {
  const head = body.head();
  const centre = project(add(kHeadCentre, apply(head, [0.012, 0, 0])));
  const ears = [-1, 1].map((side) => ({ side, behind: onHead(head, side * Math.PI / 2, 0).facing < 0.12 }));
  let out = ears.filter((ear) => ear.behind).map((ear) => drawEar(head, ear.side)).join("");
  const top = onHead(head, 0, 1.4, 0.096);
  out += tag("ellipse", { cx: n(top.x), cy: n(top.y), rx: 30, ry: 15, fill: kCoral });
  out += tag("ellipse", { cx: n(centre.x), cy: n(centre.y), rx: 143, ry: 122, fill: "url(#shell)", stroke: kLine, "stroke-width": 2.5 });
  const shine = onHead(head, 0.3, 0.62, 0.1);
  out += tag("ellipse", { cx: n(shine.x), cy: n(shine.y), rx: 34, ry: 11, fill: "#fff" });
  for (const side of [-1, 1]) {
    const cheek = onHead(head, side * 0.72, -0.28);
    if (cheek.facing > 0.15) {
      out += tag("ellipse", { cx: n(cheek.x), cy: n(cheek.y), rx: n(22 * cheek.wide), ry: 13, fill: "#f8b7a0", opacity: 0.65 });
    }
    out += drawEye(head, side, look);
  }
  out += drawMouth(head, look);
  out += ears.filter((ear) => !ear.behind).map((ear) => drawEar(head, ear.side)).join("");
  if (look.asleep) {
    for (const [i, size] of [26, 34, 44].entries()) {
      out += tag("text", { x: 448 + i * 26, y: 132 - i * 38, "font-size": size, "font-weight": 700, fill: "#6d8698" }, "z");
    }
  }
  return out;
}

const kDefinitions =
  `<defs><radialGradient id="shell" cx="42%" cy="28%" r="85%"><stop offset="0" stop-color="#ffffff"/>` +
  `<stop offset=".62" stop-color="#f3f6f9"/><stop offset="1" stop-color="#d5dfe8"/></radialGradient>` +
  `<linearGradient id="wood" x1="0" y1="0" x2="0" y2="1"><stop offset="0" stop-color="#f3dfbd"/><stop offset="1" stop-color="#dcbd8d"/></linearGradient>` +
  `<filter id="glow" x="-50%" y="-50%" width="200%" height="200%"><feGaussianBlur stdDeviation="3.200" result="b"/><feMerge><feMergeNode in="b"/><feMergeNode in="SourceGraphic"/></feMerge></filter></defs>`;

export function drawRobot(svg, body, look) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const breath = calm ? 0 : 2 * Math.sin(look.time / 1100);
  const arms = ["L", "R"].map((side) => ({ side, x: body.arm(side).hand[0] })).sort((a, b) => a.x - b.x);
  const table = tag("rect", { x: -600, y: 512, width: 1800, height: 400, fill: "url(#wood)" }) +
    tag("rect", { x: -600, y: 512, width: 1800, height: 7, fill: "#fff4dc" });
  const shadow = tag("ellipse", { cx: 300, cy: 524, rx: 170, ry: 12, fill: "#7c5a2a", opacity: 0.22 });
  svg.innerHTML = kDefinitions + drawTorso(breath) + table + shadow + tag("g", { transform: `translate(0 ${n(-breath / 2)})` },
    drawHead(body, look)) + arms.map((arm) => drawArm(body, arm.side, look.pointing)).join("");
}
