#include "services/assembly_reasoner/phrase_book.h"

#include <algorithm>
#include <set>

#include "common/configuration/yaml_reader.h"

namespace coach {
namespace {

constexpr size_t kLongestBytes = 400;

/// Forms of a word: one for all, by gender, or by gender and case. Keys: "", "gender", "gender case".
std::map<std::string, std::string> ReadForms(const YamlNode& node) {
  std::map<std::string, std::string> forms;
  if (node.IsScalar()) {
    forms[""] = node.As<std::string>();
    return forms;
  }
  for (const auto& [gender, by_gender] : node.Entries()) {
    if (by_gender.IsScalar()) {
      forms[gender] = by_gender.As<std::string>();
      continue;
    }
    for (const auto& [grammatical_case, word] : by_gender.Entries())
      forms[gender + " " + grammatical_case] = word.As<std::string>();
  }
  return forms;
}

std::string Pick(const std::map<std::string, std::string>& forms, const std::string& gender,
                 const std::string& grammatical_case) {
  for (const std::string& key : {gender + " " + grammatical_case, gender, std::string()}) {
    const auto found = forms.find(key);
    if (found != forms.end()) return found->second;
  }
  return "";
}

void Replace(std::string& text, const std::string& from, const std::string& to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

/// "[one|many]" by number.
std::string ChooseNumber(const std::string& text, bool plural) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const size_t open = text.find('[', at);
    const size_t bar = text.find('|', open), close = text.find(']', open);
    if (open == std::string::npos || bar == std::string::npos || close == std::string::npos || bar > close)
      return out + text.substr(at);
    out += text.substr(at, open - at);
    out += plural ? text.substr(bar + 1, close - bar - 1) : text.substr(open + 1, bar - open - 1);
    at = close + 1;
  }
  return out;
}

/// Words that fell away leave double spaces.
std::string Squeeze(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == ' ' && (out.empty() || out.back() == ' ')) continue;
    out += c;
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

bool BracketsFit(const std::string& text) {
  int depth = 0, bars = 0;
  for (const char c : text) {
    if (c == '[') {
      if (++depth > 1) return false;
      bars = 0;
    } else if (c == '|') {
      if (depth == 0) return false;
      ++bars;
    } else if (c == ']') {
      if (--depth < 0 || bars != 1) return false;
    }
  }
  return depth == 0 && std::count(text.begin(), text.end(), '{') == std::count(text.begin(), text.end(), '}');
}

std::vector<std::string> PlaceholdersOf(const std::string& text) {
  std::vector<std::string> out;
  for (size_t open = text.find('{'); open != std::string::npos; open = text.find('{', open + 1)) {
    const size_t close = text.find('}', open);
    if (close == std::string::npos) break;
    out.push_back(text.substr(open + 1, close - open - 1));
  }
  return out;
}

}  // namespace

const std::vector<PhraseKind>& PhraseKinds() {
  static const std::vector<std::string> kParts{"a.nom", "a.acc", "b.nom", "b.acc"};
  static const auto with = [](std::vector<std::string> more) {
    more.insert(more.end(), kParts.begin(), kParts.end());
    return more;
  };
  static const std::vector<PhraseKind> kinds{
      {"introduction", {"left"}},        // a task begins
      {"introduction_again", {"left"}},  // another task of the lesson begins
      {"step", kParts},                  // the next connection is asked for
      {"idle_1", kParts},                // the child is late: the goal in other words
      {"idle_2", kParts},                // names the two parts; eyes and look
      {"idle_3", with({"angle"})},       // points; the two parts stand at an angle
      {"idle_3_straight", kParts},       // points; the two parts stand in line
      {"idle_4", kParts},                // full description, picture on the page
      {"praise", {"left"}},              // a right connection
      {"complete", {}},                  // the last one
      {"wrong", kParts},                 // these two do not belong together
      {"wrong_turned", kParts},          // the right two, one the wrong way round
      {"wrong_unknown", kParts},         // two are joined as on no list, or as two that belong together are not
      {"wrong_last", kParts},            // the correction was said three times: the whole help
      {"hedge", kParts},                 // not sure: look once more
      {"repair", {}},                    // the correction was a mistake of the robot's
      {"lost", {}},                      // the parts can't be seen
      {"skipped", {}},                   // the operator skips a step
      {"next_task", {}},                 // another task follows
      {"pause", {}},                     // the lesson pauses
      {"resume", {}},                    // and goes on
  };
  return kinds;
}

PhraseBook PhraseBook::Load(const std::filesystem::path& file) {
  const YamlNode root = YamlNode::Load(file);
  PhraseBook book;
  book.language_ = root.Get<std::string>("language");
  book.order_ = root.Get<std::string>("order");
  book.articles_ = ReadForms(root.At("articles"));
  book.others_ = ReadForms(root.At("others"));
  for (const auto& [word, forms] : root.At("words").Entries()) book.words_[word] = ReadForms(forms);
  for (const auto& [name, node] : root.At("nouns").Entries()) {
    Noun noun;
    noun.gender = node.Get<std::string>("gender");
    for (const char* c : {"nom", "acc"}) noun.forms[c] = node.Get<std::string>(c);
    node.RejectUnknownKeys();
    book.nouns_[name] = noun;
  }
  if (!book.nouns_.contains("part")) root.At("nouns").Fail("no `part`", "a noun `part` for types without a name");
  for (const auto& [name, node] : root.At("types").Entries()) {
    book.types_[name] = {node.Get<std::string>("size", ""), node.Get<std::string>("noun")};
    if (!book.nouns_.contains(book.types_[name].noun)) node.At("noun").Fail("one of the nouns");
    if (!book.types_[name].size.empty() && !book.words_.contains(book.types_[name].size))
      node.At("size").Fail("one of the words");
    node.RejectUnknownKeys();
  }
  const YamlNode phrases = root.At("phrases");
  for (const PhraseKind& kind : PhraseKinds()) {
    book.phrases_[kind.key] = phrases.Get<std::vector<std::string>>(kind.key);
    if (book.phrases_[kind.key].empty()) phrases.At(kind.key).Fail("at least one wording");
  }
  phrases.RejectUnknownKeys();
  root.RejectUnknownKeys();
  return book;
}

int PhraseBook::Wordings(const std::string& key) const { return static_cast<int>(phrases_.at(key).size()); }

std::string PhraseBook::Form(const std::string& word, const std::string& gender,
                             const std::string& grammatical_case) const {
  const auto found = words_.find(word);
  return found == words_.end() ? "" : Pick(found->second, gender, grammatical_case);
}

std::string PhraseBook::Describe(const PartType& type, const std::string& grammatical_case, bool other) const {
  const auto known = types_.find(type.name);
  const TypeName name = known == types_.end() ? TypeName{"", "part"} : known->second;
  const Noun& noun = nouns_.at(name.noun);
  std::string text = order_;
  Replace(text, "{article}", Pick(other ? others_ : articles_, noun.gender, grammatical_case));
  Replace(text, "{size}", Form(name.size, noun.gender, grammatical_case));
  Replace(text, "{colour}", Form(type.colour, noun.gender, grammatical_case));
  Replace(text, "{noun}", noun.forms.at(grammatical_case));
  return Squeeze(text);
}

std::string PhraseBook::Render(const Task& task, const std::string& key, int wording, const PhraseValues& values,
                               bool plural) const {
  std::string text = ChooseNumber(phrases_.at(key).at(static_cast<size_t>(wording)), plural);
  for (const char* c : {"nom", "acc"}) {
    const std::string a = values.type_a >= 0 ? Describe(task.types[values.type_a], c, false) : "";
    const bool same = values.type_a >= 0 && values.type_a == values.type_b;
    const std::string b = values.type_b >= 0 ? Describe(task.types[values.type_b], c, same) : "";
    Replace(text, std::string("{a.") + c + "}", a);
    Replace(text, std::string("{b.") + c + "}", b);
  }
  Replace(text, "{left}", std::to_string(values.left));
  Replace(text, "{angle}", std::to_string(values.angle));
  // A description may begin the sentence (ASCII only: Greek wordings do not begin with one).
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return Squeeze(text);
}

std::vector<std::string> PhraseBook::Problems(const std::vector<const Task*>& tasks, int least) const {
  std::vector<std::string> out;
  for (const PhraseKind& kind : PhraseKinds()) {
    const auto& wordings = phrases_.at(kind.key);
    if (static_cast<int>(wordings.size()) < least)
      out.push_back(kind.key + ": " + std::to_string(wordings.size()) + " wordings, expected " + std::to_string(least));
    if (std::set<std::string>(wordings.begin(), wordings.end()).size() != wordings.size())
      out.push_back(kind.key + ": two wordings are alike");
    for (size_t w = 0; w < wordings.size(); ++w) {
      const std::string place = kind.key + " " + std::to_string(w + 1) + ": ";
      if (!BracketsFit(wordings[w])) out.push_back(place + "brackets do not fit: [one child|a group], {placeholder}");
      for (const std::string& p : PlaceholdersOf(wordings[w])) {
        if (std::find(kind.placeholders.begin(), kind.placeholders.end(), p) == kind.placeholders.end())
          out.push_back(place + "placeholder {" + p + "} has no value here");
      }
      for (const Task* task : tasks) {
        size_t longest = 0;
        for (int a = 0; a < static_cast<int>(task->types.size()); ++a) {
          for (int b = 0; b < static_cast<int>(task->types.size()); ++b) {
            for (const bool plural : {false, true})
              longest = std::max(longest, Render(*task, kind.key, static_cast<int>(w), {a, b, 99, 180}, plural).size());
          }
        }
        if (longest > kLongestBytes)
          out.push_back(place + std::to_string(longest) + " bytes, expected at most " + std::to_string(kLongestBytes));
      }
    }
  }
  for (const Task* task : tasks) {
    for (const PartType& type : task->types) {
      if (!type.colour.empty() && !words_.contains(type.colour))
        out.push_back("words: the colour '" + type.colour + "' of task " + task->name + " is missing");
      if (!types_.contains(type.name))
        out.push_back("types: '" + type.name + "' of task " + task->name + " is missing");
    }
  }
  return out;
}

}  // namespace coach
