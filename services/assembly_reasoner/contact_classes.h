// The ways in which two parts can be joined: every connection and mistake of the task as relative poses of two part
// types, modulo symmetry, with the motion that the joint leaves free.
//
// Two connections whose relative poses can't be told apart (the four corners of a rectangle) are one class. A
// continuous symmetry of a part is one more freedom of its joints.
#pragma once

#include <vector>

#include "common/assembly/task.h"
#include "common/geometry/pose.h"

namespace coach {

/// One relative pose with its freedoms, composed left to right: M_1(q_1) .. M_n(q_n) X_AB.
struct ContactTemplate {
  Pose X_AB = Pose::Identity();
  std::vector<JointFreedom> freedom;  ///< A's frame
};

struct ContactClass {
  std::vector<ContactTemplate> templates;  ///< of part B in part A, one for every indistinguishable relative pose
  std::vector<int> connections;            ///< indices into Task::connections that look like this
  std::vector<int> mistakes;               ///< indices into Task::mistakes that look like this
  double arm = 0;                          ///< m, half the diameter of the smaller part; 0 where it has no mesh
};

/// How far a relative pose is from a class.
struct ContactError {
  Vector6 xi = Vector6::Zero();       ///< Perturb(X_nominal, xi) = X_AB; m, rad; A's frame
  Pose X_nominal = Pose::Identity();  ///< nearest relative pose of the class
  /// Columns: the directions of xi in which the joint does not give way. What is orthogonal to them is free.
  Eigen::Matrix<double, 6, Eigen::Dynamic> constrained = Matrix6::Identity();
  double distance = 1e9;  ///< of xi, in units of 1 mm and 1 degree (root of the sum of squares)
};

class ContactTable {
 public:
  explicit ContactTable(const Task& task);

  /// Classes between two types. @pre type_a <= type_b: as Task::parts is in the order of types, part_a < part_b.
  const std::vector<ContactClass>& Classes(int type_a, int type_b) const;

 private:
  size_t num_types_ = 0;
  std::vector<std::vector<ContactClass>> classes_;  // type_a * num_types + type_b
};

/// The pose of the class nearest to X_AB, over templates and freedoms.
ContactError NearestContact(const ContactClass& contact, const Pose& X_AB);

/// X_AB of a joint moved along its freedoms by q (m or rad), from the task's relative pose.
Pose MoveJoint(const ContactTemplate& joint, const std::vector<double>& q);

/// Whether part_a of the class (the first of the pair) stands in slot_a of the connection. Where both parts are of one
/// type, either order is possible and true is returned.
bool FirstIsSlotA(const Task& task, int connection, int type_a);

}  // namespace coach
