// The teacher's page: puts the pieces together.
import {byId, element, rebuild, readable} from './dom.js';
import {fetchTask, listenToState, listenToView, post} from './connection.js';
import {picturePlace, pictureRate, showPictureIn, showView, tintPicture} from './camera.js';
import {coloursOfConnection, connectionName, showPlan} from './plan.js';
import {currentAct, showRobot} from './robot.js';
import {setUpTable, showTable} from './table3d.js';
import {addEvents, showTimeline} from './timeline.js';
import {showHealth} from './health.js';
import {setUpNotes, showNotes, showQuestionnaire} from './notes.js';
import {setUpNewTask, showNewTask} from './new_task.js';
import {setUpWizard, showWizard} from './setup.js';
import {pageLanguage, t, usePageLanguage, wordsOf} from './words.js';

const INTRODUCTION = 0, IDLE = 5, PAUSED = 8, COMPLETE = 9;
const page = {state: null, task: null, view: null, fetching: false};
const reported = new Set();

function toast(text, bad = false) {
  const note = element('div', {class: bad ? 'toast bad' : 'toast'}, text);
  byId('toasts').append(note);
  setTimeout(() => note.remove(), bad ? 8000 : 3000);
}

async function send(kind, argument = '') {
  const answer = await post('api/command', {kind, argument: String(argument)});
  if (answer.id) reported.add(answer.id);
  else toast(t('not_sent', answer.error ?? t('no_network')), true);
  return Boolean(answer.id);
}

function stop() {
  byId('stop').classList.add('pressed');
  send('stop').then((sent) => sent && toast(t('stopped')));
}

function setUpControls() {
  for (const id of ['start', 'pause', 'resume', 'skip', 'repeat', 'help']) byId(id).addEventListener('click', () => send(id));
  byId('stop').addEventListener('click', stop);
  document.addEventListener('keydown', (event) => { if (event.key === 'Escape' && !event.repeat) stop(); });
  byId('reset-tracker').addEventListener('click', () => send('reset_tracker'));
  byId('task').addEventListener('change', (event) => send('choose_task', event.target.value));
  byId('language').addEventListener('change', (event) => send('language', event.target.value));
  byId('volume').addEventListener('input', (event) => { byId('volume-value').textContent = event.target.value; });
  byId('volume').addEventListener('change', (event) => send('volume', event.target.value));
  byId('say').addEventListener('submit', async (event) => {
    event.preventDefault();
    const text = byId('say-text');
    if (text.value.trim() && await send('say', text.value.trim())) text.value = '';
  });
  byId('page-language').addEventListener('change', (event) => {
    localStorage.setItem('page-language', event.target.value);
    usePageLanguage(event.target.value);
    showAll();
  });
}

function showHeadline(state, task) {
  const {lesson} = state;
  let title, detail = '';
  if (!lesson.alive) {
    [title, detail] = [t('no_reasoner'), t('no_reasoner_detail')];
  } else {
    title = lesson.session === 0 || (lesson.phase === INTRODUCTION && !lesson.made && !state.events.length && !state.acts.length) ? t('not_started') : t(`phase.${lesson.phase}`);
    if (task?.connections?.[lesson.step]) detail = t('asks_for', `${connectionName(task, lesson.step)} (${coloursOfConnection(task, lesson.step)})`);
    if (lesson.phase === IDLE && lesson.idle_level) detail += ` · ${t('hint_level', lesson.idle_level)}`;
    if (lesson.phase === COMPLETE) detail = t('all_made', lesson.required);
  }
  if (state.task.problem) detail = t('task_problem', state.task.problem);
  if (byId('phase').textContent !== title) byId('phase').textContent = title;
  if (byId('phase-detail').textContent !== detail) byId('phase-detail').textContent = detail;
  const paused = lesson.phase === PAUSED, over = lesson.phase === COMPLETE || !lesson.alive || lesson.session === 0;
  byId('start').hidden = !(over || lesson.phase === INTRODUCTION);
  byId('pause').hidden = paused || over;
  byId('resume').hidden = !paused;
  for (const id of ['skip', 'help']) byId(id).disabled = over || paused;
}

function showChoices(state) {
  const chosen = (select, values, value, label) => {
    const all = value && !values.includes(value) ? [value, ...values] : values;
    rebuild(select, [all, pageLanguage(), state.task.name], () => all.map((item) => element('option', {value: item}, label(item))));
    if (document.activeElement !== select && value) select.value = value;
  };
  chosen(byId('task'), state.tasks, state.task.choice, (file) => readable(file === state.task.choice ? state.task.name : file));
  chosen(byId('language'), state.languages, state.robot.language, (code) => wordsOf(pageLanguage()).language_name[code] ?? code);
}

function reportCommands(state) {
  for (const command of state.commands) {
    if (command.fate !== 'unanswered' || !reported.delete(command.id)) continue;
    const missing = command.waiting_for.map((name) => t(`service.${name}`)).join(', ');
    toast(t('unanswered', t(`command.${command.kind}`), missing), true);
  }
}

function showAll() {
  const {state, task} = page;
  if (!state) return;
  byId('station').textContent = state.station;
  showHeadline(state, task);
  showChoices(state);
  showRobot(state);
  showHealth(state);
  showTimeline(state, task);
  reportCommands(state);
  if (task?.connections) showPlan(task, state.lesson, send);
  showNotes(state, task, toast);
  showQuestionnaire(toast);
  const rate = pictureRate();
  showWizard(page);
  showNewTask(page);
  byId('camera-figures').textContent = rate > 0 ? t('fps', rate.toFixed(0)) : '';
  showCameraNote(rate > 0);
}

/** Says why there is no picture; over the last one, if there was one. */
function showCameraNote(alive) {
  const note = byId('camera-note');
  note.hidden = alive;
  note.classList.toggle('over', Boolean(page.pictured));
  note.textContent = t(page.pictured ? 'camera_silent' : page.view && !page.pictures ? 'no_picture_remote' : 'no_picture');
}

async function onState(state) {
  page.state = state;
  addEvents(state);
  if (!page.fetching && state.task.revision !== (page.task?.revision ?? 0)) {
    page.fetching = true;
    try { page.task = await fetchTask(); } catch { /* asked for again with the next state */ }
    page.fetching = false;
  }
  showAll();
}

function onView(view, jpeg) {
  page.view = view;
  page.pictures = Boolean(jpeg) || view.width === 0;
  page.pictured ||= Boolean(jpeg);
  showView(view, jpeg, page.task);
  const {state} = page;
  showTable(view, page.task, state && {seat: state.seat, target: currentAct(state)?.point, connections: state.lesson.connections});
}

function showPage() {
  const wanted = location.hash.slice(1) || 'lesson';
  const known = [...document.querySelectorAll('.page')].map((section) => section.id.slice('page-'.length));
  const name = known.includes(wanted) ? wanted : 'lesson';
  for (const link of document.querySelectorAll('.tabs a')) link.dataset.page === name ? link.setAttribute('aria-current', 'page') : link.removeAttribute('aria-current');
  for (const section of document.querySelectorAll('.page')) section.hidden = section.id !== `page-${name}`;
  if (name === 'lesson') showPictureIn(byId('lesson-stage'));
  if (name !== 'setup') {
    tintPicture(null);
    picturePlace(null);
  }
  showAll();
}

const preferred = localStorage.getItem('page-language') ?? (navigator.language.startsWith('el') ? 'el' : 'en');
byId('page-language').value = preferred;
usePageLanguage(preferred);
setUpControls();
setUpTable();
setUpWizard(send, toast);
setUpNewTask(toast);
setUpNotes(() => page.state?.data_utime ?? 0, toast);
addEventListener('hashchange', () => { showPage(); scrollTo(0, 0); });
showPage();
listenToState(onState, (alive) => { byId('offline').hidden = alive; });
listenToView(onView);
