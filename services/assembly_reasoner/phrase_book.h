// What the robot can say in one language: wordings with placeholders that agree in gender, case and number.
//
// A phrase file (deploy/phrases/LANGUAGE.yaml):
//   language: el
//   articles: {neuter: {nom: το, acc: το}, feminine: {nom: η, acc: την}}   # "the", by gender and case
//   others:   {neuter: {nom: το άλλο, acc: το άλλο}}                       # "the other"
//   order: "{article} {size} {colour} {noun}"                             # of a part's description
//   words:                                                                # sizes and colours
//     blue: μπλε                                                          # one form, or by gender, or by gender and
//     case green: {neuter: πράσινο, feminine: {nom: πράσινη, acc: πράσινη}}
//   nouns:
//     part: {gender: neuter, nom: κομμάτι, acc: κομμάτι}                  # for types that `types` does not know
//   types:                                                                # part types of task files
//     long: {size: long, noun: brick}
//   phrases:
//     step: ["[Βάλε|Βάλτε] {a.acc} πάνω στην άκρη, δίπλα σε {b.acc}."]    # [one child|a group]
// Placeholders: {a.nom} {a.acc} {b.nom} {b.acc} (two parts, with article), {left} (steps left), {angle} (degrees).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// What a kind of phrase is for and which placeholders its wordings may use.
struct PhraseKind {
  std::string key;
  std::vector<std::string> placeholders;
};
/// Every kind that the guidance uses; a phrase file must have all of them and no other.
const std::vector<PhraseKind>& PhraseKinds();

struct PhraseValues {
  int type_a = -1, type_b = -1;  ///< part types; -1 none
  int left = 0;                  ///< steps left
  int angle = 0;                 ///< degrees between the two parts
};

class PhraseBook {
 public:
  /// @throws ConfigurationError naming file, line, key, what was found and expected
  static PhraseBook Load(const std::filesystem::path& file);

  const std::string& language() const { return language_; }
  int Wordings(const std::string& key) const;
  /// @param plural a group is spoken to
  std::string Render(const Task& task, const std::string& key, int wording, const PhraseValues& values,
                     bool plural) const;

  /// What is wrong with the wordings, empty if nothing: less than `least` a kind, two alike, unbalanced brackets,
  /// placeholders the kind does not have, unknown words for a task's colours, renderings longer than 400 bytes.
  std::vector<std::string> Problems(const std::vector<const Task*>& tasks, int least = 6) const;

 private:
  using Forms = std::map<std::string, std::string>;  // "gender case" -> word
  struct Noun {
    std::string gender;
    Forms forms;  // case -> word
  };
  struct TypeName {
    std::string size, noun;
  };
  std::string Form(const std::string& word, const std::string& gender, const std::string& grammatical_case) const;
  std::string Describe(const PartType& type, const std::string& grammatical_case, bool other) const;

  std::string language_, order_;
  std::map<std::string, Forms> words_;
  Forms articles_, others_;
  std::map<std::string, Noun> nouns_;
  std::map<std::string, TypeName> types_;
  std::map<std::string, std::vector<std::string>> phrases_;
};

}  // namespace coach
