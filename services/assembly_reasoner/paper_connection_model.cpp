#include <algorithm>
#include <cmath>
#include <map>

#include "common/assembly/connection_probability.h"
#include "services/assembly_reasoner/connection_model.h"

namespace coach {
namespace {

constexpr double kCertain = 12;  // nats: probabilities of exactly 0 and 1 are what [2] gives

class PaperConnectionModel : public ConnectionModel {
 public:
  PaperConnectionModel(const Task& task, const ContactTable& contacts) : task_(task), contacts_(contacts) {}

  PairVerdict Judge(const PairView& view) override {
    PairVerdict verdict;
    if (view.a->status == PartStatus::kAbsent || view.b->status == PartStatus::kAbsent) return verdict;
    verdict.has_evidence = true;
    const Pose X_AB = view.a->X_TP.inverse() * view.b->X_TP;
    const auto& classes = contacts_.Classes(task_.parts[view.part_a].type, task_.parts[view.part_b].type);
    for (const ContactClass& contact : classes) {
      double p = 0;
      for (const ContactTemplate& joint : contact.templates)
        p = std::max(p, PaperConnectionProbability(joint.X_AB, X_AB));
      verdict.log_odds.push_back(std::clamp(std::log(p / (1 - p)), -kCertain, kCertain));
    }
    return verdict;
  }
  int64_t ChangeTime(int, int, int, int, int64_t now) const override { return now; }
  void Exchange(int, int) override {}

 private:
  const Task& task_;
  const ContactTable& contacts_;
};

}  // namespace

std::unique_ptr<ConnectionModel> MakePaperConnectionModel(const Task& task, const ContactTable& contacts) {
  return std::make_unique<PaperConnectionModel>(task, contacts);
}

}  // namespace coach
