// The page's own words. What the robot says comes ready-made from the phrase files.
const texts = {
  en: {
    language: "en", robot: "Robot", table: "Our table", you: "You", help: "I need help", help_sent: "Let me see!",
    sound: "Turn on sound", voice: "Voice", voice_server: "Robot", voice_browser: "This device", voice_none: "Silent",
    offline: "The robot's computer does not answer. I keep trying.", ready: "Hello! I am ready.",
    parts: (n) => (n === 1 ? "1 part on the table" : `${n} parts on the table`),
  },
  el: {
    language: "el", robot: "Ρομπότ", table: "Το τραπέζι μας", you: "Εσύ", help: "Θέλω βοήθεια", help_sent: "Για να δω!",
    sound: "Άνοιξε τον ήχο", voice: "Φωνή", voice_server: "Ρομπότ", voice_browser: "Συσκευή", voice_none: "Σιωπή",
    offline: "Ο υπολογιστής του ρομπότ δεν απαντά. Συνεχίζω να προσπαθώ.", ready: "Γεια σου! Είμαι έτοιμο.",
    parts: (n) => (n === 1 ? "1 κομμάτι στο τραπέζι" : `${n} κομμάτια στο τραπέζι`),
  },
};

export function textsFor(language) {
  return texts[language.slice(0, 2)] || texts.en;
}
