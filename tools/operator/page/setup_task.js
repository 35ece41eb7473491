// Set-up, second step: what is built at this table.
import {element, readable} from './dom.js';
import {t} from './words.js';

export const taskStep = {
  name: 'task',
  done: ({task}) => task.choice && !task.problem,
  key: ({task, tasks}) => [task, tasks],
  show: ({task, tasks}, page, {save}) => [
    element('p', {class: 'lead'}, t('setup.task_lead')),
    task.problem && element('p', {class: 'verdict bad', role: 'alert'}, t('setup.task_problem', task.problem)),
    element('div', {class: 'choice-list', role: 'radiogroup', 'aria-labelledby': 'setup-title-step'}, tasks.map((name) => element('label', {class: 'choice'},
      element('input', {type: 'radio', name: 'setup-task', value: name, checked: name === task.choice, 'data-focus': `task-${name}`, change: () => save({task: name})}), element('span', {}, readable(name))))),
    element('p', {}, element('a', {href: '#new'}, t('setup.new_task')))],
};
