#include "tools/simulator/still_scenes.h"

#include "tools/simulator/shapes.h"

namespace coach {

void Fig4(Making* m) {
  m->scenario.stage.child = false;
  m->AddProp(MakeBox({0.14, 0.05, 0.17}),
             OnTable(m->random.Uniform(-0.03, 0.03), -0.17, 0.085, m->random.Uniform(-0.2, 0.2)));
  m->Furnish({.clutter = 5, .clutter_from = 0.25});
  const int n = static_cast<int>(m->task.parts.size());
  std::vector<Pose> poses;
  for (int i = 0; i < n; ++i) {
    // Side by side in a row behind the obstacle, about 10 cm from one another.
    const double x = (i - 0.5 * (n - 1)) * 0.11 + m->random.Uniform(-0.01, 0.01);
    poses.push_back(Flat(*m, i, x, 0.03 + m->random.Uniform(-0.02, 0.02), 0.5 * M_PI + m->random.Uniform(-0.4, 0.4)));
  }
  m->Place(poses);
  CameraPath& path = m->scenario.camera;
  path.target = {0, 0.02, 0.02};
  path.distance = 0.9;
  path.swing = 1;
  path.azimuth = 0.25;
  path.elevation = 0.68;
  path.period = m->random.Uniform(10, 13);
  path.tremor = 0.0012;
  const double end = m->scenario.options.seconds > 0 ? m->scenario.options.seconds : 30;
  for (double t = m->random.Uniform(5, 7); t < end; t += m->random.Uniform(6, 8)) {
    const auto push = [&](double most) {
      return (m->random.Chance(0.5) ? 1 : -1) * m->random.Uniform(0.5 * most, most);
    };
    path.jolts.push_back(
        {t, m->random.Uniform(0.14, 0.25), {push(0.09), push(0.06), push(0.06)}, {push(0.07), push(0.07), push(0.05)}});
  }
  m->child->set_now(end);
}

void Start(Making* m) {
  m->scenario.stage.child = false;
  m->Furnish({.clutter = 3});
  m->Scatter(0.5);
  m->scenario.camera.tremor = 0;
  m->child->set_now(1.5);
}

}  // namespace coach
