// Tables of label names and colours. A title in a comment, otherwise the first line of a label, decides the
// format of all lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "image/number_of.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

enum class TableFormat { kItkSnap, kColours, kNames };

constexpr const char* kKnownFormats =
    "ITK-SNAP's label descriptions, colour tables of FreeSurfer and 3D Slicer, lines 'value name'";

const char* line_of(TableFormat format) {
  switch (format) {
    case TableFormat::kItkSnap:
      return "a line of ITK-SNAP, VALUE R G B A VIS MSH \"NAME\"";
    case TableFormat::kColours:
      return "a label value, its name and its colour, VALUE NAME R G B A";
    case TableFormat::kNames:
      break;
  }
  return "a label value and its name";
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// Three words from `at`.
std::optional<Rgb> colour_at(const std::vector<std::string>& words, std::size_t at) {
  Rgb colour{};
  for (std::size_t i = 0; i < colour.size(); ++i) {
    const auto share = number_of<std::uint8_t>(words[at + i]);
    if (!share) return std::nullopt;
    colour[i] = *share;
  }
  return colour;
}

// A line without its quoted part, and this part without its quotes.
struct Line {
  std::vector<std::string> words;
  std::optional<std::string> quoted;

  explicit Line(const std::string& text) {
    const std::size_t open = text.find('"'), close = text.rfind('"');
    const bool has_quotes = open != std::string::npos && close > open;
    if (has_quotes) quoted = text.substr(open + 1, close - open - 1);
    words = words_of(has_quotes ? text.substr(0, open) : text);
  }
  std::optional<std::uint32_t> value() const {
    return words.empty() ? std::nullopt : number_of<std::uint32_t>(words[0]);
  }
};

// VALUE R G B A VIS MSH "NAME"
std::optional<Label> label_of_itk_snap(const Line& line) {
  const auto value = line.value();
  if (!value || line.words.size() != 7 || !line.quoted) return std::nullopt;
  const auto colour = colour_at(line.words, 1);
  const bool has_numbers = std::all_of(line.words.begin() + 4, line.words.end(), [](const std::string& word) {
    return number_of<double>(word).has_value();
  });
  if (!colour || !has_numbers) return std::nullopt;
  return Label{*value, *line.quoted, colour};
}

// VALUE NAME R G B A; blanks belong to the name.
std::optional<Label> label_of_colours(const Line& line) {
  const auto value = line.value();
  const std::size_t num_words = line.words.size();
  if (!value || num_words < 6 || line.quoted) return std::nullopt;
  const auto colour = colour_at(line.words, num_words - 4);
  if (!colour || !number_of<std::uint8_t>(line.words.back())) return std::nullopt;
  std::string name = line.words[1];
  for (std::size_t i = 2; i < num_words - 4; ++i) name += " " + line.words[i];
  return Label{*value, name, colour};
}

bool is_number(const std::string& word) {
  const auto number = number_of<double>(word);
  return number && std::isfinite(*number);
}

// VALUE NAME, or VALUE "NAME". Blanks belong to the name. Numbers at the end, which tables of MRIcron have,
// do not.
std::optional<Label> label_of_names(const Line& line) {
  const auto value = line.value();
  if (!value || (line.words.size() < 2 && !line.quoted)) return std::nullopt;
  if (line.quoted) return Label{*value, *line.quoted, std::nullopt};
  std::size_t end = line.words.size();
  while (end > 2 && is_number(line.words[end - 1])) --end;
  std::string name = line.words[1];
  for (std::size_t i = 2; i < end; ++i) name += " " + line.words[i];
  return Label{*value, name, std::nullopt};
}

std::optional<Label> label_of(const Line& line, TableFormat format) {
  switch (format) {
    case TableFormat::kItkSnap:
      return label_of_itk_snap(line);
    case TableFormat::kColours:
      return label_of_colours(line);
    case TableFormat::kNames:
      break;
  }
  return label_of_names(line);
}

std::optional<TableFormat> format_by_title(std::string_view comment) {
  constexpr std::array<std::pair<std::string_view, TableFormat>, 3> kTitles{
      {{"ITK-SnAP Label Description File", TableFormat::kItkSnap},
       {"Label Name:", TableFormat::kColours},         // FreeSurfer
       {"Color table file", TableFormat::kColours}}};  // 3D Slicer
  for (const auto& [title, format] : kTitles)
    if (comment.find(title) != std::string_view::npos) return format;
  return std::nullopt;
}

std::optional<TableFormat> format_of(const Line& line) {
  for (const TableFormat format : {TableFormat::kItkSnap, TableFormat::kColours, TableFormat::kNames})
    if (label_of(line, format)) return format;
  return std::nullopt;
}

}  // namespace

std::vector<Label> read_label_table(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": the label table cannot be opened");
  std::optional<TableFormat> format;
  std::vector<Label> labels;
  std::string text;
  for (std::size_t number = 1; std::getline(file, text); ++number) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";  // editors of Windows begin files with it
    if (number == 1 && text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    const auto refuse = [&](const std::string& fault) {
      throw InputError(path + ":" + std::to_string(number) + ": " + fault);
    };
    const std::size_t start = text.find_first_not_of(" \t\r");
    if (start == std::string::npos) continue;
    if (text[start] == '#') {
      if (!format) format = format_by_title(text);
      continue;
    }
    const Line line(text);
    if (!format) format = format_of(line);
    if (!format) refuse(std::string("no known format of label tables (known: ") + kKnownFormats + ")");
    std::optional<Label> label = label_of(line, *format);
    if (!label) refuse(std::string("expected ") + line_of(*format));
    if (label->name.empty()) refuse("the label has no name");
    labels.push_back(std::move(*label));
  }
  if (labels.empty()) throw InputError(path + ": the label table has no label");
  return labels;
}

}  // namespace podm
