// Label tables: those of ITK-SNAP (IDX R G B A VIS MSH "NAME"), and plain "value name ..." lines as in the
// tables of MRIcron.
#include <cctype>
#include <fstream>
#include <sstream>

#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm {

namespace {

// The quoted name in an ITK-SNAP line, or the word after the value.
std::string name_in(const std::string& rest) {
  const std::size_t open = rest.find('"'), close = rest.rfind('"');
  if (open != std::string::npos && close > open) return rest.substr(open + 1, close - open - 1);
  std::istringstream words(rest);
  std::string name;
  words >> name;
  if (name == "\"\"") name.clear();
  return name;
}

}  // namespace

std::map<std::uint32_t, std::string> read_label_names(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": the label table cannot be opened");
  std::map<std::uint32_t, std::string> names;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    const std::size_t start = line.find_first_not_of(" \t\r");
    if (start == std::string::npos || line[start] == '#') continue;
    std::istringstream words(line);
    std::int64_t value = -1;
    std::string rest;
    if (!(words >> value) || value < 0 || value > 0xffffffffll || !std::getline(words, rest) ||
        std::isspace(static_cast<unsigned char>(rest.front())) == 0) {
      throw InputError(path + ":" + std::to_string(number) + ": expected a label value and its name");
    }
    const std::string name = name_in(rest);
    if (name.empty()) throw InputError(path + ":" + std::to_string(number) + ": the label has no name");
    names[static_cast<std::uint32_t>(value)] = name;
  }
  if (names.empty()) throw InputError(path + ": the label table has no label");
  return names;
}

}  // namespace podm
