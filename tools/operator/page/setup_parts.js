// Set-up, fourth step: every part is found and has its name.
import {element, readable, swatch} from './dom.js';
import {colourOf} from './colours.js';
import {t} from './words.js';

const TRACKED = 0, FOUND = [0, 1];

function statuses({state, task, view}) {
  const alive = state?.services.some((service) => service.service === 'pose-filter' && service.alive);
  if (!task?.parts || !view?.parts || view.parts.length !== task.parts.length || !alive) return null;
  return view.parts.map((part) => part.status);
}

export const partsStep = {
  name: 'parts',
  done: (status, page) => statuses(page)?.every((part) => FOUND.includes(part)),
  key: (status, page) => [statuses(page), page.task?.revision],
  show(status, page, {send}) {
    const found = statuses(page);
    const seen = found?.filter((part) => FOUND.includes(part)).length ?? 0;
    return [
      element('p', {class: 'lead'}, t('setup.parts_lead')),
      !found ? element('p', {class: 'verdict wait'}, t('no_reasoner')) : element('p', {class: seen === found.length ? 'verdict good' : 'verdict bad', role: 'status'},
        seen === found.length ? t('setup.parts_good', seen) : t('setup.parts_missing', seen, found.length)),
      found && element('ul', {class: 'checks'}, page.task.parts.map((part, index) => element('li', {},
        element('span', {class: `badge ${FOUND.includes(found[index]) ? 'made' : 'wrong'}`, 'aria-hidden': 'true'}, found[index] === TRACKED ? '✓' : '!'),
        element('span', {}, swatch(colourOf(page.task.types[part.type])), ' ', readable(part.name)), element('small', {}, t(`status.${found[index]}`))))),
      element('p', {}, element('button', {type: 'button', 'data-focus': 'search', click: () => send('reset_tracker')}, t('setup.search')))];
  },
};
