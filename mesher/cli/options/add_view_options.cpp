// The options of podm view.
#include <fmt/format.h>

#include "cli/options/add_options.h"

namespace podm::cli {
namespace {

constexpr int kLeastPixels = 16, kMostPixels = 16384;
constexpr const char* kPlaneForm =
    "AXIS=PLACE or none: AXIS is x, y, z or a normal such as 1,1,0; "
    "PLACE is a fraction such as 0.5, or -20mm";

std::array<double, 3> parse_normal(const std::string& text, const std::string& option) {
  if (text == "x") return {1, 0, 0};
  if (text == "y") return {0, 1, 0};
  if (text == "z") return {0, 0, 1};
  const std::vector<double> normal = parse_numbers(text, option, 3, kPlaneForm);
  if (normal == std::vector<double>(3))
    throw InputError(fmt::format("{}: '{}' has no direction", option, text));
  return {normal[0], normal[1], normal[2]};
}

std::optional<CutPlane> parse_plane(const std::string& text, const std::string& option) {
  if (text == "none") return std::nullopt;
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    throw InputError(fmt::format("{}: '{}' is not {}", option, text, kPlaneForm));
  CutPlane plane{.normal = parse_normal(text.substr(0, equals), option)};
  std::string place = text.substr(equals + 1);
  plane.is_fraction = !place.ends_with("mm");
  if (!plane.is_fraction) place.resize(place.size() - 2);
  plane.place = parse_numbers(place, option, 1, kPlaneForm)[0];
  if (plane.is_fraction && !(plane.place > 0 && plane.place < 1))
    throw InputError(
        fmt::format("{}: '{}' is not a fraction between 0 and 1; write mm as {}mm", option, place, place));
  return plane;
}

std::array<int, 2> parse_size(const std::string& text, const std::string& option) {
  const std::size_t times = text.find('x');
  if (times == std::string::npos)
    throw InputError(fmt::format("{}: '{}' is not WIDTHxHEIGHT, as in 1600x1200", option, text));
  const auto pixels = [&](const std::string& part) {
    return static_cast<int>(parse_integer(part, option, kLeastPixels, kMostPixels));
  };
  return {pixels(text.substr(0, times)), pixels(text.substr(times + 1))};
}

std::string parse_colour(const std::string& text, const std::string& option) {
  if (text == "white") return "#ffffff";
  if (text == "black") return "#000000";
  const bool is_hexadecimal = text.size() == 7 && text[0] == '#' &&
                              text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (!is_hexadecimal) throw InputError(fmt::format("{}: '{}' is not white, black or #rrggbb", option, text));
  return text;
}

std::vector<std::string> parse_names(const std::string& text, const std::string& option) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    names.push_back(text.substr(begin, end - begin));
    if (names.back().empty()) throw InputError(fmt::format("{}: '{}' has an empty name", option, text));
    begin = end + 1;
  }
  return names;
}

void add_cut_options(CLI::App& app, ViewCommand& command) {
  begin_group(app, "Parts shown");
  add_one(app, "--cut", "PLANE",
          "omit cells beyond this plane: an axis or a normal, and a place, as a\n"
          "fraction of the mesh's extent or in mm: x=0.5, z=-20mm, 1,1,0=0.3;\nor none",
          into(command.cut, parse_plane, "y=0.5"));
  add_flag(app, "--flip", command.flip,
           "omit the cells on the other side of the cut, and look from there [default: no]");
  add_one(app, "--labels", "NAMES",
          "show only these labels, by name or value, e.g. liver,spleen [default: all]",
          into(command.labels, parse_names));
  add_one(app, "--hide", "NAMES", "show all labels except these [default: none]",
          into(command.hide, parse_names));
}

void add_look_options(CLI::App& app, ViewCommand& command) {
  begin_group(app, "Appearance");
  add_one(app, "--colour", type_of_choices<Colour>(),
          "label; or quality of cells, bad cells bright: dihedral (smallest angle),\n"
          "ratio (circumradius over shortest edge) or size (circumradius)",
          into(command.colour, parse_choice<Colour>, to_string(command.colour)));
  add_one(app, "--camera", "DEG,DEG",
          "direction of view: degrees to the right of the direction that faces the cut,\n"
          "and degrees above it",
          {[&command](const std::string& text, const std::string& name) {
             const auto angles = parse_numbers(text, name, 2, "two angles in degrees, as in 20,15");
             command.camera_deg = {angles[0], angles[1]};
           },
           fmt::format("{:g},{:g}", command.camera_deg[0], command.camera_deg[1])});
  add_one(app, "--zoom", "X", "magnification; at 1 the whole mesh fits the picture",
          into(
              command.zoom,
              [](const std::string& text, const std::string& name) {
                return parse_positive(text, name, "number");
              },
              shown(command.zoom)));
  add_one(app, "--size", "WxH", "size of the picture, pixels",
          into(command.size, parse_size, fmt::format("{}x{}", command.size[0], command.size[1])));
  add_one(app, "--background", "COLOUR", "white, black or #rrggbb",
          into(command.background, parse_colour, "white"));
  add_flag(app, "--no-legend", command.without_legend,
           "omit the legend of colours [default: it is at the right]");
}

}  // namespace

void add_view_command(CLI::App& program, ViewCommand& command) {
  CLI::App& app =
      add_command(program, "view", "draw a picture of a mesh, cut open, coloured by label or quality");
  require(add_one(app, "MESH", "", "tetrahedra with labels: a file that podm-verify reads",
                  into(command.mesh_path)));
  begin_group(app, "Options");
  require(add_one(app, "-o,--output", "PICTURE", "PNG file [required]",
                  [&command](const std::string& text, const std::string& name) {
                    if (!text.ends_with(".png"))
                      throw InputError(fmt::format("{}: '{}' does not end in .png", name, text));
                    command.output_path = text;
                  }));
  add_cut_options(app, command);
  add_look_options(app, command);
}

}  // namespace podm::cli
