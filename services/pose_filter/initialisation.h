// Poses from nothing, as the paper does it: table plane, clusters above it, candidate rotations refined by ICP.
#pragma once

#include <optional>
#include <vector>

#include "common/assembly/detections.h"
#include "common/geometry/camera.h"
#include "common/geometry/mesh.h"
#include "services/pose_filter/depth_renderer.h"
#include "services/pose_filter/observation.h"
#include "services/pose_filter/observation_model.h"
#include "services/pose_filter/random.h"

namespace coach {

struct InitialisationOptions {
  int step = 2;                     ///< px between the depth readings that are used
  double farthest = 3;              ///< m; farther readings are not looked at
  double plane_distance = 0.008;    ///< m from the table's plane that still is table
  int plane_iterations = 300;       ///< RANSAC triples
  double least_table = 0.1;         ///< of the readings must lie on the table
  double lowest = 0.010;            ///< m above the plane; below it is table
  double highest = 0.4;             ///< m above the plane; above it is background
  double cluster_distance = 0.015;  ///< m, DBSCAN's neighbourhood
  int cluster_neighbours = 10;      ///< DBSCAN: of a core point
  int least_points = 40;            ///< of a cluster
  int candidates = 40;              ///< random rotations
  int icp_iterations = 30;
  double icp_distance = 0.02;  ///< m, of corresponding points
  int icp_points = 250;        ///< of the cluster, at most
  int model_points = 1500;     ///< of the part's surface
};

/// The readings above the table, in clusters.
struct SceneClusters {
  std::optional<Plane> table;           ///< camera frame; empty: none found, everything was clustered
  std::vector<Vector3> points;          ///< m, camera frame
  std::vector<Eigen::Vector2i> pixels;  ///< of the points
  std::vector<int> cluster;             ///< of the points; -1: of none
  int num_clusters = 0;
};

/// Largest plane by RANSAC and least squares, then DBSCAN of what stands on it. The same for the same image and seed.
/// @param depth CV_16UC1; empty: no points.
SceneClusters FindClusters(const cv::Mat& depth, double metres_per_unit, const CameraModel& camera, uint64_t seed,
                           const InitialisationOptions& options);

/// The points of the cluster in which most of a region's pixels lie; of these, those of the region's colour if there
/// are enough. Empty if the region is in no cluster of size.
std::vector<Vector3> PointsOfRegion(const SceneClusters& clusters, const Detections& detections, const Region& region,
                                    const InitialisationOptions& options);

struct PoseFit {
  Pose X_CP = Pose::Identity();
  double log_likelihood = 0;  ///< nats, of the depth image with the part there against without it
};

/// Refines random rotations of the part at the points by ICP and keeps the one that explains the depth image best.
/// Empty if none comes close.
std::optional<PoseFit> FitPose(const TriangleMesh& mesh, const RenderMesh& render_mesh,
                               const std::vector<Vector3>& points, const ObservationModel& model,
                               const DepthEvidence& evidence, Random& random, const InitialisationOptions& options);

}  // namespace coach
