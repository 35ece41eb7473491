// The words of the page for new tasks, in every language of the page; see words.js.

export const NEW_WORDS = {
  en: {
    title: 'A new task', lead: 'From a finished model, from single parts, or from what you build on the table.', way: 'How', way_model: 'A finished model: all parts where they belong', way_parts: 'Single parts, without connections', way_table: 'What is built on the table now',
    name: 'Name of the task', files: 'Files (OBJ, STL, PLY, GLB)', units: 'Units of the files', model: 'The model', count: 'How many: {0}',
    model_lead: 'One file with every part where it is in the end. Equal parts are found by their shape; parts that touch are connected.', parts_lead: 'One file for each kind of part. The task has no connections: the parts are only followed.', table_lead: 'Build the structure from the present task’s parts, leave it in view of the camera and take the hands away for four seconds. Then press Check.',
    busy: 'Working …', understood: 'Parts: {0}. Connections: {1}.', remark: {small: '{0} is only {2} mm long: are the units right?', large: '{0} is {2} mm long: are the units right?', colourless: '{0} has no colour that the robot can say.', overlap: '{0} and {1} overlap by {2} mm.', alone: '{0} touches no other part.', unseen: '{0} is not seen well.', moved: '{0} does not lie still.'}, check: 'Check', save: 'Save the task', saved: 'Saved as {0}.', book: 'Picture book for the children', use: 'Use it at this table', picture: 'The finished structure and its parts',
  },
  el: {
    title: 'Νέα κατασκευή', lead: 'Από έτοιμο μοντέλο, από χωριστά κομμάτια, ή από ό,τι χτίζετε στο τραπέζι.', way: 'Πώς', way_model: 'Έτοιμο μοντέλο: όλα τα κομμάτια στη θέση τους', way_parts: 'Χωριστά κομμάτια, χωρίς συνδέσεις', way_table: 'Ό,τι είναι χτισμένο τώρα στο τραπέζι',
    name: 'Όνομα της κατασκευής', files: 'Αρχεία (OBJ, STL, PLY, GLB)', units: 'Μονάδες των αρχείων', model: 'Το μοντέλο', count: 'Πόσα: {0}',
    model_lead: 'Ένα αρχείο με κάθε κομμάτι στην τελική του θέση. Τα ίδια κομμάτια βρίσκονται από το σχήμα τους· όσα ακουμπούν συνδέονται.', parts_lead: 'Ένα αρχείο για κάθε είδος κομματιού. Χωρίς συνδέσεις: τα κομμάτια απλώς παρακολουθούνται.', table_lead: 'Χτίστε με τα κομμάτια της τωρινής κατασκευής, αφήστε το μπροστά στην κάμερα και απομακρύνετε τα χέρια για τέσσερα δευτερόλεπτα. Μετά πατήστε Έλεγχος.',
    busy: 'Επεξεργασία …', understood: 'Κομμάτια: {0}. Συνδέσεις: {1}.', remark: {small: 'Μήκος μόνο {2} mm ({0}): είναι σωστές οι μονάδες;', large: 'Μήκος {2} mm ({0}): είναι σωστές οι μονάδες;', colourless: 'Το ρομπότ δεν έχει λέξη για το χρώμα: {0}.', overlap: 'Μπαίνουν το ένα στο άλλο κατά {2} mm: {0} και {1}.', alone: 'Δεν ακουμπά κανένα άλλο κομμάτι: {0}.', unseen: 'Δεν φαίνεται καλά: {0}.', moved: 'Δεν μένει ακίνητο: {0}.'}, check: 'Έλεγχος', save: 'Αποθήκευση', saved: 'Αποθηκεύτηκε ως {0}.', book: 'Εικονογραφημένο βιβλίο για τα παιδιά', use: 'Χρήση σε αυτό το τραπέζι', picture: 'Η έτοιμη κατασκευή και τα κομμάτια της',
  },
};
