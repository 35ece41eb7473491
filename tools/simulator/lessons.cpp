#include "tools/simulator/lessons.h"

#include <cmath>

#include "tools/simulator/enactment.h"

namespace coach {

void Build(Making* m) {
  m->Furnish({});
  const Random start = m->random;
  const ChildStyle style = m->style;
  // Interludes are left out, the least important first, and then the child works faster, until the lesson fits.
  for (int left_out = 0; left_out < 9; ++left_out) {
    m->random = start;
    m->style = style;
    LessonPlan plan;
    plan.mistakes = m->scenario.options.mistakes;
    plan.out_of_view = left_out < 1;
    plan.turn = left_out < 2;
    plan.near_miss = left_out < 3;
    plan.cover = left_out < 4;
    if (left_out >= 5) plan.mistakes = 0;
    if (left_out > 4) m->style.speed *= std::pow(1.3, left_out - 4), m->style.pause *= std::pow(0.6, left_out - 4);
    const Pose place = StructurePlace(m->task, m->structure, *m->solids, m->random);
    m->Place(ScatterParts(m->task, *m->solids, m->structure, place, m->scenario.stage.room.clutter, 0.3, m->random));
    m->child->set_now(1.2);
    Enactment(m->task, m->structure, *m->solids, m->child.get(), &m->scenario.performance, &m->random).Play(plan);
    const double limit = m->scenario.options.seconds;
    if (limit <= 0 || m->child->now() <= limit) break;
  }
}

void Ready(Making* m) {
  m->Furnish({});
  const Pose place = StructurePlace(m->task, m->structure, *m->solids, m->random);
  m->Place(ScatterParts(m->task, *m->solids, m->structure, place, m->scenario.stage.room.clutter, 0.2, m->random));
  m->child->set_now(3);
}

void BuildWithJolts(Making* m) {
  Build(m);
  m->scenario.camera.tremor = 0.001;
  for (double t = 3; t < m->child->now(); t += m->random.Uniform(4, 7)) {
    const double duration = m->random.Uniform(0.12, 0.25);
    const Vector3 shift(m->random.Uniform(-0.06, 0.06), m->random.Uniform(-0.04, 0.04), m->random.Uniform(-0.03, 0.04));
    const Vector3 turn(m->random.Uniform(-0.06, 0.06), m->random.Uniform(-0.06, 0.06), m->random.Uniform(-0.06, 0.06));
    m->scenario.camera.jolts.push_back({t, duration, shift, turn});
  }
}

void BuildOfShinyParts(Making* m) {
  Build(m);
  for (Material& material : m->scenario.stage.part_materials) material.depth_holes = 0.4, material.gloss = 0.6;
}

void BuildOfOneColour(Making* m) {
  for (Material& material : m->scenario.stage.part_materials) material = m->scenario.stage.part_materials[0];
  Build(m);
}

void BuildNoisy(Making* m) {
  Build(m);
  m->scenario.stage.depth.noise = 2;
  m->scenario.stage.colour.noise = 2;
}

}  // namespace coach
