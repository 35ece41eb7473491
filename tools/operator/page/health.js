// Whether everything works, in plain words first and in figures below.
import {byId, element} from './dom.js';
import {t} from './words.js';

const EXPECTED = ['capture', 'detector', 'pose-filter', 'assembly-reasoner', 'robot-bridge'];
const LOOK = ['degraded', 'ok', 'degraded', 'failed'];

const lookOf = (service) => (!service?.alive ? 'failed' : LOOK[service.state]);

export function showHealth(state) {
  const byName = new Map(state.services.map((service) => [service.service, service]));
  const names = [...EXPECTED, ...[...byName.keys()].filter((name) => !EXPECTED.includes(name))];
  const looks = names.map((name) => lookOf(byName.get(name)));
  const worst = ['failed', 'degraded', 'ok'].find((look) => looks.includes(look));
  byId('health-dot').className = `dot ${worst}`;
  const troubled = names.filter((_, index) => looks[index] !== 'ok').map((name) => t('needs', t(`service.${name}`)));
  byId('health-summary').textContent = troubled.length ? t('health_bad', troubled.join(', ')) : t('health_good', names.length);
  if (!byId('page-health').hidden) byId('services').replaceChildren(...names.map((name) => card(name, byName.get(name))));
}

function card(name, service) {
  const figures = !service ? [] : [
    ['rate', `${service.rate.toFixed(1)} Hz`],
    service.latency_p50_ms > 0 && ['latency', t('of_99', service.latency_p50_ms.toFixed(0), service.latency_p99_ms.toFixed(0))],
    ['dropped', t('of_received', service.dropped, service.received)],
    ['lost', service.socket_drops], ['errors', service.decode_errors],
    service.resident_mb > 0 && ['memory', `${service.resident_mb.toFixed(0)} MB`]].filter(Boolean);
  return element('article', {class: 'card service'},
    element('span', {class: `dot ${lookOf(service)}`, 'aria-hidden': 'true'}),
    element('h2', {}, element('span', {}, t(`service.${name}`)), element('small', {}, service ? `${name} · ${service.host} · ${service.pid}` : name)),
    element('p', {}, service?.alive ? t(`state.${service.state}`) : t('not_answering'), service?.message ? ` — ${service.message}` : ''),
    figures.length ? element('dl', {}, figures.map(([key, value]) => element('div', {}, element('dt', {}, t(`figure.${key}`)), element('dd', {}, value)))) : null);
}
