#include "python/from_python.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "cli/options/option_values.h"
#include "podm/errors.h"

namespace podm::python {
namespace {

namespace py = pybind11;

std::string repr_of(const py::handle& value) {
  return py::str(py::repr(value).attr("encode")("utf-8", "replace").attr("decode")());
}

[[noreturn]] void fail(const std::string& keyword, const std::string& expected, const py::handle& value) {
  throw InputError(fmt::format("{}: {} is expected, not {}", keyword, expected, repr_of(value)));
}

// True for instances of a class of a module: numbers.Real, collections.abc.Mapping.
bool is_a(const py::handle& value, const char* module, const char* name) {
  return py::isinstance(value, py::module_::import(module).attr(name));
}

bool is_bool(const py::handle& value) { return PyBool_Check(value.ptr()) || is_a(value, "numpy", "bool_"); }
bool is_real(const py::handle& value) { return is_a(value, "numbers", "Real") && !is_bool(value); }
bool is_integral(const py::handle& value) { return is_a(value, "numbers", "Integral") && !is_bool(value); }
bool is_text(const py::handle& value) { return py::isinstance<py::str>(value); }
bool is_path(const py::handle& value) { return is_text(value) || py::hasattr(value, "__fspath__"); }
bool is_mapping(const py::handle& value) { return is_a(value, "collections.abc", "Mapping"); }

// Bytes of a text in UTF-8, or of the name of a file as the system has it. C++ takes a NUL, but its libraries
// end at it, and would write or read another file.
std::string bytes_of(const std::string& keyword, const py::handle& value, bool is_file) {
  const auto refuse = [&] {
    fail(keyword,
         is_file ? "the name of a file, without NUL or lone surrogates,"
                 : "text, without NUL or lone surrogates,",
         value);
  };
  try {
    const py::object encoded =
        is_file ? py::module_::import("os").attr("fsencode")(value) : value.attr("encode")();
    std::string bytes = py::cast<py::bytes>(encoded);
    if (bytes.find('\0') != std::string::npos) refuse();
    return bytes;
  } catch (const py::error_already_set&) {
    refuse();
  }
  return {};
}

double real_of(const py::handle& value) {
  return py::cast<double>(py::float_(py::reinterpret_borrow<py::object>(value)));
}

// 1e6 and 1000000 are the same.
std::string text_of_number(const py::handle& value) {
  if (is_integral(value)) return py::str(py::int_(py::reinterpret_borrow<py::object>(value)));
  const double real = real_of(value);
  if (std::isfinite(real) && real == std::floor(real) && std::abs(real) < 1e15)
    return fmt::format("{:.0f}", real);
  return fmt::format("{}", real);
}

std::string number_or_text(const std::string& keyword, const py::handle& value) {
  if (is_real(value)) return text_of_number(value);
  if (!is_path(value)) fail(keyword, "a number or a text", value);
  return bytes_of(keyword, value, !is_text(value));
}

double positive_of(const std::string& keyword, const py::handle& value, const char* quantity) {
  const double number = real_of(value);
  if (!(std::isfinite(number) && number > 0))
    throw InputError(fmt::format("{}: '{}' is not a positive {}", keyword, text_of_number(value), quantity));
  return number;
}

bool is_label_value(const py::handle& value) {
  if (!is_integral(value)) return false;
  const py::int_ number(py::reinterpret_borrow<py::object>(value));
  return number >= py::int_(0) && number < py::int_(std::uint64_t{1} << 32);
}

std::string label_of(const std::string& keyword, const py::handle& value) {
  return is_text(value) ? bytes_of(keyword, value, false)
                        : std::string(py::str(py::int_(py::reinterpret_borrow<py::object>(value))));
}

bool is_label(const py::handle& value) { return is_text(value) || is_label_value(value); }

py::object items_of(const py::handle& mapping) { return mapping.attr("items")(); }

// The value of a number or of a text that holds one.
void assign(double& to, const py::handle& value, const Declaration& of) {
  cli::parse_into(to, number_or_text(spelled(of), value), of);
}

template <std::integral Integer>
void assign(Integer& to, const py::handle& value, const Declaration& of) {
  cli::parse_into(to, number_or_text(spelled(of), value), of);
}

void assign(bool& to, const py::handle& value, const Declaration& of) {
  if (!is_bool(value)) fail(spelled(of), "True or False", value);
  to = py::cast<bool>(py::bool_(py::reinterpret_borrow<py::object>(value)));
}

template <Named Choice>
void assign(Choice& to, const py::handle& value, const Declaration& of) {
  cli::parse_into(to, number_or_text(spelled(of), value), of);
}

void assign(std::string& to, const py::handle& value, const Declaration& of) {
  const bool is_file = std::string(of.type) == "FILE";
  if (is_file && !is_path(value)) fail(spelled(of), "the name of a file", value);
  if (is_file) {
    cli::parse_into(to, bytes_of(spelled(of), value, true), of);
  } else {
    cli::parse_into(to, number_or_text(spelled(of), value), of);
  }
}

void assign(std::array<double, 2>& to, const py::handle& value, const Declaration& of) {
  if (is_text(value)) return cli::parse_into(to, bytes_of(spelled(of), value, false), of);
  if (!is_a(value, "collections.abc", "Iterable")) fail(spelled(of), "a pair of numbers", value);
  const py::list numbers(py::reinterpret_borrow<py::object>(value));
  if (numbers.size() != 2 || !is_real(numbers[0]) || !is_real(numbers[1]))
    fail(spelled(of), "a pair of numbers", value);
  for (std::size_t i = 0; i < 2; ++i) to[i] = positive_of(spelled(of), numbers[i], of.quantity);
}

void assign(cli::LabelLengths& to, const py::handle& value, const Declaration& of) {
  const std::string keyword = spelled(of);
  if (!is_mapping(value))
    fail(keyword, "a dict from names or values of labels to mm, as {\"liver\": 2},", value);
  for (const py::handle item : items_of(value)) {
    const py::object label = item[py::int_(0)], length = item[py::int_(1)];
    if (!is_label(label)) fail(keyword, "a label's name or value", label);
    if (!is_real(length)) fail(keyword, "a length in mm for " + repr_of(label), length);
    const std::string name = label_of(keyword, label);
    to.push_back({name, positive_of(keyword + " " + name, length, "length in mm")});
  }
}

void assign(std::vector<cli::NearLabels>& to, const py::handle& value, const Declaration& of) {
  const std::string keyword = spelled(of);
  if (!is_mapping(value)) fail(keyword, "a dict from pairs of labels to mm, as {(\"liver\", 0): 1},", value);
  for (const py::handle item : items_of(value)) {
    const py::object pair = item[py::int_(0)], size = item[py::int_(1)];
    const bool is_pair = py::isinstance<py::tuple>(pair) && py::len(pair) == 2;
    if (!is_pair || !is_label(pair[py::int_(0)]) || !is_label(pair[py::int_(1)]))
      fail(keyword, "a pair of labels, by name or value,", pair);
    const py::tuple lengths = py::isinstance<py::tuple>(size) ? py::tuple(size) : py::make_tuple(size);
    bool are_lengths = lengths.size() == 1 || lengths.size() == 2;
    for (const py::handle length : lengths) are_lengths = are_lengths && is_real(length);
    if (!are_lengths) fail(keyword, "a length in mm, or a length and a width, for " + repr_of(pair), size);
    cli::NearLabels near{
        .labels = {label_of(keyword, pair[py::int_(0)]), label_of(keyword, pair[py::int_(1)])}};
    const std::string place = fmt::format("{} {},{}", keyword, near.labels[0], near.labels[1]);
    near.radius_mm = positive_of(place, lengths[0], "length in mm");
    near.width_mm = lengths.size() == 1 ? near.radius_mm : positive_of(place, lengths[1], "width in mm");
    to.push_back(near);
  }
}

// One value, an iterable of values, or a text such as "1,3-4".
cli::LabelRanges label_values(const std::string& keyword, const py::handle& value) {
  if (is_text(value)) return parse_label_ranges(bytes_of(keyword, value, false), keyword);
  const bool is_iterable = is_a(value, "collections.abc", "Iterable");
  const py::list values = is_iterable ? py::list(py::reinterpret_borrow<py::object>(value)) : py::list();
  const py::list all =
      is_iterable ? values : py::list(py::make_tuple(py::reinterpret_borrow<py::object>(value)));
  cli::LabelRanges ranges;
  for (const py::handle each : all) {
    if (!is_label_value(each)) ranges.clear();
    if (!is_label_value(each)) break;
    const auto number = py::cast<std::uint32_t>(py::int_(py::reinterpret_borrow<py::object>(each)));
    ranges.emplace_back(number, number);
  }
  if (ranges.empty() || ranges.size() != all.size())
    fail(keyword, "one or several label values, 0 to 2^32 - 1, as [1, 3, 4] or \"1,3-4\",", value);
  return ranges;
}

void assign(cli::LabelRanges& to, const py::handle& value, const Declaration& of) {
  to = label_values(spelled(of), value);
}

// One number, an iterable of numbers, or a text such as "1,0".
void assign(LayerOrder& to, const py::handle& value, const Declaration& of) {
  const std::string keyword = spelled(of);
  if (is_text(value)) return cli::parse_into(to, bytes_of(keyword, value, false), of);
  const bool is_iterable = is_a(value, "collections.abc", "Iterable");
  const py::object given = py::reinterpret_borrow<py::object>(value);
  const py::list numbers = is_iterable ? py::list(given) : py::list(py::make_tuple(given));
  std::vector<std::string> texts;
  for (const py::handle number : numbers) {
    if (!is_integral(number)) fail(keyword, "numbers of layers from bottom to top, as [1, 0],", value);
    texts.push_back(text_of_number(number));
  }
  cli::parse_into(to, fmt::format("{}", fmt::join(texts, ",")), of);
}

void assign(cli::Merges& to, const py::handle& value, const Declaration& of) {
  const std::string keyword = spelled(of);
  if (!is_mapping(value)) fail(keyword, "a dict from names to label values, as {\"kidney\": [2, 3]},", value);
  for (const py::handle item : items_of(value)) {
    const py::object name = item[py::int_(0)], values = item[py::int_(1)];
    if (!is_text(name)) fail(keyword, "a name", name);
    std::string text;
    for (const auto& [first, last] : label_values(keyword, values))
      for (std::uint64_t label = first; label <= last; ++label)
        text += fmt::format("{}{}", text.empty() ? "" : ",", label);
    to.push_back(parse_merge(text + "=" + bytes_of(keyword, name, false)));
  }
}

void assign(cli::MemoryLimit& to, const py::handle& value, const Declaration& of) {
  cli::parse_into(to, number_or_text(spelled(of), value), of);
}

template <class Other>
void assign(Other&, const py::handle&, const Declaration& of) {
  throw InternalError(std::string("no keyword corresponds to ") + of.name);
}

bool is_keyword_of(const Declaration& of, OptionUse use) {
  return (of.uses & use) != 0 || (use == kInPlan && of.group == OptionGroup::kLabels);
}

}  // namespace

cli::MeshCommand command_of(const py::dict& keywords, OptionUse use) {
  cli::MeshCommand command;
  std::set<std::string> known, given;
  for_each_option(command, [&](const Declaration& of, auto& to) {
    if (!is_keyword_of(of, use)) return;
    const std::string keyword = spelled(of);
    known.insert(keyword);
    if (!keywords.contains(keyword) || keywords[keyword.c_str()].is_none()) return;
    const py::object value = keywords[keyword.c_str()];
    assign(to, value, of);
    if (!value.is(py::bool_(false))) given.insert(keyword);
  });
  for (const auto& [keyword, value] : keywords)
    if (!known.contains(std::string(py::str(keyword))))
      throw InputError("unknown keyword " + repr_of(keyword));
  for_each_option(command, [&](const Declaration& of, const auto&) {
    if (!given.contains(spelled(of))) return;
    if (of.needs && !given.contains(spelled(of.needs)))
      throw InputError(fmt::format("{} requires {}", spelled(of), spelled(of.needs)));
    if (of.excludes && given.contains(spelled(of.excludes)))
      throw InputError(fmt::format("{} excludes {}", spelled(of), spelled(of.excludes)));
  });
  return command;
}

std::optional<GmshVersion> gmsh_version_of(const py::object& value) {
  if (value.is_none()) return std::nullopt;
  return cli::parse_choice<GmshVersion>(number_or_text("gmsh_version", value), "gmsh_version");
}

}  // namespace podm::python
