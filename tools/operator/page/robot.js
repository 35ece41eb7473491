// The robot's words: what it says now, what waits, what it said.
import {byId, element, rebuild} from './dom.js';
import {t} from './words.js';

const ACT = 0, STARTED = 2, DONE = 3, INTERRUPTED = 4;
const LOOK = ['', 'now', 'now', 'good', '', 'bad', 'bad'];

/** The act that is being said, or null. */
export function currentAct(state) {
  return [...state.acts].reverse().find((act) => act.kind === ACT && act.state === STARTED && act.text) ?? null;
}

export function showRobot(state) {
  const {robot, acts} = state;
  const now = currentAct(state);
  const latest = now ?? [...acts].reverse().find((act) => act.kind === ACT && act.text && [DONE, INTERRUPTED].includes(act.state));
  const said = latest && latest.state !== INTERRUPTED, text = said ? latest.text : t('silent');
  const speech = byId('speech');
  if (speech.textContent !== text) speech.textContent = text;
  speech.lang = said ? latest.language : '';
  speech.classList.toggle('silent', !now);
  byId('robot-state').textContent = !robot.alive ? t('robot_off') : [
    robot.connected ? t(`back_end.${robot.back_end}`) : t('robot_apart'),
    robot.battery >= 0 && t('battery', Math.round(robot.battery * 100)), robot.speaking && t('speaking')].filter(Boolean).join(' · ');

  const spoken = acts.filter((act) => act.text).reverse();
  rebuild(byId('acts'), [document.documentElement.lang, spoken.map((act) => [act.id, act.state])], () =>
    spoken.map((act) => element('li', {class: act.state >= DONE ? 'done' : ''},
      element('span', {lang: act.language}, act.text),
      element('span', {class: `tag ${LOOK[act.state]}`, title: act.reason}, t(`act.${act.state}`)))));
}
