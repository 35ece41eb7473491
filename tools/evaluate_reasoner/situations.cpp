#include "tools/evaluate_reasoner/situations.h"

#include <algorithm>
#include <numeric>

namespace coach {
namespace {

using Kind = ScriptAction::Kind;

Situation Orders(const Task& task, int orders) {
  const int64_t all = CountPlainScripts(task);
  int64_t stride = std::max<int64_t>(1, all / std::max(1, orders));
  while (stride > 1 && std::gcd(stride, all) != 1) ++stride;  // so that every digit of the number changes
  Situation s;
  for (int64_t i = 0; i < all; i += stride) s.scripts.push_back(PlainScriptAt(task, i));
  s.name = std::to_string(s.scripts.size()) + " of " + std::to_string(all) + " orders and assignments";
  return s;
}

Situation UnderTheHands(Situation s) {
  s.name = "the same, joints made under the hands";
  for (auto& script : s.scripts) {
    for (ScriptAction& action : script) action.hidden = true;
  }
  return s;
}

/// Mistakes that can't be taken for the beginning of a variant.
Situation Mistakes(const Task& task) {
  Situation s;
  for (size_t m = 0; m < task.mistakes.size(); ++m) {
    const int index = static_cast<int>(m);
    if (!IsOnlyWrong(task, index)) continue;
    const auto first = [&](int type, int other) {
      int p = 0;
      while (task.parts[p].type != type || p == other) ++p;
      return p;
    };
    const int a = first(task.mistakes[m].type_a, -1), b = first(task.mistakes[m].type_b, a);
    s.scripts.push_back({{Kind::kMistake, index, a, b}, {Kind::kUndo, index, a, b}});
  }
  s.name = "every listed mistake, undone";
  return s;
}

Situation Undone(const Task& task) {
  Situation s{"every connection, undone, made again", {}};
  for (const ScriptAction& made : PlainScriptAt(task, 0)) {
    ScriptAction undo = made;
    undo.kind = Kind::kUndo;
    s.scripts.push_back({made, undo, made});
  }
  return s;
}

Situation NearMisses(const Task& task, int millimetres) {
  Situation s{"near misses of " + std::to_string(millimetres) + " mm", {}};
  for (ScriptAction miss : PlainScriptAt(task, 0)) {
    miss.kind = Kind::kNearMiss;
    miss.gap = millimetres / 1000.0;
    s.scripts.push_back({miss, miss, miss});
  }
  return s;
}

}  // namespace

std::vector<Situation> Situations(const Task& task, int orders) {
  const Situation plain = Orders(task, orders);
  std::vector<Situation> out{plain, UnderTheHands(plain), Mistakes(task), Undone(task)};
  for (const int millimetres : {5, 10, 15, 20, 25, 30}) out.push_back(NearMisses(task, millimetres));
  return out;
}

}  // namespace coach
