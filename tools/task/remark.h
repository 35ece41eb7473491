// What a person should look at before a new task is used.
#pragma once

#include <string>

namespace coach {

struct Remark {
  /// Of a draft: small, large, colourless (that the robot can't say), overlap, alone (touches no other part). Of parts
  /// on the table: unseen, moved.
  std::string kind;
  std::string part;     ///< name of the part or its type
  std::string other{};  ///< overlap: the other part
  int millimetres = 0;  ///< small, large: how long it is; overlap: how deep
};

/// In English; the page has words of its own (page/words_new.js).
std::string Sentence(const Remark& remark);

}  // namespace coach
