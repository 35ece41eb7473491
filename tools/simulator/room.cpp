#include "tools/simulator/room.h"

#include <algorithm>
#include <cmath>

#include "tools/simulator/motion.h"
#include "tools/simulator/shapes.h"

namespace coach {
namespace {

Vector3 FromHsv(double hue, double saturation, double value) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + hue / 30, 6);
    return value - value * saturation * std::max(0.0, std::min({k, 4 - k, 1.0}));
  };
  return FromSrgb(static_cast<int>(255 * channel(5)), static_cast<int>(255 * channel(3)),
                  static_cast<int>(255 * channel(1)));
}

Material RandomMaterial(Random& random, int patterns) {
  Material m;
  m.colour = FromHsv(random.Uniform(0, 180), random.Uniform(0.1, 0.8), random.Uniform(0.3, 0.9));
  m.second_colour = random.Chance(0.5)
                        ? Vector3(0.6 * m.colour)
                        : FromHsv(random.Uniform(0, 180), random.Uniform(0.1, 0.7), random.Uniform(0.2, 0.9));
  m.pattern = random.Pick(patterns);
  m.tile = random.Uniform(0.2, 0.7);
  m.gloss = random.Chance(0.3) ? 0.15 : 0.02;
  return m;
}

void AddTable(Room* room, Random& random) {
  Fixture table;
  table.mesh = MakeBox({2 * kTableHalfX, 2 * kTableHalfY, 0.03});
  table.X_W = OnTable(0, 0, -0.015, 0);
  Material& m = table.material;
  switch (random.Pick(3)) {
    case 0:  // wood
      m.colour = FromSrgb(214, 180, 140), m.second_colour = FromSrgb(166, 126, 88), m.pattern = 2, m.tile = 0.55;
      m.gloss = 0.06;
      break;
    case 1:  // grey laminate
      m.colour = FromSrgb(205, 203, 198), m.second_colour = FromSrgb(168, 166, 162), m.pattern = 1, m.tile = 0.35;
      m.gloss = 0.05;
      break;
    default:  // cloth
      m.colour = FromSrgb(188, 178, 160), m.second_colour = FromSrgb(130, 118, 105), m.pattern = 4, m.tile = 0.18;
      m.gloss = 0;
      break;
  }
  room->fixtures.push_back(table);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      room->fixtures.push_back(
          {MakeBox({0.05, 0.05, 0.56}), m, OnTable(x * (kTableHalfX - 0.06), y * (kTableHalfY - 0.06), -0.31, 0)});
    }
  }
}

void AddBackground(Room* room, Random& random) {
  const int patterns = static_cast<int>(room->patterns.size());
  Material floor;
  floor.colour = FromSrgb(120, 118, 118), floor.second_colour = FromSrgb(90, 88, 90), floor.pattern = 1,
  floor.tile = 0.8;
  room->fixtures.push_back({MakeBox({6, 6, 0.05}), floor, OnTable(0, 1, -0.62, 0)});
  Material wall;
  wall.colour = FromSrgb(190, 192, 196), wall.second_colour = FromSrgb(150, 155, 165), wall.pattern = 1,
  wall.tile = 1.5;
  room->fixtures.push_back({MakeBox({7, 0.1, 3.4}), wall, OnTable(0, random.Uniform(1.5, 2.2), 1, 0)});
  room->fixtures.push_back({MakeBox({0.1, 6, 3.4}), wall, OnTable(-2.6, 1, 1, 0)});
  room->fixtures.push_back({MakeBox({0.1, 6, 3.4}), wall, OnTable(2.6, 1, 1, 0)});
  for (int i = 0; i < 7; ++i) {
    const Vector3 size(random.Uniform(0.2, 0.7), random.Uniform(0.2, 0.5), random.Uniform(0.3, 1.2));
    const double x = random.Uniform(-1.6, 1.6);
    const double y = random.Uniform(0.95, 1.4);
    room->fixtures.push_back({MakeBox(size), RandomMaterial(random, patterns),
                              OnTable(x, y, -0.6 + 0.5 * size.z(), random.Uniform(-0.4, 0.4))});
  }
}

void AddClutter(const RoomOptions& options, Room* room, Random& random) {
  const int patterns = static_cast<int>(room->patterns.size());
  for (int i = 0; i < options.clutter; ++i) {
    const double side = random.Chance(0.5) ? 1 : -1;
    const double x = side * random.Uniform(options.clutter_from, kTableHalfX - 0.08);
    const double y = random.Uniform(-0.2, 0.3);
    const double yaw = random.Uniform(-3, 3);
    const Material m = RandomMaterial(random, patterns);
    Spot place{{x, y}, 0.06};
    switch (random.Pick(4)) {
      case 0: {
        const double r = random.Uniform(0.015, 0.03);
        room->fixtures.push_back({MakeBall(r), m, OnTable(x, y, r, yaw)});
        break;
      }
      case 1: {
        const double h = random.Uniform(0.04, 0.1), r = random.Uniform(0.02, 0.035);
        room->fixtures.push_back({MakeCylinder(r, h), m, OnTable(x, y, 0.5 * h, yaw)});
        break;
      }
      case 2: {
        const Vector3 size(random.Uniform(0.03, 0.09), random.Uniform(0.02, 0.05), random.Uniform(0.015, 0.04));
        room->fixtures.push_back({MakeBox(size), m, OnTable(x, y, 0.5 * size.z(), yaw)});
        break;
      }
      default: {  // a pencil
        place.radius = 0.08;
        Pose X = OnTable(x, y, 0.004, yaw);
        X.linear() = X.linear() * Eigen::AngleAxisd(M_PI / 2, Vector3::UnitX()).toRotationMatrix();
        room->fixtures.push_back({MakeCylinder(0.004, 0.15, 8), m, X});
      }
    }
    room->clutter.push_back(place);
  }
}

void SetLooks(Room* room, Random& random) {
  static const std::vector<Vector3> kSkins{FromSrgb(236, 190, 160), FromSrgb(222, 165, 130), FromSrgb(190, 130, 95),
                                           FromSrgb(140, 90, 62), FromSrgb(96, 62, 45)};
  room->skin.colour = kSkins[static_cast<size_t>(random.Pick(static_cast<int>(kSkins.size())))];
  room->skin.second_colour = 0.85 * room->skin.colour;
  room->skin.pattern = 1;
  room->skin.tile = 0.15;
  room->skin.gloss = 0.05;
  room->clothes = RandomMaterial(random, static_cast<int>(room->patterns.size()));
  // Clothes move and their pattern does not move with them, so it is kept faint.
  room->clothes.pattern = 1;
  room->clothes.second_colour = 0.75 * room->clothes.colour;
  room->clothes.gloss = 0;
  room->hair.colour = FromSrgb(50, 35, 25);
  room->hair.second_colour = FromSrgb(25, 18, 14);
  room->hair.gloss = 0;
  room->body.size = random.Uniform(0.94, 1.08);
  room->body.seat.x() = random.Uniform(-0.05, 0.05);
  room->body.sleeve = random.Chance(0.6) ? random.Uniform(0.82, 0.93) : random.Uniform(0.3, 0.5);
}

void SetLight(const RoomOptions& options, Room* room, Random& random) {
  Lighting& l = room->lighting;
  l.lamp = {random.Uniform(-0.9, 0.9), random.Uniform(-0.5, 0.6), random.Uniform(1.5, 2.1)};
  l.lamp_size = random.Uniform(0.1, 0.35);
  const double warmth = random.Uniform(-0.06, 0.1);
  const double ratio = random.Uniform(0.6, 1.1);
  l.lamp_colour = options.light * ratio * 0.75 * Vector3(1 + warmth, 1, 1 - 1.3 * warmth);
  l.ambient *= options.light * random.Uniform(0.8, 1.15);
  l.ground *= options.light;
  l.window = {random.Chance(0.5) ? 1.0 : -1.0, random.Uniform(-0.6, 0.4), random.Uniform(0.3, 0.8)};
  l.window_colour *= options.light * random.Uniform(0.3, 1.2);
}

}  // namespace

Room MakeRoom(const RoomOptions& options, Random& random) {
  Room room;
  for (const Pattern::Kind kind : {Pattern::Kind::kPlain, Pattern::Kind::kCloth, Pattern::Kind::kWood,
                                   Pattern::Kind::kPatches, Pattern::Kind::kSpeckle}) {
    room.patterns.emplace_back(kind, random);
  }
  AddTable(&room, random);
  AddBackground(&room, random);
  AddClutter(options, &room, random);
  SetLooks(&room, random);
  SetLight(options, &room, random);
  return room;
}

Material PartMaterial(const HsvRange& range) {
  const double high_hue = range.high[0] + (range.low[0] > range.high[0] ? 180 : 0);
  const double hue = std::fmod(0.5 * (range.low[0] + high_hue), 180.0);
  const double saturation = (0.25 * range.low[1] + 0.75 * std::min(range.high[1], 250)) / 255.0;
  const double value = (0.15 * range.low[2] + 0.85 * std::min(range.high[2], 215)) / 255.0;
  Material m;
  m.colour = FromHsv(hue, saturation, value);
  m.second_colour = 0.93 * m.colour;
  m.pattern = 1;
  m.tile = 0.1;
  m.gloss = 0.06;
  return m;
}

}  // namespace coach
