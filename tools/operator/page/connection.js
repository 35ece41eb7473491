// The page's side of page_server.h: state, live view, commands. Reconnects for ever.

/** Calls `onState(state)` for every state and `onAlive(boolean)` when the connection comes or goes. */
export function listenToState(onState, onAlive) {
  const source = new EventSource('api/events');
  source.onopen = () => onAlive(true);
  source.onerror = () => {
    onAlive(false);
    if (source.readyState === EventSource.CLOSED) setTimeout(() => listenToState(onState, onAlive), 1000);
  };
  source.onmessage = (event) => { onAlive(true); onState(JSON.parse(event.data)); };
}

/** Calls `onView(view, jpeg)` with the newest live view, as often as the browser draws: a slow one leaves views out, it does
 * not lag behind. `jpeg` is null if there is no picture. */
export async function listenToView(onView) {
  for (;;) {
    try {
      const response = await fetch('api/live', {cache: 'no-store'});
      if (response.ok) await readRecords(response.body.getReader(), onView);
    } catch { /* the banner of the state's connection says it */ }
    await new Promise((resolve) => setTimeout(resolve, 1000));
  }
}

async function readRecords(reader, onView) {
  let buffer = new Uint8Array(0), newest = null;
  const show = () => {
    const {json, jpeg} = newest;
    newest = null;
    onView(JSON.parse(new TextDecoder().decode(json)), jpeg.length ? jpeg.slice() : null);
  };
  for (;;) {
    const {value, done} = await reader.read();
    if (done) return;
    const joined = new Uint8Array(buffer.length + value.length);
    joined.set(buffer);
    joined.set(value, buffer.length);
    buffer = joined;
    let record;
    while ((record = firstRecord(buffer))) {
      if (record.json.length) {
        if (!newest) requestAnimationFrame(show);
        newest = record;
      }
      buffer = buffer.subarray(record.size);
    }
  }
}

function firstRecord(buffer) {
  const view = new DataView(buffer.buffer, buffer.byteOffset, buffer.length);
  if (buffer.length < 4) return null;
  const jsonSize = view.getUint32(0, true);
  if (buffer.length < 8 + jsonSize) return null;
  const jpegSize = view.getUint32(4 + jsonSize, true);
  const size = 8 + jsonSize + jpegSize;
  if (buffer.length < size) return null;
  return {json: buffer.subarray(4, 4 + jsonSize), jpeg: buffer.subarray(8 + jsonSize, size), size};
}

/** What an address answers; null if it does not. */
export async function fetchJson(path) {
  try {
    const response = await fetch(path, {cache: 'no-store'});
    return response.ok ? await response.json() : null;
  } catch {
    return null;
  }
}

export async function fetchTask() {
  return (await fetch('api/task', {cache: 'no-store'})).json();
}

/** Sends one thing. @return {id} or {error} */
export const post = (path, body) => postAs(path, 'application/json', JSON.stringify(body));

/** Sends a file. */
export const postFile = (path, file) => postAs(path, 'application/octet-stream', file);

async function postAs(path, type, body) {
  try {
    const response = await fetch(path, {method: 'POST', headers: {'Content-Type': type, 'X-Coach': '1'}, body});
    return await response.json();
  } catch {
    return {error: null};
  }
}
