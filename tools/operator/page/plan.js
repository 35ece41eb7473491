// The assembly as a picture: what is made, missing, next and wrong.
import {byId, element, readable, rebuild, svg, swatch} from './dom.js';
import {colourOf} from './colours.js';
import {t} from './words.js';

const MADE = 1, UNSURE = 2, UNKNOWN_CONTACT = -1000;

/** 'blue and green' of a connection of the task. */
export function coloursOfConnection(task, index) {
  const words = task.connections[index].slots.map((slot) => typeOfSlot(task, slot).colour);
  return t('and', t(`colour.${words[0]}`), t(`colour.${words[1]}`));
}

export function connectionName(task, index) {
  return readable(task.connections[index].name);
}

const typeOfSlot = (task, slot) => task.types[task.slots[slot].type];

/** The plan of the variant that is being built: the task's own one until another is recognised. */
export function planOf(task, lesson) {
  const listed = lesson.connections.find((c) => c.connection >= 0)?.connection;
  return task.plans.find((plan) => plan.joints.some((joint) => joint.connection === listed)) ?? task.plans[0];
}

/** @param send (kind, argument) sends a command */
export function showPlan(task, lesson, send) {
  const language = document.documentElement.lang;
  const states = lesson.connections.map((c) => [c.connection, c.state, c.part_a, c.part_b]);
  rebuild(byId('plan'), [task.revision, states, lesson.step, language], () => drawing(task, lesson));
  rebuild(byId('connections'), [task.revision, states, lesson.step, language], () => rows(task, lesson, send));
  const progress = lesson.required ? (lesson.made >= lesson.required ? t('all_made', lesson.required) : t('progress', lesson.made, lesson.required)) : '';
  byId('progress').textContent = progress;
}

/** States of the task's connections, by index. */
function stateOf(lesson) {
  const byIndex = new Map();
  for (const connection of lesson.connections) {
    if (connection.connection >= 0) byIndex.set(connection.connection, connection);
  }
  return byIndex;
}

function drawing(task, lesson) {
  const plan = planOf(task, lesson);
  if (!plan?.slots.length) return element('p', {}, t('no_plan'));
  const unit = Math.max(plan.width, plan.height) / 100, margin = 9 * unit;
  const states = stateOf(lesson);
  const root = svg('svg', {viewBox: `${-margin} ${-margin} ${plan.width + 2 * margin} ${plan.height + 2 * margin}`, role: 'img', 'aria-label': t('assembly')});
  const order = plan.slots.map((_, index) => index).sort((a, b) => plan.slots[a].height - plan.slots[b].height);
  for (const slot of order) {
    const colour = colourOf(typeOfSlot(task, slot));
    const joined = plan.joints.some(({connection}) => task.connections[connection].slots.includes(slot) && states.get(connection)?.state === MADE);
    root.append(svg('path', {
      class: 'plan-slot', d: pathOf(plan.slots[slot].outlines), fill: colour, 'fill-rule': 'evenodd', stroke: colour,
      'fill-opacity': joined ? 0.95 : 0.22, 'stroke-dasharray': joined ? '' : `${2 * unit} ${1.5 * unit}`, 'stroke-width': 0.8 * unit}));
  }
  plan.joints.forEach(({connection, place: [x, y]}, index) => root.append(mark(index, x, y, 5.2 * unit, states.get(connection), connection === lesson.step)));
  return root;
}

function pathOf(outlines) {
  return outlines.map((polygon) => {
    let path = '';
    for (let k = 0; k < polygon.length; k += 2) path += `${k ? 'L' : 'M'}${polygon[k]} ${polygon[k + 1]}`;
    return path + 'Z';
  }).join('');
}

function mark(index, x, y, radius, connection, next) {
  const state = connection?.state ?? 0;
  const look = state === MADE ? {fill: '#1d7a46', stroke: '#ffffff', ink: '#ffffff', text: '✓'}
    : state === UNSURE ? {fill: '#fdf1d6', stroke: '#d99a1c', ink: '#8a5a00', text: '?'}
    : next ? {fill: '#e4eefb', stroke: '#1c5fb8', ink: '#1c5fb8', text: index + 1}
    : {fill: '#ffffff', stroke: '#8b9595', ink: '#566363', text: index + 1};
  return svg('g', {class: 'plan-mark', transform: `translate(${x} ${y})`},
    next && state !== MADE && svg('circle', {class: 'plan-next', r: radius * 1.4, 'stroke-width': radius * 0.2}),
    svg('circle', {r: radius, fill: look.fill, stroke: look.stroke, 'stroke-width': radius * 0.18}),
    svg('text', {fill: look.ink, 'font-size': radius * 1.15, y: radius * 0.05}, look.text));
}

function rows(task, lesson, send) {
  const states = stateOf(lesson);
  const mistakes = lesson.connections.filter((c) => c.connection < 0);
  return [...mistakes.map((mistake) => mistakeRow(task, mistake)),
          ...(planOf(task, lesson)?.joints ?? []).map(({connection}, number) => connectionRow(task, lesson, states.get(connection), connection, number + 1, send))];
}

function mistakeRow(task, mistake) {
  const part = (index) => (task.parts[index] ? readable(task.parts[index].name) : '?');
  const name = mistake.connection === UNKNOWN_CONTACT ? t('unknown_contact') : readable(task.mistakes[-1 - mistake.connection]?.name ?? '');
  return element('li', {class: 'wrong-row'}, element('span', {class: 'badge wrong', 'aria-hidden': 'true'}, '✕'),
    element('div', {}, t('wrong_with', part(mistake.part_a), part(mistake.part_b)), element('small', {}, name)));
}

function connectionRow(task, lesson, connection, index, number, send) {
  const state = connection?.state ?? 0;
  const next = index === lesson.step && state !== MADE;
  const kind = state === MADE ? 'made' : state === UNSURE ? 'unsure' : next ? 'next' : 'open';
  const name = connectionName(task, index);
  const parts = connection && connection.part_a >= 0 && connection.part_b >= 0
    ? t('and', readable(task.parts[connection.part_a].name), readable(task.parts[connection.part_b].name))
    : coloursOfConnection(task, index);
  const note = task.connections[index].closes_by_itself && state !== MADE ? `, ${t('closes')}` : '';
  const done = state === MADE;
  return element('li', {},
    element('span', {class: `badge ${kind}`, 'aria-hidden': 'true'}, done ? '✓' : state === UNSURE ? '?' : number),
    element('div', {}, ...task.connections[index].slots.map((slot) => swatch(colourOf(typeOfSlot(task, slot)))), ' ', name,
      element('small', {}, `${t(kind)}${note} · ${parts}`)),
    element('button', {type: 'button', class: 'small', 'data-focus': `mark-${index}`, 'aria-label': `${t(done ? 'mark_undone' : 'mark_done')}: ${name}`,
      click: () => send(done ? 'mark_undone' : 'mark_done', task.connections[index].name)}, t(done ? 'mark_undone' : 'mark_done')));
}
