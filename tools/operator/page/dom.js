// Small helpers for building the page. Text always goes in as text, so no name can bring markup with it.

export const byId = (id) => document.getElementById(id);

/** Element with attributes and children; a function attribute is an event handler, a falsy child is left out. */
export function element(tag, attributes = {}, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** The same for SVG. */
export function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, children);
}

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') node.addEventListener(name, value);
    else if (value === true) node.setAttribute(name, '');
    else if (value !== false && value != null) node.setAttribute(name, value);
  }
  for (const child of children.flat()) {
    if (child || child === 0) node.append(child instanceof Node ? child : String(child));
  }
  return node;
}

/** Rebuilds a container only when `key` (anything JSON) differs from the last time: keeps focus, selection and scroll. */
export function rebuild(container, key, make) {
  const text = JSON.stringify(key);
  if (container.dataset.key === text) return;
  const focused = container.contains(document.activeElement) ? document.activeElement.dataset.focus : null;
  container.replaceChildren(...[make()].flat().filter(Boolean));
  container.dataset.key = text;
  if (focused) container.querySelector(`[data-focus="${CSS.escape(focused)}"]`)?.focus();
}

/** Seconds as m:ss. */
export function clock(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

/** Technical names for people: 'long_brick_1' -> 'long brick 1'. */
export const readable = (name) => name.replaceAll('_', ' ');

export function swatch(colour) {
  const dot = element('span', {class: 'swatch', 'aria-hidden': 'true'});
  dot.style.background = colour;
  return dot;
}
