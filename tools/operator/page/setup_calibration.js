// Set-up, fifth step for a robot with arms: its seat, measured by a part in its hand.
import {element, readable} from './dom.js';
import {fetchJson, post} from './connection.js';
import {t} from './words.js';

const RUNNING = ['connecting', 'moving'], REFUSALS = ['busy', 'lesson'];
const FEWEST = 6;        // poses that make a result
const PERIOD = 500;      // ms
const chosen = {part: 0, arm: 'right'};
let calibration = null;  // as the server tells it; null: not asked yet
let asking = false;

export const calibrationKey = () => [calibration];

/** Asks for the progress, again and again while the arm moves. */
async function follow(redraw) {
  if (asking) return;
  asking = true;
  do {
    calibration = await fetchJson('api/setup/calibration') ?? calibration ?? {state: 'none'};
    redraw();
    if (RUNNING.includes(calibration.state)) await new Promise((resolve) => { setTimeout(resolve, PERIOD); });
  } while (RUNNING.includes(calibration.state));
  asking = false;
}

async function start(url, {toast, redraw}) {
  const answer = await post('api/setup/calibrate', {...chosen, url});
  if (!answer.state) return toast(REFUSALS.includes(answer.error) ? t(`setup.arm_refused.${answer.error}`) : t('not_sent', answer.error ?? t('no_network')), true);
  calibration = answer;
  follow(redraw);
}

/** In the order of the fields below it. */
const seatOf = ({position, roll_pitch_yaw}) => `${position.map((metres) => (metres * 100).toFixed(1)).join(' · ')} cm, ${roll_pitch_yaw[2].toFixed(1)}°`;

/** Why there is no result, in the page's language; what the program says beside it. */
function reason({problem, poses, reports}) {
  const used = reports.filter((report) => report.used).length;
  if (problem === 'stopped') return t('setup.arm_stopped');
  if (!reports.length) return `${t('setup.arm_no_robot')} (${problem})`;
  return used < FEWEST ? t('setup.arm_unseen', used, poses, FEWEST) : `${t('setup.arm_bad')} (${problem})`;
}

function outcome(robot, accept, tools) {
  if (calibration.state === 'failed') return element('p', {class: 'verdict bad', role: 'alert'}, reason(calibration));
  if (calibration.state !== 'done') return null;
  const {good, residual_mm, expected_mm} = calibration;
  const answered = (use) => () => {
    if (use) accept(calibration);
    calibration = {state: 'none'};
    tools.redraw();
  };
  return [
    element('p', {class: good ? 'verdict good' : 'verdict bad', role: 'status'}, t(good ? 'setup.arm_good' : 'setup.arm_bad'), ' ', t('setup.arm_error', residual_mm, expected_mm)),
    element('dl', {class: 'seats'}, element('dt', {}, t('setup.arm_old')), element('dd', {}, seatOf(robot)), element('dt', {}, t('setup.arm_new')), element('dd', {}, seatOf(calibration))),
    element('p', {class: 'row'},
      good && element('button', {type: 'button', class: 'primary', id: 'setup-arm-accept', 'data-focus': 'arm-accept', click: answered(true)}, t('setup.arm_accept')),
      element('button', {type: 'button', id: 'setup-arm-keep', 'data-focus': 'arm-keep', click: answered(false)}, t('setup.arm_keep')))];
}

function progress() {
  const {state, problem, poses, reports} = calibration, pose = Math.min(reports.length + 1, poses);
  return [
    element('p', {class: 'verdict wait', role: 'status'}, state === 'connecting' ? `${t('setup.arm_connecting')} ${problem}` : reports.length < poses ? t('setup.arm_pose', pose, poses) : t('setup.arm_down')),
    element('ol', {class: 'poses'}, Array.from({length: poses}, (_, index) => {
      const report = reports[index];
      return element('li', {class: report ? report.used ? 'badge made' : 'badge wrong' : index + 1 === pose && state === 'moving' ? 'badge next' : 'badge open', 'aria-label': t(report ? report.used ? 'setup.arm_seen' : 'setup.arm_missed' : 'setup.arm_pose', index + 1, poses)}, report ? report.used ? '✓' : '!' : index + 1);
    }))];
}

/** @param robot what is being edited; accept(seat) takes the measured one over */
export function calibrating(robot, page, tools, accept) {
  if (!calibration) { follow(tools.redraw); return null; }
  const running = RUNNING.includes(calibration.state), parts = page.task?.parts ?? [];
  const choice = (key, options) => element('label', {class: 'field'}, element('span', {}, t(`setup.arm_${key}`)),
    element('select', {'data-focus': `arm-${key}`, disabled: running, change: (event) => { chosen[key] = key === 'part' ? Number(event.target.value) : event.target.value; }},
      options.map(([value, label]) => element('option', {value, selected: value === chosen[key]}, label))));
  return element('details', {open: true}, element('summary', {}, t('setup.arm_title')), element('p', {class: 'lead'}, t('setup.arm_lead')),
    element('div', {class: 'fields'}, choice('part', parts.map((part, index) => [index, readable(part.name)])), choice('arm', ['right', 'left'].map((side) => [side, t(`setup.arm_${side}`)]))),
    running ? progress() : outcome(robot, accept, tools),
    element('button', {type: 'button', id: 'setup-arm-start', 'data-focus': 'arm-start', disabled: running || !parts.length, click: () => start(robot.url, tools)}, t('setup.arm_start')));
}
