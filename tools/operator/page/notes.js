// A second observer's notes: true events with their times, free notes, the questionnaire.
import {byId, clock, element, readable, rebuild, svg, swatch} from './dom.js';
import {colourOf} from './colours.js';
import {post} from './connection.js';
import {planOf} from './plan.js';
import {startOfLesson} from './timeline.js';
import {t} from './words.js';

const SHIFT = 0.5;  // s
let moment = () => 0;

async function keep(annotation, toast) {
  const annotator = byId('annotator').value;
  localStorage.setItem('annotator', annotator);
  const answer = await post('api/annotation', {annotator, utime: moment(), ...annotation});
  if (!answer.id) toast(t('not_sent', answer.error ?? t('no_network')), true);
  return Boolean(answer.id);
}

/** @param now () => data time, us */
export function setUpNotes(now, toast) {
  moment = now;
  byId('annotator').value = localStorage.getItem('annotator') ?? '';
  byId('note').addEventListener('submit', async (event) => {
    event.preventDefault();
    const text = byId('note-text');
    if (text.value.trim() && await keep({kind: 'note', value: text.value.trim()}, toast)) text.value = '';
  });
}

export function showNotes(state, task, toast) {
  const language = document.documentElement.lang;
  rebuild(byId('note-connections'), [task?.revision, language, task?.plans && task.plans.indexOf(planOf(task, state.lesson))], () => !task?.connections ? [] : [
    ...(planOf(task, state.lesson)?.joints ?? []).map((joint) => task.connections[joint.connection]).map((connection) => buttons(connection.name, [...connection.slots.map((slot) => swatch(colourOf(task.types[task.slots[slot].type]))), ' ', readable(connection.name)], ['connect', 'disconnect'], toast)),
    ...task.mistakes.map((mistake) => buttons(mistake.name, [...mistake.types.map((type) => swatch(colourOf(task.types[type]))), ' ', readable(mistake.name)], ['wrong', 'disconnect'], toast)),
    buttons('unknown', [t('wrong_other')], ['wrong', 'disconnect'], toast)]);
  const notes = [...state.annotations].reverse();
  rebuild(byId('annotations'), [language, notes.map((note) => note.id), startOfLesson()], () =>
    notes.length ? notes.map((note) => kept(note, toast)) : element('li', {}, t('no_notes')));
}

function buttons(subject, label, kinds, toast) {
  return element('div', {class: 'note-row'}, element('div', {}, label),
    element('div', {}, kinds.map((kind) => element('button', {type: 'button', class: 'small', 'data-focus': `${kind}-${subject}`,
      'aria-label': `${t(`note_${kind}`)}: ${readable(subject)}`, click: () => keep({kind, subject}, toast)}, t(`note_${kind}`)))));
}

function kept(note, toast) {
  const start = startOfLesson();
  const change = (changes) => () => keep({...note, ...changes, replaces_id: note.id}, toast);
  const timed = ['connect', 'wrong', 'disconnect'].includes(note.kind);
  return element('li', {},
    element('time', {}, start && note.utime >= start ? clock((note.utime - start) / 1e6) : '–'),
    element('span', {}, element('strong', {}, `${t(`kind.${note.kind}`)} `), [readable(note.subject), note.value, note.annotator && `(${note.annotator})`].filter(Boolean).join(' ')),
    element('div', {},
      timed && element('button', {type: 'button', class: 'small', 'aria-label': t('earlier', SHIFT), click: change({utime: note.utime - SHIFT * 1e6})}, `− ${SHIFT} s`),
      timed && element('button', {type: 'button', class: 'small', 'aria-label': t('later', SHIFT), click: change({utime: note.utime + SHIFT * 1e6})}, `+ ${SHIFT} s`),
      element('button', {type: 'button', class: 'small', click: change({kind: 'removed'})}, t('remove'))));
}

/** Questions with five faces each. Answers are notes of kind 'questionnaire': subject = question's number, value = 1..5. */
export function showQuestionnaire(toast) {
  const form = byId('questionnaire');
  rebuild(form, [document.documentElement.lang], () => [
    element('label', {class: 'field'}, element('span', {}, t('child')), element('input', {type: 'text', id: 'child', maxlength: 40, autocomplete: 'off'})),
    ...[0, 1, 2, 3, 4].map((question) => element('fieldset', {}, element('legend', {}, t(`question.${question}`)),
      element('div', {class: 'faces'}, [0, 1, 2, 3, 4].map((grade) => element('label', {},
        element('input', {type: 'radio', name: `question-${question}`, value: grade + 1}), face(grade), element('span', {}, t(`face.${grade}`))))))),
    element('button', {type: 'submit', class: 'primary'}, t('questions_send'))]);
  form.onsubmit = async (event) => {
    event.preventDefault();
    const child = byId('child').value;
    let good = true;
    for (const [name, grade] of new FormData(form)) {
      good = await keep({kind: 'questionnaire', subject: name.replace('question-', ''), value: child ? `${grade} ${child}` : grade}, toast) && good;
    }
    if (good) { form.reset(); toast(t('questions_kept')); }
  };
}

function face(grade) {
  const bend = (grade - 2) * 5;
  return svg('svg', {viewBox: '0 0 52 52', 'aria-hidden': 'true'},
    svg('circle', {cx: 26, cy: 26, r: 24, fill: ['#f3c6bd', '#f6dcb8', '#f7ecb8', '#dcedbb', '#bfe6c5'][grade], stroke: '#566363', 'stroke-width': 1.5}),
    svg('circle', {cx: 18, cy: 21, r: 3, fill: '#1d2a2a'}), svg('circle', {cx: 34, cy: 21, r: 3, fill: '#1d2a2a'}),
    svg('path', {d: `M15 ${35 - bend / 2}Q26 ${35 + bend} 37 ${35 - bend / 2}`, fill: 'none', stroke: '#1d2a2a', 'stroke-width': 2.6, 'stroke-linecap': 'round'}));
}
