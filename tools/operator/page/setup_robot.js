// Set-up, fifth step: which robot, and where it sits.
import {element, readable} from './dom.js';
import {post} from './connection.js';
import {calibrating, calibrationKey} from './setup_calibration.js';
import {t} from './words.js';

const TRACKED = 0;
const FIELDS = [['x', 'position', 0, 100], ['y', 'position', 1, 100], ['z', 'position', 2, 100], ['yaw', 'roll_pitch_yaw', 2, 1]];
let form = null;     // what is being edited; null: as saved
let mark = {near: null, far: null, ahead: 15, height: 10};

const shown = (status) => form ?? status.robot;

function number(label, value, id, change) {
  return element('label', {class: 'field'}, element('span', {}, label), element('input', {type: 'number', id, step: 'any', value, 'data-focus': id, change: (event) => change(Number(event.target.value))}));
}

function edit(status, change, redraw) {
  form = structuredClone(shown(status));
  change(form);
  redraw();
}

async function measure(status, {toast, redraw}, parts) {
  const answer = await post('api/setup/seat', {near: mark.near ?? parts[0], far: mark.far ?? parts[1], ahead: mark.ahead / 100, height: mark.height / 100});
  if (!answer.position) return toast(['unseen', 'close'].includes(answer.error) ? t(`setup.seat_error.${answer.error}`) : t('not_sent', answer.error ?? t('no_network')), true);
  edit(status, (robot) => Object.assign(robot, answer, {seated: true}), redraw);
}

function measuring(status, page, tools) {
  const parts = (page.view?.parts ?? []).map((part, index) => index).filter((index) => page.view.parts[index].status === TRACKED && page.task?.parts?.[index]);
  const choice = (key, standard) => element('label', {class: 'field'}, element('span', {}, t(`setup.${key}`)), element('select', {'data-focus': key, change: (event) => { mark[key] = Number(event.target.value); }},
    parts.map((index) => element('option', {value: index, selected: index === (mark[key] ?? standard)}, readable(page.task.parts[index].name)))));
  return element('details', {open: !status.robot.seated && shown(status).back_end !== 'nao'}, element('summary', {}, t('setup.measure_title')), element('p', {class: 'lead'}, t('setup.measure_lead')),
    element('div', {class: 'fields'}, choice('near', parts[0]), choice('far', parts[1]),
      number(t('setup.ahead'), mark.ahead, 'setup-ahead', (value) => { mark.ahead = value; }), number(t('setup.height'), mark.height, 'setup-height', (value) => { mark.height = value; })),
    element('button', {type: 'button', id: 'setup-measure', 'data-focus': 'measure', disabled: parts.length < 2, click: () => measure(status, tools, parts)}, t('setup.measure')));
}

export const robotStep = {
  name: 'robot',
  done: ({robot}) => robot.seated,
  key: (status, page) => [shown(status), calibrationKey(), page.task?.revision, page.view?.parts?.map((part) => part.status === TRACKED)],
  show(status, page, tools) {
    const robot = shown(status);
    return [
      element('div', {class: 'fields'},
        element('label', {class: 'field'}, element('span', {}, t('setup.back_end')), element('select', {'data-focus': 'back-end', change: (event) => edit(status, (one) => { one.back_end = event.target.value; }, tools.redraw)},
          ['virtual', 'nao', 'log'].map((name) => element('option', {value: name, selected: name === robot.back_end}, t(`setup.back_ends.${name}`))))),
        robot.back_end === 'nao' && element('label', {class: 'field'}, element('span', {}, t('setup.url')), element('input', {type: 'text', value: robot.url, 'data-focus': 'url', change: (event) => edit(status, (one) => { one.url = event.target.value; }, tools.redraw)}))),
      robot.back_end === 'nao' && calibrating(robot, page, tools, ({position, roll_pitch_yaw}) => edit(status, (one) => Object.assign(one, {position, roll_pitch_yaw, seated: true}), tools.redraw)),
      measuring(status, page, tools),
      element('h3', {}, t('setup.seat_title')), element('p', {class: 'lead'}, t(robot.seated ? 'setup.seat_known' : 'setup.seat_open')),
      element('div', {class: 'fields'}, FIELDS.map(([name, list, index, scale]) => number(t(`setup.seat_${name}`), Math.round(robot[list][index] * scale * 10) / 10, `seat-${name}`,
        (value) => edit(status, (one) => { one[list][index] = value / scale; }, tools.redraw))))];
  },
  async leave({save, status}) {
    const {back_end, position, roll_pitch_yaw, url} = shown(status());
    const saved = await save({robot: {back_end, position, roll_pitch_yaw, ...(back_end === 'nao' && {url})}});
    if (saved) form = null;
    return saved;
  },
};
