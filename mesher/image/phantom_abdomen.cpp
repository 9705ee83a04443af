#include "image/phantom_abdomen.h"

#include <numbers>

namespace podm {

namespace {

Shape body_layer(double inset) {
  return superellipsoid({0, 0, 0}, {165 - inset, 112 - inset, 97 - inset}, 2.4, 8);
}

// Bodies, discs, arches and the canal of six lumbar levels.
void add_spine(std::vector<Organ>& organs) {
  constexpr double kLevel = 34, kY = -52;
  for (int i = -3; i <= 2; ++i) {
    const double z = kLevel * (i + 0.5);
    organs.push_back({16, "disc", ellipsoid({0, kY, z - kLevel / 2}, {24, 19, 8})});
    organs.push_back({15, "vertebra", superellipsoid({0, kY, z}, {23, 18, 12.5}, 2.2, 5)});
    organs.push_back({15, "vertebra", tube({{-34, kY - 26, z}, {0, kY - 27, z - 2}, {34, kY - 26, z}}, 5)});
    organs.push_back({15, "vertebra", tube({{0, kY - 27, z}, {0, kY - 46, z - 8}}, 4)});
  }
  organs.push_back({17, "spinal canal", tube({{0, kY - 25, -86}, {0, kY - 25, 86}}, 7)});
}

void add_ribs(std::vector<Organ>& organs) {
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < 4; ++i) {
      std::vector<Point> path;
      for (int step = 2; step <= 13; ++step) {
        path.push_back(on_ellipse(side * step * std::numbers::pi / 18, 144, 93, 74 - 24.0 * i, -26));
      }
      organs.push_back({18, "rib", within(tube(path, 4.5), body_layer(8))});
    }
  }
}

void add_bowel(std::vector<Organ>& organs) {
  std::vector<Point> path;
  for (int i = 0; i <= 44; ++i) {  // a snake in three layers
    const double t = i / 44.0 * 6 * std::numbers::pi;
    path.push_back({62 * std::sin(t), 38 + 20 * std::cos(2.3 * t), -76 + 58 * i / 44.0});
  }
  organs.push_back({19, "bowel wall", tube(path, 12)});
  organs.push_back({20, "bowel lumen", tube(path, 9)});
}

void add_kidney(std::vector<Organ>& organs, double side, std::uint32_t label, const char* name) {
  const Point c{side * 68, -42, 4 + 6 * side};
  organs.push_back(
      {label, name,
       without(ellipsoid(c, {26, 22, 50}), ellipsoid({c.x - side * 26, c.y + 6, c.z}, {14, 12, 15}))});
  organs.push_back({23, "renal pelvis", ellipsoid({c.x - side * 6, c.y + 2, c.z}, {11, 9, 24})});
}

void add_vessels(std::vector<Organ>& organs) {
  organs.push_back({12, "aorta", tube({{-14, -24, 88}, {-13, -22, -40}, {-34, -20, -84}}, 9.5)});
  organs.push_back({12, "aorta", tube({{-13, -22, -40}, {16, -20, -84}}, 7)});
  for (const double side : {-1.0, 1.0}) {
    organs.push_back({12, "aorta", tube({{-13, -22, 14}, {side * 36, -34, 8}, {side * 58, -38, 6}}, 3)});
  }
  organs.push_back({13, "vena cava", tube({{20, -22, 88}, {21, -21, -40}, {34, -20, -84}}, 11)});
  organs.push_back({14, "portal vein", tube({{4, 4, -6}, {24, 6, 20}, {48, 10, 34}}, 6.5)});
  organs.push_back({14, "portal vein", tube({{48, 10, 34}, {84, 0, 46}, {104, -12, 58}}, 4)});
  organs.push_back({14, "portal vein", tube({{48, 10, 34}, {34, 36, 48}, {6, 52, 56}}, 3.5)});
  organs.push_back({14, "portal vein", tube({{84, 0, 46}, {104, 26, 30}}, 2.5)});
  organs.push_back({14, "portal vein", tube({{4, 4, -6}, {-40, -4, 8}, {-92, -30, 34}}, 3.5)});  // splenic
}

}  // namespace

std::vector<Organ> abdomen_organs() {
  std::vector<Organ> organs{
      {1, "skin", body_layer(0)},
      {2, "fat", body_layer(4)},
      {3, "muscle wall", body_layer(16)},
      {4, "abdominal cavity", superellipsoid({0, 8, 0}, {134, 80, 86}, 2.4, 8)},
  };
  const Shape cavity = superellipsoid({0, 6, 0}, {136, 86, 88}, 2.4, 8);
  add_ribs(organs);
  organs.push_back({21, "psoas muscle", tube({{40, -58, 40}, {52, -48, -84}}, 17)});
  organs.push_back({21, "psoas muscle", tube({{-40, -58, 40}, {-52, -48, -84}}, 17)});
  organs.push_back(
      {5, "liver",
       within(without(ellipsoid({58, 8, 36}, {84, 70, 56}), ellipsoid({26, -12, -16}, {54, 46, 34})),
              cavity)});
  organs.push_back({5, "liver", within(ellipsoid({-4, 40, 52}, {58, 30, 24}), cavity)});
  organs.push_back({9, "stomach wall", tube({{-66, 2, 62}, {-76, 18, 34}, {-56, 40, 10}, {-16, 44, 2}}, 23)});
  organs.push_back(
      {22, "stomach lumen", tube({{-66, 2, 62}, {-76, 18, 34}, {-56, 40, 10}, {-16, 44, 2}}, 19)});
  organs.push_back(
      {6, "spleen",
       within(without(ellipsoid({-104, -26, 40}, {28, 40, 44}), ellipsoid({-72, -6, 40}, {26, 34, 34})),
              cavity)});
  organs.push_back({10, "gallbladder", tube({{46, 40, -2}, {56, 54, -16}}, 11)});
  organs.push_back({11, "pancreas", tube({{30, 6, -12}, {0, 14, 2}, {-48, -2, 14}, {-78, -18, 26}}, 10)});
  add_kidney(organs, 1, 7, "right kidney");
  add_kidney(organs, -1, 8, "left kidney");
  add_bowel(organs);
  add_spine(organs);
  add_vessels(organs);
  return organs;
}

}  // namespace podm
