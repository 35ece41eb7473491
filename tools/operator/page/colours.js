// Colours of parts on the page: clear ones for known words, else the middle of the part's range.

const KNOWN = {blue: '#3f7fe0', green: '#3aa765', red: '#d9483b', yellow: '#e8bf2f', orange: '#e8842f', white: '#e9e9e4',
               black: '#3b3f42', purple: '#8a5cc9', brown: '#8d623f', pink: '#e583ae'};

/** @param type of api/task */
export function colourOf(type) {
  return KNOWN[type.colour] ?? `rgb(${type.rgb.join(' ')})`;
}

/** Red, green, blue 0..1 of '#rrggbb' or 'rgb(r g b)'. */
export function components(colour) {
  const numbers = colour.startsWith('#') ? colour.match(/[0-9a-f]{2}/g).map((h) => parseInt(h, 16)) : colour.match(/\d+/g).map(Number);
  return numbers.map((n) => n / 255);
}
