#include "services/assembly_reasoner/contact_classes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coach {
namespace {

constexpr double kLengthUnit = 0.001;                    // m, of ContactError::distance
constexpr double kAngleUnit = std::numbers::pi / 180;    // rad
constexpr double kSameDistance = 4.0;                    // poses nearer than this are one class
constexpr double kCircle = 2 * std::numbers::pi - 1e-6;  // a range of rotation from here on is a full turn

double Length(const Vector6& xi) {
  return std::sqrt(xi.head<3>().squaredNorm() / (kLengthUnit * kLengthUnit) +
                   xi.tail<3>().squaredNorm() / (kAngleUnit * kAngleUnit));
}

Pose Turned(const Matrix3& R) {
  Pose X = Pose::Identity();
  X.linear() = R;
  return X;
}

Pose Motion(const JointFreedom& freedom, double q) {
  Pose M = Pose::Identity();
  if (freedom.kind == JointFreedom::Kind::kTranslation) {
    M.translation() = q * freedom.axis;
  } else {
    M.linear() = ExpRotation(q * freedom.axis);
    M.translation() = freedom.point - M.linear() * freedom.point;
  }
  return M;
}

JointFreedom Moved(const Pose& X, JointFreedom freedom, double sign) {
  freedom.axis = sign * (X.linear() * freedom.axis);
  freedom.point = X * freedom.point;
  return freedom;
}

JointFreedom FullTurn(const Vector3& axis, const Vector3& point) {
  return {JointFreedom::Kind::kRotation, axis, point, -std::numbers::pi, std::numbers::pi};
}

/// The joint seen from the other part: (M_1 .. M_n X)^-1 = (X^-1 M_n^-1 X) .. (X^-1 M_1^-1 X) X^-1.
ContactTemplate Reversed(const ContactTemplate& joint) {
  ContactTemplate out;
  out.X_AB = joint.X_AB.inverse();
  for (auto f = joint.freedom.rbegin(); f != joint.freedom.rend(); ++f) out.freedom.push_back(Moved(out.X_AB, *f, -1));
  return out;
}

/// Every relative pose that the symmetries of the two parts make indistinguishable.
std::vector<ContactTemplate> Equivalents(const ContactTemplate& joint, const SymmetryGroup& a, const SymmetryGroup& b) {
  std::vector<ContactTemplate> out;
  for (const Matrix3& S_A : a.discrete) {
    for (const Matrix3& S_B : b.discrete) {
      ContactTemplate t;
      t.X_AB = Turned(S_A) * joint.X_AB * Turned(S_B);
      for (const Vector3& axis : a.axes) t.freedom.push_back(FullTurn(S_A * axis, Vector3::Zero()));
      for (const JointFreedom& f : joint.freedom) t.freedom.push_back(Moved(Turned(S_A), f, 1));
      for (const Vector3& axis : b.axes) t.freedom.push_back(FullTurn(t.X_AB.linear() * axis, t.X_AB.translation()));
      const bool seen = std::any_of(out.begin(), out.end(), [&](const ContactTemplate& other) {
        return t.freedom.empty() && Length(Difference(other.X_AB, t.X_AB)) < 0.1;
      });
      if (!seen) out.push_back(t);
    }
  }
  return out;
}

double Clamped(const JointFreedom& f, double q) {
  if (f.kind == JointFreedom::Kind::kRotation && f.high - f.low >= kCircle) return q;
  return std::clamp(q, f.low, f.high);
}

/// The complement of the directions in which the joint moves at q.
Eigen::MatrixXd ConstrainedDirections(const ContactTemplate& joint, const std::vector<double>& q) {
  constexpr double kStep = 1e-5;
  const Pose X = MoveJoint(joint, q);
  Eigen::MatrixXd J(6, static_cast<int>(q.size()));
  for (size_t i = 0; i < q.size(); ++i) {
    std::vector<double> moved = q;
    moved[i] += kStep;
    J.col(static_cast<int>(i)) = Difference(X, MoveJoint(joint, moved)) / kStep;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
  qr.setThreshold(1e-4);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(6, 6);
  return Q.rightCols(6 - qr.rank());
}

/// Gauss-Newton over the freedoms from a start.
ContactError Descend(const ContactTemplate& joint, const Pose& X_AB, std::vector<double> q) {
  const int n = static_cast<int>(q.size());
  const auto residual = [&](const std::vector<double>& at) {
    Vector6 xi = Difference(MoveJoint(joint, at), X_AB);
    xi.head<3>() /= kLengthUnit;
    xi.tail<3>() /= kAngleUnit;
    return xi;
  };
  for (int iteration = 0; iteration < 8 && n > 0; ++iteration) {
    const Vector6 r = residual(q);
    Eigen::MatrixXd J(6, n);
    constexpr double kStep = 1e-5;
    for (int i = 0; i < n; ++i) {
      std::vector<double> moved = q;
      moved[i] += kStep;
      J.col(i) = (residual(moved) - r) / kStep;
    }
    const Eigen::MatrixXd H = J.transpose() * J + 1e-6 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd step = H.ldlt().solve(-J.transpose() * r);
    for (int i = 0; i < n; ++i) q[i] = Clamped(joint.freedom[i], q[i] + std::clamp(step[i], -0.5, 0.5));
    if (step.norm() < 1e-7) break;
  }
  ContactError error;
  error.X_nominal = MoveJoint(joint, q);
  error.xi = Difference(error.X_nominal, X_AB);
  error.distance = Length(error.xi);
  if (n > 0) error.constrained = ConstrainedDirections(joint, q);
  return error;
}

ContactError NearestOfTemplate(const ContactTemplate& joint, const Pose& X_AB) {
  const size_t n = joint.freedom.size();
  std::vector<double> middle(n);
  for (size_t i = 0; i < n; ++i) middle[i] = (joint.freedom[i].low + joint.freedom[i].high) / 2;
  ContactError best = Descend(joint, X_AB, middle);
  // Rotations over wide ranges have several minima: start from each third of the range.
  for (size_t i = 0; i < n; ++i) {
    const JointFreedom& f = joint.freedom[i];
    if (f.kind != JointFreedom::Kind::kRotation || f.high - f.low < 1.5) continue;
    for (const double part : {1.0 / 6, 5.0 / 6}) {
      std::vector<double> start = middle;
      start[i] = f.low + part * (f.high - f.low);
      const ContactError other = Descend(joint, X_AB, start);
      if (other.distance < best.distance) best = other;
    }
  }
  return best;
}

void Add(std::vector<ContactClass>& classes, const ContactTemplate& joint, const SymmetryGroup& a,
         const SymmetryGroup& b, int connection, int mistake) {
  ContactClass* home = nullptr;
  for (ContactClass& c : classes) {
    const bool same_freedom = c.templates[0].freedom.size() == joint.freedom.size() + a.axes.size() + b.axes.size();
    if (same_freedom && NearestContact(c, joint.X_AB).distance < kSameDistance) home = &c;
  }
  if (home == nullptr) {
    home = &classes.emplace_back();
    home->templates = Equivalents(joint, a, b);
  }
  if (connection >= 0) home->connections.push_back(connection);
  if (mistake >= 0) home->mistakes.push_back(mistake);
}

double Arm(const PartType& type) { return type.mesh.vertices.empty() ? 0 : Extent(type.mesh).diameter / 2; }

}  // namespace

Pose MoveJoint(const ContactTemplate& joint, const std::vector<double>& q) {
  Pose X = joint.X_AB;
  for (size_t i = joint.freedom.size(); i-- > 0;) X = Motion(joint.freedom[i], q[i]) * X;
  return X;
}

ContactTable::ContactTable(const Task& task) : num_types_(task.types.size()), classes_(num_types_ * num_types_) {
  const auto add = [&](int type_a, int type_b, const ContactTemplate& joint, int connection, int mistake) {
    const bool in_order = type_a <= type_b;
    const int first = std::min(type_a, type_b), second = std::max(type_a, type_b);
    auto& classes = classes_[first * num_types_ + second];
    const SymmetryGroup &a = task.types[first].symmetries, &b = task.types[second].symmetries;
    Add(classes, in_order ? joint : Reversed(joint), a, b, connection, mistake);
    if (type_a != type_b) return;
    // Equal parts: either may be the first.
    for (ContactClass& c : classes) {
      const bool mine = (connection >= 0 && !c.connections.empty() && c.connections.back() == connection) ||
                        (mistake >= 0 && !c.mistakes.empty() && c.mistakes.back() == mistake);
      const ContactTemplate other = Reversed(joint);
      if (!mine || NearestContact(c, other.X_AB).distance < kSameDistance) continue;
      for (const ContactTemplate& t : Equivalents(other, a, b)) c.templates.push_back(t);
    }
  };
  for (size_t i = 0; i < task.connections.size(); ++i) {
    const Connection& c = task.connections[i];
    add(task.slots[c.slot_a].type, task.slots[c.slot_b].type, {c.X_AB, c.freedom}, static_cast<int>(i), -1);
  }
  for (size_t i = 0; i < task.mistakes.size(); ++i) {
    const Mistake& m = task.mistakes[i];
    add(m.type_a, m.type_b, {m.X_AB, {}}, -1, static_cast<int>(i));
  }
  for (size_t a = 0; a < num_types_; ++a) {
    for (size_t b = a; b < num_types_; ++b) {
      for (ContactClass& c : classes_[a * num_types_ + b]) c.arm = std::min(Arm(task.types[a]), Arm(task.types[b]));
    }
  }
}

const std::vector<ContactClass>& ContactTable::Classes(int type_a, int type_b) const {
  return classes_[type_a * num_types_ + type_b];
}

ContactError NearestContact(const ContactClass& contact, const Pose& X_AB) {
  ContactError best;
  for (const ContactTemplate& joint : contact.templates) {
    const ContactError error = NearestOfTemplate(joint, X_AB);
    if (error.distance < best.distance) best = error;
  }
  return best;
}

bool FirstIsSlotA(const Task& task, int connection, int type_a) {
  return task.slots[task.connections[connection].slot_a].type == type_a;
}

}  // namespace coach
