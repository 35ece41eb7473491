// A robot that only writes down what it would do. Speech takes as long as it would take to say.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "services/robot_bridge/back_end.h"

namespace coach {

class LogBackEnd : public BackEnd {
 public:
  /// @param write receives one line an order, e.g. `say 17 en "Well done!"`
  explicit LogBackEnd(std::function<void(const std::string&)> write) : write_(std::move(write)) {}

  std::string name() const override { return "log"; }
  bool physical() const override { return false; }
  std::vector<BackEndEvent> Poll(int64_t now) override;
  BackEndState State() const override { return {true, "", -1}; }

  void Say(const SpeechOrder& speech) override;
  void Silence() override;
  void Move(const JointPath& path) override;
  void Freeze() override { write_("freeze"); }
  void SetEyes(const EyeColour& colour) override { write_("eyes " + HexOf(colour)); }
  void Rest() override { write_("rest"); }
  void Wake() override { write_("wake"); }
  void SetVolume(double volume) override;

 private:
  std::function<void(const std::string&)> write_;
  std::optional<SpeechOrder> speech_;
  int64_t speech_end_ = 0;  // us; 0: not yet known
};

}  // namespace coach
