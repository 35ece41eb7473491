// The rules of speech over everything that is said in random lessons: children that build, err, undo and vanish,
// operators that press anything, robots that do not report, processes that are killed.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "classroom.h"

namespace coach {
namespace {

bool Begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

class RandomLesson {
 public:
  explicit RandomLesson(uint64_t seed) : room_(seed) {}

  Classroom Play() {
    room_.robot_reports = Chance(0.8);
    room_.Run(0.4);
    room_.Operator(OperatorKind::kStart);
    for (int action = 0; action < 14; ++action) {
      Act(Uniform(0, 1));
      room_.moving = Chance(0.4);
      room_.RunOn(Uniform(0.5, Chance(0.2) ? 60 : 12));
    }
    return std::move(room_);
  }

 private:
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(room_.random()); }
  bool Chance(double p) { return Uniform(0, 1) < p; }

  void Act(double dice) {
    if (dice < 0.4) {
      room_.JoinRight(static_cast<int>(room_.random()() % 4));
    } else if (dice < 0.55 && room_.joints().empty()) {
      room_.Join(0, 1, Rectangle().mistakes[room_.random()() % 3].X_AB);
    } else if (dice < 0.75) {
      room_.Undo(0, 1);
    } else if (dice < 0.8 && !room_.joints().empty()) {
      const auto [a, b] = room_.joints().begin()->first;
      room_.Undo(a, b);
    } else if (dice < 0.85) {
      room_.hidden = !room_.hidden;
    } else if (dice < 0.9) {
      room_.Restart();
    } else {
      const auto kind = static_cast<OperatorKind>(room_.random()() % 14);
      room_.Operator(kind, Chance(0.5) ? "corner_2" : "el");
    }
  }

  Classroom room_;
};

void EverySentenceIsWhole(const Classroom& room) {
  int64_t last = 0;
  for (const auto& s : room.said) {
    ASSERT_GT(s.command.id, last);
    last = s.command.id;
    ASSERT_FALSE(s.command.text.empty());
    ASSERT_LE(s.command.text.size(), 400u);
    ASSERT_EQ(s.command.text.find_first_of("{}[]|"), std::string::npos) << s.command.text;
  }
}

void UnsolicitedOnesAreSixSecondsApart(const Classroom& room) {
  int64_t last = 0;
  for (const auto& s : room.said) {
    if (!std::set<std::string>{"step", "hedge", "lost"}.contains(s.command.phrase_key)) continue;
    // The clock of the gap starts anew in a new process.
    ASSERT_TRUE(last == 0 || s.at - last >= 6000000 || room.restarted() >= last) << s.command.phrase_key;
    last = s.at;
  }
}

bool AskedForHelp(const Classroom& room, int64_t from, int64_t to) {
  return std::any_of(room.events.begin(), room.events.end(), [&](const GuidanceEvent& e) {
    return e.kind == "operator" && e.subject == "help" && e.utime >= from && e.utime <= to;
  });
}

void OnlyWhatIsWrongIsCorrectedAndNotAgainWithinTwelveSeconds(const Classroom& room) {
  int64_t last = 0;
  std::set<std::tuple<int, int, int>> before;
  for (const auto& s : room.said) {
    if (!Begins(s.command.phrase_key, "wrong")) continue;
    std::set<std::tuple<int, int, int>> mistakes;
    for (const ConnectionState& x : s.state.connections) {
      if (x.connection < 0) mistakes.insert({x.connection, x.part_a, x.part_b});
    }
    ASSERT_FALSE(mistakes.empty()) << "a correction of what is right: " << s.command.text;
    const bool again = std::includes(before.begin(), before.end(), mistakes.begin(), mistakes.end());
    ASSERT_TRUE(!again || s.at - last >= 12000000 || s.command.phrase_key != "wrong" || AskedForHelp(room, last, s.at));
    last = s.at;
    before = std::move(mistakes);
  }
}

void NothingElseIsAskedForWhileAMistakeWaits(const Classroom& room) {
  for (const auto& s : room.said) {
    const std::string& key = s.command.phrase_key;
    ASSERT_FALSE(s.state.phase == Phase::kWrong && (key == "step" || key == "hedge" || Begins(key, "idle"))) << key;
  }
}

void OnlyWhatIsMadeIsPraised(const Classroom& room) {
  for (const auto& s : room.said) ASSERT_TRUE(s.command.phrase_key != "praise" || s.state.made > 0);
}

void NoWordingComesAgainWithinThree(const Classroom& room) {
  std::map<std::string, std::vector<int>> wordings;
  for (const auto& s : room.said) {
    if (s.command.phrase_key == "operator" || room.restarted() > 0) continue;
    auto& last = wordings[s.command.language + s.command.phrase_key];
    const auto from = last.size() > 3 ? last.end() - 3 : last.begin();
    ASSERT_EQ(std::find(from, last.end(), s.command.wording), last.end()) << s.command.text;
    last.push_back(s.command.wording);
  }
}

void EventsAreInOrder(const Classroom& room) {
  for (size_t i = 1; i < room.events.size(); ++i) ASSERT_GT(room.events[i].id, room.events[i - 1].id);
}

/// That two sentences never overlap is checked by the classroom itself. Other lessons:
/// --gtest_random_seed=N.
TEST(SpeechRules, HoldInRandomLessons) {
  constexpr uint64_t kLessons = 200;
  const uint64_t first = 1 + kLessons * static_cast<uint64_t>(GTEST_FLAG_GET(random_seed));
  size_t utterances = 0;
  for (uint64_t seed = first; seed < first + kLessons && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    const Classroom room = RandomLesson(seed).Play();
    utterances += room.said.size();
    EverySentenceIsWhole(room);
    UnsolicitedOnesAreSixSecondsApart(room);
    OnlyWhatIsWrongIsCorrectedAndNotAgainWithinTwelveSeconds(room);
    NothingElseIsAskedForWhileAMistakeWaits(room);
    OnlyWhatIsMadeIsPraised(room);
    NoWordingComesAgainWithinThree(room);
    EventsAreInOrder(room);
  }
  EXPECT_GT(utterances, 1000u);
}

}  // namespace
}  // namespace coach
