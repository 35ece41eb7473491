// The set-up pages: six steps beside the live picture. Each step is a file of its own: {name, done, show, leave}.
import {byId, element, rebuild} from './dom.js';
import {fetchJson, post} from './connection.js';
import {picturePlace, showPictureIn, tintPicture} from './camera.js';
import {cameraStep} from './setup_camera.js';
import {taskStep} from './setup_task.js';
import {coloursStep} from './setup_colours.js';
import {partsStep} from './setup_parts.js';
import {robotStep} from './setup_robot.js';
import {soundStep} from './setup_sound.js';
import {t} from './words.js';

const STEPS = [cameraStep, taskStep, coloursStep, partsStep, robotStep, soundStep];
const PATIENCE = 20000;  // ms until services that did not start again are to be restarted by hand
const wizard = {step: 0, status: null, page: null, oldSince: 0, busy: false};
let tools = null;

/** @param send (kind, argument) sends a command */
export function setUpWizard(send, toast) {
  tools = {send, toast, save, refresh: () => poll(true), status: () => wizard.status, redraw: () => showWizard(wizard.page)};
  byId('setup-back').addEventListener('click', () => go(wizard.step - 1));
  byId('setup-next').addEventListener('click', async () => {
    const step = STEPS[wizard.step];
    if (step.leave && !await step.leave(tools)) return;
    if (wizard.step + 1 < STEPS.length) go(wizard.step + 1);
    else location.hash = 'lesson';
  });
  setInterval(() => { if (visible()) poll(); }, 1000);
}

const visible = () => !byId('page-setup').hidden;

async function poll(now = false) {
  if (wizard.busy && !now) return;
  wizard.busy = true;
  const status = await fetchJson('api/setup');
  wizard.busy = false;
  if (status) use(status);
}

function use(status) {
  wizard.status = status;
  wizard.oldSince = status.old.length ? wizard.oldSince || performance.now() : 0;
  showWizard(wizard.page);
}

/** Saves settings. @return whether they are kept */
async function save(changes) {
  const answer = await post('api/setup/save', changes);
  if (answer.file === undefined) {
    tools.toast(t('not_sent', answer.error ?? t('no_network')), true);
    return false;
  }
  tools.toast(t('setup.saved'));
  use(answer);
  return true;
}

function go(step) {
  wizard.step = Math.min(Math.max(step, 0), STEPS.length - 1);
  tintPicture(null);
  picturePlace(null);
  showWizard(wizard.page);
  byId('setup-title-step').focus();
}

/** @param page {state, task, view} as app.js keeps it */
export function showWizard(page) {
  wizard.page = page;
  if (!visible()) return;
  showPictureIn(byId('setup-stage'));
  if (!wizard.status) { poll(); return; }
  const step = STEPS[wizard.step], language = document.documentElement.lang;
  const done = STEPS.map((one) => Boolean(one.done(wizard.status, page)));
  rebuild(byId('setup-steps'), [language, wizard.step, done], () => STEPS.map((one, index) => element('li', {},
    element('button', {type: 'button', class: done[index] ? 'wizard-step done' : 'wizard-step', 'data-focus': one.name, 'aria-current': index === wizard.step ? 'step' : null, click: () => go(index)},
      element('span', {class: 'wizard-number', 'aria-hidden': 'true'}, done[index] ? '✓' : index + 1), t(`setup.step.${one.name}`), element('span', {class: 'hidden'}, ` ${t(done[index] ? 'setup.done' : 'setup.open')}`)))));
  byId('setup-title-step').textContent = t(`setup.${step.name}_title`);
  rebuild(byId('setup-content'), [language, wizard.step, step.key(wizard.status, page)], () => step.show(wizard.status, page, tools));
  byId('setup-back').disabled = wizard.step === 0;
  byId('setup-next').textContent = t(wizard.step + 1 < STEPS.length ? 'setup.next' : 'setup.finish');
  showFile();
}

function showFile() {
  const {status} = wizard, names = status.old.map((name) => t(`service.${name}`)).join(', ');
  const late = wizard.oldSince && performance.now() - wizard.oldSince > PATIENCE;
  byId('setup-old').textContent = status.old.length ? t(late ? 'setup.restart_by_hand' : 'setup.restarting', names) : '';
  byId('setup-file').textContent = status.file ? t('setup.file', status.file) : t('setup.no_file');
}
