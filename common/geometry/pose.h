// Rigid transforms SE(3).
//
// Notation, everywhere in this project: X_AB is the pose of frame B in frame A, p_A = X_AB * p_B, X_AC = X_AB * X_BC.
// Frames: C camera (x right, y down, z forward), T table (z up), P part (as in its mesh), R robot's torso (x front, z
// up). Lengths in metres, angles in radians.
#pragma once

#include <Eigen/Geometry>

namespace coach {

using Pose = Eigen::Isometry3d;
using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// A small motion or its rate: translation (m) first, then rotation vector (rad), both in the parent frame.
using Vector6 = Eigen::Matrix<double, 6, 1>;
/// Covariance of such a motion.
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Rotation by |w| radians about w. Exact for every length, series near 0.
Matrix3 ExpRotation(const Vector3& w);

/// Inverse of ExpRotation; the result's length is in [0, pi].
Vector3 LogRotation(const Matrix3& R);

/// The pose X_AB moved by xi, given in A: position p + xi.head<3>(), rotation Exp(xi.tail<3>()) R.
/// Translation and rotation do not mix, so a covariance's blocks are those of position and of orientation about the
/// part's origin.
Pose Perturb(const Pose& X_AB, const Vector6& xi);

/// The xi with Perturb(from, xi) = to.
Vector6 Difference(const Pose& from, const Pose& to);

/// Covariance of (translation, rotation) rotated from frame B into A: blocks R C R^T.
Matrix6 RotateCovariance(const Matrix3& R_AB, const Matrix6& covariance_B);

/// Covariance of X_AC = X_AB * X_BC for independent errors of both, each in its own parent frame.
Matrix6 ComposeCovariance(const Pose& X_AB, const Matrix6& covariance_AB, const Pose& X_BC,
                          const Matrix6& covariance_BC);

/// Pose from a rotation that may be slightly off (it is projected onto SO(3)) and a position.
Pose MakePose(const Matrix3& R, const Vector3& p);

/// Angle of the rotation between two poses, rad, in [0, pi].
double RotationAngle(const Matrix3& R);

}  // namespace coach
