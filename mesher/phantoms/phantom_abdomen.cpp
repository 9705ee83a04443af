// The abdomen, from the skin inwards: a patient who lies on the back, cut off above the liver and below the
// navel.
#include "phantoms/phantom_abdomen.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace podm {

namespace {

// The part of the body at least `depth` mm below the skin.
Shape body(double depth) { return slab({0, 0, 0}, kAbdomenHalfExtent - Vector{depth, depth, depth}); }

Shape cavity() { return slab({0, 8, 0}, {137, 82, 84}); }
Shape right_dome() { return dome({60, 4, 22}, {86, 84, 56}); }
Shape left_dome() { return dome({-66, 0, 14}, {80, 84, 58}); }

// The fat around a kidney is this much wider than the kidney, mm. Neighbors keep this distance.
constexpr double kPerirenalFat = 4;
constexpr Point kRightKidney{80, -44, -8}, kLeftKidney{-80, -44, 4};
Shape kidney(const Point& c, double widened_by) {
  const double w = widened_by;
  return leaning(ellipsoid(c, {27 + w, 23 + w, 50 + w}), c, c.x > 0 ? -10 : 10);
}

void add_wall(std::vector<Organ>& organs) {
  organs.push_back({1, "skin", body(0)});
  organs.push_back({2, "subcutaneous fat", body(4)});
  organs.push_back({3, "muscle wall", body(16)});
  organs.push_back({4, "visceral fat", cavity()});
}

// The lungs extend downwards in a wedge between the wall and the diaphragm.
void add_chest(std::vector<Organ>& organs) {
  const Shape chest = within(cavity(), above(24));
  organs.push_back({5, "lung", chest});
  organs.push_back({4, "visceral fat", within(dome({0, 10, 40}, {40, 96, 90}), cavity())});
  organs.push_back({6, "heart", within(ellipsoid({-18, 40, 84}, {52, 36, 22}), cavity())});
  for (const Shape& side : {left_dome(), right_dome()}) {
    organs.push_back({3, "muscle wall", within(side, chest)});
  }
  for (const Shape& side : {dome({-66, 0, 11}, {77, 81, 58}), dome({60, 4, 19}, {83, 81, 56})}) {
    organs.push_back({4, "visceral fat", within(side, cavity())});
  }
}

void add_muscles(std::vector<Organ>& organs) {
  const Shape psoas = tube(smooth({{{30, -58, 48}, 8}, {{42, -54, -10}, 16}, {{54, -44, -90}, 20}}));
  const Shape back = tube({{{30, -84, 92}, 15}, {{31, -84, -92}, 18}});
  for (const Shape& side : {psoas, mirrored(psoas)}) organs.push_back({7, "psoas", within(side, body(16))});
  for (const Shape& side : {back, mirrored(back)}) {
    organs.push_back({8, "back muscle", within(side, body(15))});
  }
}

void add_bones(std::vector<Organ>& organs) {
  constexpr double kLevel = 34, kY = -48;  // distance of vertebrae, and y of the middle of their bodies
  const Shape clip = body(7);              // ends below the skin
  for (int level = -3; level <= 3; ++level) {
    const double z = kLevel * level;
    organs.push_back({10, "disc", within(ellipsoid({0, kY, z - kLevel / 2}, {24, 20, 9}), clip)});
    const Shape waist = torus(32, 11);
    const Shape waist_here{[=](const Point& p) {
                             return waist.value({p.x, (p.y - kY) * 1.2, p.z - z});
                           },
                           waist.low, waist.high};
    for (const Shape& part :
         {without(slab({0, kY, z}, {23, 19, 13.5}), waist_here),
          tube(smooth({{16, kY - 12, z}, {14, kY - 32, z}, {0, kY - 42, z}}, 5)),    // arch, right
          tube(smooth({{-16, kY - 12, z}, {-14, kY - 32, z}, {0, kY - 42, z}}, 5)),  // arch, left
          tube({{{14, kY - 26, z}, 5}, {{46, kY - 32, z + 2}, 3.5}}),                // transverse processes
          tube({{{-14, kY - 26, z}, 5}, {{-46, kY - 32, z + 2}, 3.5}}),              //
          tube({{{0, kY - 40, z}, 4}, {{0, kY - 50, z - 8}, 4.5}})}) {               // spinous process
      organs.push_back({9, "vertebra", within(part, clip)});
    }
  }
  organs.push_back({11, "spinal canal", within(tube({{0, kY - 27, -97}, {0, kY - 27, 97}}, 8), clip)});

  constexpr double kDegree = std::numbers::pi / 180, kRibDepth = 22, kRibDrop = 34;
  const Vector ring = kAbdomenHalfExtent - Vector{kRibDepth, kRibDepth, 0};
  for (int i = 0; i < 4; ++i) {
    std::vector<Point> path;
    for (double angle = 18; angle <= 142 - 22 * i; angle += 4) {
      const double z = 66 - 23 * i - kRibDrop * (1 - std::cos(angle * kDegree)) / 2;
      path.push_back(on_slab_outline(ring, angle * kDegree, z));
    }
    const Shape rib = within(tube(path, 4.5), body(10));
    organs.push_back({12, "rib", rib});
    organs.push_back({12, "rib", mirrored(rib)});
  }
  const Shape wing = within(
      without(ellipsoid({94, -34, -98}, {42, 50, 46}), ellipsoid({86, -24, -98}, {42, 50, 48})), body(10));
  organs.push_back({13, "hip bone", wing});
  organs.push_back({13, "hip bone", mirrored(wing)});
}

void add_liver(std::vector<Organ>& organs) {
  const Shape room = within(dome({60, 4, 17}, {81, 79, 56}), slab({0, 8, 0}, {135, 80, 82}));
  const Shape hollow = ellipsoid({22, -2, -26}, {62, 62, 44});  // holds gut and pancreas
  const Shape back = ellipsoid({4, -50, 30}, {50, 44, 120});    // holds spine and great vessels
  const Shape right = without(without(without(ellipsoid({70, 2, 20}, {72, 78, 60}), hollow), back),
                              kidney(kRightKidney, kPerirenalFat));
  organs.push_back({14, "liver", within(right, room)});
  organs.push_back({14, "liver", within(without(ellipsoid({4, 46, 48}, {58, 32, 24}), hollow), cavity())});
  organs.push_back(
      {15, "gallbladder", tube(smooth({{{44, 26, 2}, 4}, {{52, 44, -8}, 10}, {{60, 58, -22}, 13}}))});
}

void add_spleen(std::vector<Organ>& organs) {
  const Shape room = within(dome({-66, 0, 9}, {75, 79, 58}), slab({0, 8, 0}, {135, 80, 82}));
  const Shape spleen =
      without(without(ellipsoid({-106, -26, 30}, {34, 46, 44}), ellipsoid({-72, 10, 30}, {34, 46, 44})),
              kidney(kLeftKidney, kPerirenalFat));
  organs.push_back({16, "spleen", within(spleen, room)});
}

void add_kidney(std::vector<Organ>& organs, std::uint32_t label, const char* name, const Point& c) {
  const double medial = c.x > 0 ? -1 : 1;
  const auto turned = [&](const Shape& shape) { return leaning(shape, c, -10 * -medial); };
  const Point hilum{c.x + medial * 26, c.y + 6, c.z};
  organs.push_back({label, name, without(kidney(c, 0), turned(ellipsoid(hilum, {16, 13, 16})))});
  for (int row = -2; row <= 2; ++row) {  // pyramids
    for (const double side : {-1.0, 0.0, 1.0}) {
      const double z = c.z + 15.5 * row, reach = row * row == 4 ? 0.5 : 1;
      const Point at{c.x - medial * (side == 0 ? 13 : 2) * reach, c.y + 12 * side * reach, z};
      organs.push_back({19, "renal medulla", turned(ellipsoid(at, {6.5, 6, 6}))});
    }
  }
  const Shape pelvis = tube(smooth({{{c.x - medial * 2, c.y, c.z + 22}, 4},
                                    {{c.x + medial * 6, c.y + 2, c.z}, 7},
                                    {{c.x - medial * 2, c.y, c.z - 22}, 4}}));
  organs.push_back({20, "renal pelvis", turned(pelvis)});
  organs.push_back({20, "renal pelvis",  // and ureter
                    tube(smooth({{{c.x + medial * 6, c.y + 2, c.z}, 7},
                                 {{c.x + medial * 26, c.y + 10, c.z - 18}, 4.5},
                                 {{c.x + medial * 34, c.y + 20, -70}, 3.5}}))});
  for (const double limb : {-9.0, 9.0}) {
    organs.push_back({21, "adrenal gland",
                      tube({{{c.x + medial * 30, c.y + 10, c.z + 52}, 3.5},
                            {{c.x + medial * (30 - limb), c.y - 6, c.z + 38}, 2.5}})});
  }
}

void add_stomach_and_bowel(std::vector<Organ>& organs) {
  organs.push_back({26, "duodenum",
                    tube(smooth({{6, 46, 2},
                                 {34, 40, 0},
                                 {52, 22, -10},
                                 {52, 4, -32},
                                 {26, 4, -44},
                                 {-20, 6, -42},
                                 {-36, 16, -38}},
                                10))});

  constexpr double kWall = 3.5;
  const auto stomach = smooth(
      {{{-60, 0, 42}, 22}, {{-74, 10, 34}, 25}, {{-66, 36, 12}, 23}, {{-34, 50, 4}, 17}, {{2, 46, 4}, 11}});
  organs.push_back({22, "stomach wall", within(tube(stomach), cavity())});
  const Shape inside = tube(widened(stomach, -kWall));
  organs.push_back({23, "stomach fluid", inside});
  organs.push_back(
      {24, "stomach gas", within(inside, in_front_of(34))});  // gas rises: the patient lies on the back

  const auto small_bowel = smooth({{-36, 16, -38},
                                   {-58, 28, -40},
                                   {-30, 36, -42},
                                   {20, 28, -42},
                                   {60, 34, -46},
                                   {58, 58, -52},
                                   {10, 56, -52},
                                   {-52, 55, -52},
                                   {-70, 42, -64},
                                   {-40, 28, -70},
                                   {16, 34, -72},
                                   {56, 22, -70},
                                   {44, 4, -72},
                                   {-8, 8, -70},
                                   {-58, 0, -68}},
                                  11);
  organs.push_back({27, "small bowel wall", within(tube(small_bowel), cavity())});
  organs.push_back({28, "small bowel lumen", within(tube(widened(small_bowel, -2.5)), cavity())});

  const auto colon = waved(smooth({{92, -6, -92},
                                   {102, 0, -62},
                                   {104, 12, -38},
                                   {88, 42, -26},
                                   {46, 70, -20},
                                   {0, 74, -18},
                                   {-48, 73, -22},
                                   {-92, 43, -24},
                                   {-110, 16, -14},
                                   {-110, -8, -32},
                                   {-108, -10, -50},
                                   {-92, -8, -92}},
                                  16),
                           2, 22);
  organs.push_back({29, "colon wall", within(tube(colon), cavity())});
  organs.push_back({30, "colon content", within(tube(widened(colon, -3)), slab({0, 8, 0}, {134, 79, 81}))});
}

void add_vessels(std::vector<Organ>& organs) {
  const auto add = [&](std::uint32_t label, const char* name, const std::vector<Knot>& knots) {
    organs.push_back({label, name, within(tube(smooth(knots)), body(16))});
  };
  add(31, "aorta", {{{-12, -17, 90}, 10}, {{-12, -17, 0}, 9}, {{-10, -18, -52}, 8}});
  for (const double side : {-1.0, 1.0}) {
    add(31, "aorta",
        {{{-10, -18, -50}, 7.5}, {{-10 + 20 * side, -20, -72}, 6}, {{-8 + 42 * side, -20, -92}, 6}});
    add(31, "aorta", {{{-12, -18, 8}, 3.5}, {{22 * side, -32, 2}, 3.5}, {{60 * side, -40, -5 * side}, 3}});
  }
  add(31, "aorta", {{{-12, -12, 14}, 4}, {{-10, 2, 2}, 4}, {{-6, 18, -26}, 3.5}, {{0, 26, -56}, 3}});
  add(32, "vena cava", {{{22, -10, 90}, 12}, {{20, -15, 30}, 12}, {{20, -17, -52}, 11}});
  add(32, "vena cava", {{{20, -17, -50}, 9}, {{34, -24, -76}, 7.5}, {{48, -24, -92}, 7.5}});
  add(32, "vena cava", {{{18, -18, -50}, 9}, {{-2, -26, -72}, 7.5}, {{-34, -28, -92}, 7.5}});
  for (const double side : {-1.0, 1.0}) {
    add(32, "vena cava",
        {{{20, -15, 4}, 4.5}, {{20 + 18 * side, -16, 1}, 4.5}, {{62 * side, -36, -2 - 5 * side}, 4}});
  }
  add(33, "portal vein", {{{0, 8, -34}, 5}, {{6, 4, -4}, 7}, {{24, 8, 22}, 7}, {{46, 10, 34}, 6.5}});
  add(33, "portal vein", {{{46, 10, 34}, 6}, {{78, 2, 36}, 5}, {{108, -14, 40}, 3}});
  add(33, "portal vein", {{{78, 2, 36}, 4.5}, {{98, 24, 26}, 3.5}, {{112, 34, 14}, 2.5}});
  add(33, "portal vein", {{{40, 10, 32}, 5.5}, {{28, 34, 44}, 4.5}, {{0, 48, 46}, 3}});
  add(33, "portal vein", {{{4, 2, -6}, 5}, {{-32, 0, 8}, 4.5}, {{-76, -10, 24}, 4}});  // from the spleen
  add(34, "hepatic vein", {{{22, -8, 64}, 6}, {{58, -4, 58}, 5}, {{98, 4, 50}, 2.5}});
  add(34, "hepatic vein", {{{22, -8, 64}, 6}, {{44, 20, 58}, 5}, {{62, 46, 44}, 2.5}});
  add(34, "hepatic vein", {{{22, -8, 64}, 6}, {{16, 22, 58}, 4.5}, {{-8, 44, 56}, 2.5}});
}

}  // namespace

std::vector<Organ> abdomen_organs() {
  std::vector<Organ> organs;
  add_wall(organs);
  add_chest(organs);
  add_muscles(organs);
  add_bones(organs);
  add_liver(organs);
  add_spleen(organs);
  add_kidney(organs, 17, "right kidney", kRightKidney);
  add_kidney(organs, 18, "left kidney", kLeftKidney);
  organs.push_back(
      {25, "pancreas",
       tube(smooth({{{32, 10, -16}, 14}, {{8, 14, -2}, 8}, {{-32, 8, 6}, 9}, {{-80, -6, 24}, 6}}))});
  add_vessels(organs);
  add_stomach_and_bowel(organs);
  return organs;
}

std::vector<Organ> membrane_organs() {
  constexpr std::array<std::uint32_t, 4> kLarge{14, 16, 17, 18};  // liver, spleen, kidneys
  std::vector<Organ> organs{{1, "body", body(0)}};
  for (Organ& organ : abdomen_organs())
    if (std::ranges::count(kLarge, organ.label) > 0) organs.push_back(std::move(organ));
  organs.push_back({19, "membrane", within(ellipsoid({0, 60, -10}, {50, 1000, 35}), coronal_sheet(60, 2.2))});
  return organs;
}

}  // namespace podm
