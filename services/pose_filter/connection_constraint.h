// Parts that are probably connected move as one in a share of the particles: section IV-B4 of the paper.
#pragma once

#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"

namespace coach {

/// Two parts that may be one body.
struct RigidLink {
  int part_a = 0, part_b = 0;
  Pose X_AB = Pose::Identity();  ///< as the connection demands, in the symmetric equivalent nearest to the estimate
  double probability = 0;
};

/// The links between parts with known poses, most probable first; for each two parts the best connection only. The
/// probability is [1] of the paper, from the poses.
/// @param X_CP pose of each part, any common frame.
/// @param known whether a part's pose is known.
std::vector<RigidLink> FindLinks(const Task& task, const std::vector<Pose>& X_CP, const std::vector<bool>& known);

/// The same with the reasoner's probabilities. Links of the belief whose parts or connection don't exist are ignored.
std::vector<RigidLink> FindLinks(const Task& task, const std::vector<Pose>& X_CP, const std::vector<bool>& known,
                                 const ConnectionBelief& belief);

/// Which parts follow which: bodies made of the first links of a list. A link that closes a ring is implied by the
/// others and left out.
class RigidBodies {
 public:
  RigidBodies(int parts, const std::vector<RigidLink>& links, size_t num_links);

  struct Follower {
    int part = 0;
    int leader = 0;                ///< placed before it
    Pose X_LF = Pose::Identity();  ///< pose of the follower in its leader
  };
  /// The parts that follow `part`, in an order in which leaders come first; empty if it is alone.
  const std::vector<Follower>& FollowersOf(int part) const { return followers_[static_cast<size_t>(part)]; }
  /// Whether the part moves by itself: it is alone or the first of its body.
  bool Leads(int part) const { return leads_[static_cast<size_t>(part)]; }

 private:
  std::vector<std::vector<Follower>> followers_;
  std::vector<bool> leads_;
};

/// How many links, counted from the most probable, a particle at `level` in [0, 1) obeys: those with min(probability,
/// cap) above the level. With levels spread evenly each link is enforced on its share of the particles, and the links
/// of one sub-assembly on the same ones.
size_t NumEnforced(const std::vector<RigidLink>& links, double level, double cap = 0.6);

}  // namespace coach
