#include "services/detector/connected_components.h"

#include <algorithm>

namespace coach {
namespace {

int Root(std::vector<int>& parent, int i) {
  while (parent[static_cast<size_t>(i)] != i) {
    int& up = parent[static_cast<size_t>(i)];
    up = parent[static_cast<size_t>(up)];
    i = up;
  }
  return i;
}

/// The smaller root wins, so that a component's root is its first run.
void Unite(std::vector<int>& parent, int a, int b) {
  a = Root(parent, a);
  b = Root(parent, b);
  if (a != b) parent[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
}

}  // namespace

void ConnectedComponents::Find(const BitImage& image) {
  runs_.clear();
  parent_.clear();
  components_.clear();
  size_t above = 0, above_end = 0;  // runs of the previous row that may still touch the next run
  for (int y = 0; y < image.height(); ++y) {
    const size_t first = runs_.size();
    ForEachRun(image, y, [&](int begin, int end) {
      const int index = static_cast<int>(runs_.size());
      runs_.push_back({y, begin, end, 0});
      parent_.push_back(index);
      while (above < above_end && runs_[above].end < begin) ++above;
      for (size_t i = above; i < above_end && runs_[i].begin <= end; ++i) Unite(parent_, static_cast<int>(i), index);
    });
    above = first;
    above_end = runs_.size();
  }
  for (size_t i = 0; i < runs_.size(); ++i) {
    PixelRun& run = runs_[i];
    const int root = Root(parent_, static_cast<int>(i));
    if (root == static_cast<int>(i)) {
      run.component = static_cast<int>(components_.size());
      components_.push_back({0, {0, 0}, {run.begin, run.y, run.end, run.y + 1}});
    } else {
      run.component = runs_[static_cast<size_t>(root)].component;
    }
    Component& c = components_[static_cast<size_t>(run.component)];
    const int length = run.end - run.begin;
    c.area += length;
    c.centroid[0] += 0.5 * (run.begin + run.end - 1) * length;
    c.centroid[1] += static_cast<double>(run.y) * length;
    c.box = {std::min(c.box[0], run.begin), c.box[1], std::max(c.box[2], run.end), run.y + 1};
  }
  for (Component& c : components_) {
    c.centroid[0] /= c.area;
    c.centroid[1] /= c.area;
    c.box[2] -= c.box[0];
    c.box[3] -= c.box[1];
  }
}

}  // namespace coach
