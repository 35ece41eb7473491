// The page for new tasks: from mesh files, or from what was built on the table.
import {byId, element, readable, rebuild, swatch} from './dom.js';
import {colourOf} from './colours.js';
import {post, postFile} from './connection.js';
import {showPictureIn} from './camera.js';
import {t} from './words.js';

const COLOURS = ['blue', 'green', 'red', 'yellow', 'orange', 'purple', 'pink', 'brown', 'white', 'black'];
const draft = {way: 'model', name: '', units: 'mm', model: '', colours: {}, made: null, problem: '', busy: false, files: []};
let tools = null;

const visible = () => !byId('page-new').hidden;
const redraw = () => { if (visible()) showNewTask(tools.page); };

export function setUpNewTask(toast) {
  tools = {toast, page: null};
}

async function receive(files) {
  draft.busy = true;
  redraw();
  for (const file of files) {
    const answer = await postFile(`api/task/mesh?name=${encodeURIComponent(file.name)}`, file);
    if (!answer.pieces) { tools.toast(t('not_sent', answer.error ?? t('no_network')), true); continue; }
    draft.files = [...draft.files.filter((known) => known.name !== answer.name), answer];
    if (!draft.model) draft.model = answer.name;
    if (!draft.name) draft.name = answer.name.replace(/\.\w+$/, '');
  }
  draft.busy = false;
  if (draft.model) await make(false);
  redraw();
}

const remark = ({kind, part, other, millimetres}) => t(`new.remark.${kind}`, readable(part), readable(other), millimetres);

/** Which files make the task: one model, or a file for each part. */
function request(save) {
  const {name, units, colours} = draft;
  if (draft.way === 'table') return {name, table: true, save};
  return draft.way === 'model' ? {name, units, model: draft.model, colours, save}
    : {name, units, save, parts: draft.files.map((file) => ({file: file.name, name: file.name.replace(/\.\w+$/, ''), colour: colours[file.name] ?? 'blue', count: draft.counts?.[file.name] ?? 1}))};
}

async function make(save) {
  draft.busy = true;
  redraw();
  const answer = await post('api/task/make', request(save));
  draft.busy = false;
  draft.problem = answer.parts ? '' : answer.doubts?.map(remark).join(' ') ?? answer.error ?? t('no_network');
  draft.made = answer.parts ? answer : null;
  redraw();
}

function set(changes, again = true) {
  Object.assign(draft, changes, {problem: ''});
  if (again && (draft.way === 'parts' ? draft.files.length : draft.way === 'model' && draft.model)) make(false);
  else redraw();
}

const choice = (value, options, label, change, id) => element('select', {'data-focus': id, id, change: (event) => change(event.target.value)}, options.map((one) => element('option', {value: one, selected: one === value}, label(one))));
const field = (label, control) => element('label', {class: 'field'}, element('span', {}, label), control);

function source() {
  if (draft.way === 'table') return element('p', {class: 'lead'}, t('new.table_lead'));
  return [
    element('p', {class: 'lead'}, t(draft.way === 'model' ? 'new.model_lead' : 'new.parts_lead')),
    element('div', {class: 'fields'},
      field(t('new.files'), element('input', {type: 'file', id: 'new-files', multiple: true, accept: '.obj,.stl,.ply,.glb', 'data-focus': 'files', change: (event) => receive(event.target.files)})),
      field(t('new.units'), choice(draft.units, ['mm', 'm'], (one) => one, (units) => set({units}), 'new-units'))),
    draft.way === 'model' && draft.files.length > 1 ? field(t('new.model'), choice(draft.model, draft.files.map((file) => file.name), (one) => one, (model) => set({model}), 'new-model')) : null,
    draft.way === 'parts' && element('ul', {class: 'checks'}, draft.files.map((file) => element('li', {}, element('span', {}, file.name),
      choice(draft.colours[file.name] ?? 'blue', COLOURS, (one) => t(`colour.${one}`), (colour) => set({colours: {...draft.colours, [file.name]: colour}}), `colour-${file.name}`),
      element('input', {type: 'number', min: 1, max: 100, value: draft.counts?.[file.name] ?? 1, 'aria-label': t('new.count', file.name), 'data-focus': `count-${file.name}`, change: (event) => set({counts: {...draft.counts, [file.name]: Number(event.target.value)}})}))))];
}

function result() {
  const {made} = draft;
  if (!made) return null;
  return [
    element('p', {class: 'verdict good', role: 'status'}, t('new.understood', made.parts.reduce((sum, part) => sum + part.count, 0), made.joints)),
    made.doubts.map((doubt) => element('p', {class: 'verdict bad'}, remark(doubt))),
    element('ul', {class: 'checks'}, made.parts.map((part) => element('li', {}, swatch(colourOf({colour: part.colour, rgb: [136, 136, 136]})),
      element('span', {}, `${part.count} × ${part.name}`), draft.way === 'model' ? choice(part.colour, COLOURS, (one) => t(`colour.${one}`), (colour) => set({colours: {...draft.colours, [part.name]: colour}}), `colour-${part.name}`) : element('small', {}, t(`colour.${part.colour}`))))),
    made.file && element('p', {class: 'verdict good', role: 'status'}, t('new.saved', made.file)),
    made.file && element('p', {class: 'row'}, element('a', {href: `api/task/book?name=${encodeURIComponent(made.file)}`, target: '_blank', rel: 'noopener'}, t('new.book')), element('a', {href: '#setup'}, t('new.use')))];
}

/** The picture comes as SVG text; as an image it can run nothing. */
const picture = () => draft.made && element('img', {alt: t('new.picture'), class: 'book-picture', src: `data:image/svg+xml;base64,${btoa(unescape(encodeURIComponent(draft.made.picture)))}`});

export function showNewTask(page) {
  tools.page = page;
  if (!visible()) return;
  const table = draft.way === 'table' && !draft.made;
  if (table) showPictureIn(byId('new-stage'));
  byId('new-stage').hidden = !table;
  rebuild(byId('new-picture'), [draft.made?.picture?.length, draft.made?.parts, draft.name, document.documentElement.lang], picture);
  rebuild(byId('new-content'), [document.documentElement.lang, draft.way, draft.units, draft.model, draft.colours, draft.counts, draft.busy, draft.problem, draft.files.map((file) => file.name), draft.made && [draft.made.parts, draft.made.doubts, draft.made.file, draft.made.joints]], () => [
    element('div', {class: 'choice-list ways', role: 'radiogroup', 'aria-label': t('new.way')}, ['model', 'parts', 'table'].map((way) => element('label', {class: 'choice'},
      element('input', {type: 'radio', name: 'new-way', value: way, checked: way === draft.way, 'data-focus': `way-${way}`, change: () => set({way, made: null}, false)}), element('span', {}, t(`new.way_${way}`))))),
    field(t('new.name'), element('input', {type: 'text', id: 'new-name', maxlength: 48, value: draft.name, 'data-focus': 'name', autocomplete: 'off', change: (event) => { draft.name = event.target.value.trim(); }})),
    source(),
    draft.busy && element('p', {class: 'verdict wait', role: 'status'}, t('new.busy')),
    draft.problem && element('p', {class: 'verdict bad', role: 'alert'}, draft.problem),
    result(),
    element('div', {class: 'row wizard-buttons'},
      element('button', {type: 'button', 'data-focus': 'check', id: 'new-check', disabled: draft.busy, click: () => make(false)}, t('new.check')),
      element('button', {type: 'button', class: 'primary', 'data-focus': 'save', id: 'new-save', disabled: draft.busy || !draft.made, click: () => make(true)}, t('new.save')))].flat(2));
}
