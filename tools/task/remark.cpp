#include "tools/task/remark.h"

#include <map>

namespace coach {

std::string Sentence(const Remark& remark) {
  const std::string length = std::to_string(remark.millimetres) + " mm";
  const std::map<std::string, std::string> sentences{
      {"small", remark.part + " is only " + length + " long: are the units right?"},
      {"large", remark.part + " is " + length + " long: are the units right?"},
      {"colourless", remark.part + " has no colour that the robot can say"},
      {"overlap", remark.part + " and " + remark.other + " overlap by " + length},
      {"alone", remark.part + " touches no other part"},
      {"unseen", remark.part + " is not seen well"},
      {"moved", remark.part + " does not lie still"}};
  return sentences.at(remark.kind);
}

}  // namespace coach
