// The robot's joint angles over time, and where its arms and head are: the same chain as services/robot_bridge/kinematics.h.
export const multiply = (A, B) => A.map((row) => B[0].map((_, j) => row.reduce((sum, a, k) => sum + a * B[k][j], 0)));
export const apply = (A, v) => A.map((row) => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const Rx = (a) => [[1, 0, 0], [0, Math.cos(a), -Math.sin(a)], [0, Math.sin(a), Math.cos(a)]];
const Ry = (a) => [[Math.cos(a), 0, Math.sin(a)], [0, 1, 0], [-Math.sin(a), 0, Math.cos(a)]];
const Rz = (a) => [[Math.cos(a), -Math.sin(a), 0], [Math.sin(a), Math.cos(a), 0], [0, 0, 1]];
export function rotationOf([w, x, y, z]) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
}

export class Body {
  constructor() {
    this.angles = {};
    this.motions = new Map();  // joint name -> {times, angles, begun}
    this.now = 0;
  }

  configure(joints) {
    for (const joint of joints) this.angles[joint.name] ??= joint.rest;
  }

  move({ joints, times, angles }) {
    joints.forEach((name, j) => this.motions.set(name, { times, angles: angles.map((row) => row[j]), begun: this.now }));
  }

  freeze() { this.motions.clear(); }

  advance(time) {
    this.now = time;
    for (const [name, { times, angles, begun }] of this.motions) {
      const t = (time - begun) / 1000;
      let i = 1;
      while (i < times.length - 1 && times[i] < t) ++i;
      const share = Math.min(1, Math.max(0, (t - times[i - 1]) / (times[i] - times[i - 1])));
      this.angles[name] = angles[i - 1] + share * (angles[i] - angles[i - 1]);
      if (t >= times[times.length - 1]) this.motions.delete(name);
    }
  }

  /// Points of an arm in the torso's frame. @param side "L" or "R"
  arm(side) {
    const sign = side === "L" ? 1 : -1;
    const angle = (joint) => this.angles[side + joint] ?? 0;
    const upper = multiply(Ry(angle("ShoulderPitch")), Rz(angle("ShoulderRoll")));
    const fore = multiply(multiply(upper, Rx(angle("ElbowYaw"))), Rz(angle("ElbowRoll")));
    const shoulder = [0, sign * 0.098, 0.1];
    const elbow = add(shoulder, apply(upper, [0.105, sign * 0.015, 0]));
    const direction = [fore[0][0], fore[1][0], fore[2][0]];
    return { shoulder, elbow, wrist: add(elbow, scale(direction, 0.05595)), hand: add(elbow, scale(direction, 0.1137)), direction };
  }

  head() {
    return multiply(Rz(this.angles.HeadYaw ?? 0), Ry(this.angles.HeadPitch ?? 0));
  }
}
