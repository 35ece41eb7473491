// What happened when: a track of dots and the list behind it.
import {byId, clock, element, readable, rebuild, svg} from './dom.js';
import {t} from './words.js';

const COLOUR = {connect: '#1d7a46', wrong: '#b3261e', disconnect: '#b36a00', repair: '#8a5cc9', operator: '#1c5fb8', say: '#1f5f5b', session: '#566363'};
const LANES = [['connect', 'wrong', 'disconnect', 'repair'], ['say', 'act'], ['operator', 'session']];
const LISTED = 150;
const MARKS = 8;  // on the track, at most
const events = [];
let session = null;

/** Takes the events of a state: all of a session once, then only new ones. */
export function addEvents(state) {
  if (state.lesson.session !== session) {
    session = state.lesson.session;
    events.length = 0;
  }
  const known = new Set(events.map((event) => event.id));
  for (const event of state.events) if (!known.has(event.id)) events.push(event);
}

/** Data's time, us; events before the first frame have none (0) and count as the start. null: nothing has happened yet. */
export const startOfLesson = () => (events.find((event) => event.utime > 0) ?? events[0])?.utime ?? null;

export function showTimeline(state, task) {
  const start = startOfLesson();
  const end = Math.max(state.data_utime, events.at(-1)?.utime ?? 0);
  byId('lesson-time').textContent = start ? t('lesson_of', clock((end - start) / 1e6)) : '';
  const shown = events.filter((event) => event.kind in COLOUR);
  rebuild(byId('track'), [Math.floor(end / 2e6), byId('track').clientWidth, shown.length, state.annotations.length, session], () => track(start, end, shown, state.annotations));
  rebuild(byId('events'), [document.documentElement.lang, shown.length, session, task?.revision], () =>
    shown.length ? shown.slice(-LISTED).reverse().map((event) => row(event, start, task)) : element('li', {}, element('span'), element('span'), t('no_events')));
}

function track(start, end, shown, annotations) {
  const width = byId('track').clientWidth || 600, span = Math.max(end - (start ?? end), 30e6);
  const x = (utime) => 8 + Math.max(utime - start, 0) / span * (width - 16);
  const root = svg('svg', {viewBox: `0 0 ${width} 74`, 'aria-hidden': 'true'});
  LANES.forEach((_, lane) => root.append(svg('line', {x1: 0, x2: width, y1: 12 + lane * 16, y2: 12 + lane * 16, stroke: '#e2dfd6'})));
  if (start === null) return root;
  const step = [10, 30, 60, 120, 300, 600, 1800, 3600].find((s) => span / 1e6 / s <= MARKS) ?? span / 1e6 / MARKS;
  for (let s = 0; s <= span / 1e6; s += step) {
    root.append(svg('text', {x: x(start + s * 1e6), y: 71, 'font-size': 11, fill: '#566363', 'text-anchor': s ? 'middle' : 'start'}, clock(s)));
  }
  for (const event of shown) {
    const lane = LANES.findIndex((kinds) => kinds.includes(event.kind));
    const at = lane === 0 && event.since > start ? event.since : event.utime;
    root.append(svg('circle', {cx: x(at), cy: 12 + Math.max(lane, 0) * 16, r: lane === 0 ? 6 : 4, fill: COLOUR[event.kind]},
      svg('title', {}, `${t(`events.${event.kind}`)} ${event.subject}`)));
  }
  for (const annotation of annotations) {
    if (annotation.utime < start || annotation.utime > end) continue;
    root.append(svg('path', {d: `M${x(annotation.utime)} 48l5 9h-10z`, fill: '#8a5cc9'}, svg('title', {}, annotation.subject || annotation.value)));
  }
  return root;
}

function row(event, start, task) {
  const dot = element('span', {class: 'event-dot', 'aria-hidden': 'true'});
  dot.style.background = COLOUR[event.kind];
  const parts = [event.part_a, event.part_b].filter((part) => part >= 0).map((part) => task?.parts?.[part]).filter(Boolean).map((part) => readable(part.name));
  const detail = [parts.join(' + '), event.reason].filter(Boolean).join(' · ');
  return element('li', {}, element('time', {}, clock((event.utime - start) / 1e6)), dot,
    element('span', {}, `${t(`events.${event.kind}`)}: ${readable(event.subject)} `, detail && element('small', {}, detail)));
}
