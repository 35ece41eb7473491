// Set-up, third step: the colours of the parts in this room's light, by clicking them.
import {element, swatch} from './dom.js';
import {post} from './connection.js';
import {colourOf} from './colours.js';
import {picturePlace, tintPicture} from './camera.js';
import {t} from './words.js';

const ERRORS = ['no_task', 'no_picture', 'not_on_table', 'few_pixels'];
const CHANNELS = [['hue', 179], ['saturation', 255], ['value', 255]];
const pending = new Map();  // colour: {range or null, found}
let chosen = null, tuning = false;

const wordOf = (name) => { const word = t(`colour.${name}`); return word === name ? name.replaceAll('_', ' ') : word; };
const rangeOf = (colour) => pending.get(colour.name)?.range ?? colour.range;

async function clicked(x, y, {toast, redraw}) {
  const name = chosen;
  const found = await post('api/setup/colour', {x, y, colour: name});
  if (!found.range) return toast(ERRORS.includes(found.error) ? t(`setup.colour_error.${found.error}`) : found.error ?? t('no_network'), true);
  pending.set(name, {range: found.range, found});
  redraw();
}

function remarks(colour) {
  const found = pending.get(colour.name)?.found ?? (pending.has(colour.name) ? {table_share: 0, overlaps: []} : colour);
  const list = [];
  if (found.table_share > 0.01) list.push(t('setup.colour_table', Math.round(found.table_share * 100)));
  if (found.overlaps.length) list.push(t('setup.colour_overlap', found.overlaps.map(wordOf).join(', ')));
  if (found.part_share < 0.85) list.push(t('setup.colour_misses', Math.round(found.part_share * 100)));
  return list;
}

function card(colour, tools) {
  const kept = pending.has(colour.name) ? 'colour_new' : colour.own ? 'colour_own' : 'colour_task', bad = remarks(colour);
  return element('label', {class: 'choice'},
    element('input', {type: 'radio', name: 'setup-colour', value: colour.name, checked: colour.name === chosen, 'data-focus': `colour-${colour.name}`, change: () => { chosen = colour.name; tools.redraw(); }}),
    element('span', {}, swatch(colourOf({colour: colour.name, rgb: [136, 136, 136]})), ' ', element('strong', {}, wordOf(colour.name)), ' ', element('small', {class: 'tag'}, t(`setup.${kept}`)),
      element('small', {class: bad.length ? 'remark bad' : 'remark'}, bad.length ? bad.join(' ') : t('setup.colour_good'))));
}

function fineTuning(colour, tools) {
  const range = rangeOf(colour);
  const slider = (bound, index, top) => element('label', {class: 'volume'}, element('span', {}, t(`setup.${bound === 'low' ? 'from' : 'to'}`, t(`setup.${CHANNELS[index][0]}`))),
    element('input', {type: 'range', min: 0, max: top, value: range[bound][index], 'data-focus': `${bound}-${index}`, change: (event) => {
      const changed = structuredClone(range);
      changed[bound][index] = Number(event.target.value);
      pending.set(colour.name, {range: changed});
      tools.redraw();
    }}));
  return element('details', {open: tuning, toggle: (event) => { tuning = event.target.open; }}, element('summary', {}, t('setup.fine')), CHANNELS.flatMap(([, top], index) => [slider('low', index, top), slider('high', index, top)]),
    (colour.own || pending.has(colour.name)) && element('button', {type: 'button', class: 'small', 'data-focus': 'forget', click: () => {
      colour.own ? pending.set(colour.name, {range: null}) : pending.delete(colour.name);
      tools.redraw();
    }}, t('setup.forget')));
}

export const coloursStep = {
  name: 'colours',
  done: ({colours}) => colours.length && colours.every((colour) => colour.own || pending.has(colour.name)),
  key: ({colours}) => [colours.map(({name, own, range, overlaps, part_share, table_share}) => [name, own, range, overlaps, part_share < 0.85, Math.round(table_share * 100)]), [...pending], chosen],
  show({colours}, page, tools) {
    if (!colours.length) return element('p', {class: 'verdict wait'}, t('setup.no_colours'));
    if (!colours.some((colour) => colour.name === chosen)) chosen = (colours.find((colour) => !colour.own) ?? colours[0]).name;
    const colour = colours.find((one) => one.name === chosen), found = pending.get(chosen)?.found;
    picturePlace((x, y) => clicked(x, y, tools));
    tintPicture(rangeOf(colour));
    return [
      element('p', {class: 'lead'}, t('setup.colours_lead')),
      element('div', {class: 'choice-list', role: 'radiogroup', 'aria-labelledby': 'setup-title-step'}, colours.map((one) => card(one, tools))),
      found && element('p', {class: 'verdict good', role: 'status'}, t(found.part ? 'setup.colour_part' : 'setup.colour_region', found.pixels)),
      fineTuning(colour, tools),
      pending.size ? element('p', {class: 'lead'}, t('setup.not_kept', [...pending.keys()].map(wordOf).join(', '))) : null];
  },
  async leave({save}) {
    const colours = Object.fromEntries([...pending].map(([name, {range}]) => [name, range]));
    if (pending.size && !await save({colours})) return false;
    pending.clear();
    return true;
  },
};
