// Set-up, first step: light, distance and tilt of the camera.
import {element} from './dom.js';
import {t} from './words.js';

const PROBLEMS = {picture: ['no_picture'], light: ['dark', 'bright'], depth: ['no_depth'], table: ['no_table', 'uneven'], distance: ['near', 'far'], tilt: ['flat']};

const figures = (camera) => ({
  light: t('setup.figure.light', camera.brightness), depth: t('setup.figure.depth', Math.round(camera.depth_share * 100)),
  table: t('setup.figure.table', Math.round(camera.table_share * 100), camera.residual_mm), distance: t('setup.figure.distance', camera.distance_cm), tilt: t('setup.figure.tilt', camera.tilt_degrees)});

export const cameraStep = {
  name: 'camera',
  done: ({camera}) => camera.alive && !camera.problems.length,
  key: ({camera}) => camera,
  show({camera}) {
    if (!camera.alive) return element('p', {class: 'verdict wait'}, t('setup.camera_wait'));
    const unknown = camera.problems.includes('no_table') || camera.problems.includes('no_depth');
    return [
      ...(camera.problems.length ? camera.problems.map((problem) => element('p', {class: 'verdict bad', role: 'status'}, t(`setup.problem.${problem}`))) : [element('p', {class: 'verdict good', role: 'status'}, t('setup.camera_good'))]),
      element('ul', {class: 'checks'}, Object.entries(PROBLEMS).map(([name, problems]) => {
        const bad = problems.some((problem) => camera.problems.includes(problem));
        const open = !bad && unknown && ['table', 'distance', 'tilt'].includes(name);
        return element('li', {}, element('span', {class: `badge ${bad ? 'wrong' : open ? '' : 'made'}`, 'aria-hidden': 'true'}, bad ? '!' : open ? '?' : '✓'),
          element('span', {}, t(`setup.check.${name}`)), element('small', {}, open ? '' : figures(camera)[name] ?? ''));
      }))];
  },
};
