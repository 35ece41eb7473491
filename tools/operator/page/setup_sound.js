// Set-up, last step: the robot can be heard.
import {element} from './dom.js';
import {currentAct} from './robot.js';
import {t} from './words.js';

let heard = false;

export const soundStep = {
  name: 'sound',
  done: () => heard,
  key: (status, {state}) => [heard, state?.robot.connected, state && currentAct(state)?.id, state?.robot.speaking],
  show(status, {state}, {send, save, redraw}) {
    const volume = element('input', {type: 'range', id: 'setup-volume', min: 0, max: 100, step: 5, value: Math.round(status.robot.volume * 100), 'data-focus': 'volume', change: () => send('volume', volume.value)});
    return [
      element('p', {class: 'lead'}, t('setup.sound_lead')),
      heard && element('p', {class: 'verdict good', role: 'status'}, t('setup.ready')),
      !state?.robot.connected && element('p', {class: 'verdict bad'}, t('setup.sound_silent')),
      element('label', {class: 'volume'}, element('span', {}, t('volume')), volume),
      element('p', {class: 'row'}, element('button', {type: 'button', 'data-focus': 'say', click: () => send('say', t('setup.sound_text'))}, t('setup.sound_say')),
        element('button', {type: 'button', class: 'primary', id: 'setup-heard', 'data-focus': 'heard', click: async () => {
          if (!await save({robot: {volume: Number(volume.value) / 100}})) return;
          heard = true;
          redraw();
        }}, t('setup.sound_heard'))),
      element('p', {class: 'lead'}, t('setup.sound_state', state?.robot.speaking ? t('speaking') : t('silent')))];
  },
};
