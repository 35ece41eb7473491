// Every word of the page, in every language of the page. {0}, {1} are filled in.

import {NEW_WORDS} from './words_new.js';
import {SETUP_WORDS} from './words_setup.js';

const WORDS = {
  en: {
    pages: 'Pages', skip_to_content: 'Skip to the lesson', lesson: 'Lesson', notes: 'Notes', questions: 'Questionnaire', health: 'System',
    page_language: 'Language of this page', stop: 'STOP', offline: 'The connection to Coach is lost. Trying again …',
    task: 'Task', robot_language: 'Robot speaks', controls: 'Controls of the lesson', start: 'Start', pause: 'Pause', resume: 'Resume',
    skip: 'Skip step', help: 'Give a hint', camera: 'Camera', camera_description: 'Live picture of the table with outlines of the parts',
    camera_silent: 'No new picture from the camera', no_picture: 'No picture from the camera yet', no_picture_remote: 'The camera’s picture stays on the computer at the table.',
    parts: 'Parts', assembly: 'Assembly', robot: 'Robot', queue: 'What the robot said and will say', say: 'Say', say_label: 'Text for the robot to say',
    say_placeholder: 'Say something to the child …', repeat: 'Repeat', volume: 'Volume', table: 'Table', table_hint: 'drag to turn',
    table_description: 'Three-dimensional view of the parts on the table; arrow keys turn it', timeline: 'Timeline',
    phase: ['Introduction', 'Next step', 'The child is building', 'Well done', 'A mistake to put right', 'The child may need help', 'Nobody is building', 'The parts are hard to see', 'Paused', 'Finished'],
    not_started: 'Ready to start', no_reasoner: 'Waiting for Coach', no_reasoner_detail: 'The guidance service is not answering yet.',
    task_problem: 'The task can’t be used: {0}', asks_for: 'Asks for {0}', hint_level: 'Hint {0} of 4', progress: '{0} of {1} made', all_made: 'All {0} made',
    status: ['seen', 'hidden', 'out of view', 'lost', 'not seen yet'], made: 'made', open: 'missing', unsure: 'not sure', next: 'next',
    closes: 'closes by itself', mark_done: 'Mark done', mark_undone: 'Undo', wrong_with: 'Wrong: {0} with {1}', unknown_contact: 'an unknown connection',
    no_plan: 'This task has no connections: parts are only followed.', silent: 'The robot is quiet.', robot_off: 'not answering', robot_apart: 'no robot connected',
    back_end: {nao: 'NAO', virtual: 'virtual robot', log: 'no robot, log only'}, speaking: 'speaking',
    act: ['waiting', 'in the queue', 'speaking', 'said', 'interrupted', 'too late', 'failed'], battery: 'battery {0} %',
    events: {connect: 'made', wrong: 'wrong', disconnect: 'undone', phase: 'phase', say: 'says', act: 'act', operator: 'teacher', repair: 'taken back', session: 'lesson', hint: 'hint'},
    no_events: 'Nothing has happened yet.', fps: '{0} pictures a second', stopped: 'Stopped. Press Resume to go on.',
    sent: 'Sent', unanswered: '“{0}”: no answer from {1}', not_sent: 'Not sent: {0}', no_network: 'no connection',
    notes_title: 'What really happened', notes_lead: 'For a second observer: press at the moment you see it. Times can be corrected below.',
    annotator: 'Your name or initials', note_label: 'Note', note_placeholder: 'Anything worth remembering …', note_add: 'Add note', notes_kept: 'Kept',
    note_connect: 'Made', note_wrong: 'Wrong', note_disconnect: 'Undone', wrong_other: 'Some other wrong connection', earlier: '{0} s earlier', later: '{0} s later',
    remove: 'Remove', no_notes: 'No notes yet.', kind: {connect: 'Made', wrong: 'Wrong', disconnect: 'Undone', note: 'Note', questionnaire: 'Answer'},
    questions_title: 'How was it?', questions_lead: 'Ask the child, or let the child press the faces.', questions_send: 'Keep the answers', questions_kept: 'Thank you! The answers are kept.',
    child: 'Code of the child (no name)', question: ['Did you like building with the robot?', 'Did you understand what the robot told you?', 'Did the robot help you when you needed it?', 'Was it easy to build?', 'Would you like to do it again?'],
    face: ['not at all', 'a little', 'so-so', 'a lot', 'very much'],
    health_title: 'Is everything working?', health_good: 'Yes: all {0} services are working.', health_bad: 'Not quite: {0}.', needs: '{0} needs attention', not_answering: 'not answering',
    state: ['starting', 'working', 'working with trouble', 'failed'], reset_tracker: 'Search for all parts again',
    service: {capture: 'Camera', detector: 'Colour detector', 'pose-filter': 'Tracker', 'assembly-reasoner': 'Guidance', 'robot-bridge': 'Robot link', operator: 'This page', record: 'Recorder'},
    figure: {rate: 'rate', latency: 'delay', dropped: 'left out', lost: 'lost on the way', errors: 'unreadable', memory: 'memory'},
    of_99: '{0} ms, 99 % under {1} ms', of_received: '{0} of {1}', command: {choose_task: 'Choose task', language: 'Language', start: 'Start', pause: 'Pause', resume: 'Resume', skip: 'Skip step', mark_done: 'Mark done', mark_undone: 'Undo', repeat: 'Repeat', say: 'Say', volume: 'Volume', reset_tracker: 'Search again', stop: 'STOP', help: 'Give a hint'},
    colour: {blue: 'blue', green: 'green', red: 'red', yellow: 'yellow', orange: 'orange', white: 'white', black: 'black', purple: 'purple', brown: 'brown', pink: 'pink'},
    setup: SETUP_WORDS.en, new: NEW_WORDS.en, and: '{0} and {1}', lesson_of: 'lesson time {0}', language_name: {en: 'English', el: 'Greek'},
  },
  el: {
    pages: 'Σελίδες', skip_to_content: 'Μετάβαση στο μάθημα', lesson: 'Μάθημα', notes: 'Σημειώσεις', questions: 'Ερωτηματολόγιο', health: 'Σύστημα',
    page_language: 'Γλώσσα της σελίδας', stop: 'ΣΤΟΠ', offline: 'Χάθηκε η σύνδεση με το Coach. Νέα προσπάθεια …',
    task: 'Κατασκευή', robot_language: 'Το ρομπότ μιλάει', controls: 'Χειρισμός του μαθήματος', start: 'Έναρξη', pause: 'Παύση', resume: 'Συνέχεια',
    skip: 'Επόμενο βήμα', help: 'Δώσε βοήθεια', camera: 'Κάμερα', camera_description: 'Ζωντανή εικόνα του τραπεζιού με τα περιγράμματα των κομματιών',
    camera_silent: 'Καμία νέα εικόνα από την κάμερα', no_picture: 'Δεν υπάρχει ακόμα εικόνα από την κάμερα', no_picture_remote: 'Η εικόνα της κάμερας μένει στον υπολογιστή του τραπεζιού.',
    parts: 'Κομμάτια', assembly: 'Κατασκευή', robot: 'Ρομπότ', queue: 'Τι είπε και τι θα πει το ρομπότ', say: 'Πες το', say_label: 'Κείμενο για το ρομπότ',
    say_placeholder: 'Πες κάτι στο παιδί …', repeat: 'Ξανά', volume: 'Ένταση', table: 'Τραπέζι', table_hint: 'σύρετε για περιστροφή',
    table_description: 'Τρισδιάστατη όψη των κομματιών στο τραπέζι· τα βελάκια την περιστρέφουν', timeline: 'Χρονολόγιο',
    phase: ['Εισαγωγή', 'Επόμενο βήμα', 'Το παιδί χτίζει', 'Μπράβο', 'Ένα λάθος για διόρθωση', 'Το παιδί ίσως θέλει βοήθεια', 'Κανείς δεν χτίζει', 'Τα κομμάτια δεν φαίνονται καλά', 'Σε παύση', 'Τέλος'],
    not_started: 'Έτοιμο για έναρξη', no_reasoner: 'Αναμονή για το Coach', no_reasoner_detail: 'Η υπηρεσία καθοδήγησης δεν απαντά ακόμα.',
    task_problem: 'Η κατασκευή δεν μπορεί να χρησιμοποιηθεί: {0}', asks_for: 'Ζητά {0}', hint_level: 'Βοήθεια {0} από 4', progress: '{0} από {1} έτοιμες', all_made: 'Και οι {0} έτοιμες',
    status: ['φαίνεται', 'κρυμμένο', 'εκτός εικόνας', 'χάθηκε', 'δεν φάνηκε ακόμα'], made: 'έτοιμη', open: 'λείπει', unsure: 'αβέβαιη', next: 'επόμενη',
    closes: 'κλείνει μόνη της', mark_done: 'Έγινε', mark_undone: 'Αναίρεση', wrong_with: 'Λάθος: {0} με {1}', unknown_contact: 'άγνωστη σύνδεση',
    no_plan: 'Χωρίς συνδέσεις: τα κομμάτια απλώς παρακολουθούνται.', silent: 'Το ρομπότ σιωπά.', robot_off: 'δεν απαντά', robot_apart: 'κανένα ρομπότ συνδεδεμένο',
    back_end: {nao: 'NAO', virtual: 'εικονικό ρομπότ', log: 'χωρίς ρομπότ'}, speaking: 'μιλάει',
    act: ['περιμένει', 'στην ουρά', 'μιλάει', 'ειπώθηκε', 'διακόπηκε', 'πολύ αργά', 'απέτυχε'], battery: 'μπαταρία {0} %',
    events: {connect: 'έτοιμη', wrong: 'λάθος', disconnect: 'λύθηκε', phase: 'φάση', say: 'λέει', act: 'κίνηση', operator: 'δάσκαλος', repair: 'ανακλήθηκε', session: 'μάθημα', hint: 'βοήθεια'},
    no_events: 'Δεν έγινε τίποτα ακόμα.', fps: '{0} εικόνες το δευτερόλεπτο', stopped: 'Σταμάτησε. Πατήστε Συνέχεια.',
    sent: 'Στάλθηκε', unanswered: '«{0}»: καμία απάντηση από {1}', not_sent: 'Δεν στάλθηκε: {0}', no_network: 'χωρίς σύνδεση',
    notes_title: 'Τι έγινε στ’ αλήθεια', notes_lead: 'Για δεύτερο παρατηρητή: πατήστε τη στιγμή που το βλέπετε. Οι χρόνοι διορθώνονται παρακάτω.',
    annotator: 'Το όνομα ή τα αρχικά σας', note_label: 'Σημείωση', note_placeholder: 'Κάτι που αξίζει να θυμόμαστε …', note_add: 'Προσθήκη', notes_kept: 'Καταγραφές',
    note_connect: 'Έγινε', note_wrong: 'Λάθος', note_disconnect: 'Λύθηκε', wrong_other: 'Κάποια άλλη λάθος σύνδεση', earlier: '{0} δ. νωρίτερα', later: '{0} δ. αργότερα',
    remove: 'Αφαίρεση', no_notes: 'Καμία σημείωση ακόμα.', kind: {connect: 'Έγινε', wrong: 'Λάθος', disconnect: 'Λύθηκε', note: 'Σημείωση', questionnaire: 'Απάντηση'},
    questions_title: 'Πώς σου φάνηκε;', questions_lead: 'Ρωτήστε το παιδί ή αφήστε το να πατήσει τα πρόσωπα.', questions_send: 'Αποθήκευση', questions_kept: 'Ευχαριστούμε! Οι απαντήσεις αποθηκεύτηκαν.',
    child: 'Κωδικός παιδιού (όχι όνομα)', question: ['Σου άρεσε να χτίζεις με το ρομπότ;', 'Κατάλαβες τι σου έλεγε το ρομπότ;', 'Σε βοήθησε το ρομπότ όταν το χρειάστηκες;', 'Ήταν εύκολο να το φτιάξεις;', 'Θα ήθελες να το ξανακάνεις;'],
    face: ['καθόλου', 'λίγο', 'έτσι κι έτσι', 'πολύ', 'πάρα πολύ'],
    health_title: 'Λειτουργούν όλα;', health_good: 'Ναι: και οι {0} υπηρεσίες λειτουργούν.', health_bad: 'Όχι ακριβώς: {0}.', needs: '{0}: χρειάζεται προσοχή', not_answering: 'δεν απαντά',
    state: ['ξεκινά', 'λειτουργεί', 'λειτουργεί με προβλήματα', 'απέτυχε'], reset_tracker: 'Νέα αναζήτηση όλων των κομματιών',
    service: {capture: 'Κάμερα', detector: 'Ανιχνευτής χρωμάτων', 'pose-filter': 'Παρακολούθηση', 'assembly-reasoner': 'Καθοδήγηση', 'robot-bridge': 'Σύνδεση ρομπότ', operator: 'Αυτή η σελίδα', record: 'Καταγραφή'},
    figure: {rate: 'ρυθμός', latency: 'καθυστέρηση', dropped: 'παραλείφθηκαν', lost: 'χάθηκαν', errors: 'μη αναγνώσιμα', memory: 'μνήμη'},
    of_99: '{0} ms, 99 % κάτω από {1} ms', of_received: '{0} από {1}', command: {choose_task: 'Κατασκευή', language: 'Γλώσσα', start: 'Έναρξη', pause: 'Παύση', resume: 'Συνέχεια', skip: 'Επόμενο βήμα', mark_done: 'Έγινε', mark_undone: 'Αναίρεση', repeat: 'Ξανά', say: 'Πες το', volume: 'Ένταση', reset_tracker: 'Νέα αναζήτηση', stop: 'ΣΤΟΠ', help: 'Δώσε βοήθεια'},
    colour: {blue: 'μπλε', green: 'πράσινο', red: 'κόκκινο', yellow: 'κίτρινο', orange: 'πορτοκαλί', white: 'άσπρο', black: 'μαύρο', purple: 'μωβ', brown: 'καφέ', pink: 'ροζ'},
    setup: SETUP_WORDS.el, new: NEW_WORDS.el, and: '{0} και {1}', lesson_of: 'χρόνος {0}', language_name: {en: 'αγγλικά', el: 'ελληνικά'},
  },
};

let language = 'en';

/** The text of a key ('phase.2' or 'events.connect' for lists and maps), filled in; the key's last piece if there is none. */
export function t(key, ...values) {
  let text = WORDS[language];
  for (const piece of key.split('.')) text = text?.[piece];
  if (typeof text !== 'string') return key.split('.').pop();
  return text.replace(/\{(\d)\}/g, (_, n) => values[n] ?? '');
}

export const pageLanguage = () => language;
export const wordsOf = (code) => WORDS[code];

/** Chooses the page's language and writes every marked element anew. */
export function usePageLanguage(code) {
  language = WORDS[code] ? code : 'en';
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll('[data-t]')) element.textContent = t(element.dataset.t);
  for (const element of document.querySelectorAll('[data-t-label]')) element.setAttribute('aria-label', t(element.dataset.tLabel));
  for (const element of document.querySelectorAll('[data-t-placeholder]')) element.placeholder = t(element.dataset.tPlaceholder);
}
