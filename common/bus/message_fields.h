// Checked fields, shared by the conversions of messages.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "common/geometry/pose.h"

namespace coach {

[[noreturn]] inline void RefuseField(const char* field, const std::string& found) {
  throw std::invalid_argument(std::string(field) + " is " + found);
}

inline double Finite(double value, const char* field) {
  if (!std::isfinite(value)) RefuseField(field, std::to_string(value));
  return value;
}

inline double InRange(double value, double low, double high, const char* field) {
  if (!(value >= low && value <= high)) RefuseField(field, std::to_string(value));
  return value;
}

inline int IndexInRange(int value, int low, int high, const char* field) {
  if (value < low || value > high) RefuseField(field, std::to_string(value));
  return value;
}

template <class Enum>
Enum KnownValue(int value, Enum last, const char* field) {
  return static_cast<Enum>(IndexInRange(value, 0, static_cast<int>(last), field));
}

template <class T>
Vector3 FiniteVector(const T (&values)[3], const char* field) {
  return {Finite(values[0], field), Finite(values[1], field), Finite(values[2], field)};
}

template <class T>
void SetVector(const Vector3& v, T (&out)[3]) {
  for (int i = 0; i < 3; ++i) out[i] = static_cast<T>(v[i]);
}

/// Quaternion w, x, y, z, unit within 1e-3.
template <class T>
Matrix3 UnitRotation(const T (&q)[4], const char* field) {
  const Eigen::Quaterniond quaternion(q[0], q[1], q[2], q[3]);
  if (!(std::abs(quaternion.norm() - 1) < 1e-3)) RefuseField(field, "no unit quaternion");
  return quaternion.normalized().toRotationMatrix();
}

template <class T>
void SetRotation(const Matrix3& R, T (&out)[4]) {
  const Eigen::Quaterniond q(R);
  const double sign = q.w() < 0 ? -1 : 1;
  out[0] = static_cast<T>(sign * q.w());
  out[1] = static_cast<T>(sign * q.x());
  out[2] = static_cast<T>(sign * q.y());
  out[3] = static_cast<T>(sign * q.z());
}

/// Upper triangle, row by row.
inline Matrix6 FiniteCovariance(const float (&values)[21], const char* field) {
  Matrix6 covariance;
  int i = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) covariance(r, c) = covariance(c, r) = Finite(values[i++], field);
  if ((covariance.diagonal().array() < 0).any()) RefuseField(field, "negative on its diagonal");
  return covariance;
}

inline void SetCovariance(const Matrix6& covariance, float (&out)[21]) {
  int i = 0;
  for (int r = 0; r < 6; ++r)
    for (int c = r; c < 6; ++c) out[i++] = static_cast<float>(covariance(r, c));
}

}  // namespace coach
