#include "services/assembly_reasoner/lesson_configuration.h"

#include <algorithm>

namespace coach {
namespace {

namespace fs = std::filesystem;

void ReadConnections(const YamlNode& node, AssemblyReasonerOptions& o) {
  const auto number = [&](const char* key, double& value, double low, double high) {
    value = node.GetInRange(key, value, low, high);
  };
  o.paper = node.GetChoice("model", o.paper ? "paper" : "coach", {"paper", "coach"}) == "paper";
  number("decide_probability", o.decide_probability, 0.5, 0.999);
  number("decide_hold", o.decide_hold, 0, 5);
  number("wrong_hold", o.wrong_hold, 0, 5);
  number("undo_hold", o.undo_hold, 0, 5);
  number("deepest_overlap", o.deepest_overlap, 0, 0.05);
  number("correlation_time", o.model.correlation_time, 0.01, 2);
  number("blur_time", o.model.blur_time, 0, 0.2);
  number("blur_turn", o.model.blur_turn, 0, 5);
  number("hidden_blur", o.model.hidden_blur, 0, 0.02);
  number("slack_position", o.model.slack_position, 1e-4, 0.02);
  number("slack_angle", o.model.slack_angle, 1e-3, 0.3);
  number("smallest_visible", o.model.smallest_visible, 0.01, 0.5);
  number("full_visible", o.model.full_visible, 0.01, 1);
  number("apart_visible", o.model.apart_visible, 0.05, 1);
  number("largest_log_odds", o.model.largest_log_odds, 1, 50);
  number("far_distance", o.model.far_distance, 0.005, 0.2);
  number("together_travel", o.model.together_travel, 0.005, 0.5);
  number("together_turn", o.model.together_turn, 0.02, 3);
  number("together_time", o.model.together_time, 0.1, 5);
  number("together_bonus", o.model.together_bonus, 0, 10);
  number("image_weight", o.model.image_weight, 0, 1);
  number("image_limit", o.model.image_limit, 0, 10);
  number("break_overlap", o.break_overlap, 0, 0.05);
  number("pressed_limit", o.model.pressed_limit, 0, 10);
  number("inferred_price", o.model.inferred_price, 0, 10);
  number("calm_speed", o.model.calm_speed, 0, 2);
  number("clear_gap", o.model.clear_gap, 0, 0.1);
  number("break_visible", o.model.break_visible, 0, 1);
  number("fastest_pull", o.model.fastest_pull, 0.05, 10);
  number("fastest_twist", o.model.fastest_twist, 0.5, 100);
  number("jump_time", o.model.jump_time, 0, 10);
  number("dating_limit", o.model.dating_limit, 0.1, 20);
  number("dating_visible", o.model.dating_visible, 0.05, 1);
  number("least_approach", o.model.least_approach, 0.001, 1);
  number("unknown_travel", o.model.unknown_travel, 0.02, 1);
  number("unknown_time", o.model.unknown_time, 0.2, 10);
  number("unknown_gap", o.model.unknown_gap, 0.0005, 0.02);
  number("unknown_slip", o.model.unknown_slip, 0.001, 0.05);
  number("unknown_twist", o.model.unknown_twist, 0.01, 1);
  number("hidden_visible", o.hidden.hidden_visible, 0, 0.5);
  number("holder_visible", o.hidden.holder_visible, 0.05, 1);
  number("seat_position", o.hidden.seat_position, 0.001, 0.05);
  number("seat_angle", o.hidden.seat_angle, 0.01, 1);
  number("play_position", o.hidden.play_position, 0.0001, 0.02);
  number("play_angle", o.hidden.play_angle, 0.001, 0.3);
  number("forgetting_time", o.belief.forgetting_time, 0.01, 5);
  number("price_connection", o.belief.price_connection, -5, 10);
  number("price_mistake", o.belief.price_mistake, -5, 10);
  number("price_unknown", o.belief.price_unknown, -5, 20);
  number("stickiness", o.belief.stickiness, 0, 10);
  number("implied_odds", o.belief.implied_odds, 0, 20);
  node.RejectUnknownKeys();
}

void ReadResponses(const YamlNode& node, ResponseOptions& o) {
  const auto number = [&](const char* key, double& value, double low, double high) {
    value = node.GetInRange(key, value, low, high);
  };
  number("praise_probability", o.praise_probability, 0.5, 1);
  number("praise_hold", o.praise_hold, 0, 10);
  number("correct_probability", o.correct_probability, 0.5, 1);
  number("correct_hold", o.correct_hold, 0, 30);
  number("correct_margin", o.correct_margin, 0, 1);
  number("correct_gap", o.correct_gap, 0, 120);
  o.correct_times = static_cast<int>(node.GetInRange("correct_times", o.correct_times, 0, 10));
  number("hedge_low", o.hedge_low, 0.1, 1);
  number("hedge_hold", o.hedge_hold, 0, 60);
  number("hedge_gap", o.hedge_gap, 0, 600);
  number("away", o.away, 5, 3600);
  number("lost", o.lost, 0.5, 60);
  number("lost_gap", o.lost_gap, 5, 3600);
  number("repair_window", o.repair_window, 0, 60);
  number("moving_speed", o.moving_speed, 0.005, 1);
  number("hand_time", o.hand_time, 0, 2);
  number("still_time", o.still_time, 0, 10);
  if (const auto idle = node.Find("idle")) {
    const auto seconds = idle->As<std::vector<double>>();
    const bool rising = seconds.size() == 4 && seconds[0] > 0 && std::is_sorted(seconds.begin(), seconds.end());
    if (!rising) idle->Fail("four rising numbers of seconds");
    std::copy(seconds.begin(), seconds.end(), o.idle.begin());
  }
  node.RejectUnknownKeys();
}

void ReadSpeech(const YamlNode& node, LessonOptions& options) {
  SpeechOptions& o = options.speech;
  o.expiry = node.GetInRange("expiry", o.expiry, 0.5, 30);
  o.unsolicited_gap = node.GetInRange("unsolicited_gap", o.unsolicited_gap, 0, 120);
  o.pause = node.GetInRange("pause", o.pause, 0, 10);
  o.characters_per_second = node.GetInRange("characters_per_second", o.characters_per_second, 3, 40);
  o.robot_patience = node.GetInRange("robot_patience", o.robot_patience, 0, 30);
  options.validity = node.GetInRange("validity", options.validity, 1, 60);
  options.no_repeat = static_cast<int>(node.GetInRange("no_repeat", options.no_repeat, 0, 20));
  node.RejectUnknownKeys();
}

}  // namespace

LessonConfiguration ReadLessonConfiguration(const YamlNode& section, const fs::path& folder) {
  LessonConfiguration c;
  c.options.language = section.Get<std::string>("language", c.options.language);
  c.options.group = section.Get<bool>("group", c.options.group);
  c.options.start_by_itself = section.Get<bool>("start_by_itself", c.options.start_by_itself);
  c.options.task_pause = section.GetInRange("task_pause", c.options.task_pause, 0, 3600);
  if (const auto list = section.Find("tasks")) {
    for (const std::string& file : list->As<std::vector<std::string>>()) c.tasks.push_back(folder / file);
  }
  const auto path = [&](const char* key) {
    const auto text = section.Get<std::string>(key, "");
    return text.empty() ? fs::path() : folder / text;
  };
  c.phrases = path("phrases");
  c.event_log = path("event_log");
  if (const auto node = section.Find("connections")) ReadConnections(*node, c.options.reasoner);
  if (const auto node = section.Find("responses")) ReadResponses(*node, c.options.response);
  if (const auto node = section.Find("speech")) ReadSpeech(*node, c.options);
  section.RejectUnknownKeys();
  return c;
}

std::map<std::string, PhraseBook> LoadPhraseBooks(const fs::path& folder) {
  std::map<std::string, PhraseBook> books;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".yaml") continue;
    const PhraseBook book = PhraseBook::Load(entry.path());
    if (!books.emplace(book.language(), book).second)
      throw ConfigurationError(entry.path().string() + ": language: found " + book.language() +
                               " a second time, expected one file a language");
  }
  if (books.empty()) throw ConfigurationError(folder.string() + ": found no phrase file, expected en.yaml or others");
  return books;
}

fs::path ShippedPhrases() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  fs::path folder = program.parent_path();
  if (fs::exists(folder / "../share/coach/phrases")) return folder / "../share/coach/phrases";
  while (folder.has_relative_path()) {
    if (fs::exists(folder / "deploy/phrases/en.yaml")) return folder / "deploy/phrases";
    folder = folder.parent_path();
  }
  throw ConfigurationError("no phrase files beside " + program.string() + ": give the folder as guidance.phrases");
}

}  // namespace coach
