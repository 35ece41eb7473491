#include "tools/report/style.h"

namespace coach {

const char* const kStyleSheet = R"css(
:root { --paper: #f5f4ef; --card: #fff; --line: #e2dfd6; --ink: #1d2a2a; --soft: #566363; --accent: #1f5f5b; --made: #1d7a46; --wrong: #b3261e; --amber: #8a5a00; --blue: #1c5fb8; }
* { box-sizing: border-box; }
body { margin: 0; font: 15px/1.5 system-ui, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", "DejaVu Sans", sans-serif; color: var(--ink); background: var(--paper); }
header { background: var(--accent); color: #fff; padding: 1.6rem 2rem 1.4rem; }
header h1 { margin: 0; font-size: 1.7rem; letter-spacing: -0.01em; }
header p { margin: 0.3rem 0 0; opacity: 0.9; overflow-wrap: anywhere; }
nav { display: flex; flex-wrap: wrap; gap: 0.3rem 1.3rem; padding: 0.7rem 2rem; background: var(--card); border-bottom: 1px solid var(--line); }
nav a { color: var(--accent); font-weight: 600; text-decoration: none; }
nav a:hover { text-decoration: underline; }
main { max-width: 1160px; margin: 0 auto; padding: 1.2rem 1rem 3rem; }
section { margin-top: 1.6rem; }
h2 { font-size: 1.25rem; margin: 0 0 0.7rem; overflow-wrap: anywhere; }
h3 { font-size: 1.02rem; margin: 0 0 0.5rem; display: flex; flex-wrap: wrap; gap: 0.2rem 0.8rem; align-items: baseline; }
h3 small { font-weight: 400; color: var(--soft); font-size: 0.86rem; }
.card { background: var(--card); border: 1px solid var(--line); border-radius: 12px; padding: 1rem 1.2rem; margin-bottom: 1rem; break-inside: avoid; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 0.8rem; }
.tile { background: var(--card); border: 1px solid var(--line); border-radius: 12px; padding: 0.8rem 1rem; break-inside: avoid; }
.tile b { display: block; font-size: 1.55rem; line-height: 1.2; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: 0.88rem; }
.two { display: grid; grid-template-columns: repeat(auto-fit, minmax(400px, 1fr)); gap: 1rem; }
.two > .card { margin: 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 0.9rem; }
th { text-align: left; color: var(--soft); font-weight: 600; border-bottom: 2px solid var(--line); padding: 0.3rem 0.7rem 0.3rem 0; vertical-align: bottom; }
td { border-bottom: 1px solid #efece4; padding: 0.26rem 0.7rem 0.26rem 0; vertical-align: top; overflow-wrap: anywhere; }
tr { break-inside: avoid; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.soft, .soft { color: var(--soft); }
td.heading { font-weight: 700; padding-top: 0.9rem; }
.tag { display: inline-block; border-radius: 99px; padding: 0 0.6rem; font-size: 0.8rem; font-weight: 600; background: #e8e6df; }
.tag.good { background: #e1f3e7; color: var(--made); } .tag.bad { background: #fbe5e3; color: var(--wrong); }
.problems { background: #fdf1d6; border: 1px solid #ecd9a8; border-radius: 12px; padding: 0.7rem 1.2rem; margin: 0 0 1rem; }
.problems ul { margin: 0.2rem 0 0; padding-left: 1.2rem; }
details { margin-top: 0.6rem; } summary { cursor: pointer; color: var(--accent); font-weight: 600; }
pre { overflow-x: auto; background: #faf9f5; border: 1px solid var(--line); border-radius: 8px; padding: 0.7rem; font-size: 0.8rem; white-space: pre-wrap; overflow-wrap: anywhere; }
svg { display: block; width: 100%; height: auto; }
svg text { font: 11px system-ui, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", "DejaVu Sans", sans-serif; fill: var(--ink); }
.label { text-anchor: end; } .tick { text-anchor: middle; fill: var(--soft); } .unit, .key-name { fill: var(--soft); }
svg text.wrong { fill: var(--wrong); } svg text.plot-title { font-weight: 700; font-size: 13px; }
svg text.words { font-size: 10px; pointer-events: none; } svg text.tick, svg text.unit, svg text.key-name { fill: #566363; }
.grid { stroke: #e6e3da; stroke-width: 1; } .ground { fill: #f3f1ea; } .finish { stroke: var(--made); stroke-width: 1.5; stroke-dasharray: 4 3; }
.bound { stroke: var(--wrong); stroke-dasharray: 4 3; }
.probability { fill: #9fc9c4; fill-opacity: 0.75; stroke: #4a928b; stroke-width: 0.8; }
.dated { stroke: #1d2a2a; stroke-width: 1.6; }
.truth { fill: #1d2a2a; stroke: #fff; stroke-width: 0.8; } .missed { fill: #fff; stroke: var(--wrong); stroke-width: 2; }
.made { fill: #2c9a5c; stroke: #fff; stroke-width: 1; } .mistake { fill: var(--wrong); stroke: #fff; stroke-width: 1; }
.undone { fill: #8b9494; stroke: #fff; stroke-width: 1; } .false { fill: #fff; stroke: #d97706; stroke-width: 2.4; }
.phase-introduction, .phase-announce { fill: #bcd3ef; } .phase-wait { fill: #d9dcd6; } .phase-correct, .phase-complete { fill: #a9dcb9; } .phase-wrong { fill: #eea8a2; }
.phase-idle { fill: #f1d58e; } .phase-away { fill: #c4bda9; } .phase-tracking_lost { fill: #d7b5df; } .phase-paused { fill: #9aa3a3; }
.say-explain { fill: #bcd3ef; } .say-praise { fill: #a9dcb9; } .say-corrective { fill: #eea8a2; } .say-hint { fill: #f1d58e; } .say-operator { fill: #d7c3ea; }
.broken { stroke: #1d2a2a; stroke-dasharray: 3 2; fill-opacity: 0.45; } .look { fill: #1c5fb8; } .point { fill: #d97706; }
.order { fill: #6b3fa0; } .note { fill: #8a5a00; }
.tracked { fill: #7cc293; } .occluded { fill: #f1c75b; } .outside { fill: #b9bfc4; } .lost { fill: #c9302c; } .absent { fill: #ffffff; stroke: #c9c5b9; stroke-width: 0.5; }
.legend { display: flex; flex-wrap: wrap; gap: 0.2rem 1.1rem; margin: 0.2rem 0 1rem; color: var(--soft); font-size: 0.85rem; }
.key { display: inline-flex; align-items: center; gap: 0.35rem; } .key svg { width: 16px; height: 16px; }
.line { fill: none; stroke-width: 1.8; stroke-linejoin: round; } .line-0 { stroke: #1f5f5b; } .line-1 { stroke: #d97706; } .line-2 { stroke: #1c5fb8; } .line-3 { stroke: #b3261e; } .line-4 { stroke: #6b3fa0; } .line-5 { stroke: #7a7a2a; }
.bar { fill: #4a928b; }
footer { color: var(--soft); font-size: 0.85rem; max-width: 1160px; margin: 0 auto; padding: 0 1rem 2rem; }
@page { size: A4; margin: 14mm 12mm; }
@media print { body { background: #fff; font-size: 11px; } nav { display: none; } main { padding: 0; max-width: none; } header { padding: 0.8rem 1rem; } .card, .tile { border-color: #ccc; } .two { grid-template-columns: 1fr 1fr; } h2, h3 { break-after: avoid; } section { break-inside: auto; } * { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
)css";

}  // namespace coach
