// The virtual robot's page: listens to the robot bridge's events, speaks, and draws robot and table. The protocol is
// docs/robot-protocol.md.
import { Body } from "/body.js";
import { drawRobot } from "/robot.js";
import { Table } from "/table.js";
import { textsFor } from "/texts.js";

const $ = (id) => document.getElementById(id);
const client = Math.random().toString(36).slice(2);
const query = new URLSearchParams(location.search);

const state = {
  language: query.get("lang") || navigator.language || "en",
  asleep: false,
  eyes: "#2aa8b8",
  speech: null,   // {id, begun (ms), seconds, over}
  volume: 0.8,
  target: null,
};
const body = new Body();
const table = new Table($("table"));
const audio = new Audio();

function showTexts() {
  const texts = textsFor(state.language);
  document.documentElement.lang = texts.language;
  for (const element of document.querySelectorAll("[data-text]")) element.textContent = texts[element.dataset.text];
  $("table").setAttribute("aria-label", table.describe(texts));
  table.texts = texts;
  if (!state.speech) showCaption(texts.ready);
}

// Each word is its own element, so that it can be marked when it is said.
function showCaption(text) {
  const words = document.createElement("span");
  words.className = "words";
  for (const [i, word] of text.split(" ").entries()) {
    if (i) words.append(" ");
    const span = document.createElement("span");
    span.textContent = word;
    words.append(span);
  }
  $("caption").classList.toggle("long", text.length > 110);
  $("caption").replaceChildren(words);
}

function markWords(share) {
  const words = [...document.querySelectorAll("#caption .words > span")];
  const total = words.reduce((sum, word) => sum + word.textContent.length + 1, 0);
  let before = 0;
  for (const word of words) {
    word.classList.toggle("said", before <= share * total);
    before += word.textContent.length + 1;
  }
}

function report(type, id) {
  fetch("/report", { method: "POST", body: JSON.stringify({ type, id, client }) }).catch(() => {});
}

function silence() {
  audio.pause();
  audio.onplaying = audio.onended = audio.onerror = null;
  window.speechSynthesis?.cancel();
  if (state.speech) state.speech.over = true;
}

function began(id) {
  if (state.speech?.id !== id) return;
  state.speech.begun = performance.now();
  report("speech_started", id);
}
function ended(id) {
  if (state.speech?.id !== id || state.speech.over) return;
  state.speech.over = true;
  report("speech_done", id);
}

function say(event) {
  silence();
  if (event.language !== state.language) {
    state.language = event.language;
    showTexts();
  }
  state.speech = { id: event.id, begun: performance.now(), seconds: event.seconds, over: false };
  showCaption(event.text);
  const voice = $("voice").value;
  if (voice === "browser" && window.speechSynthesis) {
    const utterance = new SpeechSynthesisUtterance(event.text);
    utterance.lang = event.language;
    utterance.volume = state.volume;
    utterance.onstart = () => began(event.id);
    utterance.onend = utterance.onerror = () => ended(event.id);
    speechSynthesis.speak(utterance);
  } else if (voice === "server" && event.audio) {
    audio.src = event.audio;
    audio.volume = state.volume;
    audio.onplaying = () => { $("sound").hidden = true; began(event.id); };
    audio.onended = audio.onerror = () => ended(event.id);
    audio.play().catch((error) => { if (error.name === "NotAllowedError") $("sound").hidden = false; });
  }
}

const handlers = {
  hello(event) { body.configure(event.joints); table.configure(event); showTexts(); },
  say,
  said() { if (state.speech) { state.speech.over = true; markWords(1); } },
  silence() {  // what was broken off is no longer true
    silence();
    if (state.speech) showCaption("…");
  },
  move(event) { body.move(event); },
  freeze() { body.freeze(); },
  eyes(event) { state.eyes = event.colour; },
  rest() { state.asleep = true; },
  wake() { state.asleep = false; },
  target(event) { state.target = event.position; },
  volume(event) { audio.volume = state.volume = event.volume; },
  scene(event) {
    const changed = table.show(event);
    if (changed && table.texts) $("table").setAttribute("aria-label", table.describe(table.texts));
  },
};

function connect() {
  const events = new EventSource("/events");
  events.onopen = () => { $("offline").hidden = true; };
  events.onerror = () => {
    $("offline").hidden = false;
    if (events.readyState === EventSource.CLOSED) setTimeout(connect, 2000);
  };
  events.onmessage = (message) => {
    const event = JSON.parse(message.data);
    handlers[event.type]?.(event);
  };
}

$("help").onclick = () => {
  report("help", 0);
  const texts = textsFor(state.language);
  const label = $("help").querySelector("span");
  $("help").classList.add("sent");
  label.textContent = texts.help_sent;
  setTimeout(() => { $("help").classList.remove("sent"); label.textContent = textsFor(state.language).help; }, 2500);
};
$("sound").onclick = () => { $("sound").hidden = true; audio.play().catch(() => {}); };
$("voice").onchange = () => { silence(); localStorage.setItem("voice", $("voice").value); };
$("voice").value = localStorage.getItem("voice") || "server";

function draw(time) {
  body.advance(time);
  const speech = state.speech;
  const talking = speech !== null && !speech.over;
  if (talking) markWords((time - speech.begun) / 1000 / speech.seconds);
  const pointing = state.target !== null;
  drawRobot($("robot"), body, { time, talking, asleep: state.asleep, eyes: state.eyes, pointing });
  table.draw(time, body, state.target);
  requestAnimationFrame(draw);
}

showTexts();
connect();
requestAnimationFrame(draw);
